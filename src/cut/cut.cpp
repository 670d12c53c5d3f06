// Smooths labels into a cut.
#include "cut/cut.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "base/cancel_flag.h"
#include "cut/leaf_labels.h"
#include "cut/site_cut.h"
#include "cut/split_cut.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

constexpr std::size_t kHalo = kCutHalo;  // two binomial passes reach two voxels
constexpr std::size_t kSide = kCutSide;
constexpr std::uint32_t kMixed = 0x10000;  // above all labels, Labels::kEroded included

using LeafWeights = std::array<std::uint16_t, 512>;

// The normal quantile of (1 + d) / 2 for d in 0..1, in 1/1024 steps: voxels to the cut by the
// difference d of smoothed indicators.
class Profile {
 public:
  Profile() {
    for (int i = 0; i < kSteps; ++i) {
      double low = 0.0, high = 4.0;
      for (int k = 0; k < 50; ++k) {
        const double x = (low + high) / 2;
        (std::erf(x / std::sqrt(2.0)) < static_cast<double>(i) / kSteps ? low : high) = x;
      }
      table_[static_cast<std::size_t>(i)] = static_cast<float>(low);
    }
    table_[kSteps] = 3.0f;
  }

  // Odd in `difference`, so that the two sides of a cut agree to the bit.
  float distance(int difference, int sum) const {
    if (sum == 0) return 3.0f;
    const float at = static_cast<float>(std::abs(difference)) / static_cast<float>(sum) * kSteps;
    const auto i = std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(kSteps - 1));
    const float x =
        std::min(table_[i] + (table_[i + 1] - table_[i]) * (at - static_cast<float>(i)), 3.0f);
    return difference < 0 ? -x : x;
  }

 private:
  static constexpr int kSteps = 1024;
  std::array<float, kSteps + 1> table_{};
};

// [leaf] the only label of a leaf's voxels, 0 if none, kMixed if several.
std::vector<std::uint32_t> leafLabels(const Labels& labels) {
  const LeafBlocks& blocks = *labels.blocks;
  std::vector<std::uint32_t> only(blocks.count());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, only.size(), 64), [&](const auto& range) {
    for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      const LabelRange found = rangeOf(std::span(&labels.fragment[leaf * 512], 512));
      only[leaf] = found.isSeveral() ? kMixed : found.high;
    }
  });
  return only;
}

std::uint32_t onlyOf(std::uint32_t a, std::uint32_t b) {
  if (a == 0 || b == 0) return a | b;
  return a == b ? a : kMixed;
}

// [6] the only label of each outermost layer of a leaf, 0 if none, kMixed if several.
std::array<std::uint32_t, 6> layersOf(const Labels& labels, std::size_t leaf) {
  const std::uint16_t* const own = &labels.fragment[leaf * 512];
  std::array<std::uint32_t, 6> layers{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t across = std::array<std::size_t, 3>{64, 8, 1}[axis],
                      rows = std::array<std::size_t, 3>{8, 64, 64}[axis],
                      along = std::array<std::size_t, 3>{1, 1, 8}[axis];
    for (std::size_t high = 0; high < 2; ++high) {
      std::array<std::uint16_t, 64> layer;
      for (std::size_t i = 0; i < 64; ++i)
        layer[i] = own[high * 7 * across + i / 8 * rows + i % 8 * along];
      const LabelRange found = rangeOf(layer);
      layers[2 * axis + high] = found.isSeveral() ? kMixed : found.high;
    }
  }
  return layers;
}

// [leaf] layersOf the leaves with several labels.
std::vector<std::array<std::uint32_t, 6>> mixedLayers(const Labels& labels,
                                                      std::span<const std::uint32_t> leafLabel) {
  std::vector<std::array<std::uint32_t, 6>> layers(leafLabel.size());
  tbb::parallel_for(std::size_t{0}, layers.size(), [&](std::size_t leaf) {
    if (leafLabel[leaf] == kMixed) layers[leaf] = layersOf(labels, leaf);
  });
  return layers;
}

