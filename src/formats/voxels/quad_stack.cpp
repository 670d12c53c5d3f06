// The paper's quad-stack, `.qstack`: columns of equal labels, in a quadtree over x and y.
//
//     u64 2 | u16 nx, u16 ny, u16 nz | u64 nodes | node, node, ...                little-endian
//     node:      u64 intervals | u32 maxX, u32 maxY | u32 minX, u32 minY | interval, ...
//     interval:  u8 maxX - minX, u8 maxY - minY | u16 label | u16 z of its end (exclusive), of each
//     column
//
// A quadrant whose columns have the same labels in the same order is a leaf.  Intervals
// that all children have at the same position then move up to the node.
//
// source  Graciano, Rueda, Pospisil, Bittner, Benes, QuadStack, 2021; the layout is that of the
//         paper's authors (docs/formats.md)
#include <sherd/error.h>
#include <sherd/files.h>

#include <algorithm>
#include <array>
#include <memory>

#include "base/input_error.h"
#include "base/little_endian.h"
#include "formats/voxels/parse_voxels.h"
#include "formats/voxels/voxel_encoders.h"
#include "formats/voxels/voxel_runs.h"

namespace sherd {
namespace {

constexpr std::size_t kHeaderBytes = 22, kNodeBytes = 24, kIntervalBytes = 4;
constexpr int kWidest = 255;  // of a node with intervals: their sides are stored in 8 bits
constexpr std::uint16_t kWildcard = 65535;  // a label that the authors' writer never moves up

struct Square {
  int minX = 0, minY = 0, maxX = 0, maxY = 0;  // max is exclusive

  [[nodiscard]] int width() const { return maxX - minX; }
  [[nodiscard]] int height() const { return maxY - minY; }
  [[nodiscard]] std::size_t columns() const {
    return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
  }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(x - minX) * static_cast<std::size_t>(height()) +
           static_cast<std::size_t>(y - minY);
  }
};

struct Interval {
  std::uint16_t label = 0;
  std::vector<std::uint16_t> ends;  // [columns of the node], y fastest
};

struct QuadNode {
  Square square;
  std::vector<Interval> intervals;
  std::vector<std::unique_ptr<QuadNode>> children;
};

bool sameLabels(const Columns& columns, const Square& s) {
  if (std::max(s.width(), s.height()) > kWidest) return false;
  const std::size_t count = columns.count(s.minX, s.minY);
  const Columns::Interval* first = columns.at(s.minX, s.minY);
  for (int x = s.minX; x < s.maxX; ++x) {
    for (int y = s.minY; y < s.maxY; ++y) {
      if (columns.count(x, y) != count) return false;
      const Columns::Interval* other = columns.at(x, y);
      for (std::size_t i = 0; i < count; ++i) {
        if (other[i].label != first[i].label) return false;
      }
    }
  }
  return true;
}

std::vector<Interval> leafIntervals(const Columns& columns, const Square& s) {
  std::vector<Interval> intervals(columns.count(s.minX, s.minY));
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    intervals[i].label = columns.at(s.minX, s.minY)[i].label;
    intervals[i].ends.reserve(s.columns());
    for (int x = s.minX; x < s.maxX; ++x) {
      for (int y = s.minY; y < s.maxY; ++y) {
        intervals[i].ends.push_back(static_cast<std::uint16_t>(columns.at(x, y)[i].end));
      }
    }
  }
  return intervals;
}

std::vector<Square> quarters(const Square& s) {
  const int midX = s.minX + (s.width() + 1) / 2, midY = s.minY + (s.height() + 1) / 2;
  std::vector<Square> all{{s.minX, s.minY, midX, midY},
                          {s.minX, midY, midX, s.maxY},
                          {midX, s.minY, s.maxX, midY},
                          {midX, midY, s.maxX, s.maxY}};
  std::erase_if(all, [](const Square& q) { return q.columns() == 0; });
  return all;
}

