// Reads an OBJ file with its look.
#include "mesh/read_obj.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

#include "mesh/beside.h"
#include "mesh/colours.h"
#include "mesh/mtl.h"
#include "mesh/obj_lines.h"
#include "mesh/triangulate.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// A vertex's place, divided by w where there is one, as Assimp has it: in single precision.
struct Vertex {
  glm::dvec3 position{0.0};
  glm::vec3 colour{1.0f};
  bool isColoured = false;
};

Vertex vertexIn(std::string_view line) {
  std::array<double, 6> values{};
  std::size_t count = 0;
  while (count < values.size()) {
    const auto value = parseReal(takeWord(line));
    if (!value) break;
    values[count++] = *value;
  }
  Vertex vertex;
  const double w = count == 4 && values[3] != 0.0 ? values[3] : 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    vertex.position[axis] = static_cast<float>(values[static_cast<std::size_t>(axis)] / w);
  }
  vertex.isColoured = count == 6;
  if (vertex.isColoured) vertex.colour = {values[3], values[4], values[5]};
  return vertex;
}

struct Reader {
  struct Face {
    std::size_t first, count;  // of its corners
    std::uint32_t material;
  };

  const MeshFile& file;
  RawMesh out{};
  std::vector<Vertex> vertices{};
  std::vector<glm::vec2> texcoords{};
  std::vector<Face> faces{};
  std::vector<std::pair<std::size_t, std::uint32_t>> corners{};  // vertex, texture coordinate
  std::size_t largestTexcoord = 0;                               // that a face uses, from 1
  std::vector<std::string> libraries{};
  std::map<std::string, std::uint32_t, std::less<>> materialByName{};
  std::uint32_t material = kNone;  // of the faces that come; kNone: none was named
  std::uint32_t unnamed = kNone;   // that of faces before the first name
  bool hasColours = false, hasTexcoords = false, hasMaterials = false;
  std::vector<glm::vec3> colours{};  // [out.vertices]

  // A corner "v", "v/vt", "v//vn" or "v/vt/vn"; numbers below 0 count from the end.
  void addCorner(std::string_view word, std::size_t line) {
    const std::size_t slash = word.find('/');
    const auto v = parseInteger<std::int64_t>(word.substr(0, slash));  // checked before
    const std::size_t at =
        *v < 0 ? vertices.size() - static_cast<std::size_t>(-*v) : static_cast<std::size_t>(*v) - 1;
    corners.emplace_back(at, kNone);
    if (slash == std::string_view::npos) return;
    std::string_view second = word.substr(slash + 1);
    second = second.substr(0, second.find('/'));
    if (second.empty()) return;
    const auto vt = parseInteger<std::int64_t>(second);
    const auto count = static_cast<std::int64_t>(texcoords.size());
    if (!vt || *vt == 0 || *vt < -count || *vt > std::int64_t{kNone}) {
      throw inputError(
          file, line,
          "face has the corner " + inQuotes(word) + ", whose texture coordinate does not exist");
    }
    corners.back().second = static_cast<std::uint32_t>(*vt < 0 ? count + *vt : *vt - 1);
    largestTexcoord = std::max(largestTexcoord, corners.back().second + std::size_t{1});
    hasTexcoords = true;
  }

  // Faces are kept as they are: what they use may come behind them.
  void addFace(std::string_view rest, std::size_t line) {
    const std::size_t first = corners.size();
    for (std::string_view word = takeWord(rest); !word.empty() && word[0] != '#';
         word = takeWord(rest)) {
      addCorner(word, line);
    }
    faces.push_back({first, corners.size() - first, material});
  }

  void useMaterial(std::string_view name) {
    hasMaterials = true;
    const auto known = materialByName.find(name);
    if (known != materialByName.end()) {
      material = known->second;
      return;
    }
    material = static_cast<std::uint32_t>(out.look.materials.size());
    out.look.materials.push_back({.name = std::string(name)});
    materialByName.emplace(name, material);
  }

  void readLines() {
    ObjLines lines(file.bytes);
    while (lines.next()) {
      std::string_view rest = lines.line();
      const std::string_view keyword = takeWord(rest);
      if (keyword == "v") {
        vertices.push_back(vertexIn(rest));
        hasColours |= vertices.back().isColoured;
      } else if (keyword == "vt") {
        const auto u = parseReal(takeWord(rest)), v = parseReal(takeWord(rest));
        texcoords.emplace_back(u.value_or(0.0), v.value_or(0.0));
      } else if (keyword == "f") {
        addFace(rest, lines.number());
      } else if (keyword == "usemtl") {
        useMaterial(trimmed(rest));
      } else if (keyword == "mtllib") {
        libraries.emplace_back(trimmed(rest));
      }
    }
    if (largestTexcoord > texcoords.size()) {
      throw inputError(file, "face uses texture coordinate " + std::to_string(largestTexcoord) +
                                 ", the file has " + std::to_string(texcoords.size()));
    }
  }

  // Without texture coordinates faces share their vertices; else each corner gets one of its own.
  void makeTriangles() {
    if (!hasTexcoords) {
      for (const Vertex& vertex : vertices) addVertex(vertex);
    }
    std::vector<std::uint32_t> polygon;
    for (const Face& face : faces) {
      polygon.clear();
      for (std::size_t i = face.first; i < face.first + face.count; ++i) {
        if (!hasTexcoords) {
          polygon.push_back(static_cast<std::uint32_t>(corners[i].first));
          continue;
        }
        polygon.push_back(static_cast<std::uint32_t>(out.vertices.size()));
        addVertex(vertices[corners[i].first]);
        const std::uint32_t vt = corners[i].second;
        out.texcoords.push_back(vt == kNone ? glm::vec2(0.0f) : texcoords[vt]);
      }
      triangulate(out.vertices, polygon, out.triangles);
      ++out.polygons;
      if (hasMaterials) out.material.resize(out.triangles.size(), materialOf(face));
    }
    out.colours = coloursFrom(colours);
  }

  void addVertex(const Vertex& vertex) {
    out.vertices.push_back(vertex.position);
    if (hasColours) colours.push_back(vertex.colour);
  }

  std::uint32_t materialOf(const Face& face) {
    if (face.material != kNone) return face.material;
    if (unnamed == kNone) {
      unnamed = static_cast<std::uint32_t>(out.look.materials.size());
      out.look.materials.emplace_back();
    }
    return unnamed;
  }

  // A library is a plain file name; one line may name several.
  void readLibraries() {
    std::map<std::string, MtlMaterial> known;
    for (const std::string& line : libraries) {
      const auto path = pathBeside(file, line);
      std::error_code error;
      const bool isOne = path && std::filesystem::is_regular_file(*path, error);
      std::string_view rest = line;
      for (std::string_view name = isOne ? rest : takeWord(rest); !name.empty();
           name = isOne ? std::string_view() : takeWord(rest)) {
        const auto text = readBeside(file, name, "material library", out.look.warnings);
        if (text) addMtl(*text, known);
      }
    }
    for (Material& named : out.look.materials) {
      const auto found = known.find(named.name);
      if (found == known.end()) continue;
      named.colour = found->second.colour;
      if (hasTexcoords && !found->second.texture.empty()) {
        named.texture = textureBeside(file, found->second.texture, out.look);
      }
    }
  }
};

}  // namespace

RawMesh readObjWithLook(const MeshFile& file) {
  Reader reader{.file = file};
  reader.readLines();
  reader.makeTriangles();
  if (reader.hasMaterials) reader.readLibraries();
  return std::move(reader.out);
}

}  // namespace sherd
