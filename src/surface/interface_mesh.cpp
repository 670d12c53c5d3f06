// Dual meshing of many labels.
//
// Leaves within which nothing but one label lies are as they are in the unbroken solid: where that
// was meshed before, their cells and triangles are taken over.
#include "surface/interface_mesh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <optional>

#include "base/cancel_flag.h"
#include "surface/leaf_cells.h"
#include "surface/rims.h"
#include "surface/touching.h"
#include "surface/unbroken.h"

namespace sherd {
namespace {

template <class Work>
void forEach(std::size_t begin, std::size_t end, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) work(i);
  });
}

bool hasMesh(std::uint16_t label) { return label != 0 && label != Labels::kWorn; }

}  // namespace

/// The mesh of all labels, leaf by leaf.
class InterfaceMeshes::Meshing {
 public:
  Meshing(const Solid& solid, const Labels& labels, const Cut& cut,
          std::span<const LeafRound> rounds, std::size_t fragments, const UnbrokenSurface* unbroken,
          const Progress* progress)
      : cut_(cut),
        unbroken_(unbroken),
        rounds_(rounds),
        field_(solid, labels, cut, rounds),
        count_(solid.blocks.count()),
        quads_(count_) {
    if (unbroken_ != nullptr) {
      old_.resize(count_);
      forEach(0, count_, [&](std::size_t leaf) { old_[leaf] = oldLabel(leaf); });
    }
    meshLeaves(solid.blocks.origins, progress);
    straightenRims(quads_, junctions_, vertices_.at);
    throwIfCancelled(progress);
    gaps_ = partTouchingSheets(crowded_, quads_, vertices_);
    forEach(0, vertices_.at.size(), [&](std::size_t v) {
      vertices_.at[v] = solid.frame.worldFromIndex({vertices_.at[v]}).v;
    });
    throwIfCancelled(progress);
    numberVertices(fragments);
    // Each label's in the order that they had.
    forEach(0, count_, [&](std::size_t leaf) {
      std::stable_sort(quads_[leaf].begin(), quads_[leaf].end(), hasLowerLabel);
    });
    sortFaces(fragments);
  }

  LabelledMesh meshOf(std::size_t i) const {
    const std::size_t label = i + 1;
    LabelledMesh out;
    out.mesh.vertices.reserve(verticesOf_[label].size());
    out.place.reserve(verticesOf_[label].size());
    for (const std::uint32_t v : verticesOf_[label]) {
      out.mesh.vertices.push_back(vertices_.at[v]);
      out.place.push_back(vertices_.place[v]);
    }
    const auto forEachQuad = [&](std::uint32_t leaf, const auto& visit) {
      const auto own = std::equal_range(quads_[leaf].begin(), quads_[leaf].end(),
                                        InterfaceQuad{.label = static_cast<std::uint16_t>(label)},
                                        hasLowerLabel);
      for (auto quad = own.first; quad != own.second; ++quad) visit(*quad);
    };
    std::size_t triangles = gapsOf_[i].size();
    for (const std::uint32_t leaf : leavesOf_[i]) {
      if (hasOldTriangles(leaf)) triangles += unbroken_->leaves[leaf].triangles.size();
      forEachQuad(leaf, [&](const InterfaceQuad&) { triangles += 2; });
    }
    out.mesh.triangles.reserve(triangles);
    out.other.reserve(triangles);
    const auto add = [&](const std::array<std::uint32_t, 3>& t, std::uint16_t other) {
      out.mesh.triangles.emplace_back(number_[t[0]], number_[t[1]], number_[t[2]]);
      out.other.push_back(other);
    };
    for (const std::uint32_t leaf : leavesOf_[i]) {
      if (hasOldTriangles(leaf)) addOld(leaf, out);
      forEachQuad(leaf, [&](const InterfaceQuad& quad) {
        for (const auto& t : trianglesOf(quad, vertices_.at)) add(t, quad.other);
      });
    }
    for (const InterfaceTriangle* gap : gapsOf_[i]) add(gap->vertex, gap->other);
    return out;
  }

