// The voxels of a mesh whose holes were closed.
#include "surface/exact/closed_solid.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "base/cancel_flag.h"
#include "cut/label_cells.h"
#include "voxelize/fill/winding.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/leaves/leaf_masks.h"

namespace sherd {
namespace {

using openvdb::Coord;

// The voxels inside a closed mesh that the solid does not have, and the leaves around these.
struct Added {
  std::vector<Coord> voxels;
  std::vector<Coord> origins;  // ascending
};

Added addedVoxels(const Solid& solid, const TriangleMesh& closed, const Progress* progress) {
  TriangleMesh inVoxels{closed.vertices, closed.triangles};
  for (glm::dvec3& v : inVoxels.vertices) v = solid.frame.indexFromWorld(v);
  const Winding winding(inVoxels, Winding::Rule::signedCrossings, progress);
  Added added;
  std::array<Coord, 8> around;
  around.fill(Coord::max());
  winding.forEachRun([&](int x, int y, int z, int end, int number) {
    for (; number > 0 && z < end; ++z) {
      const Coord at(x, y, z);
      const std::uint32_t leaf = findLeaf(*solid.blocks, at);
      if (leaf != LeafBlocks::kNone &&
          solid.blocks->isInside(std::size_t{leaf} * 512 + offsetFromCoord(at))) {
        continue;
      }
      added.voxels.push_back(at);
      for (int k = 0; k < 8; ++k) {
        const Coord beside =
            at + Coord(k & 1 ? kBandSteps : -kBandSteps, k & 2 ? kBandSteps : -kBandSteps,
                       k & 4 ? kBandSteps : -kBandSteps);
        Coord& last = around[static_cast<std::size_t>(k)];  // most are those of the voxel before
        if ((beside & ~7) != last) added.origins.push_back(beside & ~7);
        last = beside & ~7;
      }
    }
  });
  std::sort(added.origins.begin(), added.origins.end());
  added.origins.erase(std::unique(added.origins.begin(), added.origins.end()), added.origins.end());
  return added;
}

// Returns the blocks of a solid with more leaves, and moves its labels to them.
LeafBlocks withLeaves(const LeafBlocks& own, const std::vector<Coord>& origins, Labels& labels) {
  LeafBlocks out;
  std::set_union(own.origins.begin(), own.origins.end(), origins.begin(), origins.end(),
                 std::back_inserter(out.origins));
  out.neighbors = leafNeighborTable(out.origins);
  out.inside.assign(out.count() * 8, 0);
  out.exteriorBand.assign(out.count() * 8, 0);
  std::vector<std::uint16_t> fragment(out.count() * 512, 0);
  std::size_t to = 0;
  for (std::size_t from = 0; from < own.count(); ++from, ++to) {
    while (out.origins[to] != own.origins[from]) ++to;
    std::copy_n(&own.inside[from * 8], 8, &out.inside[to * 8]);
    std::copy_n(&own.exteriorBand[from * 8], 8, &out.exteriorBand[to * 8]);
    std::copy_n(&labels.fragment[from * 512], 512, &fragment[to * 512]);
  }
  labels.fragment = std::move(fragment);
  labels.cost.clear();
  return out;
}

// Labels voxels from what is beside them, step by step.
class LabelsAdded {
 public:
  LabelsAdded(const LeafBlocks& blocks, const std::vector<Coord>& added, Labels& labels)
      : blocks_(blocks), labels_(labels), open_(blocks.inside.size(), 0), done_(open_) {
    for (const Coord& at : added) {
      const std::size_t voxel = voxelIndexAt(blocks, at);
      set(labels.fragment[voxel] != 0 ? done_ : open_, voxel);
    }
  }

  // Takes the voxels that have been reached and that a label may have, and what they lead to.
  //   labelFor  (voxel): of its neighbors', or 0
  template <class LabelFor>
  void run(const std::vector<Coord>& added, const LabelFor& labelFor, const Progress* progress) {
    std::vector<std::size_t> next;  // may have a neighbor with a label
    for (const Coord& at : added) {
      const std::size_t voxel = voxelIndexAt(blocks_, at);
      if (has(open_, voxel)) next.push_back(voxel);
    }
    while (!next.empty()) {
      throwIfCancelled(progress);
      std::vector<std::pair<std::size_t, std::uint16_t>> found;
      for (const std::size_t voxel : next) {
        const std::uint16_t label = labelFor(voxel);
        if (label != 0) found.emplace_back(voxel, label);
      }
      take(found);
      next = beside(found);
    }
  }

  // The label of a voxel's first neighbor over a face that has one; or that label if any has it.
  [[nodiscard]] std::uint16_t labelBeside(std::size_t voxel, std::uint16_t only = 0) const {
    for (std::size_t side = 0; side < 6; ++side) {
      const std::size_t at = voxelBeside(blocks_, voxel, side);
      if (at == kNoVoxel || labels_.fragment[at] == 0) continue;
      if (only == 0 || labels_.fragment[at] == only) return labels_.fragment[at];
    }
    return 0;
  }