// The only label of a leaf and the layer around it, 0 if none, kMixed if there may be several: of
// a leaf that it meets at an edge or a corner, a whole layer is taken.
std::uint32_t onlyWithinOne(const LeafNeighbors& neighborhood,
                            std::span<const std::uint32_t> leafLabel,
                            std::span<const std::array<std::uint32_t, 6>> layers) {
  std::uint32_t only = 0;
  for (std::size_t k = 0; k < neighborhood.size() && only != kMixed; ++k) {
    const std::uint32_t other = neighborhood[k];
    if (other == LeafBlocks::kNone) continue;
    std::uint32_t label = leafLabel[other];
    const std::array<std::size_t, 3> step{k / 9, k / 3 % 3, k % 3};  // 1: none
    for (std::size_t axis = 0; axis < 3 && label == kMixed; ++axis) {
      if (step[axis] != 1) label = layers[other][2 * axis + (step[axis] == 0 ? 1 : 0)];
    }
    only = onlyOf(only, label);
  }
  return only;
}

// The labels other than 0 in a halo, ascending.
std::vector<std::uint16_t> fragmentsIn(const CutHalo& halo) {
  // Most halos have at most one label, which this branch-free test finds.
  const LabelRange range = rangeOf(halo);
  if (range.isOne()) return {range.high};
  std::vector<std::uint16_t> fragments;
  std::uint16_t last = 0;
  for (std::size_t row = 0; row < halo.size(); row += kSide) {
    if (std::all_of(&halo[row], &halo[row] + kSide, [&](auto l) { return l == last; })) continue;
    for (std::size_t i = row; i < row + kSide; ++i) {
      const std::uint16_t label = halo[i];
      if (label == last || label == 0) continue;
      last = label;
      const auto at = std::lower_bound(fragments.begin(), fragments.end(), label);
      if (at == fragments.end() || *at != label) fragments.insert(at, label);
    }
  }
  return fragments;
}

// The smoothed indicator of `label`, 0..4096.  The filter is separable: one axis at a time.
LeafWeights smoothed(const CutHalo& halo, std::uint16_t label) {
  std::array<std::uint16_t, kSide * kSide * 8> alongZ;
  std::array<std::uint16_t, kSide * 8 * 8> alongY;
  LeafWeights weights;
  const auto tap = [](const auto* p, std::size_t stride) {
    return static_cast<std::uint16_t>(p[0] + 4 * p[stride] + 6 * p[2 * stride] + 4 * p[3 * stride] +
                                      p[4 * stride]);
  };
  for (std::size_t xy = 0; xy < kSide * kSide; ++xy) {
    std::array<std::uint16_t, kSide> row;
    for (std::size_t z = 0; z < kSide; ++z) row[z] = halo[xy * kSide + z] == label;
    for (std::size_t z = 0; z < 8; ++z) alongZ[xy * 8 + z] = tap(&row[z], 1);
  }
  for (std::size_t x = 0; x < kSide; ++x) {
    for (std::size_t yz = 0; yz < 64; ++yz)
      alongY[x * 64 + yz] = tap(&alongZ[x * kSide * 8 + yz], 8);
  }
  for (std::size_t v = 0; v < 512; ++v) weights[v] = tap(&alongY[v], 64);
  return weights;
}

// The corners of the cells that have a corner in a leaf.
constexpr std::size_t kCornerSide = 10;
using CornerLabels = LabelCube<kCornerSide>;

// The voxels of a leaf that are corners of a cell with several labels other than 0.
VoxelBits cutCorners(const CornerLabels& insideLabels) {
  const PassedCells<kCornerSide> passed = passedCells<kCornerSide>(insideLabels);
  // A voxel is a corner of its own cell and of the cells one below it along each axis.
  constexpr std::size_t kCells = 9;
  VoxelBits corners{};
  for (std::size_t x = 0; x < kCells; ++x) {
    for (std::size_t y = 0; y < kCells; ++y) {
      const unsigned cells = passed.cut[x * kCornerSide + y] & 0x1ffu;
      if (cells == 0) continue;
      const auto bits = static_cast<std::uint8_t>(cells | cells >> 1);
      for (std::size_t i = x == 0 ? 0 : x - 1; i <= std::min(x, std::size_t{7}); ++i) {
        for (std::size_t j = y == 0 ? 0 : y - 1; j <= std::min(y, std::size_t{7}); ++j) {
          corners[i * 8 + j] |= bits;
        }
      }
    }
  }
  return corners;
}

