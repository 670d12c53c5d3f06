// Whether what a reader found holds together.
#include "formats/mesh/contradictions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

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

bool isFinite(const glm::vec2& at) { return std::isfinite(at.x) && std::isfinite(at.y); }

// "triangle 3 has material 7, there are 2", of the first that has one beyond them.
std::optional<std::string> outOfRange(const std::vector<std::uint32_t>& numbers, const char* thing,
                                      std::size_t count) {
  const auto bad = std::find_if(numbers.begin(), numbers.end(),
                                [&](std::uint32_t number) { return number >= count; });
  if (bad == numbers.end()) return std::nullopt;
  return "triangle " + std::to_string(bad - numbers.begin() + 1) + " has " + thing + " " +
         std::to_string(*bad) + ", there are " + std::to_string(count);
}

}  // namespace

std::optional<std::string> contradictionIn(const RawMesh& mesh) {
  const std::size_t triangles = mesh.triangles.size();
  for (const glm::uvec3& t : mesh.triangles) {
    const std::uint32_t largest = std::max({t.x, t.y, t.z});
    if (largest < mesh.vertices.size()) continue;
    return "triangle " + std::to_string(&t - mesh.triangles.data() + 1) + " uses vertex " +
           std::to_string(largest) + ", there are " + std::to_string(mesh.vertices.size());
  }
  const SurfaceLook& look = mesh.look.surface;
  if (!fits(look.texcoords, triangles))
    return countOf("texture coordinates", look.texcoords.size(), triangles);
  if (!fits(look.colours, triangles)) return countOf("colors", look.colours.size(), triangles);
  if (!fits(look.material, triangles)) return countOf("materials", look.material.size(), triangles);
  if (!fits(mesh.objectOfTriangle, triangles))
    return countOf("objects", mesh.objectOfTriangle.size(), triangles);
  for (const auto& corners : look.texcoords) {
    if (!std::all_of(corners.begin(), corners.end(), isFinite))
      return "a texture coordinate of it is not finite";
  }
  if (const auto bad = outOfRange(look.material, "material", mesh.look.materials.size()))
    return bad;
  if (const auto bad = outOfRange(mesh.objectOfTriangle, "object", mesh.objects.size())) return bad;
  const auto textures = static_cast<int>(mesh.look.textures.size());
  for (const Material& material : mesh.look.materials) {
    if (material.texture >= -1 && material.texture < textures) continue;
    return "a material of it has texture " + std::to_string(material.texture) + ", there are " +
           std::to_string(textures);
  }
  return std::nullopt;
}

}  // namespace sherd
