// Measures gaps between neighbors, and the difference of the two sides of cracks.
#include "evaluate/cracks/joint_gaps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <memory>
#include <tuple>

#include "base/cancel_flag.h"
#include "evaluate/cracks/contact_plane.h"
#include "evaluate/cracks/heights.h"
#include "evaluate/cracks/triangle_points.h"
#include "mesh/search/mesh_distance.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

constexpr std::array<double, 4> kQuantiles{0.10, 0.50, 0.90, 0.99};
constexpr std::size_t kLeastNodes = 16;
constexpr double kMostNodesAcross = 128.0;  // a contact, where units are small

/// A point on a crack: the area that it stands for, and its distance from the neighbor.
struct GapSample {
  double gap = 0.0;  ///< share of the object's diagonal
  double area = 0.0;
  bool isFar = false;   ///< farther than the tolerance
  bool isDeep = false;  ///< and inside
};

std::map<int, std::size_t> indicesOf(std::span<const int> ids) {
  std::map<int, std::size_t> indices;
  for (std::size_t i = 0; i < ids.size(); ++i) indices[ids[i]] = i;
  return indices;
}

/// Returns the diagonal of the object of each fragment, > 0.
std::vector<double> diagonals(const JointInput& in) {
  std::vector<Box> boxes(in.graph.objects, {glm::dvec3(std::numeric_limits<double>::infinity()),
                                            glm::dvec3(-std::numeric_limits<double>::infinity())});
  for (std::size_t i = 0; i < in.meshes.size(); ++i) {
    Box& box = boxes[in.graph.object[i]];
    const Box own = bounds(*in.meshes[i].mesh);
    box = {glm::min(box.min, own.min), glm::max(box.max, own.max)};
  }
  std::vector<double> result;
  for (const std::size_t object : in.graph.object) {
    result.push_back(glm::length(boxes[object].max - boxes[object].min));
  }
  return result;
}

/// Measures the gaps of one fragment's cracks.
std::vector<GapSample> gapsOf(const JointInput& in, std::size_t i, double diagonal,
                              const std::map<int, std::size_t>& indices,
                              const std::vector<std::unique_ptr<MeshDistance>>& distances,
                              const Progress* progress) {
  std::vector<GapSample> samples;
  const DividedMesh& own = in.meshes[i];
  for (std::size_t t = 0; t < own.neighbor.size(); ++t) {
    const auto other = indices.find(own.neighbor[t]);
    if (own.neighbor[t] == 0 || other == indices.end() || other->second == i) continue;
    throwIfCancelled(progress);
    const MeshDistance& distance = *distances[other->second];
    const auto corners = positionsOf(own.mesh->vertices, own.mesh->triangles[t]);
    const std::vector<glm::dvec3> points = pointsOn(corners, in.spacing);
    const double area = areaOf(corners) / static_cast<double>(points.size());
    for (const glm::dvec3& point : points) {
      const double gap = distance.distance(point);
      const bool isFar = gap > in.tolerance * diagonal;
      samples.push_back({gap / diagonal, area, isFar, isFar && distance.contains(point, gap)});
    }
  }
  return samples;
}

std::array<double, 4> quantilesOf(std::vector<GapSample> samples) {
  std::sort(samples.begin(), samples.end(),
            [](const GapSample& a, const GapSample& b) { return a.gap < b.gap; });
  double all = 0.0, sum = 0.0;
  for (const GapSample& sample : samples) all += sample.area;
  std::array<double, 4> result{};
  std::size_t next = 0;
  for (const GapSample& sample : samples) {
    sum += sample.area;
    while (next < kQuantiles.size() && sum >= kQuantiles[next] * all) result[next++] = sample.gap;
  }
  while (next < kQuantiles.size()) result[next++] = samples.back().gap;  // rounding
  return result;
}

std::vector<std::uint32_t> towards(const DividedMesh& mesh, int id) {
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < mesh.neighbor.size(); ++t) {
    if (mesh.neighbor[t] == id) triangles.push_back(t);
  }
  return triangles;
}

/// Of the determinant of sums over nodes by their number: less is that of nodes in one line.
constexpr double kLeastSpread = 1e-9;

/// The variance that a plane of a mean and a tilt leaves, of values at nodes.
class Residual {
 public:
  void add(const glm::dvec2& at, double value) {
    const glm::dvec3 x(1.0, at);
    normal_ += glm::outerProduct(x, x);
    right_ += value * x;
    squares_ += value * value;
    ++count_;
  }
  [[nodiscard]] std::size_t count() const { return count_; }

