// Dual meshing of many labels.
//
// A leaf with only one label has the same mesh as in the intact solid.  If the intact surface is
// given, the cells and triangles of such leaves are reused.
#include "surface/interface_mesh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <optional>

#include "base/cancel_flag.h"
#include "surface/contact_boundaries.h"
#include "surface/intact.h"
#include "surface/leaf_cells.h"
#include "surface/non_manifold_vertices.h"
#include "voxelize/leaf_blocks.h"

namespace sherd {
namespace {

template <class Work>
void forEach(std::size_t begin, std::size_t end, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) work(i);
  });
}

bool hasMesh(std::uint16_t label) { return label != 0 && label != Labels::kEroded; }

}  // namespace

/// The mesh of all labels, leaf by leaf.
class InterfaceMeshes::Meshing {
 public:
  Meshing(const Solid& solid, const Labels& labels, const Cut& cut,
          std::span<const LeafNeighbors> neighborhoods, std::size_t fragments,
          const IntactSurface* intact, const Progress* progress)
      : cut_(cut),
        intact_(intact),
        neighborhoods_(neighborhoods),
        field_(solid, labels, cut, neighborhoods),
        count_(solid.blocks->count()),
        quads_(count_) {
    if (intact_ != nullptr) {
      intactLabels_.resize(count_);
      forEach(0, count_, [&](std::size_t leaf) { intactLabels_[leaf] = intactLabelOf(leaf); });
    }
    meshLeaves(solid.blocks->origins, progress);
    straightenBoundaries(quads_, junctions_, vertices_.at);
    throwIfCancelled(progress);
    gaps_ = splitNonManifoldVertices(nonManifold_, quads_, vertices_);
    forEach(0, vertices_.at.size(),
            [&](std::size_t v) { vertices_.at[v] = solid.frame.worldFromIndex(vertices_.at[v]); });
    throwIfCancelled(progress);
    numberVertices(fragments);
    // Groups quads by label; within a label they keep their order.
    forEach(0, count_, [&](std::size_t leaf) {
      std::stable_sort(quads_[leaf].begin(), quads_[leaf].end(), hasLowerLabel);
    });
    sortFaces(fragments);
  }

  LabeledMesh meshOf(std::size_t i) const {
    const std::size_t label = i + 1;
    LabeledMesh out;
    out.mesh.vertices.reserve(verticesOf_[label].size());
    out.positionId.reserve(verticesOf_[label].size());
    for (const std::uint32_t v : verticesOf_[label]) {
      out.mesh.vertices.push_back(vertices_.at[v]);
      out.positionId.push_back(vertices_.positionId[v]);
    }
    const auto forEachQuad = [&](std::uint32_t leaf, const auto& visit) {
      const auto own = std::equal_range(quads_[leaf].begin(), quads_[leaf].end(),
                                        InterfaceQuad{.label = static_cast<std::uint16_t>(label)},
                                        hasLowerLabel);
      for (auto quad = own.first; quad != own.second; ++quad) visit(*quad);
    };
    std::size_t triangles = gapsOf_[i].size();
    for (const std::uint32_t leaf : leavesOf_[i]) {
      if (reusesTriangles(leaf)) triangles += intact_->leaves[leaf].triangles.size();
      forEachQuad(leaf, [&](const InterfaceQuad&) { triangles += 2; });
    }
    out.mesh.triangles.reserve(triangles);
    out.other.reserve(triangles);
    const auto add = [&](const std::array<std::uint32_t, 3>& t, std::uint16_t other) {
      out.mesh.triangles.emplace_back(number_[t[0]], number_[t[1]], number_[t[2]]);
      out.other.push_back(other);
    };
    for (const std::uint32_t leaf : leavesOf_[i]) {
      if (reusesTriangles(leaf)) addReused(leaf, out);
      forEachQuad(leaf, [&](const InterfaceQuad& quad) {
        for (const auto& t : trianglesOf(quad, vertices_.at)) add(t, quad.other);
      });
    }
    for (const InterfaceTriangle* gap : gapsOf_[i]) add(gap->vertex, gap->other);
    return out;
  }

