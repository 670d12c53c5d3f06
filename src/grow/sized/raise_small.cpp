// Fragments that are too small to be pieces.
#include "grow/sized/raise_small.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <tuple>
#include <utility>
#include <vector>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

const std::array<openvdb::Coord, 6> kBeside{openvdb::Coord(-1, 0, 0), openvdb::Coord(1, 0, 0),
                                            openvdb::Coord(0, -1, 0), openvdb::Coord(0, 1, 0),
                                            openvdb::Coord(0, 0, -1), openvdb::Coord(0, 0, 1)};

class Raising {
 public:
  Raising(Labels& labels, std::uint64_t least)
      : labels_(labels), blocks_(*labels.blocks), least_(least), counts_(countVoxels(labels)) {}

  // See raiseSmallFragments.
  std::vector<std::pair<std::uint16_t, std::size_t>> run() {
    if (*std::min_element(counts_.begin() + 1, counts_.end()) >= least_) return {};
    std::vector<std::vector<std::size_t>> voxels(counts_.size());
    blocks_.forEachInside([&](std::size_t voxel) {
      const std::uint16_t label = labels_.fragment[voxel];
      if (label == 0 || label == Labels::kEroded || counts_[label] >= least_) return;
      voxels[label].push_back(voxel);
    });
    std::vector<std::pair<std::uint16_t, std::size_t>> changed;
    for (std::size_t i = 1; i < voxels.size(); ++i) {
      if (voxels[i].empty()) continue;
      const auto id = static_cast<std::uint16_t>(i);
      const std::size_t place = moved(id, voxels[i]);
      if (raise(id, voxels[i]) || place != kNoVoxel) changed.push_back({id, place});
    }
    return changed;
  }

 private:
  // The label of an inside voxel of a layer, else 0.
  [[nodiscard]] std::uint16_t labelAt(const openvdb::Coord& at, std::size_t layer) const {
    const std::size_t voxel = voxelIndexAt(blocks_, at);
    if (voxel == kNoVoxel || !blocks_.isInside(voxel) || blocks_.layerOf(voxel) != layer) return 0;
    return labels_.fragment[voxel];
  }

