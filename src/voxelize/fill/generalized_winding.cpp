// The generalized winding number of any mesh at voxel centers.
#include "voxelize/fill/generalized_winding.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <utility>

#include "base/cancel_flag.h"
#include "mesh/edges.h"
#include "mesh/joined.h"

namespace sherd {

namespace {

// Columns and solid angles must agree on the side of a cap that a center is on: both use vertices
// snapped to the lattice of the columns, and kTie moves centers as the columns break ties.
TriangleMesh onLattice(TriangleMesh caps, const Box& box) {
  const int bits = Winding::latticeBits(box);
  for (glm::dvec3& v : caps.vertices) {
    v.x = std::ldexp(static_cast<double>(std::llround(std::ldexp(v.x, bits))), -bits);
    v.y = std::ldexp(static_cast<double>(std::llround(std::ldexp(v.y, bits))), -bits);
  }
  return caps;
}
constexpr glm::dvec3 kTie(1e-10, 1e-11, Winding::kTieAlongZ);

// Returns how far centers are moved from which steps go to points.  The columns snap vertices along
// x and y, and break ties as kTie does; steps know the vertices as they are.  A vertex within half
// a lattice step of a center snaps onto it, so half a step leaves it on the side where it snaps to.
// Faces are often at centers.
glm::dvec3 tieOf(const Box& box) {
  const double step = std::ldexp(1.0, -Winding::latticeBits(box));
  return {0.5 * step, 0.499 * step, kTie.z};
}

// A bound of the change of the winding number over a voxel, farther than kNearBoundary from all
// boundaries of holes.
constexpr double kChange = 0.3;

// At the center of the voxel nearest to a point that isFarFromHoles().
constexpr double kSmallWinding = 0.25;

// Whether no number that winding numbers of caps are compared with lies between two: these are
// levels plus a whole number.
bool areTogether(double a, double b) {
  constexpr std::array<double, 5> kLevels{0.5 - kChange, kSmallWinding, 0.5, 1.0 - kSmallWinding,
                                          0.5 + kChange};
  return std::all_of(kLevels.begin(), kLevels.end(),
                     [&](double level) { return std::floor(a - level) == std::floor(b - level); });
}

openvdb::Coord nearestVoxel(const glm::dvec3& point) {
  return {static_cast<int>(std::lround(point.x)), static_cast<int>(std::lround(point.y)),
          static_cast<int>(std::lround(point.z))};
}

glm::dvec3 centerOf(const openvdb::Coord& voxel) { return {voxel.x(), voxel.y(), voxel.z()}; }

// Removes caps without area.  Their solid angles are negligible, and meshes in which vertices lie
// on the edges of other triangles have thousands.
TriangleMesh withArea(TriangleMesh caps) {
  constexpr double kLeastArea = 1e-4;  // square voxels
  std::erase_if(caps.triangles, [&](const glm::uvec3& t) {
    const glm::dvec3& a = caps.vertices[t.x];
    return glm::length(glm::cross(caps.vertices[t.y] - a, caps.vertices[t.z] - a)) <
           2.0 * kLeastArea;
  });
  return caps;
}

// Returns the edges that belong to a single triangle, each as a degenerate triangle.
TriangleMesh boundariesOf(const TriangleMesh& caps) {
  TriangleMesh boundaries{caps.vertices, {}};
  forEachEdge(caps, [&](const EdgeUse& edge) {
    if (edge.forward + edge.backward == 1)
      boundaries.triangles.emplace_back(edge.low, edge.high, edge.high);
  });
  return boundaries;
}

}  // namespace

GeneralizedWinding::GeneralizedWinding(const TriangleMesh& mesh, const TriangleMesh& caps,
                                       std::shared_ptr<const TriangleTree> tree,
                                       const Progress* progress, std::uint64_t most)
    : tie_(tieOf(bounds(mesh))),
      caps_(onLattice(caps, bounds(mesh))),
      capTree_(withArea(caps_)),
      boundaryTree_(boundariesOf(withArea(caps_))),
      columns_(caps_.triangles.empty()
                   ? Winding(mesh, Winding::Rule::signedCrossings, progress)
                   : Winding(joined(mesh, caps_), Winding::Rule::signedCrossings, progress)),
      tree_(std::move(tree)),
      work_(caps_.triangles.empty() ? WorkLimit::kNone : most) {
  if (!isSimple()) markOdd(progress);
}

bool GeneralizedWinding::isSteady(const glm::dvec3& point, double winding) const {
  constexpr double kNearBoundary = 1.2;  // voxels
  if (boundaryTree_.empty()) return true;
  return std::abs(winding - 0.5) > kChange &&
         !std::isfinite(boundaryTree_.nearest(point, kNearBoundary).distance);
}

openvdb::Coord GeneralizedWinding::oddDims() const {
  const openvdb::Coord dims = columns_.box().dims();
  return {dims.x() / kOddSide + 1, dims.y() / kOddSide + 1, dims.z() / kOddSide + 1};
}

void GeneralizedWinding::markOdd(const Progress* progress) {
  constexpr std::size_t kRunsPerCancelCheck = 1024;
  std::size_t runs = 0;
  const openvdb::Coord dims = oddDims(), min = columns_.box().min;
  const auto size = [](int v) { return static_cast<std::size_t>(v); };
  odd_.assign(size(dims.x()) * size(dims.y()) * size(dims.z()), false);
  columns_.forEachRun([&](int x, int y, int z, int end, int winding) {
    if (++runs % kRunsPerCancelCheck == 0) throwIfCancelled(progress);
    if (winding == 1) return;
    const std::size_t column =
        (size((x - min.x()) / kOddSide) * size(dims.y()) + size((y - min.y()) / kOddSide)) *
        size(dims.z());
    for (int k = (z - min.z()) / kOddSide; k <= (end - 1 - min.z()) / kOddSide; ++k) {
      odd_[column + size(k)] = true;
    }
  });
}

double GeneralizedWinding::capsAt(const openvdb::Coord& voxel) const {
  return capTree_.winding(centerOf(voxel) + kTie);
}

// The numbers of the voxels that were asked for.
struct GeneralizedWinding::CapsInCube {
  static constexpr int kSide = 8;
  static constexpr double kMiddle = 0.5 * (kSide - 1);
  CapsInCube(const TriangleTree& caps, const openvdb::Coord& low)
      : around(caps, centerOf(low) + kMiddle, kMiddle * std::numbers::sqrt3 + glm::length(kTie)) {
    for (std::atomic<double>& number : numbers)
      number.store(std::numeric_limits<double>::quiet_NaN(), std::memory_order_relaxed);
  }
  TriangleTree::WindingInBall around;
  std::array<std::atomic<double>, kSide * kSide * kSide> numbers;  // NaN until computed
};

GeneralizedWinding::~GeneralizedWinding() = default;

double GeneralizedWinding::capsNear(const openvdb::Coord& voxel) const {
  if (capTree_.empty()) return 0.0;
  constexpr int kSide = CapsInCube::kSide;
  const openvdb::Coord low(voxel.x() & -kSide, voxel.y() & -kSide, voxel.z() & -kSide);
  auto cube = cubes_.find(low);
  if (cube == cubes_.end())
    cube = cubes_.emplace(low, std::make_unique<CapsInCube>(capTree_, low)).first;
  const openvdb::Coord at = voxel - low;
  std::atomic<double>& number =
      cube->second->numbers[static_cast<std::size_t>((at.x() * kSide + at.y()) * kSide + at.z())];
  double winding = number.load(std::memory_order_relaxed);
  if (!std::isnan(winding)) return winding;
  const TriangleTree::WindingInBall& around = cube->second->around;
  winding = around.at(centerOf(voxel) + kTie);
  if (!areTogether(winding - around.error(), winding + around.error())) winding = capsAt(voxel);
  // Threads may compute one number at the same time: it counts once.
  if (std::isnan(number.exchange(winding, std::memory_order_relaxed))) work_.add(around.terms());
  return winding;
}

bool GeneralizedWinding::isFarFromHoles(std::span<const glm::dvec3> samples, double size) const {
  // At a distance r from a straight boundary the winding number changes by 1 / (2 pi r) per voxel,
  // and no point of a triangle is farther than a third of its longest edge from the nearest sample.
  // So only a boundary within 0.2 longest edges can change kSmallWinding to 0.5; the limit is 0.5
  // because boundaries have corners.
  constexpr double kNearBoundary = 0.5;
  constexpr double kFromCenter = 2.0 / 3.0;  // to the farthest corner, in longest edges
  if (boundaryTree_.empty()) return true;
  const double reach = (kFromCenter + kNearBoundary) * size;
  if (std::isfinite(boundaryTree_.nearest(samples.front(), reach).distance)) return false;
  return std::all_of(samples.begin(), samples.end(), [&](const glm::dvec3& sample) {
    return std::abs(capsNear(nearestVoxel(sample))) < kSmallWinding;
  });
}

bool GeneralizedWinding::isPlain(const Box& box, std::span<const glm::dvec3> samples,
                                 double size) const {
  constexpr double kAround = 2.0;
  const openvdb::Coord dims = oddDims(), min = columns_.box().min;
  openvdb::Coord low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cube = [&](double v) {
      const int at = static_cast<int>(std::floor((v - min[axis]) / kOddSide));
      return std::clamp(at, 0, dims[axis] - 1);
    };
    low[axis] = cube(box.min[axis] - kAround);
    high[axis] = cube(box.max[axis] + kAround);
  }
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) {
        if (odd_[(static_cast<std::size_t>(x) * static_cast<std::size_t>(dims.y()) +
                  static_cast<std::size_t>(y)) *
                     static_cast<std::size_t>(dims.z()) +
                 static_cast<std::size_t>(z)]) {
          return false;
        }
      }
    }
  }
  return isFarFromHoles(samples, size);
}

double GeneralizedWinding::at(const openvdb::Coord& voxel) const {
  return columns_.at(voxel) - capsAt(voxel);
}

double GeneralizedWinding::near(const glm::dvec3& point) const { return near(point, point); }

double GeneralizedWinding::near(const glm::dvec3& point, const glm::dvec3& from) const {
  const openvdb::Coord voxel = nearestVoxel(from);
  return near(voxel) + tree_->entries(centerOf(voxel) + tie_, point + tie_);
}

double GeneralizedWinding::near(const glm::dvec3& point,
                                std::span<const std::uint32_t> around) const {
  const openvdb::Coord voxel = nearestVoxel(point);
  return near(voxel) + tree_->entries(centerOf(voxel) + tie_, point + tie_, around);
}

}  // namespace sherd
