// Reads a PLY file's header, and the values of its body in sequence.
#include "formats/ply/ply_body.h"

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

// Reads a header line by line.
class HeaderReader {
 public:
  explicit HeaderReader(const MeshFile& file)
      : file_(file), text_(withoutByteOrderMark(file.bytes)), lines_(text_) {}

  PlyHeader read() && {
    if (!lines_.next() || lines_.line() != "ply") {
      throw fail("found no 'ply' in the first line");
    }
    while (lines_.next()) {
      if (lines_.number() % kLinesAtATime == 0) checkpoint(file_);
      std::string_view rest = lines_.line();
      const std::string_view keyword = takeWord(rest);
      if (keyword == "end_header") return finished();
      take(keyword, rest);
    }
    throw inputError(file_, "cut short: the header has no 'end_header'");
  }

 private:
  Error fail(const std::string& what) const { return inputError(file_, lines_.number(), what); }

  PlyHeader finished() {
    if (!hasFormat_) throw fail("the header names no format");
    header_.bodyAt = file_.bytes.size() - text_.size() + lines_.position();
    header_.lineCount = lines_.number();
    return std::move(header_);
  }

  void take(std::string_view keyword, std::string_view rest) {
    if (keyword == "format") {
      takeFormat(rest);
    } else if (keyword == "element") {
      takeElement(rest);
    } else if (keyword == "property") {
      takeProperty(rest);
    } else if (keyword == "comment") {
      charge(file_, 3 * rest.size() + kBytesPerComment);
      header_.comments.emplace_back(rest);
    } else if (!keyword.empty() && keyword != "obj_info") {
      throw fail("found " + inQuotes(keyword) + " in the header");
    }
  }

  void takeFormat(std::string_view rest) {
    const std::string_view name = takeWord(rest);
    if (name == "ascii")
      header_.encoding = PlyEncoding::ascii;
    else if (name == "binary_little_endian")
      header_.encoding = PlyEncoding::littleEndian;
    else if (name == "binary_big_endian")
      header_.encoding = PlyEncoding::bigEndian;
    else
      throw fail("format " + inQuotes(name) + " is not known");
    hasFormat_ = true;
  }

  void takeElement(std::string_view rest) {
    const std::string name(takeWord(rest));
    const auto count = parseInteger<std::uint32_t>(takeWord(rest));
    if (!count) throw fail("element " + inQuotes(name) + " has no count");
    for (const PlyElement& other : header_.elements) {
      if (other.name == name) throw fail("element " + inQuotes(name) + " is there twice");
    }
    if (header_.elements.size() == kMostNamed)
      throw fail("the header names more than " + std::to_string(kMostNamed) + " elements");
    header_.elements.push_back({name, *count, {}});
  }

  void takeProperty(std::string_view rest) {
    if (header_.elements.empty()) throw fail("property before the first element");
    if (++properties_ > kMostNamed)
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
    header_.elements.back().properties.push_back(property);
  }

  const MeshFile& file_;
  const std::string_view text_;
  LineReader lines_;
  PlyHeader header_;
  bool hasFormat_ = false;
  std::size_t properties_ = 0;
};

}  // namespace

PlyHeader readPlyHeader(const MeshFile& file) { return HeaderReader(file).read(); }

double PlyBody::textNumber() {
  const std::string_view word = takeWord(rest_);
  if (word.empty()) throw lineTooShort();
  const auto value = parseReal(word);
  if (!value) throw notA("number", word);
  return *value;
}

}  // namespace sherd