  // Whether the voxels of a fragment beside one of its own are connected without it, by those that
  // share an edge with it.  So they are if the fragment is, but other ways round it are not known.
  [[nodiscard]] bool isRemovable(const openvdb::Coord& at, std::uint16_t label,
                                 std::size_t layer) const {
    const auto cellOf = [](const openvdb::Coord& d) {
      return static_cast<std::size_t>((d.x() + 1) * 9 + (d.y() + 1) * 3 + d.z() + 1);
    };
    std::array<bool, 27> isOpen{};
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          const int steps = x * x + y * y + z * z;
          if (steps == 0 || steps == 3) continue;
          const openvdb::Coord d(x, y, z);
          isOpen[cellOf(d)] = labelAt(at + d, layer) == label;
        }
      }
    }
    std::vector<openvdb::Coord> reached;
    const auto visit = [&](const openvdb::Coord& d) {
      if (std::max({std::abs(d.x()), std::abs(d.y()), std::abs(d.z())}) > 1) return;
      if (!isOpen[cellOf(d)]) return;
      isOpen[cellOf(d)] = false;
      reached.push_back(d);
    };
    for (const openvdb::Coord& d : kBeside) {
      if (reached.empty()) visit(d);
    }
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (const openvdb::Coord& d : kBeside) visit(reached[i] + d);
    }
    const bool isAnyLeft = std::any_of(kBeside.begin(), kBeside.end(),
                                       [&](const openvdb::Coord& d) { return isOpen[cellOf(d)]; });
    return !reached.empty() && !isAnyLeft;
  }

  [[nodiscard]] bool canGive(const openvdb::Coord& at, std::uint16_t to, std::size_t layer) const {
    const std::uint16_t label = labelAt(at, layer);
    if (label == 0 || label == Labels::kEroded || label == to) return false;
    return counts_[label] > least_ && isRemovable(at, label, layer);
  }

  // Returns the voxel beside the fragment's own that is nearest to a place, of equally near ones
  // the first, or kNoVoxel.
  [[nodiscard]] std::size_t nearestGift(const std::vector<std::size_t>& own, std::uint16_t id,
                                        std::size_t layer, const glm::dvec3& middle) const {
    std::tuple<double, std::size_t> best{0.0, kNoVoxel};
    for (const std::size_t voxel : own) {
      const openvdb::Coord at = blocks_.voxelAt(voxel);
      for (const openvdb::Coord& d : kBeside) {
        const openvdb::Coord beside = at + d;
        const glm::dvec3 from = glm::dvec3(beside.x(), beside.y(), beside.z()) - middle;
        const std::tuple<double, std::size_t> found{glm::dot(from, from),
                                                    voxelIndexAt(blocks_, beside)};
        if (std::get<1>(best) != kNoVoxel && found >= best) continue;
        if (canGive(beside, id, layer)) best = found;
      }
    }
    return std::get<1>(best);
  }

  // The fragment that encloses one, or 0.
  [[nodiscard]] std::uint16_t encloserOf(const std::vector<std::size_t>& own, std::uint16_t id,
                                         std::size_t layer) const {
    std::uint16_t other = 0;
    for (const std::size_t voxel : own) {
      const openvdb::Coord at = blocks_.voxelAt(voxel);
      for (const openvdb::Coord& d : kBeside) {
        const std::uint16_t label = labelAt(at + d, layer);
        if (label == id) continue;
        if (label == 0 || label == Labels::kEroded || (other != 0 && label != other)) return 0;
        other = label;
      }
    }
    return other;
  }

  // Moves a fragment out of one that encloses it.  Returns its new voxel, or kNoVoxel.
  std::size_t moved(std::uint16_t id, std::vector<std::size_t>& own) {
    const std::size_t layer = blocks_.layerOf(own.front());
    const std::uint16_t around = encloserOf(own, id, layer);
    if (around == 0) return kNoVoxel;
    const openvdb::Coord from = blocks_.voxelAt(own.front());
    std::tuple<double, std::size_t> best{0.0, kNoVoxel};
    blocks_.forEachInside([&](std::size_t voxel) {
      if (labels_.fragment[voxel] != around || blocks_.layerOf(voxel) != layer) return;
      const openvdb::Coord at = blocks_.voxelAt(voxel);
      const openvdb::Coord to = at - from;
      const glm::dvec3 apart(to.x(), to.y(), to.z());
      const std::tuple<double, std::size_t> found{glm::dot(apart, apart), voxel};
      if (std::get<1>(best) != kNoVoxel && found >= best) return;
      const bool isAtBorder =
          std::any_of(kBeside.begin(), kBeside.end(), [&](const openvdb::Coord& d) {
            const std::uint16_t label = labelAt(at + d, layer);
            return label != around && label != id;
          });
      if (isAtBorder && isRemovable(at, around, layer)) best = found;
    });
    const std::size_t place = std::get<1>(best);
    if (place == kNoVoxel) return kNoVoxel;
    for (const std::size_t voxel : own) labels_.fragment[voxel] = around;
    labels_.fragment[place] = id;
    counts_[around] += own.size() - 1;
    own = {place};
    return place;
  }

  bool raise(std::uint16_t id, std::vector<std::size_t> own) {
    const std::size_t layer = blocks_.layerOf(own.front());
    glm::dvec3 middle(0.0);
    for (const std::size_t voxel : own) {
      const openvdb::Coord at = blocks_.voxelAt(voxel);
      middle += glm::dvec3(at.x(), at.y(), at.z()) / static_cast<double>(own.size());
    }
    const std::size_t before = own.size();
    while (own.size() < least_) {
      const std::size_t gift = nearestGift(own, id, layer, middle);
      if (gift == kNoVoxel) break;
      --counts_[labels_.fragment[gift]];
      labels_.fragment[gift] = id;
      own.push_back(gift);
    }
    counts_[id] = own.size();
    return own.size() > before;
  }

  Labels& labels_;
  const LeafBlocks& blocks_;
  const std::uint64_t least_;
  std::vector<std::uint64_t> counts_;
};

}  // namespace

std::uint64_t leastVoxelsOf(std::uint64_t voxels, std::size_t fragments) {
  const std::uint64_t quarter = voxels / (4 * std::max<std::uint64_t>(fragments, 1));
  return std::clamp<std::uint64_t>(quarter, 1, kSmallComponentVoxels);
}

std::vector<std::pair<std::uint16_t, std::size_t>> raiseSmallFragments(Labels& labels,
                                                                       std::uint64_t least) {
  if (labels.fragmentCount < 2) return {};
  return Raising(labels, least).run();
}

}  // namespace sherd