  // Of the labels of a voxel's neighbors over faces, the one that most of all 26 have: so fewer
  // fragments touch themselves.
  [[nodiscard]] std::uint16_t mostAround(std::size_t voxel) const {
    const std::uint16_t first = labelBeside(voxel);
    std::vector<std::uint16_t> beside;  // others
    for (std::size_t side = 0; side < 6; ++side) {
      const std::size_t at = voxelBeside(blocks_, voxel, side);
      const std::uint16_t label = at == kNoVoxel ? std::uint16_t{0} : labels_.fragment[at];
      if (label != 0 && label != first) beside.push_back(label);
    }
    if (beside.empty()) return first;
    beside.push_back(first);
    std::sort(beside.begin(), beside.end());
    std::vector<int> counts(beside.size(), 0);
    const Coord center = blocks_.voxelAt(voxel);
    for (int k = 0; k < 27; ++k) {
      const std::size_t at =
          voxelIndexAt(blocks_, center + Coord(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1));
      if (at == kNoVoxel) continue;
      for (std::size_t i = 0; i < beside.size(); ++i) {
        counts[i] += labels_.fragment[at] == beside[i] ? 1 : 0;
      }
    }
    const auto most = std::max_element(counts.begin(), counts.end()) - counts.begin();
    return beside[static_cast<std::size_t>(most)];
  }

  [[nodiscard]] const VoxelMask& done() const { return done_; }

 private:
  static bool has(const VoxelMask& mask, std::size_t voxel) {
    return (mask[voxel / 64] >> voxel % 64 & 1) != 0;
  }
  static void set(VoxelMask& mask, std::size_t voxel) {
    mask[voxel / 64] |= std::uint64_t{1} << voxel % 64;
  }

  void take(const std::vector<std::pair<std::size_t, std::uint16_t>>& found) {
    for (const auto& [voxel, label] : found) {
      labels_.fragment[voxel] = label;
      open_[voxel / 64] &= ~(std::uint64_t{1} << voxel % 64);
      set(done_, voxel);
    }
  }

  [[nodiscard]] std::vector<std::size_t> beside(
      const std::vector<std::pair<std::size_t, std::uint16_t>>& found) const {
    std::vector<std::size_t> next;
    for (const auto& [voxel, label] : found) {
      for (std::size_t side = 0; side < 6; ++side) {
        const std::size_t at = voxelBeside(blocks_, voxel, side);
        if (at != kNoVoxel && has(open_, at)) next.push_back(at);
      }
    }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    return next;
  }

  const LeafBlocks& blocks_;
  Labels& labels_;
  VoxelMask open_, done_;
};

// Labels voxels from what is beside them.  Returns those that are connected to labeled ones.
VoxelMask labelBySteps(const LeafBlocks& blocks, const std::vector<Coord>& added, Labels& labels,
                       const Progress* progress) {
  LabelsAdded all(blocks, added, labels);
  all.run(
      added, [&](std::size_t voxel) { return all.labelBeside(voxel); }, progress);
  return all.done();
}

// As above; first those in the cell of a fragment beside them, so that planes go on.
//   cells  [added] or empty
VoxelMask labelByCells(const LeafBlocks& blocks, const std::vector<Coord>& added,
                       const std::vector<std::uint16_t>& cells, Labels& labels,
                       const Progress* progress) {
  LabelsAdded all(blocks, added, labels);
  if (!cells.empty()) {
    std::vector<std::pair<std::size_t, std::uint16_t>> cellAt;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cellAt.emplace_back(voxelIndexAt(blocks, added[i]), cells[i]);
    }
    std::sort(cellAt.begin(), cellAt.end());
    const auto inItsCell = [&](std::size_t voxel) {
      const auto at = std::ranges::lower_bound(cellAt, std::pair{voxel, std::uint16_t{0}});
      return all.labelBeside(voxel, at->second);
    };
    all.run(added, inItsCell, progress);
  }
  all.run(
      added, [&](std::size_t voxel) { return all.mostAround(voxel); }, progress);
  return all.done();
}

}  // namespace

ClosedSolid closedSolid(const Solid& solid, const Labels& labels, const TriangleMesh& closed,
                        const Progress* progress, Extension extension) {
  ClosedSolid out{solid, labels};
  const Added added = addedVoxels(solid, closed, progress);
  const std::vector<std::uint16_t> cells = extension == Extension::cells
                                               ? cellsOf(labels, added.voxels, progress)
                                               : std::vector<std::uint16_t>{};
  LeafBlocks blocks = withLeaves(*solid.blocks, added.origins, out.labels);
  const VoxelMask more = extension == Extension::cells
                             ? labelByCells(blocks, added.voxels, cells, out.labels, progress)
                             : labelBySteps(blocks, added.voxels, out.labels, progress);
  const VoxelMask all(more.size(), ~std::uint64_t{0});
  const VoxelMask around = grownBySteps(blocks, more, all, kBandSteps);
  for (std::size_t word = 0; word < more.size(); ++word) {
    blocks.inside[word] |= more[word];
    blocks.exteriorBand[word] = (blocks.exteriorBand[word] | around[word]) & ~blocks.inside[word];
  }
  out.solid.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  out.labels.blocks = out.solid.blocks;
  return out;
}

}  // namespace sherd
