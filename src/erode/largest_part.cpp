// The largest connected part of one fragment.
#include "erode/largest_part.h"

#include <bit>
#include <utility>

namespace sherd {
namespace {

// Takes parts out of a fragment's masks, one after the other.
class Parts {
 public:
  explicit Parts(const FragmentMasks& fragment) : fragment_(fragment), rest_(fragment.masks) {}

  // Returns the part of a voxel that is left.
  LargestPart take(std::size_t leaf, unsigned offset) {
    LargestPart part{std::vector<LeafMask>(rest_.size()), 0};
    std::vector<std::pair<std::size_t, unsigned>> open;
    const auto visit = [&](std::size_t i, unsigned voxel) {
      std::uint64_t& word = rest_[i][voxel / 64];
      const std::uint64_t bit = std::uint64_t{1} << (voxel % 64);
      if ((word & bit) == 0) return;
      word &= ~bit;
      part.masks[i][voxel / 64] |= bit;
      ++part.voxels;
      open.push_back({i, voxel});
    };
    visit(leaf, offset);
    while (!open.empty()) {
      const auto [i, voxel] = open.back();
      open.pop_back();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const unsigned stride = 64u >> (3 * axis), along = voxel / stride % 8;
        const std::size_t step = axis == 0 ? 9 : axis == 1 ? 3 : 1;  // see LeafNeighbors
        if (along > 0) {
          visit(i, voxel - stride);
        } else if (const std::uint32_t below = fragment_.neighbors[i][13 - step];
                   below != LeafBlocks::kNone) {
          visit(below, voxel + 7 * stride);
        }
        if (along < 7) {
          visit(i, voxel + stride);
        } else if (const std::uint32_t above = fragment_.neighbors[i][13 + step];
                   above != LeafBlocks::kNone) {
          visit(above, voxel - 7 * stride);
        }
      }
    }
    return part;
  }

  [[nodiscard]] const std::vector<LeafMask>& rest() const { return rest_; }

 private:
  const FragmentMasks& fragment_;
  std::vector<LeafMask> rest_;
};

}  // namespace

std::uint64_t voxelsOf(const std::vector<LeafMask>& masks) {
  std::uint64_t count = 0;
  for (const LeafMask& mask : masks) {
    for (const std::uint64_t word : mask) count += static_cast<std::uint64_t>(std::popcount(word));
  }
  return count;
}

LargestPart largestPart(const FragmentMasks& fragment) {
  Parts parts(fragment);
  LargestPart largest{std::vector<LeafMask>(fragment.masks.size()), 0};
  for (std::size_t i = 0; i < fragment.masks.size(); ++i) {
    for (unsigned x = 0; x < 8; ++x) {
      while (const std::uint64_t word = parts.rest()[i][x]) {
        LargestPart part = parts.take(i, 64 * x + static_cast<unsigned>(std::countr_zero(word)));
        if (part.voxels > largest.voxels) largest = std::move(part);
      }
    }
  }
  return largest;
}

}  // namespace sherd
