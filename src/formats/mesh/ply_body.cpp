// Reads a PLY file's header, and the values of its body in sequence.
#include "formats/mesh/ply_body.h"

#include <algorithm>
#include <array>
#include <utility>

namespace sherd {
namespace {

// Limit on the elements, and on the properties, of a header; more are refused as hostile.
constexpr std::size_t kMostNamed = 1000;
// A comment may name a material or a texture, and appear in a warning.
constexpr std::uint64_t kBytesPerComment = 512;
constexpr std::size_t kLinesAtATime = 4096;

std::optional<PlyType> typeFromName(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes{{
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

}  // namespace

PlyHeader readPlyHeader(const MeshFile& file) {
  PlyHeader header;
  const std::string_view text = withoutByteOrderMark(file.bytes);
  LineReader lines(text);
  const auto fail = [&](const std::string& what) { return inputError(file, lines.number(), what); };
  if (!lines.next() || lines.line() != "ply") throw fail("found no 'ply' in the first line");
  bool hasFormat = false;
  std::size_t properties = 0;
  while (lines.next()) {
    if (lines.number() % kLinesAtATime == 0) checkpoint(file);
    std::string_view rest = lines.line();
    const std::string_view keyword = takeWord(rest);
    if (keyword == "end_header") {
      if (!hasFormat) throw fail("the header names no format");
      header.bodyAt = file.bytes.size() - text.size() + lines.position();
      header.lineCount = lines.number();
      return header;
    }
    if (keyword == "format") {
      const std::string_view name = takeWord(rest);
      if (name == "ascii")
        header.encoding = PlyEncoding::ascii;
      else if (name == "binary_little_endian")
        header.encoding = PlyEncoding::littleEndian;
      else if (name == "binary_big_endian")
        header.encoding = PlyEncoding::bigEndian;
      else
        throw fail("format " + inQuotes(name) + " is not known");
      hasFormat = true;
    } else if (keyword == "element") {
      const std::string name(takeWord(rest));
      const auto count = parseInteger<std::uint32_t>(takeWord(rest));
      if (!count) throw fail("element " + inQuotes(name) + " has no count");
      for (const PlyElement& other : header.elements) {
        if (other.name == name) throw fail("element " + inQuotes(name) + " is there twice");
      }
      if (header.elements.size() == kMostNamed)
        throw fail("the header names more than " + std::to_string(kMostNamed) + " elements");
      header.elements.push_back({name, *count, {}});
    } else if (keyword == "property") {
      if (header.elements.empty()) throw fail("property before the first element");
      if (++properties > kMostNamed)
        throw fail("the header names more than " + std::to_string(kMostNamed) + " properties");
      PlyProperty property;
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
    } else if (keyword == "comment") {
      charge(file, 3 * rest.size() + kBytesPerComment);
      header.comments.emplace_back(rest);
    } else if (!keyword.empty() && keyword != "obj_info") {
      throw fail("found " + inQuotes(keyword) + " in the header");
    }
  }
  throw inputError(file, "cut short: the header has no 'end_header'");
}

double PlyBody::textNumber() {
  const std::string_view word = takeWord(rest_);
  if (word.empty()) throw lineTooShort();
  const auto value = parseReal(word);
  if (!value) throw notA("number", word);
  return *value;
}

}  // namespace sherd
