// Reads and writes points as a compressed octree of the Point Cloud Library: `.binp`.
//
//     "<PCL-OCT-COMPRESSED>" | u32 frame 1 | u8 1 whole frame | u8 1 centers of voxels | u8 0 no
//     colors | u64 points | f64 voxel | u8 8 | f64 voxel | f64 min x y z | f64 max x y z |
//     u64 bytes of the tree | u32 frequencies[257] | the tree, range coded       little-endian
//
// The tree is written depth first, a byte for each node that is no leaf: bit i is child i, whose x,
// y and z are the bits 2, 1 and 0 of i.  A leaf is one voxel.
//
// source  Kammerl et al., Real-time compression of point cloud streams, 2012; PCL 1.13
#include "formats/points/octree_stream.h"

#include <sherd/files.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/input_error.h"
#include "base/little_endian.h"
#include "base/memory_budget.h"
#include "formats/points/parse_points.h"
#include "formats/points/range_coder.h"

namespace sherd {
namespace {

constexpr std::string_view kMagic = "<PCL-OCT-COMPRESSED>";
constexpr std::size_t kHeaderBytes = 100, kTreeHeaderBytes = 8 + 4 * 257;
constexpr double kVoxel = 1e-4, kFinest = 1e-6;
constexpr int kDeepest = 21;  // three axes in 64 bits
constexpr double kFloatEpsilon = std::numeric_limits<float>::epsilon();

void storeDouble(std::string& bytes, double value) {
  storeLittle(bytes, std::bit_cast<std::uint64_t>(value));
}

double loadDouble(const char* bytes) {
  return std::bit_cast<double>(loadLittle<std::uint64_t>(bytes));
}

double voxelSizeFor(double longest) {
  double voxel = kVoxel;
  while (longest / voxel >= 1 << kDeepest) voxel *= 10.0;
  while (longest / voxel < 1 << 10 && voxel > 1.5 * kFinest) voxel /= 10.0;
  return voxel;
}

// Interleaves the bits of three numbers, x first (Morton order): the depth-first order of an
// octree.
std::uint64_t interleaved(const std::array<std::uint64_t, 3>& key) {
  std::uint64_t code = 0;
  for (int bit = kDeepest - 1; bit >= 0; --bit) {
    for (const std::uint64_t k : key) code = code << 1 | (k >> bit & 1);
  }
  return code;
}

// Appends the subtree of one node. `codes` are its voxels, sorted; the three bits at `shift` select
// a child.
void storeTree(std::span<const std::uint64_t> codes, int shift, std::string& tree) {
  const std::size_t nodeAt = tree.size();
  tree.push_back(0);
  unsigned children = 0;
  for (std::size_t begin = 0; begin < codes.size();) {
    const std::uint64_t child = codes[begin] >> shift & 7;
    std::size_t end = begin;
    while (end < codes.size() && (codes[end] >> shift & 7) == child) ++end;
    children |= 1u << child;
    if (shift > 0) storeTree(codes.subspan(begin, end - begin), shift - 3, tree);
    begin = end;
  }
  tree[nodeAt] = static_cast<char>(children);
}

// ---- Reading

struct Header {
  std::uint64_t points = 0, treeBytes = 0;
  double voxel = 0.0;
  std::array<double, 3> min{};
  int depth = 0;
};

// Reads the header and lays the tree over its box as the library does.
Header readHeader(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with(kMagic)) {
    inputError(name, "is no octree stream of the Point Cloud Library: it does not begin with " +
                         std::string(kMagic));
  }
  if (bytes.size() < kHeaderBytes + kTreeHeaderBytes) inputError(name, "is cut in its header");
  const char* at = bytes.data() + kMagic.size() + 4;
  if (at[0] == 0 || at[1] == 0 || at[2] != 0) {
    inputError(name,
               "holds a differential frame, points that are not voxel centers, or colors; only "
               "whole frames of voxel centers are read");
  }
  Header header;
  header.points = loadLittle<std::uint64_t>(at + 3);
  header.voxel = loadDouble(at + 11);
  header.treeBytes = loadLittle<std::uint64_t>(bytes.data() + kHeaderBytes);
  std::array<double, 3> max{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.min[axis] = loadDouble(at + 28 + 8 * axis);
    max[axis] = loadDouble(at + 52 + 8 * axis);
  }
  double voxels = 2.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    voxels =
        std::max(voxels, std::ceil((max[axis] - header.min[axis] - kFloatEpsilon) / header.voxel));
  }
  const bool good =
      header.voxel > 0.0 && voxels <= 0x1p31 &&
      std::all_of(header.min.begin(), header.min.end(),
                  [](double v) { return std::abs(v) < 1e300; }) &&
      std::all_of(max.begin(), max.end(), [](double v) { return std::abs(v) < 1e300; });
  if (!good) inputError(name, "has an impossible box or voxel size");
  header.depth = static_cast<int>(std::ceil(std::log2(voxels) - kFloatEpsilon));
  const double side = std::ldexp(header.voxel, header.depth);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double over = (side - (max[axis] - header.min[axis])) / 2.0;
    if (over > kFloatEpsilon) header.min[axis] -= over;
  }
  return header;
}

class TreeReader {
 public:
  ///   most  limit on points, which can take almost no space in the file
  TreeReader(RangeDecoder& decoder, const Header& header, std::uint64_t most,
             const std::string& name, MemoryBudget& memory)
      : decoder_(decoder), header_(header), most_(most), name_(name), growing_(&memory) {}