template <class Visit>
void forEachBit(const VoxelBits& voxels, const Visit& visit) {
  for (std::size_t row = 0; row < voxels.size(); ++row) {
    for (unsigned bits = voxels[row]; bits != 0; bits &= bits - 1) {
      visit(row * 8 + static_cast<std::size_t>(std::countr_zero(bits)));
    }
  }
}

bool hasBits(const VoxelBits& voxels) {
  return std::any_of(voxels.begin(), voxels.end(), [](std::uint8_t row) { return row != 0; });
}

// See Cut::snapWeight: two binomial passes would leave little of a fragment a few voxels wide.
float snapWeight(std::uint64_t voxels) {
  constexpr float kAll = 64.0f, kNone = 216.0f;  // cubes of 4 and 6 voxels
  return std::clamp((kNone - static_cast<float>(voxels)) / (kNone - kAll), 0.0f, 1.0f);
}

// [65536] by label.
std::vector<float> snapWeights(const std::vector<std::uint64_t>& voxels) {
  std::vector<float> weights(std::size_t{Labels::kEroded} + 1);
  for (std::size_t id = 1; id < voxels.size(); ++id) weights[id] = snapWeight(voxels[id]);
  return weights;
}

// Distances to the surface of equal smoothed indicators, at the requested voxels.
void smoothCut(const CutHalo& halo, std::span<const std::uint16_t> fragments,
               const VoxelBits& requested, std::vector<float>& distance) {
  static const Profile profile;
  std::vector<LeafWeights> weights;
  for (const std::uint16_t fragment : fragments) weights.push_back(smoothed(halo, fragment));
  forEachBit(requested, [&](std::size_t v) {
    int first = 0, second = 0, sum = 0;  // the two largest weights
    std::size_t largest = 0;             // index of the fragment with the largest
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const int w = weights[i][v];
      sum += w;
      if (w > first) {
        second = std::exchange(first, w);
        largest = i;
      } else if (w > second) {
        second = w;
      }
    }
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      const int own = weights[i][v];
      distance[i * 512 + v] =
          profile.distance((i == largest && own > 0 ? second : first) - own, sum);
    }
  });
}

// The indices of the fragments with the least and the second least distance.
std::array<std::size_t, 2> leastTwo(const std::vector<float>& distance, std::size_t v) {
  std::array<std::size_t, 2> least{0, 0};
  for (std::size_t i = 1; i * 512 < distance.size(); ++i) {
    const float d = distance[i * 512 + v];
    if (d < distance[least[0] * 512 + v]) {
      least = {i, least[0]};
    } else if (least[1] == least[0] || d < distance[least[1] * 512 + v]) {
      least[1] = i;
    }
  }
  return least;
}

// The inputs of cutLeaf that all leaves share.
struct CutSource {
  const LeafBlocks& blocks;
  const Labels& labels;
  const Sites& sites;
  const SplitTree& splits;
  std::span<const float> snapWeight;  // by label
};

