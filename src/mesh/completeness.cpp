// Whether an OBJ, STL or OFF file is whole.
#include "mesh/completeness.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "mesh/obj_lines.h"
#include "mesh/read_binm.h"
#include "mesh/text_scan.h"

namespace sherd {
namespace {

static_assert(std::endian::native == std::endian::little);  // binary STL is read as it lies

constexpr std::size_t kStlHeader = 84;  // 80 bytes of anything, then the count
constexpr std::size_t kStlRecord = 50;

// Text, unlike a binary file whose header happens to begin with "solid".
bool isTextStl(std::string_view bytes) {
  const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || bytes.substr(begin, 5) != "solid") return false;
  return std::all_of(
      bytes.begin(),
      bytes.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(bytes.size(), 500)),
      [](char c) { return c != '\0'; });
}

FileCounts checkTextStl(const MeshFile& file) {
  // One facet's lines in their order: the word each begins with, the words and the numbers that
  // must follow.
  struct Line {
    std::string_view word;
    int words, numbers;
  };
  constexpr std::array<Line, 7> kFacet{{{"facet", 1, 3},
                                        {"outer", 1, 0},
                                        {"vertex", 0, 3},
                                        {"vertex", 0, 3},
                                        {"vertex", 0, 3},
                                        {"endloop", 0, 0},
                                        {"endfacet", 0, 0}}};
  const auto fits = [](std::string_view line, const Line& expected) {
    if (takeWord(line) != expected.word) return false;
    for (int i = 0; i < expected.words; ++i)
      if (takeWord(line).empty()) return false;
    return takeNumbers(line, expected.numbers) && isBlank(line);
  };
  std::size_t facets = 0, at = 0;
  bool inSolid = false;
  LineReader lines(file.bytes);
  while (lines.next()) {
    std::string_view rest = lines.line();
    const std::string_view word = takeWord(rest);
    if (word.empty()) continue;
    if (at == 0 && word == (inSolid ? "endsolid" : "solid")) {
      inSolid = !inSolid;
      continue;
    }
    const Line expected = inSolid ? kFacet[at] : Line{"solid", 0, 0};
    if (!fits(lines.line(), expected)) {
      throw inputError(file, lines.number(),
                       "found " + inQuotes(lines.line()) + " where a line with '" +
                           std::string(expected.word) + "' is expected");
    }
    at = (at + 1) % kFacet.size();
    if (at == 0) ++facets;
  }
  if (inSolid) throw inputError(file, "cut short: the last solid has no 'endsolid'");
  return {3 * facets, facets, false};
}

}  // namespace

FileCounts checkComplete(const MeshFile& file) {
  switch (file.format) {
    case MeshFormat::obj:
      return checkObj(file);
    case MeshFormat::ply:
      return checkPly(file);
    case MeshFormat::stl:
      return checkStl(file);
    case MeshFormat::off:
      return checkOff(file);
    case MeshFormat::binm:
      return checkBinm(file);
    case MeshFormat::gltf:
    case MeshFormat::glb:
      return checkGltf(file);
  }
  return {};
}

FileCounts checkObj(const MeshFile& file) {
  std::size_t vertices = 0, polygons = 0, largest = 0, largestLine = 0;
  bool look = false;
  ObjLines lines(file.bytes);
  while (lines.next()) {
    std::string_view rest = lines.line();
    const std::string_view keyword = takeWord(rest);
    if (keyword == "v") {
      if (!takeNumbers(rest, 3))
        throw inputError(file, lines.number(), "vertex has less than 3 coordinates");
      ++vertices;
      if (!look) look = takeNumbers(rest, 3);
    } else if (keyword == "vt" || keyword == "usemtl") {
      look = true;
    } else if (keyword == "f") {
      std::size_t corners = 0;
      for (std::string_view word = takeWord(rest); !word.empty() && word[0] != '#';
           word = takeWord(rest)) {
        const auto index = parseInteger<std::int64_t>(word.substr(0, word.find('/')));
        if (!index || *index == 0 || word.ends_with('/'))
          throw inputError(file, lines.number(),
                           "face has the corner " + inQuotes(word) + ", not a vertex number");
        if (*index < 0 && static_cast<std::size_t>(-*index) > vertices) {
          throw inputError(file, lines.number(),
                           "face uses vertex " + std::to_string(*index) + ", there are " +
                               std::to_string(vertices) + " before it");
        }
        if (*index > 0 && static_cast<std::size_t>(*index) > largest) {
          largest = static_cast<std::size_t>(*index);
          largestLine = lines.number();
        }
        ++corners;
      }
      if (corners < 3) throw inputError(file, lines.number(), "face has less than 3 corners");
      ++polygons;
    }
  }
  if (largest > vertices) {
    throw inputError(file, largestLine,
                     "face uses vertex " + std::to_string(largest) + ", the file has " +
                         std::to_string(vertices));
  }
  return {vertices, polygons, look};
}