 private:
  // The only label of a leaf whose cells equal those of the intact solid, 0 if it has no label;
  // else kChanged.
  std::uint32_t intactLabelOf(std::size_t leaf) const {
    if (!intact_->leaves[leaf].cells.isPlain) return kChanged;
    if (cut_.index[leaf] == Cut::kWhole) return cut_.only[leaf];
    const std::optional<std::uint16_t> only = onlyLabelOf(field_, leaf);
    return only ? *only : kChanged;
  }

  bool isReused(std::size_t leaf) const {
    return intact_ != nullptr && intactLabels_[leaf] != kChanged;
  }

  // True if the leaf's triangles equal those of the intact solid.  Next to a crack they do not,
  // because they use vertices of changed leaves.
  bool reusesTriangles(std::size_t leaf) const {
    if (!isReused(leaf) || !intact_->leaves[leaf].isWhole) return false;
    const LeafNeighbors& neighborhood = neighborhoods_[leaf];
    for (const std::size_t k : kBelow) {
      if (neighborhood[k] != LeafBlocks::kNone && intactLabels_[neighborhood[k]] == kChanged)
        return false;
    }
    return true;
  }

  // Makes cells, vertices and quads, a few slabs of leaves at a time.  The quads of a leaf need its
  // own cells and those of leaves below it, so cells are freed when the next slab has its quads.
  // All cells together would take more memory than the meshes.
  void meshLeaves(std::span<const openvdb::Coord> origins, const Progress* progress) {
    constexpr std::size_t kMinLeaves = 16384;  // leaves per batch, to keep all threads busy
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
      forEach(first, end, [&](std::size_t leaf) { makeCells(leaf); });
      appendVertices(first, end);
      throwIfCancelled(progress);
      forEach(first, end, [&](std::size_t leaf) {
        if (!reusesTriangles(leaf)) quads_[leaf] = quadsOf(field_, cells_, leaf);
      });
      forEach(kept, last, [&](std::size_t leaf) { newCells_[leaf].reset(); });
      kept = last;
    }
    newCells_ = std::vector<std::unique_ptr<LeafCells>>();
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

  void appendVertices(std::size_t first, std::size_t end) {
    for (std::size_t leaf = first; leaf < end; ++leaf) {
      const LeafCells& own = *cells_.leaves[leaf];
      const auto firstVertex = static_cast<std::uint32_t>(vertices_.at.size());
      cells_.firstVertex.push_back(firstVertex);
      for (const std::uint32_t p : own.positionIds)
        vertices_.positionId.push_back(vertices_.positionCount + p);
      for (const std::uint32_t p : own.nonManifold)
        nonManifold_.push_back(vertices_.positionCount + p);
      vertices_.positionCount += own.positionCount;
      vertices_.at.insert(vertices_.at.end(), own.vertices.begin(), own.vertices.end());
      for (Junction junction : own.junctions) {
        for (std::uint32_t& v : junction.vertices) v += firstVertex;
        junctions_.push_back(std::move(junction));
      }
    }
  }

  // Numbers the vertices of each label in order.  Splitting sheets adds vertices and leaves others
  // without a face.
  void numberVertices(std::size_t fragments) {
    label_.assign(vertices_.at.size(), 0);
    for (std::size_t leaf = 0; leaf < count_; ++leaf) {
      if (isReused(leaf)) {
        const auto first = label_.begin() + cells_.firstVertex[leaf];
        std::fill_n(first, cells_.leaves[leaf]->vertices.size(),
                    static_cast<std::uint16_t>(intactLabels_[leaf]));
      }
      for (const InterfaceQuad& quad : quads_[leaf]) {
        for (const std::uint32_t v : quad.vertex) label_[v] = quad.label;
      }
    }
    for (const InterfaceTriangle& gap : gaps_) {
      for (const std::uint32_t v : gap.vertex) label_[v] = gap.label;
    }
    std::vector<std::size_t> counts(fragments + 1, 0);
    for (const std::uint16_t label : label_) {
      if (hasMesh(label)) ++counts[label];
    }
    number_.resize(label_.size());
    verticesOf_.resize(fragments + 1);
    for (std::size_t label = 1; label <= fragments; ++label) {
      verticesOf_[label].reserve(counts[label]);
    }
    for (std::uint32_t v = 0; v < label_.size(); ++v) {
      if (!hasMesh(label_[v])) continue;
      std::vector<std::uint32_t>& own = verticesOf_[label_[v]];
      number_[v] = static_cast<std::uint32_t>(own.size());
      own.push_back(v);
    }
  }

