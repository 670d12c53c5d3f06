// Reads a PLY file's header, and the values of its body in sequence.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/little_endian.h"
#include "base/text/text_scan.h"
#include "formats/mesh/mesh_reader.h"

namespace sherd {

struct PlyType {
  std::size_t bytes = 0;
  bool isInteger = false;
  bool isSigned = false;
};

struct PlyProperty {
  std::string name;
  std::optional<PlyType> listCount;  // set for a list
  PlyType value;
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyEncoding { ascii, littleEndian, bigEndian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;  // without the keyword
  std::size_t bodyAt = 0;             // first byte after the header
  std::size_t lineCount = 0;
};

/// Reads a header.
///   throws  Error(input) no PLY, cut short, a type or format that is not known
[[nodiscard]] PlyHeader readPlyHeader(const MeshFile& file);

// Reads the values of the body in sequence, binary or text; reading past the end throws the error
// of a cut file.
class PlyBody {
 public:
  PlyBody(const MeshFile& file, const PlyHeader& header)
      : file_(file),
        encoding_(header.encoding),
        lines_(std::string_view(file.bytes).substr(header.bodyAt)),
        headerLines_(header.lineCount),
        rest_(std::string_view(file.bytes).substr(header.bodyAt)) {}

  // Begins an element; in a text file it has its own line.
  void begin(const PlyElement& element, std::size_t index) {
    element_ = &element;
    index_ = index;
    if (encoding_ != PlyEncoding::ascii) return;
    do {
      if (!lines_.next()) throw cut();
      rest_ = lines_.line();
    } while (isBlank(rest_));
  }
  void end() {
    if (encoding_ == PlyEncoding::ascii && !isBlank(rest_))
      throw inputError(file_, headerLines_ + lines_.number(),
                       "the line has more values than the header announces");
  }

  void skip(const PlyType& type, std::size_t count) {
    if (encoding_ != PlyEncoding::ascii) {
      if (rest_.size() / type.bytes < count) throw cut();
      rest_.remove_prefix(type.bytes * count);
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::string_view word = takeWord(rest_);
      if (word.empty()) throw lineTooShort();
      if (!isNumber(word)) throw notA("number", word);
    }
  }

  std::int64_t integer(const PlyType& type) {
    if (encoding_ == PlyEncoding::ascii) {
      const std::string_view word = takeWord(rest_);
      if (word.empty()) throw lineTooShort();
      const auto value = parseInteger<std::int64_t>(word);
      if (!value) throw notA("whole number", word);
      return *value;
    }
    return binaryInteger(type);
  }

  // A number of any type; one that is too large for a double is infinite.
  double number(const PlyType& type) {
    if (encoding_ == PlyEncoding::ascii) return textNumber();
    if (type.isInteger) return static_cast<double>(binaryInteger(type));
    if (type.bytes == 8) return std::bit_cast<double>(take<std::uint64_t>());
    return static_cast<double>(std::bit_cast<float>(take<std::uint32_t>()));
  }

  // Nothing but blanks may follow the last element.
  void finish() {
    bool more = !isBlank(rest_);
    if (encoding_ == PlyEncoding::ascii)
      while (!more && lines_.next()) more = !isBlank(lines_.line());
    if (more) throw inputError(file_, "holds more than its header announces");
  }

  Error bad(const std::string& what) const {
    return inputError(file_, plainText(element_->name) + " " + std::to_string(index_) + " " + what);
  }

 private:
  template <class Word>
  Word take() {
    if (rest_.size() < sizeof(Word)) throw cut();
    Word value = 0;
    if (encoding_ == PlyEncoding::littleEndian) {
      value = loadLittle<Word>(rest_.data());
    } else {
      for (std::size_t i = 0; i < sizeof(Word); ++i)
        value = static_cast<Word>(std::uint64_t{value} << 8 | static_cast<unsigned char>(rest_[i]));
    }
    rest_.remove_prefix(sizeof(Word));
    return value;
  }
  std::int64_t binaryInteger(const PlyType& type) {
    const auto as = [&]<class Signed>(Signed) -> std::int64_t {
      const auto value = take<std::make_unsigned_t<Signed>>();
      return type.isSigned ? std::int64_t{static_cast<Signed>(value)} : std::int64_t{value};
    };
    switch (type.bytes) {
      case 1:
        return as(std::int8_t{});
      case 2:
        return as(std::int16_t{});
      default:
        return as(std::int32_t{});
    }
  }
  double textNumber();
  Error cut() const {
    return inputError(file_, "cut short: the header announces " + std::to_string(element_->count) +
                                 " of " + inQuotes(element_->name) + ", the file holds " +
                                 std::to_string(index_));
  }
  Error notA(const std::string& kind, std::string_view word) const {
    return inputError(file_, headerLines_ + lines_.number(),
                      "found " + inQuotes(word) + " where a " + kind + " is expected");
  }
  Error lineTooShort() const {
    return inputError(file_, headerLines_ + lines_.number(),
                      "the line has less values than the header announces");
  }

  const MeshFile& file_;
  PlyEncoding encoding_;
  LineReader lines_;
  std::size_t headerLines_;
  std::string_view rest_;  // of the line in a text file, of the body in a binary one
  const PlyElement* element_ = nullptr;
  std::size_t index_ = 0;
};

}  // namespace sherd