FileCounts checkStl(const MeshFile& file) {
  const std::size_t size = file.bytes.size();
  std::uint32_t triangles = 0;
  if (size >= kStlHeader) std::memcpy(&triangles, file.bytes.data() + 80, sizeof triangles);
  if (size >= kStlHeader && size == kStlHeader + kStlRecord * triangles)
    return {std::size_t{3} * triangles, triangles, false};
  if (isTextStl(file.bytes)) return checkTextStl(file);
  if (size < kStlHeader)
    throw inputError(file, "cut short: neither text nor a whole header of a binary STL");
  const std::string held = std::to_string((size - kStlHeader) / kStlRecord);
  if (size < kStlHeader + kStlRecord * triangles) {
    throw inputError(file, "cut short: the header announces " + std::to_string(triangles) +
                               " triangles, the file holds " + held);
  }
  throw inputError(file, "the header announces " + std::to_string(triangles) +
                             " triangles, the file has room for " + held);
}

FileCounts checkOff(const MeshFile& file) {
  LineReader lines(file.bytes);
  std::string_view line;
  const auto expectLine = [&](const std::string& what) {
    if (!nextDataLine(lines, line))
      throw inputError(file, "cut short: the file ends before " + what);
  };
  expectLine("its header");
  const std::string_view keyword = takeWord(line);
  if (keyword != "OFF" && keyword != "COFF" && keyword != "NOFF" && keyword != "CNOFF")
    throw inputError(file, lines.number(),
                     "found " + inQuotes(keyword) + " where 'OFF' is expected");
  if (isBlank(line)) expectLine("its counts");
  const auto vertices = parseInteger<std::uint32_t>(takeWord(line));
  const auto faces = parseInteger<std::uint32_t>(takeWord(line));
  if (!vertices || !faces)
    throw inputError(file, lines.number(),
                     "found no number of vertices and faces after the header");

  for (std::size_t i = 0; i < *vertices; ++i) {
    expectLine("vertex " + std::to_string(i) + " of " + std::to_string(*vertices));
    if (!takeNumbers(line, 3))
      throw inputError(file, lines.number(), "vertex has less than 3 coordinates");
  }
  std::size_t polygons = 0;
  for (std::size_t i = 0; i < *faces; ++i) {
    expectLine("face " + std::to_string(i) + " of " + std::to_string(*faces));
    const auto corners = parseInteger<std::uint32_t>(takeWord(line));
    if (!corners) throw inputError(file, lines.number(), "face has no number of corners");
    for (std::size_t k = 0; k < *corners; ++k) {
      const std::string_view word = takeWord(line);
      const auto index = parseInteger<std::uint32_t>(word);
      if (!index || *index >= *vertices) {
        throw inputError(
            file, lines.number(),
            "face uses vertex " + inQuotes(word) + ", the file has " + std::to_string(*vertices));
      }
    }
    polygons += *corners >= 3;
  }
  if (nextDataLine(lines, line))
    throw inputError(file, lines.number(), "found " + inQuotes(line) + " after the last face");
  return {*vertices, polygons, false};
}

}  // namespace sherd
