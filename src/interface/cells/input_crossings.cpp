// Finds crossings by the tree of triangles.
#include "interface/cells/input_crossings.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

#include "mesh/search/boxes.h"
#include "mesh/triangle_area.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

// The least difference of gradients along two edges of a cell that bends its surface: that of a
// ball with a radius of 20 voxels.
constexpr float kLeastBend = 0.05f;

// Voxels on both sides of a crossing that are on the surface, up to this, in voxels: the planes of
// a crease through their centers have the distances of one plane there.
constexpr float kLeastSlope = 0.05f;

// Triangles with all edges shorter than kSmall are details, such as a scan's noise: the normal is
// the mean within kAround along each axis, of those within 40 degrees of the crossed triangle's.
constexpr double kSmall = 0.5, kAround = 0.25;  // voxels
constexpr double kAlikeCosine = 0.766;

bool isSmall(const std::array<glm::dvec3, 3>& t) {
  return std::max({glm::distance(t[0], t[1]), glm::distance(t[1], t[2]),
                   glm::distance(t[2], t[0])}) < kSmall;
}

glm::dvec3 meanNormal(const TriangleTree& tree, const glm::dvec3& around,
                      const glm::dvec3& normal) {
  glm::dvec3 sum(0.0);
  for (const std::uint32_t triangle : tree.meeting({around - kAround, around + kAround})) {
    const glm::dvec3 own = areaNormal(tree.corners(triangle));
    const double cosine = glm::dot(own, normal);
    if (std::abs(cosine) > kAlikeCosine * glm::length(own)) sum += cosine < 0.0 ? -own : own;
  }
  const double length = glm::length(sum);
  return length > 0.0 ? sum / length : normal;
}

// Calls visit(low, axis) for the edges of a leaf's cells that meet a box, from the leaf's lowest
// voxel.
template <class Visit>
void forEachEdge(const Box& box, const Visit& visit) {
  const glm::ivec3 low = glm::max(glm::ivec3(glm::ceil(box.min)), 0),
                   high = glm::min(glm::ivec3(glm::floor(box.max)), 8);
  for (int axis = 0; axis < 3; ++axis) {
    glm::ivec3 from = low, to = high;
    from[axis] = std::max(from[axis] - 1, 0);
    to[axis] = std::min(to[axis], 7);
    for (int x = from.x; x <= to.x; ++x) {
      for (int y = from.y; y <= to.y; ++y) {
        for (int z = from.z; z <= to.z; ++z) visit(openvdb::Coord(x, y, z), axis);
      }
    }
  }
}

}  // namespace

InputCrossings::InputCrossings(const Solid& solid, const openvdb::Coord& origin,
                               std::span<const KnownCrossing> known)
    : tree_(solid.region ? solid.region->boundary() : nullptr),
      known_(known),
      origin_(origin.x(), origin.y(), origin.z()),
      voxelSize_(solid.frame.voxelSize),
      areTrianglesFew_(tree_ != nullptr && tree_->size() < 1024 * solid.blocks->count()) {}

bool InputCrossings::areNeededFor(const std::array<float, 8>& toSurface) const {
  if (tree_ == nullptr) return false;
  const auto bend = kLeastBend * static_cast<float>(voxelSize_),
             slope = kLeastSlope * static_cast<float>(voxelSize_);
  for (const std::size_t bit : {4u, 2u, 1u}) {
    float least = INFINITY, most = -INFINITY;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      if (corner & bit) continue;
      const float from = toSurface[corner], to = toSurface[corner | bit], step = to - from;
      if ((from < 0.0f) != (to < 0.0f) && std::abs(step) < slope) return true;
      least = std::min(least, step);
      most = std::max(most, step);
    }
    if (most - least > bend) return true;
  }
  return false;
}

std::uint16_t& InputCrossings::indexOf(const CrossedEdge& edge) {
  if (index_.empty()) index_.assign(9 * 9 * 9 * 3, kUnknown);
  return index_[numberOf(edge)];
}

std::uint16_t InputCrossings::numberOf(const CrossedEdge& edge) {
  const openvdb::Coord& low = edge.low;
  return static_cast<std::uint16_t>(((low.x() * 9 + low.y()) * 9 + low.z()) * 3 + edge.axis);
}

