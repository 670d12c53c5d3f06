// Builds the mesh of all labels.
#include "interface/interface_surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "base/cancel_flag.h"

namespace sherd {
namespace {

bool hasLowerLabel(const InterfaceQuad& a, const InterfaceQuad& b) { return a.label < b.label; }

}  // namespace

class InterfaceSurface::Builder {
 public:
  Builder(InterfaceSurface& to, const Solid& solid, const Labels& labels, const Cut& cut,
          std::span<const LeafNeighbors> neighborhoods, const Creases& creases,
          const IntactSurface* intact)
      : to_(to),
        solid_(solid),
        cut_(cut),
        intact_(intact),
        neighborhoods_(neighborhoods),
        field_(solid, labels, cut, neighborhoods, &creases),
        count_(solid.blocks->count()),
        labels_(static_cast<std::size_t>(labels.fragmentCount)) {}

  void build(SurfaceVertices extent, const Progress* progress) {
    findReused(extent);
    to_.quads_.resize(count_);
    to_.intactOctants_.assign(count_, 0);
    meshLeaves(progress);
    std::vector<glm::dvec3>& vertices = to_.vertices_.at;
    straightenBoundaries(to_.quads_, junctions_, vertices, [&](std::size_t leaf) {
      return isAtSlots(leaf, [&](std::uint32_t other) { return hasJunctions_[other] != 0; });
    });
    throwIfCancelled(progress);
    to_.gaps_ = splitNonManifoldVertices(nonManifold_, to_.quads_, to_.vertices_);
    tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t v) {
      vertices[v] = solid_.frame.worldFromIndex(vertices[v]);
    });
    throwIfCancelled(progress);
    labelVertices();
    tbb::parallel_for(std::size_t{0}, count_, [&](std::size_t leaf) { finishQuads(leaf); });
    sortFaces();
  }

 private:
  static constexpr std::uint32_t kChanged = 0xffffffffu;

  void findReused(SurfaceVertices extent) {
    intactLabels_.assign(count_, kChanged);
    to_.reusesTriangles_.assign(count_, 0);
    hasVertices_.assign(count_, extent == SurfaceVertices::all ? 1 : 0);
    hasJunctions_.assign(count_, 0);
    if (intact_ != nullptr) {
      tbb::parallel_for(std::size_t{0}, count_,
                        [&](std::size_t leaf) { intactLabels_[leaf] = intactLabelOf(leaf); });
      tbb::parallel_for(std::size_t{0}, count_, [&](std::size_t leaf) {
        to_.reusesTriangles_[leaf] = reusesTriangles(leaf, extent) ? 1 : 0;
      });
    }
    for (std::size_t leaf = 0; leaf < count_; ++leaf) {
      if (to_.reusesTriangles_[leaf] != 0) continue;
      for (const std::size_t slot : IntactLeaf::kSlots) {
        const std::uint32_t other = neighborhoods_[leaf][slot];
        if (other != LeafBlocks::kNone) hasVertices_[other] = 1;
      }
    }
  }

  // The only label of a leaf whose cells equal those of the intact solid, 0 if it has no label;
  // else kChanged.
  std::uint32_t intactLabelOf(std::size_t leaf) const {
    if (!intact_->leaves[leaf].cells.isPlain) return kChanged;
    if (cut_.index[leaf] == Cut::kWhole) return cut_.only[leaf];
    const std::optional<std::uint16_t> only = onlyLabelOf(field_, leaf);
    return only ? *only : kChanged;
  }

  bool isReused(std::size_t leaf) const { return intactLabels_[leaf] != kChanged; }

  bool reusesTriangles(std::size_t leaf, SurfaceVertices extent) const {
    if (!isReused(leaf) || !intact_->leaves[leaf].isWhole) return false;
    // All cells around its edges have one label.
    if (extent == SurfaceVertices::changed) return cut_.index[leaf] == Cut::kWhole;
    return !isAtSlots(leaf, [&](std::uint32_t other) { return !isReused(other); });
  }

  // Whether a leaf or one of those below it, whose vertices its quads may have, fulfills a
  // condition.
  template <class Condition>
  bool isAtSlots(std::size_t leaf, const Condition& condition) const {
    return std::any_of(IntactLeaf::kSlots.begin(), IntactLeaf::kSlots.end(), [&](std::size_t slot) {
      const std::uint32_t other = neighborhoods_[leaf][slot];
      return other != LeafBlocks::kNone && condition(other);
    });
  }

  // Makes cells, vertices and quads, a few slabs of leaves at a time.  The quads of a leaf need its
  // own cells and those of leaves below it, so cells are freed when the next slab has its quads.
  // All cells together would take more memory than the meshes.
  void meshLeaves(const Progress* progress) {
    constexpr std::size_t kMinLeaves = 16384;  // leaves per batch, to keep all threads busy
    const std::span<const openvdb::Coord> origins = solid_.blocks->origins;
    newCells_.resize(count_);
    cells_.leaves.resize(count_);
    const auto nextSlab = [&](std::size_t leaf) {
      const int x = origins[leaf].x();
      while (leaf < count_ && origins[leaf].x() == x) ++leaf;
      return leaf;
    };
    std::size_t kept = 0;
    for (std::size_t first = 0, end = 0; first < count_; first = end) {
      std::size_t last = first;  // first leaf of the batch's last slab
      while (end < count_ && end - first < kMinLeaves) {
        last = end;
        end = nextSlab(end);
      }
      throwIfCancelled(progress);
      tbb::parallel_for(first, end, [&](std::size_t leaf) { makeCells(leaf); });
      appendVertices(first, end);
      throwIfCancelled(progress);
      tbb::parallel_for(first, end, [&](std::size_t leaf) {
        if (!to_.reusesTriangles(leaf)) makeQuads(leaf);
      });
      tbb::parallel_for(kept, last, [&](std::size_t leaf) { newCells_[leaf].reset(); });
      kept = last;
    }
    to_.firstVertex_ = std::move(cells_.firstVertex);
  }

  void makeCells(std::size_t leaf) {
    const LeafCells* const before = intact_ ? &intact_->leaves[leaf].cells : nullptr;
    if (isReused(leaf)) {
      cells_.leaves[leaf] = before;
      return;
    }
    newCells_[leaf] = std::make_unique<LeafCells>(cellsOf(field_, leaf, before));
    cells_.leaves[leaf] = newCells_[leaf].get();
  }

  void makeQuads(std::size_t leaf) {
    if (intact_ == nullptr || !intact_->leaves[leaf].isWhole) {
      to_.quads_[leaf] = sherd::quadsOf(field_, cells_, leaf);
      return;
    }
    const LeafEdges edges = edgesAround(neighborhoods_[leaf], [&](std::size_t other) {
      return newCells_[other] ? &newCells_[other]->made : nullptr;
    });
    const bool isAny =
        std::ranges::any_of(edges, [](const CellBits& of) { return of != CellBits{}; });
    const std::vector<InterfaceQuad> made =
        isAny ? sherd::quadsOf(field_, cells_, leaf, &edges) : std::vector<InterfaceQuad>();
    const std::vector<InterfaceQuad> kept = intactQuads(leaf);
    to_.intactOctants_[leaf] = intactOctants(leaf, made, kept);
    to_.quads_[leaf].resize(made.size() + kept.size());
    std::merge(made.begin(), made.end(), kept.begin(), kept.end(), to_.quads_[leaf].begin(),
               [](const InterfaceQuad& a, const InterfaceQuad& b) { return a.edge < b.edge; });
  }

  // The intact solid's quads whose cells all are the intact solid's.  A cell has one label, so all
  // cells around an edge have that of its inside voxel.
  std::vector<InterfaceQuad> intactQuads(std::size_t leaf) const {
    std::array<std::uint32_t, 8> first{};
    std::array<const std::uint16_t*, 8>
        fromIntact{};  // null where all cells are the intact solid's
    for (std::size_t slot = 0; slot < 8; ++slot) {
      const std::uint32_t other = neighborhoods_[leaf][IntactLeaf::kSlots[slot]];
      if (other == LeafBlocks::kNone) continue;
      first[slot] = cells_.firstVertex[other];
      if (newCells_[other]) fromIntact[slot] = newCells_[other]->fromIntact.data();
    }
    std::vector<InterfaceQuad> kept;
    kept.reserve(intact_->leaves[leaf].quads.size());
    for (const IntactLeaf::Quad& quad : intact_->leaves[leaf].quads) {
      InterfaceQuad own{.edge = quad.edge, .split = quad.split, .isIntact = true};
      bool isKept = true;
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t slot = IntactLeaf::slotOf(quad.corner[k]);
        std::uint32_t vertex = IntactLeaf::vertexOf(quad.corner[k]);
        if (fromIntact[slot] != nullptr) vertex = fromIntact[slot][vertex];
        isKept &= vertex != LeafCells::kNotIntact;
        own.vertex[k] = first[slot] + vertex;
      }
      if (!isKept) continue;
      own.label = to_.vertexLabels_[own.vertex[0]];
      kept.push_back(own);
    }
    return kept;
  }

  std::uint8_t intactOctants(std::size_t leaf, std::span<const InterfaceQuad> made,
                             std::span<const InterfaceQuad> kept) const {
    struct Octant {
      std::size_t quads = 0;
      std::uint16_t label = 0;
      bool isChanged = false;
    };
    std::array<Octant, 8> octants{};
    for (const InterfaceQuad& quad : made) octants[octantOf(quad.edge)].isChanged = true;
    for (const InterfaceQuad& quad : kept) {
      Octant& own = octants[octantOf(quad.edge)];
      own.isChanged |= own.quads > 0 && own.label != quad.label;
      own.label = quad.label;
      ++own.quads;
    }
    for (const IntactLeaf::Quad& quad : intact_->leaves[leaf].quads)
      --octants[octantOf(quad.edge)].quads;
    unsigned bits = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      if (!octants[i].isChanged && octants[i].quads == 0) bits |= 1u << i;
    }
    return static_cast<std::uint8_t>(bits);
  }

  // Settles quads and groups them by label; within a label they keep their order.
  void finishQuads(std::size_t leaf) {
    std::vector<InterfaceQuad>& quads = to_.quads_[leaf];
    for (InterfaceQuad& quad : quads) {
      if (!quad.isIntact) quad.split = settledSplit(quad, to_.vertices_.at);
    }
    if (!std::is_sorted(quads.begin(), quads.end(), hasLowerLabel)) {
      std::stable_sort(quads.begin(), quads.end(), hasLowerLabel);
    }
  }

  void appendVertices(std::size_t first, std::size_t end) {
    InterfaceVertices& vertices = to_.vertices_;
    for (std::size_t leaf = first; leaf < end; ++leaf) {
      if (hasVertices_[leaf] == 0) {
        cells_.firstVertex.push_back(kNone);
        continue;
      }
      const LeafCells& own = *cells_.leaves[leaf];
      const auto firstVertex = static_cast<std::uint32_t>(vertices.at.size());
      cells_.firstVertex.push_back(firstVertex);
      for (const std::uint32_t p : own.positionIds)
        vertices.positionId.push_back(vertices.positionCount + p);
      for (const std::uint32_t p : own.nonManifold)
        nonManifold_.push_back(vertices.positionCount + p);
      vertices.positionCount += own.positionCount;
      vertices.at.insert(vertices.at.end(), own.vertices.begin(), own.vertices.end());
      std::vector<std::uint16_t>& labels = to_.vertexLabels_;
      if (isReused(leaf)) {
        labels.insert(labels.end(), own.vertices.size(),
                      static_cast<std::uint16_t>(intactLabels_[leaf]));
      } else {
        labels.insert(labels.end(), own.labels.begin(), own.labels.end());
      }
      hasJunctions_[leaf] = own.junctions.empty() ? 0 : 1;
      for (Junction junction : own.junctions) {
        for (std::uint32_t& v : junction.vertices()) v += firstVertex;
        junctions_.push_back(junction);
      }
    }
  }

  // Splitting sheets adds vertices and leaves others without a face, at the same positions.
  void labelVertices() {
    std::vector<std::uint16_t>& label = to_.vertexLabels_;
    if (nonManifold_.empty()) return;
    const InterfaceVertices& vertices = to_.vertices_;
    std::vector<bool> isNonManifold(vertices.positionCount);
    for (const std::uint32_t positionId : nonManifold_) isNonManifold[positionId] = true;
    label.resize(vertices.at.size());
    for (std::size_t v = 0; v < label.size(); ++v) {
      if (isNonManifold[vertices.positionId[v]]) label[v] = 0;
    }
    for (const std::vector<InterfaceQuad>& quads : to_.quads_) {
      for (const InterfaceQuad& quad : quads) {
        for (const std::uint32_t v : quad.vertex) label[v] = quad.label;
      }
    }
    for (const InterfaceTriangle& gap : to_.gaps_) {
      for (const std::uint32_t v : gap.vertex) label[v] = gap.label;
    }
  }

  void sortFaces() {
    to_.leavesOf_.resize(labels_ + 1);
    const auto add = [&](std::uint16_t label, std::uint32_t leaf) {
      if (!hasMesh(label)) return;
      std::vector<std::uint32_t>& own = to_.leavesOf_[label];
      if (own.empty() || own.back() != leaf) own.push_back(leaf);
    };
    for (std::uint32_t leaf = 0; leaf < count_; ++leaf) {
      if (to_.reusesTriangles(leaf)) {
        add(static_cast<std::uint16_t>(intactLabels_[leaf]), leaf);
      } else {
        for (const InterfaceQuad& quad : to_.quads_[leaf]) add(quad.label, leaf);
      }
    }
    to_.gapsOf_.resize(labels_ + 1);
    for (const InterfaceTriangle& gap : to_.gaps_) to_.gapsOf_[gap.label].push_back(&gap);
  }

  InterfaceSurface& to_;
  const Solid& solid_;
  const Cut& cut_;
  const IntactSurface* const intact_;
  const std::span<const LeafNeighbors> neighborhoods_;
  const Field field_;
  const std::size_t count_, labels_;
  std::vector<std::uint32_t> intactLabels_;           // [leaf]
  std::vector<std::uint8_t> hasVertices_;             // [leaf]
  std::vector<std::uint8_t> hasJunctions_;            // [leaf]
  std::vector<std::unique_ptr<LeafCells>> newCells_;  // [leaf] null if reused or freed
  AllCells cells_;
  std::vector<std::uint32_t> nonManifold_;
  std::vector<Junction> junctions_;
};

InterfaceSurface::InterfaceSurface(const Solid& solid, const Labels& labels, const Cut& cut,
                                   std::span<const LeafNeighbors> neighborhoods,
                                   const Creases& creases, const IntactSurface* intact,
                                   SurfaceVertices extent, const Progress* progress) {
  Builder(*this, solid, labels, cut, neighborhoods, creases, intact).build(extent, progress);
}

std::span<const InterfaceQuad> InterfaceSurface::quadsOf(std::size_t leaf,
                                                         std::uint16_t label) const {
  const auto [first, last] = std::equal_range(quads_[leaf].begin(), quads_[leaf].end(),
                                              InterfaceQuad{.label = label}, hasLowerLabel);
  return {first, last};
}

}  // namespace sherd