 private:
  // The only label of a leaf whose cells are as in the unbroken solid, 0 where it has none; else
  // kNew.
  std::uint32_t oldLabel(std::size_t leaf) const {
    if (!unbroken_->leaves[leaf].cells.isPlain) return kNew;
    if (cut_.index[leaf] == Cut::kWhole) return cut_.only[leaf];
    const std::optional<std::uint16_t> only = onlyLabelOf(field_, leaf);
    return only ? *only : kNew;
  }

  bool isOld(std::size_t leaf) const { return unbroken_ != nullptr && old_[leaf] != kNew; }

  // Are the leaf's triangles as they were?  Those of a leaf beside a crack hold on to vertices that
  // may be new.
  bool hasOldTriangles(std::size_t leaf) const {
    if (!isOld(leaf) || !unbroken_->leaves[leaf].isWhole) return false;
    const LeafRound& round = rounds_[leaf];
    for (const std::size_t k : kBelow) {
      if (round[k] != LeafBlocks::kNone && old_[round[k]] == kNew) return false;
    }
    return true;
  }

  // Cells, vertices and quads, some slabs of leaves at a time: a leaf's quads look at cells of its
  // own and of leaves below it, so cells go when the next slab has its quads.  All of them would
  // take more memory than all that is made of them.
  void meshLeaves(std::span<const openvdb::Coord> origins, const Progress* progress) {
    constexpr std::size_t kTogether = 16384;  // leaves, to keep all threads busy
    fresh_.resize(count_);
    cells_.leaves.resize(count_);
    const auto nextSlab = [&](std::size_t leaf) {
      const int x = origins[leaf].x();
      while (leaf < count_ && origins[leaf].x() == x) ++leaf;
      return leaf;
    };
    std::size_t kept = 0;
    for (std::size_t first = 0, end = 0; first < count_; first = end) {
      std::size_t last = first;  // slab
      while (end < count_ && end - first < kTogether) {
        last = end;
        end = nextSlab(end);
      }
      throwIfCancelled(progress);
      forEach(first, end, [&](std::size_t leaf) { makeCells(leaf); });
      takeTogether(first, end);
      throwIfCancelled(progress);
      forEach(first, end, [&](std::size_t leaf) {
        if (!hasOldTriangles(leaf)) quads_[leaf] = quadsOf(field_, cells_, leaf);
      });
      forEach(kept, last, [&](std::size_t leaf) { fresh_[leaf].reset(); });
      kept = last;
    }
    fresh_ = std::vector<std::unique_ptr<LeafCells>>();
  }

  void makeCells(std::size_t leaf) {
    const LeafCells* const before = unbroken_ ? &unbroken_->leaves[leaf].cells : nullptr;
    if (isOld(leaf)) {
      cells_.leaves[leaf] = before;
      return;
    }
    fresh_[leaf] = std::make_unique<LeafCells>(cellsOf(field_, leaf, before));
    cells_.leaves[leaf] = fresh_[leaf].get();
  }

  void takeTogether(std::size_t first, std::size_t end) {
    for (std::size_t leaf = first; leaf < end; ++leaf) {
      const LeafCells& own = *cells_.leaves[leaf];
      const auto firstVertex = static_cast<std::uint32_t>(vertices_.at.size());
      cells_.firstVertex.push_back(firstVertex);
      for (const std::uint32_t p : own.places) vertices_.place.push_back(vertices_.places + p);
      for (const std::uint32_t p : own.crowded) crowded_.push_back(vertices_.places + p);
      vertices_.places += own.placeCount;
      vertices_.at.insert(vertices_.at.end(), own.vertices.begin(), own.vertices.end());
      for (Junction junction : own.junctions) {
        for (std::uint32_t& v : junction.vertices) v += firstVertex;
        junctions_.push_back(std::move(junction));
      }
    }
  }

