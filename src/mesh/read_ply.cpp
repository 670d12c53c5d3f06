// Reads a PLY file with its look.
#include "mesh/read_ply.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <utility>

#include "mesh/beside.h"
#include "mesh/colours.h"
#include "mesh/triangulate.h"

namespace sherd {
namespace {

// What the reader does with a property's value.
enum class Role { none, x, y, z, red, green, blue, u, v, corners, texcoords, texture, material };

Role roleOf(const PlyElement& element, const PlyProperty& property) {
  const auto is = [&](auto... names) { return ((property.name == names) || ...); };
  const bool ofVertex = element.name == "vertex", ofFace = element.name == "face";
  if (property.listCount) {
    if (isFaceCorners(element, property)) return Role::corners;
    return ofFace && is("texcoord") ? Role::texcoords : Role::none;
  }
  if (ofVertex && is("x")) return Role::x;
  if (ofVertex && is("y")) return Role::y;
  if (ofVertex && is("z")) return Role::z;
  if (ofVertex && is("u", "s", "texture_u", "texture_s")) return Role::u;
  if (ofVertex && is("v", "t", "texture_v", "texture_t")) return Role::v;
  if ((ofVertex || ofFace) && is("red", "r", "diffuse_red")) return Role::red;
  if ((ofVertex || ofFace) && is("green", "g", "diffuse_green")) return Role::green;
  if ((ofVertex || ofFace) && is("blue", "b", "diffuse_blue")) return Role::blue;
  if (ofFace && is("texnumber")) return Role::texture;
  if (ofFace && is("material")) return Role::material;
  return Role::none;
}

bool has(const PlyHeader& header, const std::string& element, std::initializer_list<Role> roles) {
  return std::all_of(roles.begin(), roles.end(), [&](Role role) {
    return std::any_of(header.elements.begin(), header.elements.end(), [&](const PlyElement& e) {
      return e.name == element &&
             std::any_of(e.properties.begin(), e.properties.end(),
                         [&](const PlyProperty& p) { return roleOf(e, p) == role; });
    });
  });
}

// A colour's channel as a share of the most that its type can tell; floats as they are.
float channel(double value, const PlyType& type) {
  if (!type.isInteger) return static_cast<float>(value);
  const double bits = 8.0 * static_cast<double>(type.bytes) - (type.isSigned ? 1.0 : 0.0);
  return static_cast<float>(value / (std::exp2(bits) - 1.0));
}

struct Values {
  glm::dvec3 position{0.0};
  glm::vec3 colour{1.0f};
  glm::vec2 texcoord{0.0f};
  std::vector<std::int64_t> corners{};
  std::vector<float> texcoords{};
  std::int64_t texture = 0, material = 0;
};

// The values of one vertex or face.
void take(PlyBody& body, const PlyElement& element, Values& values) {
  values.corners.clear();
  values.texcoords.clear();
  for (const PlyProperty& property : element.properties) {
    const Role role = roleOf(element, property);
    const auto number = [&] { return body.number(property.value); };
    const auto real = [&] { return static_cast<float>(body.number(property.value)); };
    if (property.listCount) {
      const auto length = static_cast<std::size_t>(body.integer(*property.listCount));
      for (std::size_t i = 0; i < length && role == Role::corners; ++i) {
        values.corners.push_back(body.integer(property.value));
      }
      for (std::size_t i = 0; i < length && role == Role::texcoords; ++i) {
        values.texcoords.push_back(real());
      }
      if (role == Role::none) body.skip(property.value, length);
      continue;
    }
    switch (role) {
      case Role::x:
      case Role::y:
      case Role::z:  // in single precision, as Assimp reads them
        values.position[static_cast<int>(role) - static_cast<int>(Role::x)] = real();
        break;
      case Role::red:
      case Role::green:
      case Role::blue:
        values.colour[static_cast<int>(role) - static_cast<int>(Role::red)] =
            channel(number(), property.value);
        break;
      case Role::u:
      case Role::v:
        values.texcoord[role == Role::u ? 0 : 1] = real();
        break;
      case Role::texture:
      case Role::material: {
        const double value = number();
        const bool good = value >= 0.0 && value <= std::numeric_limits<std::int32_t>::max();
        (role == Role::texture ? values.texture : values.material) =
            good ? static_cast<std::int64_t>(value) : 0;
        break;
      }
      default:
        body.skip(property.value, 1);
    }
  }
}

// Vertices as the file has them, and whether faces' corners need vertices of their own.
struct Reader {
  const MeshFile& file;
  const PlyHeader& header;
  bool vertexColours = has(header, "vertex", {Role::red, Role::green, Role::blue});
  bool faceColours = !vertexColours && has(header, "face", {Role::red, Role::green, Role::blue});
  bool faceTexcoords = has(header, "face", {Role::texcoords});
  bool vertexTexcoords = !faceTexcoords && has(header, "vertex", {Role::u, Role::v});
  bool byMaterial = has(header, "face", {Role::material});
  bool split = faceColours || faceTexcoords;

