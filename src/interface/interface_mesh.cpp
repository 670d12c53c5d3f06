// Assembles the meshes of labels.
#include "interface/interface_mesh.h"

#include <numeric>

#include "interface/cells/contact_boundaries.h"
#include "interface/intact.h"

namespace sherd {

InterfaceMeshes::InterfaceMeshes(const InterfaceSurface& surface,
                                 std::span<const LeafNeighbors> neighborhoods,
                                 const IntactSurface* intact)
    : surface_(surface),
      neighborhoods_(neighborhoods),
      intact_(intact),
      number_(surface.vertexLabels().size()),
      runsOf_(surface.labels() + 1),
      vertexCounts_(surface.labels() + 1, 0) {
  const std::span<const std::uint16_t> labels = surface.vertexLabels();
  for (std::uint32_t first = 0, end = 0; first < labels.size(); first = end) {
    const std::uint16_t label = labels[first];
    while (end < labels.size() && labels[end] == label) ++end;
    if (label == 0 || label > surface.labels()) continue;
    std::iota(&number_[first], number_.data() + end, vertexCounts_[label]);
    runsOf_[label].push_back({first, end - first});
    vertexCounts_[label] += end - first;
  }
}

LabeledMesh InterfaceMeshes::meshOf(std::uint16_t label) const {
  const InterfaceVertices& vertices = surface_.vertices();
  LabeledMesh out;
  out.mesh.vertices.reserve(vertexCounts_[label]);
  out.positionId.reserve(vertexCounts_[label]);
  for (const auto& [first, count] : runsOf_[label]) {
    const auto at = vertices.at.begin() + first;
    const auto positionId = vertices.positionId.begin() + first;
    out.mesh.vertices.insert(out.mesh.vertices.end(), at, at + count);
    out.positionId.insert(out.positionId.end(), positionId, positionId + count);
  }
  const std::span<const std::uint32_t> leaves = surface_.leavesOf(label);
  std::size_t triangles = surface_.gapsOf(label).size();
  for (const std::uint32_t leaf : leaves) {
    triangles += surface_.reusesTriangles(leaf) ? intact_->leaves[leaf].triangles()
                                                : 2 * surface_.quadsOf(leaf, label).size();
  }
  out.mesh.triangles.reserve(triangles);
  out.other.reserve(triangles);
  const auto add = [&](const std::array<std::uint32_t, 3>& t, std::uint16_t other) {
    out.mesh.triangles.emplace_back(number_[t[0]], number_[t[1]], number_[t[2]]);
    out.other.push_back(other);
  };
  for (const std::uint32_t leaf : leaves) {
    if (surface_.reusesTriangles(leaf)) addReused(leaf, out);
    for (const InterfaceQuad& quad : surface_.quadsOf(leaf, label)) {
      for (const auto& t : trianglesOf(quad.vertex, quad.split)) add(t, quad.other);
    }
  }
  for (const InterfaceTriangle* gap : surface_.gapsOf(label)) add(gap->vertex, gap->other);
  return out;
}

void InterfaceMeshes::addReused(std::uint32_t leaf, LabeledMesh& out) const {
  // A reused leaf's vertices have consecutive numbers.
  std::array<std::uint32_t, 8> first{};
  for (std::size_t slot = 0; slot < 8; ++slot) {
    const std::uint32_t other = neighborhoods_[leaf][IntactLeaf::kSlots[slot]];
    if (other == LeafBlocks::kNone || intact_->leaves[other].cells.vertices.empty()) continue;
    first[slot] = number_[surface_.firstVertex(other)];
  }
  const IntactLeaf& intact = intact_->leaves[leaf];
  for (const IntactLeaf::Quad& quad : intact.quads) {
    std::array<std::uint32_t, 4> corner{};
    for (std::size_t k = 0; k < 4; ++k) {
      corner[k] = first[IntactLeaf::slotOf(quad.corner[k])] + IntactLeaf::vertexOf(quad.corner[k]);
    }
    for (const auto& t : trianglesOf(corner, quad.split)) {
      out.mesh.triangles.emplace_back(t[0], t[1], t[2]);
    }
  }
  out.other.insert(out.other.end(), intact.triangles(), 0);
}

}  // namespace sherd