  // A vertex belongs to one label; each label numbers its own in order.  Parting sheets makes new
  // vertices and leaves others without a face.
  void numberVertices(std::size_t fragments) {
    label_.assign(vertices_.at.size(), 0);
    for (std::size_t leaf = 0; leaf < count_; ++leaf) {
      if (isOld(leaf)) {
        const auto first = label_.begin() + cells_.firstVertex[leaf];
        std::fill_n(first, cells_.leaves[leaf]->vertices.size(),
                    static_cast<std::uint16_t>(old_[leaf]));
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

  // [fragments] the leaves in which each label has faces, ascending.
  void sortFaces(std::size_t fragments) {
    leavesOf_.resize(fragments);
    const auto add = [&](std::uint16_t label, std::uint32_t leaf) {
      if (!hasMesh(label)) return;
      std::vector<std::uint32_t>& own = leavesOf_[label - 1u];
      if (own.empty() || own.back() != leaf) own.push_back(leaf);
    };
    for (std::uint32_t leaf = 0; leaf < count_; ++leaf) {
      if (hasOldTriangles(leaf)) {
        add(static_cast<std::uint16_t>(old_[leaf]), leaf);
      } else {
        for (const InterfaceQuad& quad : quads_[leaf]) add(quad.label, leaf);
      }
    }
    gapsOf_.resize(fragments);
    for (const InterfaceTriangle& gap : gaps_) gapsOf_[gap.label - 1u].push_back(&gap);
  }

  void addOld(std::uint32_t leaf, LabelledMesh& out) const {
    // The vertices of an old leaf are numbered one after another.
    std::array<std::uint32_t, 8> first{};
    for (std::size_t slot = 0; slot < 8; ++slot) {
      const std::uint32_t other = rounds_[leaf][kBelow[slot]];
      if (other == LeafBlocks::kNone || cells_.leaves[other]->vertices.empty()) continue;
      first[slot] = number_[cells_.firstVertex[other]];
    }
    constexpr unsigned kBits = UnbrokenLeaf::kSlotBits;
    constexpr std::uint32_t kLocal = (std::uint32_t{1} << kBits) - 1;
    const auto number = [&](UnbrokenLeaf::Corner corner) {
      return first[corner >> kBits] + (corner & kLocal);
    };
    const auto& triangles = unbroken_->leaves[leaf].triangles;
    for (const auto& t : triangles) {
      out.mesh.triangles.emplace_back(number(t[0]), number(t[1]), number(t[2]));
    }
    out.other.insert(out.other.end(), triangles.size(), 0);
  }

  static bool hasLowerLabel(const InterfaceQuad& a, const InterfaceQuad& b) {
    return a.label < b.label;
  }

  static constexpr std::uint32_t kNew = 0xffffffffu;

  // The places in a LeafRound of slots 0..7.
  static constexpr std::array<std::size_t, 8> kBelow{13, 12, 10, 9, 4, 3, 1, 0};

  const Cut& cut_;
  const UnbrokenSurface* unbroken_;
  const std::span<const LeafRound> rounds_;
  const Field field_;
  const std::size_t count_;
  std::vector<std::uint32_t> old_;  // [leaf] oldLabel; empty without an unbroken surface
  std::vector<std::unique_ptr<LeafCells>> fresh_;  // [leaf] null where old, or gone
  AllCells cells_;
  InterfaceVertices vertices_;
  std::vector<std::uint32_t> crowded_;
  std::vector<Junction> junctions_;
  std::vector<std::vector<InterfaceQuad>> quads_;  // [leaf] by label in the end
  std::vector<InterfaceTriangle> gaps_;
  std::vector<std::uint16_t> label_;                    // [vertices]
  std::vector<std::uint32_t> number_;                   // [vertices] in its label's mesh
  std::vector<std::vector<std::uint32_t>> verticesOf_;  // [labels + 1] ascending
  std::vector<std::vector<std::uint32_t>> leavesOf_;    // [labels]
  std::vector<std::vector<const InterfaceTriangle*>> gapsOf_;
};

InterfaceMeshes::InterfaceMeshes(const Solid& solid, const Labels& labels, const Cut& cut,
                                 std::span<const LeafRound> rounds, int fragments,
                                 const UnbrokenSurface* unbroken, const Progress* progress)
    : meshing_(std::make_unique<Meshing>(
          solid, labels, cut, rounds, static_cast<std::size_t>(fragments), unbroken, progress)) {}

InterfaceMeshes::~InterfaceMeshes() = default;

LabelledMesh InterfaceMeshes::meshOf(int label) const {
  return meshing_->meshOf(static_cast<std::size_t>(label) - 1);
}

}  // namespace sherd