  struct Face {
    std::size_t first, count;
    glm::vec3 colour;
    std::int64_t material;
  };
  RawMesh out{};
  std::vector<glm::dvec3> positions{};
  std::vector<glm::vec3> colours{};
  std::vector<glm::vec2> texcoords{};
  std::vector<Face> faces{};
  std::vector<std::uint32_t> corners{};
  std::vector<glm::vec2> cornerTexcoords{};

  void addFace(const Values& values, const PlyBody& body) {
    if (values.corners.size() < 3) return;
    faces.push_back({corners.size(), values.corners.size(), values.colour,
                     byMaterial ? values.material : values.texture});
    for (std::size_t k = 0; k < values.corners.size(); ++k) {
      const std::int64_t corner = values.corners[k];
      if (corner < 0 || static_cast<std::size_t>(corner) >= header.vertices) {
        throw body.bad("uses vertex " + std::to_string(corner));
      }
      corners.push_back(static_cast<std::uint32_t>(corner));
      if (!faceTexcoords) continue;
      const bool told = 2 * k + 1 < values.texcoords.size();
      cornerTexcoords.push_back(
          told ? glm::vec2(values.texcoords[2 * k], values.texcoords[2 * k + 1]) : glm::vec2(0.0f));
    }
  }

  void readBody() {
    PlyBody body(file, header);
    Values values;
    for (const PlyElement& element : header.elements) {
      for (std::size_t i = 0; i < element.count; ++i) {
        body.begin(element, i);
        take(body, element, values);
        if (element.name == "face") addFace(values, body);
        if (element.name == "vertex") {
          positions.push_back(values.position);
          if (vertexColours) colours.push_back(values.colour);
          if (vertexTexcoords) texcoords.push_back(values.texcoord);
        }
        body.end();
      }
    }
  }

  void makeTriangles() {
    std::vector<glm::vec3> outColours;
    const auto addVertex = [&](std::size_t at) {
      out.vertices.push_back(positions[at]);
      if (vertexColours) outColours.push_back(colours[at]);
      if (vertexTexcoords) out.texcoords.push_back(texcoords[at]);
    };
    for (std::size_t i = 0; i < positions.size() && !split; ++i) addVertex(i);
    std::vector<std::uint32_t> polygon;
    for (const Face& face : faces) {
      polygon.clear();
      for (std::size_t i = face.first; i < face.first + face.count; ++i) {
        if (!split) {
          polygon.push_back(corners[i]);
          continue;
        }
        polygon.push_back(static_cast<std::uint32_t>(out.vertices.size()));
        addVertex(corners[i]);
        if (faceColours) outColours.push_back(face.colour);
        if (faceTexcoords) out.texcoords.push_back(cornerTexcoords[i]);
      }
      triangulate(out.vertices, polygon, out.triangles);
      ++out.polygons;
      if (!out.look.materials.empty()) {
        const auto most = static_cast<std::int64_t>(out.look.materials.size()) - 1;
        const auto material = static_cast<std::uint32_t>(std::min(face.material, most));
        out.material.resize(out.triangles.size(), material);
      }
    }
    out.colours = coloursFrom(outColours);
  }

  // Materials are what comments say: "material NUMBER NAME [TEXTURE]" as Sherd writes them, else
  // one for each "TextureFile NAME", as MeshLab does; TEXTURE counts these from 0.
  void readComments() {
    std::vector<std::string> textures;
    std::vector<std::optional<std::size_t>> textureOf;  // [materials]
    for (const std::string& comment : header.comments) {
      std::string_view rest = comment;
      const std::string_view word = takeWord(rest);
      if (word == "TextureFile") textures.emplace_back(trimmed(rest));
      if (word != "material" || !byMaterial) continue;
      if (parseInteger<std::size_t>(takeWord(rest)) != out.look.materials.size()) continue;
      out.look.materials.push_back({.name = std::string(takeWord(rest))});
      textureOf.push_back(parseInteger<std::size_t>(takeWord(rest)));
    }
    byMaterial = !out.look.materials.empty();
    if (!faceTexcoords && !vertexTexcoords) return;
    for (std::size_t i = 0; i < textures.size() && !byMaterial; ++i) {
      out.look.materials.push_back({.name = std::filesystem::path(textures[i]).stem().string()});
      textureOf.emplace_back(i);
    }
    for (std::size_t i = 0; i < textureOf.size(); ++i) {
      if (!textureOf[i] || *textureOf[i] >= textures.size()) continue;
      out.look.materials[i].texture = textureBeside(file, textures[*textureOf[i]], out.look);
    }
  }
};

}  // namespace

bool hasLook(const PlyHeader& header) {
  return has(header, "vertex", {Role::red, Role::green, Role::blue}) ||
         has(header, "face", {Role::red, Role::green, Role::blue}) ||
         has(header, "vertex", {Role::u, Role::v}) || has(header, "face", {Role::texcoords}) ||
         has(header, "face", {Role::material});
}

RawMesh readPlyWithLook(const MeshFile& file) {
  const PlyHeader header = readPlyHeader(file);
  Reader reader{.file = file, .header = header};
  reader.readComments();
  reader.readBody();
  reader.makeTriangles();
  return std::move(reader.out);
}

}  // namespace sherd
