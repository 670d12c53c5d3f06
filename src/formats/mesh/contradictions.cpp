// Checks that a reader's result is consistent.
#include "formats/mesh/contradictions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/finite.h"

namespace sherd {
namespace {

std::string countOf(const char* things, std::size_t found, std::size_t expected) {
  return "it has " + std::to_string(found) + " " + things + " for " + std::to_string(expected) +
         " triangles";
}

// An array has one entry for each triangle, or none.
template <class Entry>
bool fits(const std::vector<Entry>& entries, std::size_t triangles) {
  return entries.empty() || entries.size() == triangles;
}

// "triangle 3 has material 7, there are 2", for the first number out of range.
std::optional<std::string> outOfRange(const std::vector<std::uint32_t>& numbers, const char* thing,
                                      std::size_t count) {
  const auto bad = std::find_if(numbers.begin(), numbers.end(),
                                [&](std::uint32_t number) { return number >= count; });
  if (bad == numbers.end()) return std::nullopt;
  return "triangle " + std::to_string(bad - numbers.begin() + 1) + " has " + thing + " " +
         std::to_string(*bad) + ", there are " + std::to_string(count);
}

std::optional<std::string> badIndex(const MeshParts& mesh) {
  for (const glm::uvec3& t : mesh.triangles) {
    const std::uint32_t largest = std::max({t.x, t.y, t.z});
    if (largest < mesh.vertices.size()) continue;
    return "triangle " + std::to_string(&t - mesh.triangles.data() + 1) + " uses vertex " +
           std::to_string(largest) + ", there are " + std::to_string(mesh.vertices.size());
  }
  return std::nullopt;
}

std::optional<std::string> badLength(const MeshParts& mesh) {
  const std::size_t triangles = mesh.triangles.size();
  const SurfaceAttributes& attributes = mesh.attributes;
  if (!fits(attributes.texcoords, triangles))
    return countOf("texture coordinates", attributes.texcoords.size(), triangles);
  if (!fits(attributes.colors, triangles))
    return countOf("colors", attributes.colors.size(), triangles);
  if (!fits(attributes.material, triangles))
    return countOf("materials", attributes.material.size(), triangles);
  if (!fits(attributes.normals, triangles))
    return countOf("normals", attributes.normals.size(), triangles);
  if (!fits(mesh.neighbor, triangles)) return countOf("neighbors", mesh.neighbor.size(), triangles);
  if (!fits(mesh.objectOfTriangle, triangles))
    return countOf("objects", mesh.objectOfTriangle.size(), triangles);
  if (!fits(mesh.polygons, triangles))
    return countOf("places in faces", mesh.polygons.size(), triangles);
  return std::nullopt;
}

std::optional<std::string> badReference(const MeshParts& mesh) {
  const SurfaceAttributes& attributes = mesh.attributes;
  for (const auto& corners : attributes.texcoords) {
    if (!std::all_of(corners.begin(), corners.end(), [](const auto& at) { return isFinite(at); }))
      return "one of its texture coordinates is not finite";
  }
  if (const auto bad =
          outOfRange(attributes.material, "material", mesh.appearance.materials.size()))
    return bad;
  if (const auto bad = outOfRange(mesh.objectOfTriangle, "object", mesh.objects.size())) return bad;
  const auto textures = static_cast<int>(mesh.appearance.textures.size());
  for (const Material& material : mesh.appearance.materials) {
    if (material.texture >= -1 && material.texture < textures) continue;
    return "one of its materials has texture " + std::to_string(material.texture) + ", there are " +
           std::to_string(textures);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> contradictionIn(const MeshParts& mesh) {
  if (auto bad = badIndex(mesh)) return bad;
  if (auto bad = badLength(mesh)) return bad;
  return badReference(mesh);
}

std::optional<std::string> contradictionIn(const RawMesh& mesh) {
  return contradictionIn(MeshParts{mesh.vertices, mesh.triangles, mesh.attributes, mesh.neighbor,
                                   mesh.appearance, mesh.objects, mesh.objectOfTriangle,
                                   mesh.polygons});
}

}  // namespace sherd