  /// The sum of the squares that are left.
  [[nodiscard]] double squares() const {
    const auto n = static_cast<double>(count_);
    if (!(glm::determinant(normal_) > kLeastSpread * n * n * n)) {  // nodes in one line: no tilt
      return std::max(0.0, squares_ - right_.x * right_.x / n);
    }
    return std::max(0.0, squares_ - glm::dot(right_, glm::inverse(normal_) * right_));
  }

 private:
  glm::dmat3 normal_{0.0};
  glm::dvec3 right_{0.0};
  double squares_ = 0.0;
  std::size_t count_ = 0;
};

/// The area of a contact where both sides have heights, over its plane, and their mean square
/// difference; world units squared.
struct ContactDifference {
  double area = 0.0;
  double meanSquare = 0.0;
};

ContactDifference differenceOf(const JointInput& in, std::size_t a, std::size_t b) {
  const TriangleMesh &one = *in.meshes[a].mesh, &two = *in.meshes[b].mesh;
  const std::vector<std::uint32_t> ofOne = towards(in.meshes[a], in.ids[b]),
                                   ofTwo = towards(in.meshes[b], in.ids[a]);
  if (ofOne.empty() || ofTwo.empty()) return {};
  const auto [plane, size, meanSquare] = contactPlane(one, ofOne);
  const double spacing = std::max(in.spacing, std::sqrt(size) / kMostNodesAcross);
  const glm::dvec3 axis =
      std::abs(plane.normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(axis, plane.normal));
  const auto first = heightsOver(one, ofOne, plane, u, spacing),
             second = heightsOver(two, ofTwo, plane, u, spacing);
  if (!first || !second) return {};
  const glm::dvec2 shift = first->low - second->low;
  const glm::dvec2 scale(std::max(first->across, 2) - 1, std::max(first->down, 2) - 1);
  Residual residual;
  for (int v = 0; v < first->down; ++v) {
    for (int k = 0; k < first->across; ++k) {
      const glm::dvec2 there = glm::dvec2(k, v) + shift;
      if (there.x < 0.0 || there.y < 0.0 || there.x >= second->across || there.y >= second->down) {
        continue;
      }
      const double apart =
          double{second->at(static_cast<int>(there.x), static_cast<int>(there.y))} -
          double{first->at(k, v)};
      if (!std::isnan(apart)) residual.add(glm::dvec2(k, v) / scale - 0.5, apart);
    }
  }
  if (residual.count() < kLeastNodes) return {};
  const auto nodes = static_cast<double>(residual.count());
  return {nodes * spacing * spacing, residual.squares() / (nodes - 3.0)};
}

std::optional<double> difference(const JointInput& in, const std::vector<double>& diagonal,
                                 const Progress* progress) {
  const auto& contacts = in.graph.contacts;
  std::vector<ContactDifference> found(contacts.size());
  tbb::parallel_for(std::size_t{0}, contacts.size(), [&](std::size_t k) {
    throwIfCancelled(progress);
    found[k] = differenceOf(in, contacts[k].first, contacts[k].second);
  });
  double area = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const double size = diagonal[contacts[k].first];
    area += found[k].area;
    sum += found[k].area * found[k].meanSquare / (size * size);
  }
  if (area == 0.0) return {};
  return std::sqrt(sum / area);
}

}  // namespace

std::optional<JointStatistics> jointsOf(const JointInput& input, const Progress* progress) {
  if (input.graph.contacts.empty()) return {};
  const std::map<int, std::size_t> indices = indicesOf(input.ids);
  const std::vector<double> diagonal = diagonals(input);
  std::vector<std::unique_ptr<MeshDistance>> distances(input.meshes.size());
  tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t i) {
    throwIfCancelled(progress);
    distances[i] = std::make_unique<MeshDistance>(*input.meshes[i].mesh);
  });
  std::vector<std::vector<GapSample>> found(input.meshes.size());
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
    found[i] = gapsOf(input, i, diagonal[i], indices, distances, progress);
  });
  std::vector<GapSample> samples;
  double deep = 0.0, open = 0.0, matched = 0.0, all = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    samples.insert(samples.end(), found[i].begin(), found[i].end());
    for (const GapSample& sample : found[i]) {
      deep += sample.isDeep ? sample.area : 0.0;
      open += sample.isFar && !sample.isDeep ? sample.area : 0.0;
      matched += sample.area;
    }
    all += input.meshes[i].area;
  }
  if (samples.empty()) return {};
  JointStatistics joints;
  joints.gap = quantilesOf(std::move(samples));
  joints.difference = difference(input, diagonal, progress);
  joints.deepShare = deep / all;
  if (input.knownNeighbors) joints.removed = open / matched;
  return joints;
}

}  // namespace sherd