// Moves up the intervals that all children have at the same position. Like the authors' writer, the
// position advances although lists shrink: of two consecutive candidates the second is skipped.
void moveUp(QuadNode& node) {
  for (std::size_t position = 0; position < node.children[0]->intervals.size(); ++position) {
    const std::uint16_t label = node.children[0]->intervals[position].label;
    const bool same =
        label != kWildcard &&
        std::all_of(node.children.begin(), node.children.end(), [&](const auto& c) {
          return position < c->intervals.size() && c->intervals[position].label == label;
        });
    if (!same) continue;
    Interval moved{label, std::vector<std::uint16_t>(node.square.columns())};
    for (const std::unique_ptr<QuadNode>& child : node.children) {
      const Square& s = child->square;
      const auto at = child->intervals.begin() + static_cast<std::ptrdiff_t>(position);
      for (int x = s.minX; x < s.maxX; ++x) {
        std::copy_n(at->ends.begin() + static_cast<std::ptrdiff_t>(s.index(x, s.minY)), s.height(),
                    moved.ends.begin() + static_cast<std::ptrdiff_t>(node.square.index(x, s.minY)));
      }
      child->intervals.erase(at);
    }
    node.intervals.push_back(std::move(moved));
  }
}

std::unique_ptr<QuadNode> build(const Columns& columns, const Square& square) {
  auto node = std::make_unique<QuadNode>();
  node->square = square;
  if (sameLabels(columns, square)) {
    node->intervals = leafIntervals(columns, square);
    return node;
  }
  for (const Square& quarter : quarters(square)) node->children.push_back(build(columns, quarter));
  if (std::max(square.width(), square.height()) <= kWidest) moveUp(*node);
  return node;
}

std::uint64_t nodesWithIntervals(const QuadNode& node) {
  std::uint64_t count = node.intervals.empty() ? 0 : 1;
  for (const auto& child : node.children) count += nodesWithIntervals(*child);
  return count;
}

void encodeNode(const QuadNode& node, const ByteSink& sink) {
  if (!node.intervals.empty()) {
    const Square& s = node.square;
    std::string bytes;
    storeLittle(bytes, std::uint64_t{node.intervals.size()});
    for (const int side : {s.maxX, s.maxY, s.minX, s.minY}) {
      storeLittle(bytes, static_cast<std::uint32_t>(side));
    }
    for (const Interval& interval : node.intervals) {
      storeLittle(bytes, static_cast<std::uint8_t>(s.width()));
      storeLittle(bytes, static_cast<std::uint8_t>(s.height()));
      storeLittle(bytes, interval.label);
      for (const std::uint16_t end : interval.ends) storeLittle(bytes, end);
    }
    sink(bytes);
  }
  for (const auto& child : node.children) encodeNode(*child, sink);
}

// ---- Reading

struct End {
  std::uint64_t column = 0;  // x * ny + y
  std::uint16_t z = 0;       // end of the interval, exclusive
  std::uint16_t label = 0;
};

class Reader {
 public:
  Reader(std::string_view bytes, std::string name) : rest_(bytes), name_(std::move(name)) {}

  template <class T>
  T take() {
    need(sizeof(T));
    const T value = loadLittle<T>(rest_.data());
    rest_.remove_prefix(sizeof(T));
    return value;
  }
  void need(std::uint64_t bytes) const {
    if (rest_.size() < bytes) inputError(name_, "is cut: a node of its quadtree has no end");
  }
  [[nodiscard]] bool done() const { return rest_.empty(); }

 private:
  std::string_view rest_;
  std::string name_;
};

