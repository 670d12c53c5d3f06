// Reads STL files.
#include "formats/mesh_files/read_stl.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "base/little_endian.h"
#include "base/text/lower_case.h"
#include "base/text/text_scan.h"

namespace sherd {
namespace {

constexpr std::size_t kHeader = 84;  // 80 unspecified bytes, then the count
constexpr std::size_t kRecord = 50;  // a normal, three corners, two unspecified bytes

// Returns whether it is text, and not a binary file whose header begins with "solid".
bool isText(std::string_view bytes) {
  const std::string_view start = bytes.substr(0, 500);
  std::string_view rest = trimmed(start);
  return lowerCase(std::string(rest.substr(0, 5))) == "solid" &&
         start.find('\0') == std::string_view::npos;
}

void addTriangle(RawMesh& out) {
  const auto first = static_cast<std::uint32_t>(out.vertices.size() - 3);
  out.triangles.emplace_back(first, first + 1, first + 2);
}

// The colors of a binary file, which two programs put into the unspecified bytes, 15 bits a facet.
// Magics has a color of the whole in the header, and a set highest bit says that a facet has it;
// for VisCAM and SolidView a set bit says that a facet has one of its own, whose channels are in
// the other order.
class FacetColors {
 public:
  explicit FacetColors(std::string_view bytes) {
    constexpr std::string_view kName = "COLOR=";
    const std::size_t at = bytes.substr(0, 80).find(kName);
    if (at > 80 - kName.size() - 4) return;
    const auto channel = [&](std::size_t i) {
      return static_cast<std::uint8_t>(bytes[at + kName.size() + i]);
    };
    ofMagics_ = true;
    ofWhole_ = {channel(0), channel(1), channel(2)};
  }

  // Whether facets have colors: in a file without "COLOR=", only if no facet has other values
  // there.
  //   count  facets
  [[nodiscard]] bool areIn(std::string_view bytes, std::size_t count) const {
    if (ofMagics_) return true;
    bool has = false;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint16_t value = valueOf(bytes, i);
      if (value != 0 && (value & kHighest) == 0) return false;
      has |= value != 0;
    }
    return has;
  }

  [[nodiscard]] glm::u8vec3 of(std::string_view bytes, std::size_t facet) const {
    const std::uint16_t value = valueOf(bytes, facet);
    if (((value & kHighest) != 0) == ofMagics_) return ofWhole_;
    const auto channel = [value](int shift) {
      return static_cast<std::uint8_t>(((value >> shift & 31) * 255 + 15) / 31);
    };
    const glm::u8vec3 color(channel(0), channel(5), channel(10));
    return ofMagics_ ? color : glm::u8vec3(color.z, color.y, color.x);
  }

 private:
  static constexpr std::uint16_t kHighest = 0x8000;

  static std::uint16_t valueOf(std::string_view bytes, std::size_t facet) {
    return loadLittle<std::uint16_t>(bytes.data() + kHeader + kRecord * facet + 48);
  }

  bool ofMagics_ = false;
  glm::u8vec3 ofWhole_{255};
};

RawMesh readBinary(const MeshFile& file, std::size_t count) {
  charge(file, count, 3 * sizeof(glm::dvec3) + sizeof(glm::uvec3));
  checkpoint(file);
  RawMesh out;
  out.vertices.reserve(3 * count);
  out.triangles.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const char* at = file.bytes.data() + kHeader + kRecord * i + 12;
    const auto next = [&at] {
      const auto value = std::bit_cast<float>(loadLittle<std::uint32_t>(at));
      at += 4;
      return static_cast<double>(value);
    };
    for (int corner = 0; corner < 3; ++corner) {
      const double x = next(), y = next(), z = next();
      out.vertices.emplace_back(x, y, z);
    }
    addTriangle(out);
  }
  const FacetColors colors(file.bytes);
  if (!colors.areIn(file.bytes, count)) return out;
  charge(file, count, sizeof(out.attributes.colors[0]));
  for (std::size_t i = 0; i < count; ++i) {
    const glm::u8vec3 color = colors.of(file.bytes, i);
    out.attributes.colors.push_back({color, color, color});
  }
  return out;
}

RawMesh readText(const MeshFile& file) {
  // The first word of each line of a facet, in order. Its normal is ignored: some programs write
  // NaN.
  constexpr std::array<std::string_view, 7> kFacet{
      {"facet", "outer", "vertex", "vertex", "vertex", "endloop", "endfacet"}};
  RawMesh out;
  constexpr std::size_t kLinesBetween = 4096;
  GrowingMemory memory(file.memory);
  std::size_t at = 0;
  bool inSolid = false;
  LineReader lines(withoutByteOrderMark(file.bytes));
  while (lines.next()) {
    if (lines.number() % kLinesBetween == 0) {
      checkpoint(file);
      memory.hold(out.vertices.size() * sizeof(glm::dvec3) +
                  out.triangles.size() * (sizeof(glm::uvec3) + sizeof(std::uint32_t)) +
                  out.objects.size() * sizeof(std::string));
    }
    std::string_view rest = lines.line();
    const std::string word = lowerCase(std::string(takeWord(rest)));
    if (word.empty()) continue;
    if (at == 0 && word == (inSolid ? "endsolid" : "solid")) {
      inSolid = !inSolid;
      if (inSolid) out.objects.emplace_back(trimmed(rest));
      continue;
    }
    const std::string_view expected = inSolid ? kFacet[at] : "solid";
    bool fits = word == expected;
    if (fits && word == "vertex") {
      glm::dvec3 v;
      for (int i = 0; i < 3 && fits; ++i) {
        const auto value = parseReal(takeWord(rest));
        fits = value.has_value();
        v[i] = value.value_or(0.0);
      }
      fits = fits && isBlank(rest);
      out.vertices.push_back(v);
    }
    if (!fits) {
      throw inputError(file, lines.number(),
                       "found " + inQuotes(lines.line()) + " where a line with '" +
                           std::string(expected) + "' is expected");
    }
    at = (at + 1) % kFacet.size();
    if (at != 0) continue;
    addTriangle(out);
    out.objectOfTriangle.push_back(static_cast<std::uint32_t>(out.objects.size()) - 1);
  }
  if (inSolid) throw inputError(file, "cut short: the last solid has no 'endsolid'");
  return out;
}

}  // namespace

RawMesh readStl(const MeshFile& file) {
  const std::size_t size = file.bytes.size();
  const std::size_t held = size < kHeader ? 0 : (size - kHeader) / kRecord;
  const auto announced = size < kHeader ? 0u : loadLittle<std::uint32_t>(&file.bytes[80]);
  const bool isWhole = size >= kHeader && (size - kHeader) % kRecord == 0;
  if (isWhole && held == announced) return readBinary(file, held);
  if (isText(withoutByteOrderMark(file.bytes))) return readText(file);
  if (size < kHeader)
    throw inputError(file, "cut short: neither text nor a whole header of a binary STL");
  const std::string counts =
      "the header announces " + std::to_string(announced) + " triangles, the file ";
  if (isWhole && held > 0 && (announced == 0 || announced == 0xffffffffu)) {
    RawMesh out = readBinary(file, held);
    out.warnings.push_back(file.name + ": " + counts + "holds " + std::to_string(held) +
                           ", which are read");
    return out;
  }
  if (held < announced)
    throw inputError(file, "cut short: " + counts + "holds " + std::to_string(held));
  throw inputError(file, counts + "has room for " + std::to_string(held));
}

}  // namespace sherd
