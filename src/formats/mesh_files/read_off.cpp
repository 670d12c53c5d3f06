// Reads OFF files.
//
// source  Geomview Manual, "OFF Files": [ST][C][N]OFF, then counts, vertices and faces
#include "formats/mesh_files/read_off.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "base/text/text_scan.h"
#include "formats/mesh/polygon_mesh.h"
#include "mesh/attributes/colors.h"

namespace sherd {
namespace {

// Vertices, faces, and corners of a face, between two checks of memory and for cancellation.
constexpr std::size_t kFacesAtATime = 4096;

struct OffReader {
  const MeshFile& file;
  LineReader lines{withoutByteOrderMark(file.bytes)};
  std::string_view line{};                                           // rest of the line
  bool hasTexcoords = false, hasColors = false, hasNormals = false;  // of vertices
  PolygonMesh mesh{};
  std::vector<glm::vec3> vertexColors{}, faceColors{};
  bool anyFaceColor = false;
  GrowingMemory memory{file.memory};

  Error bad(const std::string& what) const { return inputError(file, lines.number(), what); }

  void expectLine(const std::string& what) {
    if (!nextDataLine(lines, line))
      throw inputError(file, "cut short: the file ends before " + what);
  }

  void expectLine(const char* what, std::size_t index, std::size_t count) {
    if (nextDataLine(lines, line)) return;
    throw inputError(file, std::string("cut short: the file ends before ") + what + " " +
                               std::to_string(index) + " of " + std::to_string(count));
  }

  std::optional<double> nextReal() { return parseReal(takeWord(line)); }

  void readKeyword() {
    expectLine("its header");
    const std::string_view keyword = takeWord(line);
    std::string_view kind = keyword;
    const auto take = [&kind](std::string_view prefix) {
      const bool has = kind.starts_with(prefix);
      if (has) kind.remove_prefix(prefix.size());
      return has;
    };
    hasTexcoords = take("ST");
    hasColors = take("C");
    hasNormals = take("N");
    if (kind != "OFF") throw bad("found " + inQuotes(keyword) + " where 'OFF' is expected");
    std::string_view next = line;
    if (takeWord(next) == "BINARY")
      throw inputError(file, "is a binary OFF, which is not supported; save it as text");
  }

  // A color of three or four numbers; its alpha is left out.
  std::optional<glm::vec3> color(std::size_t numbers) {
    if (numbers != 3 && numbers != 4) return std::nullopt;
    glm::vec3 out(1.0f);
    for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(nextReal().value_or(1.0));
    if (numbers == 4) takeWord(line);
    return out;
  }

  void readVertex() {
    glm::dvec3 v;
    for (int i = 0; i < 3; ++i) {
      const auto value = nextReal();
      if (!value) throw bad("vertex has less than 3 coordinates");
      v[i] = *value;
    }
    mesh.vertices.push_back(v);
    if (hasNormals) readNormal();
    if (hasColors) {
      const std::size_t others = hasTexcoords ? 2 : 0, numbers = countWords(line);
      vertexColors.push_back(color(numbers - std::min(numbers, others)).value_or(glm::vec3(1.0f)));
    }
    if (hasTexcoords) {
      const auto s = nextReal(), t = nextReal();
      if (!s || !t) throw bad("vertex has no texture coordinates");
      mesh.vertexTexcoords.emplace_back(*s, *t);
    }
  }

  void readNormal() {
    glm::vec3& normal = mesh.vertexNormals.emplace_back(0.0f);
    for (int i = 0; i < 3; ++i) {
      const auto value = nextReal();
      if (!value) throw bad("vertex has no normal");
      normal[i] = static_cast<float>(*value);
    }
  }

  void hold() {
    checkpoint(file);
    memory.hold(mesh.bytes() - mesh.vertices.size() * sizeof(glm::dvec3) +
                (vertexColors.size() + faceColors.size()) * sizeof(glm::vec3));
  }

  // Faces of one or two corners are points and lines.
  void readFace(std::uint32_t vertices) {
    const auto corners = parseInteger<std::uint32_t>(takeWord(line));
    if (!corners) throw bad("face has no number of corners");
    for (std::size_t k = 0; k < *corners; ++k) {
      const std::string_view word = takeWord(line);
      const auto index = parseInteger<std::uint32_t>(word);
      if (!index || *index >= vertices) {
        throw bad("face uses vertex " + inQuotes(word) + ", the file has " +
                  std::to_string(vertices));
      }
      if (*corners >= 3) mesh.corners.push_back(*index);
      if (*corners >= 3 && mesh.corners.size() % kFacesAtATime == 0) hold();
    }
    if (*corners < 3) return mesh.leaveOutFace();
    mesh.endFace();
    if (hasColors) return;
    const auto found = isBlank(line) ? std::nullopt : color(countWords(line));
    anyFaceColor |= found.has_value();
    faceColors.push_back(found.value_or(glm::vec3(1.0f)));
  }

  void read() {
    readKeyword();
    if (isBlank(line)) expectLine("its counts");
    const auto vertices = parseInteger<std::uint32_t>(takeWord(line));
    const auto faces = parseInteger<std::uint32_t>(takeWord(line));
    if (!vertices || !faces) throw bad("found no number of vertices and faces after the header");
    // A line has six bytes at least.
    const std::size_t room = std::min<std::size_t>(*vertices, file.bytes.size() / 6);
    charge(file, room, sizeof(glm::dvec3));
    mesh.vertices.reserve(room);
    for (std::size_t i = 0; i < *vertices; ++i) {
      if (i % kFacesAtATime == 0) hold();
      expectLine("vertex", i, *vertices);
      readVertex();
    }
    for (std::size_t i = 0; i < *faces; ++i) {
      if (i % kFacesAtATime == 0) hold();
      expectLine("face", i, *faces);
      readFace(*vertices);
    }
    if (nextDataLine(lines, line)) throw bad("found " + inQuotes(line) + " after the last face");
    mesh.vertexColors = colorsFrom(vertexColors);
    if (anyFaceColor) mesh.faceColors = colorsFrom(faceColors);
  }
};

}  // namespace

RawMesh readOff(const MeshFile& file) {
  OffReader reader{.file = file};
  reader.read();
  RawMesh out;
  triangulateInto(file, std::move(reader.mesh), out);
  return out;
}

}  // namespace sherd
