// A row of a CSV file.
#pragma once

#include <sherd/evaluate.h>

#include <charconv>
#include <optional>
#include <string>

namespace sherd::cli {

/// One row; absent values are empty fields.
class CsvRow {
 public:
  void add(const std::string& text) {
    const bool plain = text.find_first_of(",\"\r\n") == std::string::npos;
    std::string field = plain ? text : "\"";
    if (!plain) {
      for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
      field += '"';
    }
    line_ += (line_.empty() ? "" : ",") + field;
  }
  void add(std::size_t value) { add(std::to_string(value)); }
  void add(int value) { add(std::to_string(value)); }
  void add(bool value) { add(std::string(value ? "1" : "0")); }
  void add(double value) {  // the shortest text that reads back exactly
    char text[40];
    add(std::string(text, std::to_chars(text, text + sizeof text, value).ptr));
  }
  template <class Value>
  void add(const std::optional<Value>& value) {
    value ? add(*value) : add(std::string());
  }
  void add(const std::optional<DistanceSummary>& d) {
    add(d ? std::optional(d->mean) : std::nullopt);
    add(d ? std::optional(d->p99) : std::nullopt);
    add(d ? std::optional(d->max) : std::nullopt);
  }

  std::string line() const { return line_ + "\n"; }

 private:
  std::string line_;
};

}  // namespace sherd::cli
