// The paper's run-length voxel file, `.rle`: from labels to runs, to a file, and back.
//
//     u32 nx, u32 ny, u32 nz | u16 label, u32 length | u16 label, u32 length | ... little-endian
#include <sherd/error.h>
#include <sherd/io.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <span>
#include <string>

#include "io/atomic_file.h"
#include "io/input_error.h"
#include "io/little_endian.h"

namespace sherd {
namespace {

constexpr std::uint64_t kLongestRun = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kRunBytes = 6;
constexpr std::size_t kRunsPerBlock = 1 << 16;  // of reading and writing
constexpr std::uint64_t kLargestExpanded = std::uint64_t{1} << 31;

// Adds to the last run where the label is the same; a run that its 32 bits cannot hold goes on in
// the next.
void append(std::vector<Run>& runs, std::uint16_t label, std::uint64_t length) {
  if (length > 0 && !runs.empty() && runs.back().label == label) {
    const std::uint64_t more = std::min(length, kLongestRun - runs.back().length);
    runs.back().length += static_cast<std::uint32_t>(more);
    length -= more;
  }
  while (length > 0) {
    const std::uint64_t part = std::min(length, kLongestRun);
    runs.push_back({label, static_cast<std::uint32_t>(part)});
    length -= part;
  }
}

std::uint64_t voxelsIn(const openvdb::Coord& dims) {
  return static_cast<std::uint64_t>(dims.x()) * static_cast<std::uint64_t>(dims.y()) *
         static_cast<std::uint64_t>(dims.z());
}

// The leaves over each 8x8 column of x and y.  Origins ascend by x, y, z, so a column is one range
// of them.
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
      if (x < 0 || x >= nx_ || y < 0 || y >= ny_) continue;  // outer band beyond the box
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

// Reads up to bytes.size(); fewer only at the end of the file.
std::size_t readSome(std::ifstream& in, std::span<char> bytes, const std::filesystem::path& file) {
  errno = 0;
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (in.bad()) inputError(file, "cannot be read: " + reasonOf(errno != 0 ? errno : EIO));
  return static_cast<std::size_t>(in.gcount());
}

openvdb::Coord readDims(std::ifstream& in, const std::filesystem::path& file) {
  char header[kHeaderBytes];
  const std::size_t n = readSome(in, header, file);
  if (n < kHeaderBytes) {
    inputError(file, "ends after " + std::to_string(n) + " bytes; an .rle header has 12");
  }
  std::uint64_t size[3];
  std::uint64_t voxels = 1;
  for (int axis = 0; axis < 3; ++axis) {
    size[axis] = loadLittle<std::uint32_t>(header + 4 * axis);
    const bool fits = size[axis] > 0 && size[axis] <= std::numeric_limits<std::int32_t>::max() &&
                      voxels <= std::numeric_limits<std::uint64_t>::max() / size[axis];
    if (!fits) {
      inputError(file, "its box has side " + std::to_string(size[axis]) + " along axis " +
                           "xyz"[axis] + "; is this an .rle file?");
    }
    voxels *= size[axis];
  }
  return {static_cast<int>(size[0]), static_cast<int>(size[1]), static_cast<int>(size[2])};
}

}  // namespace

RunLengthVoxels encodeRuns(const Solid& solid, const Labels& labels, int fragments) {
  const VoxelBox& box = solid.box;
  assert(!box.empty());
  const LeafColumns columns(solid.blocks, box);
  const auto voxelLabel = [&](std::uint16_t label) {
    return static_cast<std::uint16_t>(label <= fragments ? label + 1 : 1);
  };
  RunLengthVoxels voxels{box.dims(), {}};
  for (int x = box.min.x(); x <= box.max.x(); ++x) {
    for (int y = box.min.y(); y <= box.max.y(); ++y) {
      int z = box.min.z();  // rows up to here are in the runs
      const auto [begin, end] = columns.at(x, y);
      for (std::size_t leaf = begin; leaf < end; ++leaf) {
        const auto rowBit = static_cast<unsigned>(y & 7) << 3;
        const std::uint64_t slab = solid.blocks.inside[leaf * 8 + static_cast<unsigned>(x & 7)];
        const auto row = static_cast<unsigned>((slab >> rowBit) & 0xff);
        if (row == 0) continue;
        const std::size_t first = leaf * 512 + (static_cast<unsigned>(x & 7) << 6) + rowBit;
        for (unsigned bit = 0; bit < 8; ++bit) {
          if ((row >> bit & 1) == 0) continue;
          const int inside = solid.blocks.origins[leaf].z() + static_cast<int>(bit);
          append(voxels.runs, 0, static_cast<std::uint64_t>(inside - z));
          append(voxels.runs, voxelLabel(labels.fragment[first + bit]), 1);
          z = inside + 1;
        }
      }
      append(voxels.runs, 0, static_cast<std::uint64_t>(box.max.z() + 1 - z));
    }
  }
  return voxels;
}

VoxelLabels expand(const RunLengthVoxels& voxels) {
  if (voxelsIn(voxels.dims) > kLargestExpanded) {
    throw Error(ErrorCode::input, "a box of " + std::to_string(voxelsIn(voxels.dims)) +
                                      " voxels is too large to expand; 2147483648 fit");
  }
  VoxelLabels dense{voxels.dims, {}};
  dense.labels.reserve(voxelsIn(voxels.dims));
  for (const Run& run : voxels.runs) {
    dense.labels.insert(dense.labels.end(), run.length, run.label);
  }
  assert(dense.labels.size() == voxelsIn(voxels.dims));
  return dense;
}

RunLengthVoxels readRle(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) inputError(file, "is a folder; an .rle file is needed");
  std::ifstream in(file, std::ios::binary);
  if (!in) inputError(file, "cannot be opened: " + reasonOf(errno));

  RunLengthVoxels voxels{readDims(in, file), {}};
  const std::uint64_t total = voxelsIn(voxels.dims);
  std::uint64_t sum = 0;
  std::uint64_t number = 0;
  std::vector<char> block(kRunsPerBlock * kRunBytes);
  for (std::size_t n = block.size(); n == block.size();) {
    n = readSome(in, block, file);
    if (n % kRunBytes != 0) {
      inputError(file, "is cut: " + std::to_string(n % kRunBytes) +
                           " bytes follow the last whole run of 6 bytes");
    }
    for (std::size_t at = 0; at < n; at += kRunBytes) {
      ++number;
      const auto label = loadLittle<std::uint16_t>(block.data() + at);
      const auto length = loadLittle<std::uint32_t>(block.data() + at + 2);
      if (length == 0) inputError(file, "run " + std::to_string(number) + " has length 0");
      sum += length;
      if (sum > total) {
        inputError(file, "its runs pass the " + std::to_string(total) +
                             " voxels of its box at run " + std::to_string(number));
      }
      append(voxels.runs, label, length);
    }
  }
  if (sum < total) {
    inputError(file, "its runs hold " + std::to_string(sum) + " of the " + std::to_string(total) +
                         " voxels of its box; the file is cut or damaged");
  }
  return voxels;
}

void writeRle(const std::filesystem::path& file, const RunLengthVoxels& voxels) {
  AtomicFile out(file);
  std::string block;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    storeLittle(block, static_cast<std::uint32_t>(voxels.dims[axis]));
  }
  for (const Run& run : voxels.runs) {
    storeLittle(block, run.label);
    storeLittle(block, run.length);
    if (block.size() >= kRunsPerBlock * kRunBytes) {
      out.write(block);
      block.clear();
    }
  }
  out.write(block);
  out.commit();
}

}  // namespace sherd
