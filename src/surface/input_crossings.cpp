// Finds crossings by the tree of triangles.
#include "surface/input_crossings.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "mesh/boxes.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

// The least difference of gradients along two edges of a cell that bends its surface: that of a
// ball with a radius of 20 voxels.
constexpr float kLeastBend = 0.05f;

// Triangles with all edges shorter than kSmall are details, such as a scan's noise: the normal is
// the mean within kAround along each axis, of those within 40 degrees of the crossed triangle's.
constexpr double kSmall = 0.5, kAround = 0.25;  // voxels
constexpr double kAlikeCosine = 0.766;

glm::dvec3 areaNormal(const std::array<glm::dvec3, 3>& t) {
  return glm::cross(t[1] - t[0], t[2] - t[0]);
}

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

}  // namespace

InputCrossings::InputCrossings(const Solid& solid, const openvdb::Coord& origin)
    : tree_(solid.region ? solid.region->boundary() : nullptr),
      origin_(origin.x(), origin.y(), origin.z()),
      voxelSize_(solid.frame.voxelSize) {}

bool InputCrossings::areNeededFor(const std::array<float, 8>& toSurface) const {
  if (tree_ == nullptr) return false;
  const auto bend = kLeastBend * static_cast<float>(voxelSize_);
  for (const std::size_t bit : {4u, 2u, 1u}) {
    float least = INFINITY, most = -INFINITY;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      if (corner & bit) continue;
      const float step = toSurface[corner | bit] - toSurface[corner];
      least = std::min(least, step);
      most = std::max(most, step);
    }
    if (most - least > bend) return true;
  }
  return false;
}

const std::optional<InputCrossing>& InputCrossings::on(const openvdb::Coord& low, unsigned axis,
                                                       bool isLowInside) {
  if (index_.empty()) index_.assign(9 * 9 * 9 * 3, kUnknown);
  std::uint16_t& index =
      index_[static_cast<std::size_t>((low.x() * 9 + low.y()) * 9 + low.z()) * 3 + axis];
  if (index == kUnknown) {
    index = static_cast<std::uint16_t>(all_.size());
    all_.push_back(found(low, axis, isLowInside));
  }
  return all_[index];
}

std::optional<InputCrossing> InputCrossings::found(const openvdb::Coord& low, unsigned axis,
                                                   bool isLowInside) const {
  const glm::dvec3 begin = origin_ + glm::dvec3(low.x(), low.y(), low.z());
  glm::dvec3 end = begin;
  end[static_cast<int>(axis)] += 1.0;
  // From outside: triangles that other parts of the mesh hide may lie behind the first.
  const glm::dvec3 &outside = isLowInside ? end : begin, &inside = isLowInside ? begin : end;
  const std::optional<TriangleTree::Hit> hit = tree_->firstBetween(outside, inside);
  if (!hit) return std::nullopt;
  const std::array<glm::dvec3, 3> t = tree_->corners(hit->triangle);
  glm::dvec3 normal = areaNormal(t);
  const double length = glm::length(normal);
  if (length == 0.0) return std::nullopt;
  normal *= (glm::dot(normal, outside - inside) < 0.0 ? -1.0 : 1.0) / length;
  if (isSmall(t)) normal = meanNormal(*tree_, outside + hit->at * (inside - outside), normal);
  return InputCrossing{isLowInside ? 1.0 - hit->at : hit->at, normal};
}

}  // namespace sherd
