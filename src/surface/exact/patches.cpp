// Connects parts over edges that are no seams.
#include "surface/exact/patches.h"

#include <utility>

#include "base/union_find.h"

namespace sherd {
namespace {

std::vector<glm::uvec3> trianglesOf(const std::vector<Part>& parts) {
  std::vector<glm::uvec3> triangles;
  triangles.reserve(parts.size());
  for (const Part& part : parts) triangles.push_back(part.corner);
  return triangles;
}

}  // namespace

std::vector<Part> partsOf(std::span<const glm::uvec3> triangles,
                          const std::vector<std::uint8_t>& isCrossed,
                          const std::vector<CutTriangle>& parts, std::uint32_t firstVertex) {
  std::vector<Part> all;
  all.reserve(triangles.size() + parts.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (isCrossed[t] == 0) all.push_back({triangles[t] + firstVertex, t});
  }
  for (const CutTriangle& part : parts) all.push_back({part.corner, part.source});
  return all;
}

Patches::Patches(std::vector<Part> parts, std::size_t vertices, const std::vector<Seam>& seams)
    : parts_(std::move(parts)),
      edges_(trianglesOf(parts_), vertices),
      isSeam_(edges_.count(), false) {
  for (const Seam& seam : seams) {
    const std::uint32_t edge = edges_.between(seam.from, seam.to);
    if (edge != FaceEdges::kNone) isSeam_[edge] = true;
  }
  UnionFind patches(parts_.size());
  for (std::size_t e = 0; e < edges_.count(); ++e) {
    if (isSeam_[e]) continue;
    const auto uses = edges_.uses(e);
    for (std::size_t i = 1; i < uses.size(); ++i) patches.unite(uses[0].face, uses[i].face);
  }
  patchOf_ = std::move(patches).all();
}

}  // namespace sherd
