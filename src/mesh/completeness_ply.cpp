// Whether a PLY file is whole.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>

#include "mesh/completeness.h"
#include "mesh/text_scan.h"

namespace sherd {
namespace {

struct Type {
  std::size_t bytes = 0;
  bool isInteger = false;
  bool isSigned = false;
};

std::optional<Type> typeFromName(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Type>, 16> kTypes{{
      {"char", {1, true, true}},
      {"int8", {1, true, true}},
      {"uchar", {1, true, false}},
      {"uint8", {1, true, false}},
      {"short", {2, true, true}},
      {"int16", {2, true, true}},
      {"ushort", {2, true, false}},
      {"uint16", {2, true, false}},
      {"int", {4, true, true}},
      {"int32", {4, true, true}},
      {"uint", {4, true, false}},
      {"uint32", {4, true, false}},
      {"float", {4, false, true}},
      {"float32", {4, false, true}},
      {"double", {8, false, true}},
      {"float64", {8, false, true}},
  }};
  const auto* found =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.first == name; });
  if (found == kTypes.end()) return std::nullopt;
  return found->second;
}

struct Property {
  std::string name;
  std::optional<Type> listCount;  // set for a list
  Type value;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { ascii, littleEndian, bigEndian };

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::size_t vertices = 0;
  std::size_t bodyAt = 0;  // first byte after the header
  std::size_t lineCount = 0;
};

Header readHeader(const MeshFile& file) {
  Header header;
  LineReader lines(file.bytes);
  const auto fail = [&](const std::string& what) { return inputError(file, lines.number(), what); };
  if (!lines.next() || lines.line() != "ply") throw fail("found no 'ply' in the first line");
  bool hasFormat = false;
  while (lines.next()) {
    std::string_view rest = lines.line();
    const std::string_view keyword = takeWord(rest);
    if (keyword == "end_header") {
      if (!hasFormat) throw fail("the header names no format");
      header.bodyAt = lines.position();
      header.lineCount = lines.number();
      return header;
    }
    if (keyword == "format") {
      const std::string_view name = takeWord(rest);
      if (name == "ascii")
        header.encoding = Encoding::ascii;
      else if (name == "binary_little_endian")
        header.encoding = Encoding::littleEndian;
      else if (name == "binary_big_endian")
        header.encoding = Encoding::bigEndian;
      else
        throw fail("format " + inQuotes(name) + " is not known");
      hasFormat = true;
    } else if (keyword == "element") {
      const std::string name(takeWord(rest));
      const auto count = parseInteger<std::uint32_t>(takeWord(rest));
      if (!count) throw fail("element " + inQuotes(name) + " has no count");
      header.elements.push_back({name, *count, {}});
      if (name == "vertex") header.vertices = *count;
    } else if (keyword == "property") {
      if (header.elements.empty()) throw fail("property before the first element");
      Property property;
      std::string_view type = takeWord(rest);
      if (type == "list") {
        property.listCount = typeFromName(takeWord(rest));
        if (!property.listCount || !property.listCount->isInteger)
          throw fail("the list's count is not of a whole-number type");
        type = takeWord(rest);
      }
      const auto value = typeFromName(type);
      if (!value) throw fail("type " + inQuotes(type) + " is not known");
      property.value = *value;
      property.name = takeWord(rest);
      header.elements.back().properties.push_back(property);
    } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
      throw fail("found " + inQuotes(keyword) + " in the header");
    }
  }
  throw inputError(file, "cut short: the header has no 'end_header'");
}