std::vector<KnownCrossing> InputCrossings::found() const {
  std::vector<KnownCrossing> found;
  for (std::size_t edge = 0; edge < index_.size(); ++edge) {
    if (index_[edge] != kUnknown)
      found.push_back({static_cast<std::uint16_t>(edge), all_[index_[edge]]});
  }
  return found;
}

InputCrossings::Segment InputCrossings::segmentOf(const CrossedEdge& edge) const {
  const glm::dvec3 begin = origin_ + glm::dvec3(edge.low.x(), edge.low.y(), edge.low.z());
  glm::dvec3 end = begin;
  end[edge.axis] += 1.0;
  // From outside: triangles that other parts of the mesh hide may lie behind the first.
  return edge.isLowInside ? Segment{end, begin} : Segment{begin, end};
}

// By the edges that each triangle's box meets, where the tree would be searched for each edge.
void InputCrossings::find(std::span<const CrossedEdge> edges) {
  constexpr double kRounding = 1e-4;       // voxels
  constexpr std::size_t kMostEdges = 256;  // visited for each edge: the tree would be faster
  if (edges.empty() || !areTrianglesFew_) return;
  std::array<std::uint16_t, 9 * 9 * 9 * 3> numberOf;
  numberOf.fill(kUnknown);
  for (std::size_t i = 0; i < edges.size(); ++i)
    numberOf[static_cast<std::size_t>(&indexOf(edges[i]) - index_.data())] =
        static_cast<std::uint16_t>(i);
  struct Near {
    std::uint32_t edge, triangle;
  };
  std::vector<Near> near;
  std::size_t visited = 0;
  for (const std::uint32_t triangle :
       tree_->meeting(widened({origin_, origin_ + 8.0}, kRounding))) {
    const Box box = widened(boxOf(tree_->corners(triangle)), kRounding);
    forEachEdge({box.min - origin_, box.max - origin_}, [&](const openvdb::Coord& low, int axis) {
      const auto at = static_cast<std::size_t>(((low.x() * 9 + low.y()) * 9 + low.z()) * 3 + axis);
      if (numberOf[at] != kUnknown) near.push_back({numberOf[at], triangle});
      ++visited;
    });
    if (visited > kMostEdges * edges.size()) return;
  }
  std::vector<std::uint32_t> first(edges.size() + 1, 0), triangles(near.size());
  for (const Near& pair : near) ++first[pair.edge + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (const Near& pair : near) triangles[next[pair.edge]++] = pair.triangle;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Segment segment = segmentOf(edges[i]);
    const auto own = std::span(triangles).subspan(first[i], first[i + 1] - first[i]);
    indexOf(edges[i]) = static_cast<std::uint16_t>(all_.size());
    all_.push_back(crossingOf(edges[i], segment, tree_->firstBetween(segment[0], segment[1], own)));
  }
}

const std::optional<InputCrossing>& InputCrossings::on(const CrossedEdge& edge) {
  const auto known = std::ranges::lower_bound(known_, numberOf(edge), {}, &KnownCrossing::edge);
  if (known != known_.end() && known->edge == numberOf(edge)) return known->crossing;
  std::uint16_t& index = indexOf(edge);
  if (index == kUnknown) {
    index = static_cast<std::uint16_t>(all_.size());
    const Segment segment = segmentOf(edge);
    all_.push_back(crossingOf(edge, segment, tree_->firstBetween(segment[0], segment[1])));
  }
  return all_[index];
}

std::optional<InputCrossing> InputCrossings::crossingOf(
    const CrossedEdge& edge, const Segment& segment,
    const std::optional<TriangleTree::Hit>& hit) const {
  if (!hit) return std::nullopt;
  const auto& [outside, inside] = segment;
  const std::array<glm::dvec3, 3> t = tree_->corners(hit->triangle);
  glm::dvec3 normal = areaNormal(t);
  const double length = glm::length(normal);
  if (length == 0.0) return std::nullopt;
  normal *= (glm::dot(normal, outside - inside) < 0.0 ? -1.0 : 1.0) / length;
  if (isSmall(t)) normal = meanNormal(*tree_, outside + hit->at * (inside - outside), normal);
  return InputCrossing{edge.isLowInside ? 1.0 - hit->at : hit->at, normal, hit->triangle};
}

}  // namespace sherd
