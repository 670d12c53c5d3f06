// Writes a fragment's mesh as a prim of USD.
#include "formats/usd/usd_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <limits>
#include <map>
#include <vector>

namespace sherd {
namespace {

// Values of corners, each written once, and which of them each corner has.
template <class Value>
struct Indexed {
  std::vector<Value> values{};
  std::vector<std::uint32_t> of{};  // [3 triangles]

  void add(const Value& value) {
    std::array<float, Value::length()> key;
    for (int k = 0; k < Value::length(); ++k) key[static_cast<std::size_t>(k)] = value[k] + 0.0f;
    const auto [at, isNew] = number_.try_emplace(key, static_cast<std::uint32_t>(values.size()));
    if (isNew) values.push_back(value);
    of.push_back(at->second);
  }

 private:
  std::map<std::array<float, Value::length()>, std::uint32_t> number_{};
};

void appendWhole(std::string& text, std::uint32_t value) { appendShortest(text, value); }

class MeshPrim {
 public:
  MeshPrim(UsdText& text, const PieceMesh& piece) : text_(text), piece_(piece) {}

  void topology() {
    const std::vector<glm::uvec3>& triangles = piece_.mesh.triangles;
    text_.array("int[] faceVertexCounts", triangles,
                [](std::string& to, const glm::uvec3&) { to += '3'; });
    text_.array("int[] faceVertexIndices", triangles, [](std::string& to, const glm::uvec3& t) {
      for (int k = 0; k < 3; ++k) appendWhole(k > 0 ? to += ", " : to, t[k]);
    });
  }

  void points(const glm::dvec3& origin) {
    text_.line(usdExtent(piece_.mesh, origin));
    text_.array(
        "point3f[] points", piece_.mesh.vertices,
        [&](std::string& to, const glm::dvec3& v) { to += usdVector(glm::vec3(v - origin)); });
  }

  void neighbor() {
    std::vector<std::uint32_t> neighbor;
    for (std::size_t t = 0; t < piece_.mesh.triangles.size(); ++t) {
      neighbor.push_back(piece_.mesh.neighborOf(t));
    }
    text_.array("int[] primvars:neighbor", neighbor, appendWhole, "interpolation = \"uniform\"");
  }

  void normals() {
    Indexed<glm::vec3> normals;
    for (const std::array<glm::vec3, 3>& corners : shortNormals(piece_)) {
      for (const glm::vec3& n : corners) normals.add(n);
    }
    indexed("normal3f[] primvars:normals", normals,
            [](std::string& to, const glm::vec3& n) { to += usdVector(n); });
  }

  void texcoords() {
    if (piece_.attributes.texcoords.empty()) return;
    Indexed<glm::vec2> all;
    for (const auto& corners : piece_.attributes.texcoords) {
      for (const glm::vec2& at : corners) all.add(at);
    }
    indexed("texCoord2f[] primvars:st", all, [](std::string& to, const glm::vec2& at) {
      appendFloat(to += '(', at.x);
      appendFloat(to += ", ", at.y);
      to += ')';
    });
  }

  void colors() {
    if (piece_.attributes.colors.empty()) return;
    Indexed<glm::vec3> all;
    for (const auto& corners : piece_.attributes.colors) {
      for (const glm::u8vec3& color : corners) all.add(linearFromSrgb(color));
    }
    indexed("color3f[] primvars:displayColor", all,
            [](std::string& to, const glm::vec3& color) { to += usdVector(color); });
  }

  void subsets(const std::function<std::string(std::uint32_t)>& materialPath) {
    std::map<std::uint32_t, std::vector<std::uint32_t>> faces;
    for (std::uint32_t t = 0; t < piece_.mesh.triangles.size(); ++t) {
      faces[piece_.materialOf(t)].push_back(t);
    }
    for (const auto& [material, own] : faces) {
      const std::string path = materialPath(material);
      text_.open("def GeomSubset", path.substr(path.rfind('/') + 1),
                 "\n    prepend apiSchemas = [\"MaterialBindingAPI\"]\n");
      text_.line("uniform token elementType = \"face\"");
      text_.line("uniform token familyName = \"materialBind\"");
      text_.array("int[] indices", own, appendWhole);
      text_.line("rel material:binding = <" + path + ">");
      text_.close();
    }
  }

 private:
  template <class Value, class Append>
  void indexed(const std::string& declaration, const Indexed<Value>& all, const Append& append) {
    text_.array(declaration, all.values, append, "interpolation = \"faceVarying\"");
    const std::string name = declaration.substr(declaration.find(' ') + 1);
    text_.array("int[] " + name + ":indices", all.of, appendWhole);
  }

  UsdText& text_;
  const PieceMesh& piece_;
};

}  // namespace

std::string usdExtent(const TriangleMesh& mesh, const glm::dvec3& origin, double unit) {
  glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
  for (const glm::dvec3& v : mesh.vertices) {
    low = glm::min(low, glm::vec3((v - origin) / unit));
    high = glm::max(high, glm::vec3((v - origin) / unit));
  }
  return "float3[] extent = [" + usdVector(low) + ", " + usdVector(high) + "]";
}

void writeUsdMesh(UsdText& text, const std::string& name, const PieceMesh& piece,
                  const glm::dvec3& origin,
                  const std::function<std::string(std::uint32_t)>& materialPath) {
  const bool isPlain = !materialPath;
  text.open("def Mesh", name,
            std::string("\n    prepend apiSchemas = [") +
                (isPlain ? "" : "\"MaterialBindingAPI\", ") +
                "\"PhysicsCollisionAPI\", \"PhysicsMeshCollisionAPI\"]\n");
  text.line("uniform bool doubleSided = 0");
  MeshPrim prim(text, piece);
  prim.points(origin);
  prim.topology();
  if (!isPlain) {
    prim.normals();
    prim.texcoords();
    prim.colors();
    prim.neighbor();
  }
  text.line("uniform token physics:approximation = \"convexHull\"");
  text.line("uniform token subdivisionScheme = \"none\"");
  if (!isPlain) {
    text.line("uniform token subsetFamily:materialBind:familyType = \"partition\"");
    prim.subsets(materialPath);
  }
  text.close();
}

}  // namespace sherd
