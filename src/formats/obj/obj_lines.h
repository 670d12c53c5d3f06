// The lines of an OBJ file.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "base/text/text_scan.h"

namespace sherd {

/// The lines of an OBJ file; a line that ends in a backslash is joined with the next.
class ObjLines {
 public:
  explicit ObjLines(std::string_view text) : lines_(text) {}
  bool next() {
    if (!lines_.next()) return false;
    line_ = lines_.line();
    number_ = lines_.number();
    if (!line_.ends_with('\\')) return true;
    joined_.clear();
    while (line_.ends_with('\\')) {
      joined_.append(line_.substr(0, line_.size() - 1)).append(" ");
      line_ = lines_.next() ? lines_.line() : std::string_view();
    }
    line_ = joined_.append(line_);
    return true;
  }
  std::string_view line() const { return line_; }
  std::size_t number() const { return number_; }  // of the first line joined

 private:
  LineReader lines_;
  std::string joined_;
  std::string_view line_;
  std::size_t number_ = 0;
};

}  // namespace sherd