  // Sets leavesOf_ and gapsOf_.
  void sortFaces(std::size_t fragments) {
    leavesOf_.resize(fragments);
    const auto add = [&](std::uint16_t label, std::uint32_t leaf) {
      if (!hasMesh(label)) return;
      std::vector<std::uint32_t>& own = leavesOf_[label - 1u];
      if (own.empty() || own.back() != leaf) own.push_back(leaf);
    };
    for (std::uint32_t leaf = 0; leaf < count_; ++leaf) {
      if (reusesTriangles(leaf)) {
        add(static_cast<std::uint16_t>(intactLabels_[leaf]), leaf);
      } else {
        for (const InterfaceQuad& quad : quads_[leaf]) add(quad.label, leaf);
      }
    }
    gapsOf_.resize(fragments);
    for (const InterfaceTriangle& gap : gaps_) gapsOf_[gap.label - 1u].push_back(&gap);
  }

  void addReused(std::uint32_t leaf, LabeledMesh& out) const {
    // A reused leaf's vertices have consecutive numbers.
    std::array<std::uint32_t, 8> first{};
    for (std::size_t slot = 0; slot < 8; ++slot) {
      const std::uint32_t other = neighborhoods_[leaf][kBelow[slot]];
      if (other == LeafBlocks::kNone || cells_.leaves[other]->vertices.empty()) continue;
      first[slot] = number_[cells_.firstVertex[other]];
    }
    constexpr unsigned kBits = IntactLeaf::kSlotBits;
    constexpr std::uint32_t kLocal = (std::uint32_t{1} << kBits) - 1;
    const auto number = [&](IntactLeaf::Corner corner) {
      return first[corner >> kBits] + (corner & kLocal);
    };
    const auto& triangles = intact_->leaves[leaf].triangles;
    for (const auto& t : triangles) {
      out.mesh.triangles.emplace_back(number(t[0]), number(t[1]), number(t[2]));
    }
    out.other.insert(out.other.end(), triangles.size(), 0);
  }

  static bool hasLowerLabel(const InterfaceQuad& a, const InterfaceQuad& b) {
    return a.label < b.label;
  }

  static constexpr std::uint32_t kChanged = 0xffffffffu;

  // Indices into LeafNeighbors of the slots 0..7 of IntactLeaf::Corner.
  static constexpr std::array<std::size_t, 8> kBelow{13, 12, 10, 9, 4, 3, 1, 0};

  const Cut& cut_;
  const IntactSurface* intact_;
  const std::span<const LeafNeighbors> neighborhoods_;
  const Field field_;
  const std::size_t count_;
  std::vector<std::uint32_t> intactLabels_;           // [leaf] empty without an intact surface
  std::vector<std::unique_ptr<LeafCells>> newCells_;  // [leaf] null if reused or freed
  AllCells cells_;
  InterfaceVertices vertices_;
  std::vector<std::uint32_t> nonManifold_;
  std::vector<Junction> junctions_;
  std::vector<std::vector<InterfaceQuad>> quads_;  // [leaf] finally sorted by label
  std::vector<InterfaceTriangle> gaps_;
  std::vector<std::uint16_t> label_;                    // [vertices]
  std::vector<std::uint32_t> number_;                   // [vertices] in its label's mesh
  std::vector<std::vector<std::uint32_t>> verticesOf_;  // [labels + 1] ascending
  std::vector<std::vector<std::uint32_t>> leavesOf_;    // [labels] with faces of it, ascending
  std::vector<std::vector<const InterfaceTriangle*>> gapsOf_;
};

InterfaceMeshes::InterfaceMeshes(const Solid& solid, const Labels& labels, const Cut& cut,
                                 std::span<const LeafNeighbors> neighborhoods, int fragments,
                                 const IntactSurface* intact, const Progress* progress)
    : meshing_(std::make_unique<Meshing>(solid, labels, cut, neighborhoods,
                                         static_cast<std::size_t>(fragments), intact, progress)) {}

InterfaceMeshes::~InterfaceMeshes() = default;

LabeledMesh InterfaceMeshes::meshOf(int label) const {
  return meshing_->meshOf(static_cast<std::size_t>(label) - 1);
}

}  // namespace sherd
