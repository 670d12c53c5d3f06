// Assembles the meshes of labels.
#include "surface/interface_mesh.h"

#include <array>
#include <vector>

#include "surface/contact_boundaries.h"
#include "surface/intact.h"
#include "surface/interface_surface.h"

namespace sherd {

/// The mesh of all labels, with vertices numbered by label.
class InterfaceMeshes::Meshing {
 public:
  Meshing(const Solid& solid, const Labels& labels, const Cut& cut,
          std::span<const LeafNeighbors> neighborhoods, const Creases& creases,
          const IntactSurface* intact, const Progress* progress)
      : intact_(intact),
        neighborhoods_(neighborhoods),
        surface_(solid, labels, cut, neighborhoods, creases, intact, SurfaceVertices::all,
                 progress) {
    numberVertices(static_cast<std::size_t>(labels.fragmentCount));
  }

  LabeledMesh meshOf(std::uint16_t label) const {
    const InterfaceVertices& vertices = surface_.vertices();
    LabeledMesh out;
    out.mesh.vertices.reserve(verticesOf_[label].size());
    out.positionId.reserve(verticesOf_[label].size());
    for (const std::uint32_t v : verticesOf_[label]) {
      out.mesh.vertices.push_back(vertices.at[v]);
      out.positionId.push_back(vertices.positionId[v]);
    }
    const std::span<const std::uint32_t> leaves = surface_.leavesOf(label);
    std::size_t triangles = surface_.gapsOf(label).size();
    for (const std::uint32_t leaf : leaves) {
      triangles += surface_.reusesTriangles(leaf) ? intact_->leaves[leaf].triangles.size()
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
        for (const auto& t : trianglesOf(quad, vertices.at)) add(t, quad.other);
      }
    }
    for (const InterfaceTriangle* gap : surface_.gapsOf(label)) add(gap->vertex, gap->other);
    return out;
  }

 private:
  void numberVertices(std::size_t fragments) {
    const std::span<const std::uint16_t> labels = surface_.vertexLabels();
    const auto hasMesh = [&](std::uint16_t label) { return label != 0 && label <= fragments; };
    std::vector<std::size_t> counts(fragments + 1, 0);
    for (const std::uint16_t label : labels) {
      if (hasMesh(label)) ++counts[label];
    }
    number_.resize(labels.size());
    verticesOf_.resize(fragments + 1);
    for (std::size_t label = 1; label <= fragments; ++label) {
      verticesOf_[label].reserve(counts[label]);
    }
    for (std::uint32_t v = 0; v < labels.size(); ++v) {
      if (!hasMesh(labels[v])) continue;
      std::vector<std::uint32_t>& own = verticesOf_[labels[v]];
      number_[v] = static_cast<std::uint32_t>(own.size());
      own.push_back(v);
    }
  }

  void addReused(std::uint32_t leaf, LabeledMesh& out) const {
    // A reused leaf's vertices have consecutive numbers.
    std::array<std::uint32_t, 8> first{};
    for (std::size_t slot = 0; slot < 8; ++slot) {
      const std::uint32_t other = neighborhoods_[leaf][IntactLeaf::kSlots[slot]];
      if (other == LeafBlocks::kNone || intact_->leaves[other].cells.vertices.empty()) continue;
      first[slot] = number_[surface_.firstVertex(other)];
    }
    const auto number = [&](IntactLeaf::Corner corner) {
      return first[IntactLeaf::slotOf(corner)] + IntactLeaf::vertexOf(corner);
    };
    const auto& triangles = intact_->leaves[leaf].triangles;
    for (const auto& t : triangles) {
      out.mesh.triangles.emplace_back(number(t[0]), number(t[1]), number(t[2]));
    }
    out.other.insert(out.other.end(), triangles.size(), 0);
  }

  const IntactSurface* intact_;
  const std::span<const LeafNeighbors> neighborhoods_;
  const InterfaceSurface surface_;
  std::vector<std::uint32_t> number_;                   // [vertices] in its label's mesh
  std::vector<std::vector<std::uint32_t>> verticesOf_;  // [labels + 1] ascending
};

InterfaceMeshes::InterfaceMeshes(const Solid& solid, const Labels& labels, const Cut& cut,
                                 std::span<const LeafNeighbors> neighborhoods,
                                 const Creases& creases, const IntactSurface* intact,
                                 const Progress* progress)
    : meshing_(std::make_unique<Meshing>(solid, labels, cut, neighborhoods, creases, intact,
                                         progress)) {}

InterfaceMeshes::~InterfaceMeshes() = default;

LabeledMesh InterfaceMeshes::meshOf(int label) const {
  return meshing_->meshOf(static_cast<std::uint16_t>(label));
}

}  // namespace sherd