bool isFaceCorners(const Element& element, const Property& property) {
  return element.name == "face" && property.listCount &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

void checkHeader(const MeshFile& file, const Header& header) {
  bool hasCorners = false;
  std::size_t coordinates = 0;
  for (const Element& element : header.elements) {
    if (element.properties.empty() && element.count > 0)
      throw inputError(file, "element " + inQuotes(element.name) + " has no properties");
    if (element.name == "tristrips")
      throw inputError(file, "triangle strips are not supported; save it with single faces");
    for (const Property& property : element.properties) {
      hasCorners |= isFaceCorners(element, property);
      coordinates += element.name == "vertex" && !property.listCount &&
                     (property.name == "x" || property.name == "y" || property.name == "z");
    }
  }
  if (coordinates != 3) throw inputError(file, "its vertices have no x, y and z");
  if (!hasCorners) throw inputError(file, "its faces have no list 'vertex_indices'");
}

// The values of the body one after another, binary or as words; what is asked for beyond the end is
// a cut file.
class Body {
 public:
  Body(const MeshFile& file, const Header& header)
      : file_(file),
        encoding_(header.encoding),
        lines_(std::string_view(file.bytes).substr(header.bodyAt)),
        headerLines_(header.lineCount),
        rest_(std::string_view(file.bytes).substr(header.bodyAt)) {}

  // An element's turn begins: in a text it has a line of its own.
  void begin(const Element& element, std::size_t index) {
    element_ = &element;
    index_ = index;
    if (encoding_ != Encoding::ascii) return;
    do {
      if (!lines_.next()) throw cut();
      rest_ = lines_.line();
    } while (isBlank(rest_));
  }
  void end() {
    if (encoding_ == Encoding::ascii && !isBlank(rest_))
      throw inputError(file_, headerLines_ + lines_.number(),
                       "the line has more values than the header announces");
  }

  void skip(const Type& type, std::size_t count) {
    if (encoding_ != Encoding::ascii) {
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

  std::int64_t integer(const Type& type) {
    if (encoding_ == Encoding::ascii) {
      const std::string_view word = takeWord(rest_);
      if (word.empty()) throw lineTooShort();
      const auto value = parseInteger<std::int64_t>(word);
      if (!value) throw notA("whole number", word);
      return *value;
    }
    if (rest_.size() < type.bytes) throw cut();
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < type.bytes; ++i) {
      const std::size_t at = encoding_ == Encoding::bigEndian ? i : type.bytes - 1 - i;
      value = value << 8 | static_cast<unsigned char>(rest_[at]);
    }
    rest_.remove_prefix(type.bytes);
    if (!type.isSigned) return static_cast<std::int64_t>(value);
    const std::size_t unused = 64 - 8 * type.bytes;
    return static_cast<std::int64_t>(value << unused) >> unused;  // carries the sign up
  }

  // Nothing but blanks may follow the last element.
  void finish() {
    bool more = !isBlank(rest_);
    if (encoding_ == Encoding::ascii)
      while (!more && lines_.next()) more = !isBlank(lines_.line());
    if (more) throw inputError(file_, "holds more than its header announces");
  }

  Error bad(const std::string& what) const {
    return inputError(file_, plainText(element_->name) + " " + std::to_string(index_) + " " + what);
  }

 private:
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
  Encoding encoding_;
  LineReader lines_;
  std::size_t headerLines_;
  std::string_view rest_;  // of the line in a text, of the file in a binary one
  const Element* element_ = nullptr;
  std::size_t index_ = 0;
};

}  // namespace

FileCounts checkPly(const MeshFile& file) {
  const Header header = readHeader(file);
  checkHeader(file, header);
  std::size_t polygons = 0;
  Body body(file, header);
  for (const Element& element : header.elements) {
    for (std::size_t i = 0; i < element.count; ++i) {
      body.begin(element, i);
      for (const Property& property : element.properties) {
        if (!property.listCount) {
          body.skip(property.value, 1);
          continue;
        }
        const std::int64_t length = body.integer(*property.listCount);
        if (length < 0) throw body.bad("has a list of negative length");
        if (!isFaceCorners(element, property)) {
          body.skip(property.value, static_cast<std::size_t>(length));
          continue;
        }
        for (std::int64_t k = 0; k < length; ++k) {
          const std::int64_t index = body.integer(property.value);
          if (index < 0 || static_cast<std::size_t>(index) >= header.vertices) {
            throw body.bad("uses vertex " + std::to_string(index) + ", the file has " +
                           std::to_string(header.vertices));
          }
        }
        polygons += length >= 3;
      }
      body.end();
    }
  }
  body.finish();
  return {header.vertices, polygons};
}

}  // namespace sherd