//   corners  of CutExtent::cells, else null
//   extent   of the whole cut
CutLeaf cutLeaf(const CutSource& from, std::size_t leaf, const LeafNeighbors& neighborhood,
                const CutHalo& halo, const CornerLabels* corners, CutExtent extent,
                std::vector<std::uint16_t> fragments) {
  CutLeaf cut;
  cut.fragments = std::move(fragments);
  const std::size_t count = cut.fragments.size();
  VoxelBits requested;
  requested.fill(0xff);
  if (corners != nullptr) requested = cutCorners(*corners);
  if (extent == CutExtent::none || !hasBits(requested)) return cut;

  VoxelBits rest = requested;
  if (from.sites.empty() && from.splits.empty()) {
    cut.distance.resize(count * 512);
  } else {
    const CutHalo insideLabels =
        labelsAround<kHalo, kHalo>(from.blocks, from.labels, neighborhood, Voxels::inside);
    const openvdb::Coord& origin = from.blocks.origins[leaf];
    SiteCut planes = from.splits.empty()
                         ? siteCut(insideLabels, origin, cut.fragments, from.sites, requested)
                         : splitCut(insideLabels, origin, cut.fragments, from.splits, requested);
    cut.distance = std::move(planes.distance);
    for (std::size_t row = 0; row < rest.size(); ++row) rest[row] ^= planes.holds[row];
  }
  if (hasBits(rest)) smoothCut(halo, cut.fragments, rest, cut.distance);
  const std::uint16_t* const owner = &from.labels.fragment[leaf * 512];
  forEachBit(requested, [&](std::size_t v) {
    const bool isInside = from.blocks.isInside(leaf * 512 + v);
    const auto [largest, next] = leastTwo(cut.distance, v);
    for (std::size_t i = 0; i < count; ++i) {
      float& d = cut.distance[i * 512 + v];
      const std::size_t rival = i == largest ? next : largest;
      const float snap =
          std::max(from.snapWeight[cut.fragments[i]], from.snapWeight[cut.fragments[rival]]);
      if (snap > 0.0f && owner[v] != 0) {
        d = (1.0f - snap) * d + snap * (owner[v] == cut.fragments[i] ? -0.5f : 0.5f);
      }
      const bool isOnPlane = ((rest[v / 8] >> (v % 8)) & 1) == 0;
      if (isInside && !(isOnPlane && extent == CutExtent::exact)) {
        d = owner[v] == cut.fragments[i] ? std::min(d, -Cut::kLeastDepth)
                                         : std::max(d, Cut::kLeastDepth);
      }
    }
  });
  return cut;
}

}  // namespace

Cut findCut(const Labels& labels, std::span<const LeafNeighbors> neighborhoods, CutExtent extent,
            const Progress* progress) {
  const LeafBlocks& blocks = *labels.blocks;
  const std::vector<std::uint32_t> leafLabel = leafLabels(labels);
  std::vector<std::array<std::uint32_t, 6>> layers;
  if (extent == CutExtent::cells) layers = mixedLayers(labels, leafLabel);
  const Sites sites(labels.sites, labels.walls);
  const SplitTree splits(labels.splits, labels.cracks, labels.walls);
  std::vector<CutLeaf> perLeaf(blocks.count());
  Cut cut;
  cut.snapWeight = snapWeights(countVoxels(labels));
  cut.only.resize(blocks.count());
  CancelFlag stop(progress);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.count(), 16), [&](const auto& range) {
    if (stop.isSet()) return;
    for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      const LeafNeighbors& neighborhood = neighborhoods[leaf];
      std::uint32_t only = 0;
      for (const std::uint32_t other : neighborhood) {
        if (other == LeafBlocks::kNone) continue;
        only = onlyOf(only, leafLabel[other]);
      }
      if (only != kMixed) {
        cut.only[leaf] = static_cast<std::uint16_t>(only);
        continue;
      }
      std::optional<CornerLabels> corners;
      if (extent == CutExtent::cells) {
        const std::uint32_t near = onlyWithinOne(neighborhood, leafLabel, layers);
        if (near != kMixed) {
          cut.only[leaf] = static_cast<std::uint16_t>(near);
          continue;
        }
        corners = labelsAround<1, 1>(blocks, labels, neighborhood, Voxels::inside);
        const LabelRange found = rangeOf(*corners);
        if (!found.isSeveral()) {
          cut.only[leaf] = found.high;
          continue;
        }
      }
      const CutHalo halo = labelsAround<kHalo, kHalo>(blocks, labels, neighborhood, Voxels::all);
      std::vector<std::uint16_t> fragments = fragmentsIn(halo);
      if (fragments.size() == 1) {
        cut.only[leaf] = fragments.front();
      } else if (fragments.size() > 1) {
        perLeaf[leaf] = cutLeaf({blocks, labels, sites, splits, cut.snapWeight}, leaf, neighborhood,
                                halo, corners ? &*corners : nullptr, extent, std::move(fragments));
      }
    }
  });
  stop.throwIfSet();
  cut.index.assign(blocks.count(), Cut::kWhole);
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    if (perLeaf[leaf].fragments.empty()) continue;
    cut.index[leaf] = static_cast<std::uint32_t>(cut.leaves.size());
    cut.leaves.push_back(std::move(perLeaf[leaf]));
  }
  return cut;
}

}  // namespace sherd
