// Converts labels of leaf blocks to runs over a box.
#include <sherd/files.h>

#include <bit>
#include <cassert>

#include "formats/voxels/voxel_runs.h"
#include "grow/fields/check_labels.h"

namespace sherd {
namespace {

// The leaves of each 8x8 column in x and y. Origins ascend by x, y, z, so a column is one range.
class LeafColumns {
 public:
  LeafColumns(const LeafBlocks& blocks, const VoxelBox& box)
      : x0_(box.min.x() >> 3),
        y0_(box.min.y() >> 3),
        nx_((box.max.x() >> 3) - x0_ + 1),
        ny_((box.max.y() >> 3) - y0_ + 1),
        columns_(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_)) {
    for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
      const int x = (blocks.origins[leaf].x() >> 3) - x0_;
      const int y = (blocks.origins[leaf].y() >> 3) - y0_;
      if (x < 0 || x >= nx_ || y < 0 || y >= ny_) continue;  // exterior band beyond the box
      Range& column = columns_[index(x, y)];
      if (column.end == 0) column.begin = leaf;
      column.end = leaf + 1;
    }
  }

  struct Range {
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  Range at(int x, int y) const { return columns_[index((x >> 3) - x0_, (y >> 3) - y0_)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(ny_) +
           static_cast<std::size_t>(y);
  }

  int x0_, y0_, nx_, ny_;
  std::vector<Range> columns_;
};

// Returns a bit for each of eight labels, set where it differs from the one before.  Most rows have
// one label, and a loop to the first that differs ends where no processor expects it.
unsigned changesIn(const std::uint16_t* label) {
  unsigned changes = 0;
  for (unsigned k = 1; k < 8; ++k) {
    changes |= static_cast<unsigned>(label[k] != label[k - 1]) << k;
  }
  return changes;
}

}  // namespace

RunLengthVoxels encodeRuns(const Solid& solid, const Labels& labels, int fragments) {
  checkLabels(labels, solid);
  const VoxelBox& box = solid.box;
  assert(!box.empty());
  const LeafColumns columns(*solid.blocks, box);
  RunLengthVoxels voxels{box.dims(), {}};
  const auto voxelLabel = [&](std::uint16_t label) {
    return static_cast<std::uint16_t>(label <= fragments ? label + 1 : 1);
  };
  // Appends the runs of voxels along z.
  const auto append = [&](const std::uint16_t* label, unsigned count) {
    for (unsigned begin = 0; begin < count;) {
      unsigned end = begin + 1;
      while (end < count && label[end] == label[begin]) ++end;
      appendRun(voxels.runs, voxelLabel(label[begin]), end - begin);
      begin = end;
    }
  };
  for (int x = box.min.x(); x <= box.max.x(); ++x) {
    for (int y = box.min.y(); y <= box.max.y(); ++y) {
      int z = box.min.z();  // voxels below it are in the runs
      const auto [begin, end] = columns.at(x, y);
      for (std::size_t leaf = begin; leaf < end; ++leaf) {
        const auto rowBit = static_cast<unsigned>(y & 7) << 3;
        const std::uint64_t slab = solid.blocks->inside[leaf * 8 + static_cast<unsigned>(x & 7)];
        auto row = static_cast<unsigned>((slab >> rowBit) & 0xff);
        if (row == 0) continue;
        const std::uint16_t* const label =
            &labels.fragment[leaf * 512 + (static_cast<unsigned>(x & 7) << 6) + rowBit];
        const unsigned changes = changesIn(label);
        while (row != 0) {
          const auto bit = static_cast<unsigned>(std::countr_zero(row));
          const auto count = static_cast<unsigned>(std::countr_one(row >> bit));
          const int inside = solid.blocks->origins[leaf].z() + static_cast<int>(bit);
          appendRun(voxels.runs, 0, static_cast<std::uint64_t>(inside - z));
          const unsigned span = ((1u << count) - 1) << bit;
          if ((changes & span & (span << 1)) == 0) {
            appendRun(voxels.runs, voxelLabel(label[bit]), count);
          } else {
            append(label + bit, count);
          }
          z = inside + static_cast<int>(count);
          row &= ~span;
        }
      }
      appendRun(voxels.runs, 0, static_cast<std::uint64_t>(box.max.z() + 1 - z));
    }
  }
  return voxels;
}

}  // namespace sherd