  // Reads the node at `depth` whose voxel indices begin with `key`.
  void read(const std::array<std::uint32_t, 3>& key, int depth, std::vector<glm::dvec3>& points) {
    if (depth == header_.depth) {
      if (points.size() == std::min(header_.points, most_)) {
        inputError(name_,
                   "holds more points than its header announces or a file of its size can hold");
      }
      constexpr std::size_t kPointsAtATime = 4096;
      if (points.size() % kPointsAtATime == 0)
        growing_.hold((points.size() + kPointsAtATime) * sizeof(glm::dvec3));
      glm::dvec3& point = points.emplace_back();
      for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        point[axis] = (key[i] + 0.5) * header_.voxel + header_.min[i];
      }
      return;
    }
    const std::optional<std::uint8_t> children = decoder_.next();
    if (!children || ++taken_ > header_.treeBytes) inputError(name_, "is cut or damaged");
    if (*children == 0) inputError(name_, "is damaged: a node of its octree has no child");
    for (std::uint32_t child = 0; child < 8; ++child) {
      if ((*children >> child & 1) == 0) continue;
      read({key[0] << 1 | child >> 2, key[1] << 1 | (child >> 1 & 1), key[2] << 1 | (child & 1)},
           depth + 1, points);
    }
  }

  [[nodiscard]] std::uint64_t taken() const { return taken_; }

 private:
  RangeDecoder& decoder_;
  const Header& header_;
  std::uint64_t most_;
  const std::string& name_;
  GrowingMemory growing_;
  std::uint64_t taken_ = 0;
};

}  // namespace

OctreeStream octreeStream(const Blocks<SurfacePoints>& points, const std::string& name) {
  if (points.count == 0) inputError(name, "a .binp needs at least one point");
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  points.forEach([&](const SurfacePoints& block) {
    for (const glm::dvec3& p : block.positions) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!(std::abs(p[axis]) < 1e300)) inputError(name, "a .binp needs finite points");
        low[axis] = std::min(low[axis], p[axis]);
        high[axis] = std::max(high[axis], p[axis]);
      }
    }
  });
  const double longest = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  const double voxel = voxelSizeFor(longest);
  int depth = 1;
  while (std::floor(longest / voxel) >= 1 << depth) ++depth;
  std::vector<std::uint64_t> codes;
  codes.reserve(points.count);
  points.forEach([&](const SurfacePoints& block) {
    for (const glm::dvec3& p : block.positions) {
      std::array<std::uint64_t, 3> key{};
      for (int axis = 0; axis < 3; ++axis) {
        key[static_cast<std::size_t>(axis)] =
            static_cast<std::uint64_t>(std::floor((p[axis] - low[axis]) / voxel));
      }
      codes.push_back(interleaved(key));
    }
  });
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  std::string tree;
  storeTree(codes, 3 * (depth - 1), tree);
  const Frequencies frequencies = frequenciesOf(tree);

  OctreeStream stream{std::string(kMagic), points.count - codes.size(), voxel};
  std::string& bytes = stream.bytes;
  storeLittle(bytes, std::uint32_t{1});
  bytes.append("\1\1\0", 3);  // a whole frame, of voxels' centers, without colors
  storeLittle(bytes, std::uint64_t{codes.size()});
  storeDouble(bytes, voxel);
  storeLittle(bytes, std::uint8_t{8});
  storeDouble(bytes, static_cast<float>(voxel));
  for (int axis = 0; axis < 3; ++axis) storeDouble(bytes, low[axis]);
  // Slightly less than the tree's side: over the whole of it readers would lay a deeper tree.
  const double side = std::ldexp(voxel, depth) - kFloatEpsilon;
  for (int axis = 0; axis < 3; ++axis) storeDouble(bytes, low[axis] + side);
  storeLittle(bytes, std::uint64_t{tree.size()});
  for (const std::uint32_t frequency : frequencies) storeLittle(bytes, frequency);
  bytes += rangeEncoded(tree, frequencies);
  return stream;
}

SurfacePoints parseBinp(std::string_view bytes, const std::string& name,
                        const ReadOptions& options) {
  MemoryBudget memory(name, options.maxMemory);
  const Header header = readHeader(bytes, name);
  Frequencies frequencies{};
  for (std::size_t s = 0; s < frequencies.size(); ++s) {
    frequencies[s] = loadLittle<std::uint32_t>(bytes.data() + kHeaderBytes + 8 + 4 * s);
  }
  const bool rising = std::adjacent_find(frequencies.begin(), frequencies.end(),
                                         std::greater_equal<>()) == frequencies.end();
  if (frequencies[0] != 0 || frequencies[256] > 65536 || !rising) {
    inputError(name, "is damaged: its table of frequencies is invalid");
  }
  RangeDecoder decoder(bytes.substr(kHeaderBytes + kTreeHeaderBytes), frequencies);
  TreeReader tree(decoder, header, 64 * bytes.size(), name, memory);
  SurfacePoints points;
  tree.read({0, 0, 0}, 0, points.positions);
  if (points.positions.size() != header.points || tree.taken() != header.treeBytes ||
      !decoder.done()) {
    inputError(name, "is damaged: it holds " + std::to_string(points.positions.size()) +
                         " points, its header announces " + std::to_string(header.points));
  }
  return points;
}

}  // namespace sherd
