// Checks that a merged mesh is consistent.
#include <sherd/error.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

#include "base/files/parsed_json.h"
#include "base/finite.h"
#include "formats/mesh/contradictions.h"

namespace sherd {
namespace {

// Whether a text is empty or JSON that other code may go through by recursion.
bool isShallowJson(const std::string& text) {
  try {
    return text.empty() || parsedJson(text).is_object();
  } catch (const Error&) {
    return false;
  }
}

std::optional<std::string> badAppearance(const Appearance& appearance) {
  for (const Material& material : appearance.materials) {
    if (!isFinite(material.color)) return "one of its materials has a color that is not finite";
    if (!isShallowJson(material.gltf)) return "one of its materials is no object of JSON";
  }
  return std::nullopt;
}

// What merging makes sure of.
std::optional<std::string> badGeometry(const TriangleMesh& mesh) {
  for (const glm::dvec3& v : mesh.vertices) {
    if (!isFinite(v)) {
      return "vertex " + std::to_string(&v - mesh.vertices.data() + 1) + " is not finite";
    }
  }
  for (const glm::uvec3& t : mesh.triangles) {
    if (t.x == t.y || t.y == t.z || t.z == t.x) {
      return "triangle " + std::to_string(&t - mesh.triangles.data() + 1) + " has equal corners";
    }
  }
  constexpr float kMostOff = 1e-3f;
  for (const auto& corners : mesh.attributes.normals) {
    for (const glm::vec3& n : corners) {
      if (!(std::abs(glm::dot(n, n) - 1.0f) <= kMostOff))
        return "one of its normals is no unit vector";
    }
  }
  if (auto bad = tooLong(mesh)) return "it " + *bad;
  return std::nullopt;
}

}  // namespace

std::optional<std::string> contradictionIn(const SourceMesh& source) {
  const TriangleMesh& mesh = source.mesh;
  if (auto bad = contradictionIn(MeshParts{mesh.vertices, mesh.triangles, mesh.attributes,
                                           mesh.neighbor, source.appearance, source.objects,
                                           source.objectOfTriangle, source.polygons})) {
    return bad;
  }
  if (auto bad = badAppearance(source.appearance)) return bad;
  return badGeometry(mesh);
}

std::optional<std::string> tooLong(const TriangleMesh& mesh) {
  constexpr double kLongestSide = 1e37;
  const Box box = bounds(mesh);
  for (int axis = 0; axis < 3; ++axis) {
    const double side = box.max[axis] - box.min[axis];
    if (side <= kLongestSide) continue;
    std::array<char, 40> length{};
    std::snprintf(length.data(), length.size(), "%.3g", side);
    return std::string("is ") + length.data() + " long along " + "xyz"[axis] +
           ", at most 1e37 is supported (scale it)";
  }
  return std::nullopt;
}

}  // namespace sherd