void readNode(Reader& in, const openvdb::Coord& dims, std::vector<End>& ends,
              GrowingMemory& growing, const std::string& name) {
  in.need(kNodeBytes);
  const auto intervals = in.take<std::uint64_t>();
  std::array<std::uint32_t, 4> sides{};
  for (std::uint32_t& side : sides) side = in.take<std::uint32_t>();
  const auto [maxX, maxY, minX, minY] = sides;
  const bool within = minX < maxX && minY < maxY && maxX <= static_cast<std::uint32_t>(dims.x()) &&
                      maxY <= static_cast<std::uint32_t>(dims.y());
  if (!within) inputError(name, "has a node outside of its box");
  const std::uint64_t columns = std::uint64_t{maxX - minX} * (maxY - minY);
  for (std::uint64_t i = 0; i < intervals; ++i) {
    in.need(kIntervalBytes + 2 * columns);
    growing.hold((ends.size() + columns) * sizeof(End));
    const auto width = in.take<std::uint8_t>(), height = in.take<std::uint8_t>();
    if (width != ((maxX - minX) & 0xff) || height != ((maxY - minY) & 0xff)) {
      inputError(name, "has an interval whose sides are not its node's");
    }
    const auto label = in.take<std::uint16_t>();
    for (std::uint64_t x = minX; x < maxX; ++x) {
      for (std::uint64_t y = minY; y < maxY; ++y) {
        ends.push_back(
            {x * static_cast<std::uint64_t>(dims.y()) + y, in.take<std::uint16_t>(), label});
      }
    }
  }
}

}  // namespace

RunLengthVoxels parseQuadStack(std::string_view bytes, const std::string& name,
                               const ReadOptions& options) {
  MemoryBudget memory(name, options.maxMemory);
  if (bytes.size() < kHeaderBytes) inputError(name, "is cut: a .qstack header has 22 bytes");
  Reader in(bytes, name);
  if (in.take<std::uint64_t>() != 2) {
    inputError(name, "is no .qstack of 16-bit labels: its first number is not 2");
  }
  std::array<std::uint64_t, 3> sides{};
  for (std::uint64_t& side : sides) side = in.take<std::uint16_t>();
  RunLengthVoxels voxels{boxOf(sides, name), {}};
  const auto nodes = in.take<std::uint64_t>();
  std::vector<End> ends;
  GrowingMemory growing(&memory);
  for (std::uint64_t i = 0; i < nodes; ++i) readNode(in, voxels.dims, ends, growing, name);
  if (!in.done()) inputError(name, "holds more than its nodes");
  std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) {
    return a.column != b.column ? a.column < b.column : a.z < b.z;
  });

  std::uint64_t column = 0;
  std::uint16_t z = 0;
  GrowingMemory growingRuns(&memory);
  constexpr std::size_t kEndsAtATime = std::size_t{1} << 12;
  for (const End& end : ends) {
    if (static_cast<std::size_t>(&end - ends.data()) % kEndsAtATime == 0)
      growingRuns.hold((voxels.runs.size() + kEndsAtATime) * sizeof(Run));
    if (end.column != column || end.z <= z || end.z > sides[2]) {
      inputError(name, "does not fill its box: column " + std::to_string(column) +
                           " has a gap or an overlap at z " + std::to_string(z));
    }
    appendRun(voxels.runs, end.label, std::uint64_t{end.z} - z);
    z = end.z;
    if (z < sides[2]) continue;
    z = 0;
    ++column;
  }
  if (column != sides[0] * sides[1]) inputError(name, "does not fill its box: columns are missing");
  return voxels;
}

void encodeQuadStack(const RunLengthVoxels& voxels, const ByteSink& sink) {
  const openvdb::Coord& dims = voxels.dims;
  const auto wide = [&](int axis) { return static_cast<std::uint64_t>(dims[axis]); };
  if (std::max({dims.x(), dims.y(), dims.z()}) > 0xffff || wide(0) * wide(1) > Columns::kMost) {
    throw Error(ErrorCode::output, "a .qstack holds sides up to 65535 and 2^25 columns, not " +
                                       std::to_string(dims.x()) + " x " + std::to_string(dims.y()) +
                                       " x " + std::to_string(dims.z()) + "; try .rle");
  }
  const Columns columns(voxels);
  const std::unique_ptr<QuadNode> root = build(columns, {0, 0, dims.x(), dims.y()});
  std::string header;
  storeLittle(header, std::uint64_t{2});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    storeLittle(header, static_cast<std::uint16_t>(dims[axis]));
  }
  storeLittle(header, nodesWithIntervals(*root));
  sink(header);
  encodeNode(*root, sink);
}

}  // namespace sherd
