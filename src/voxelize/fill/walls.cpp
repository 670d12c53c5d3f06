// The wall thickness of a mesh, and the resolution that it needs.
//
// The wall at a sampled point is the length of a ray along the inward normal up to the exit:
//
//        point  normal
//     ─────┬───────▲─────         The ray continues through surfaces inside the solid, which
//          │ wall                 overlapping components have.  Samples inside the solid are
//     ─────┴─────────────         ignored.
//
// A wedge gets arbitrarily thin toward its edge, but loses almost no volume there.  So a thin wall
// counts with the greatest thickness found within four times its thickness: wedges of 14 degrees
// and more have no thin walls, plates and branches do.
#include "voxelize/fill/walls.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "base/infinity.h"
#include "mesh/surface_by_area.h"

namespace sherd {
namespace {

constexpr std::size_t kSamples = 2000;
constexpr double kThinnestShare = 0.01;
constexpr std::size_t kEveryForVolume = 4;  // one of so many samples is measured on all sides

// Edges and curves of walls thicker than this lose no volume; voxels of the coarsest automatic
// grid.
constexpr double kThickVoxels = 12.0;

// Voxelization cuts off edges and curves: it loses kCut * (1/ab + 1/bc + 1/ca) of the volume of a
// box of a, b and c voxels, measured on round and square bars of 2 to 6 voxels.
constexpr double kCut = 1.26;
constexpr double kCutShare = 0.02;

// Walls wider than kPlate times their thickness are plates, flat or bent, with negligible edges;
// bars longer than kBar times their thickness have negligible ends.
constexpr double kPlate = 3.0, kBar = 2.0;

constexpr double kOffset = 1e-3;   // voxels
constexpr int kMostSurfaces = 32;  // surfaces that a ray passes inside the solid
constexpr double kBesideWalls = 4.0;
constexpr double kThicker = 1.02;
constexpr int kMostSteps = 6;
constexpr std::size_t kDirections = 8;

class Walls {
 public:
  Walls(const TriangleTree& tree, double gridVoxels)
      : tree_(tree), thin_(kWholeWallVoxels * gridVoxels), thick_(kThickVoxels * gridVoxels) {}

  struct Wall {
    double thickness = kInfinity;
    double cut = 0.0;  // volume lost at edges and curves per area, 1 / voxels
  };

  // Returns the wall behind a sample; nullopt for a point that does not bound the solid.
  [[nodiscard]] std::optional<Wall> behind(const SurfaceSample& at, bool allSides) const {
    Wall wall{tree_.firstHit(at.point, -at.normal, kOffset), 0.0};
    const bool isThin = wall.thickness < thin_;
    if (!isThin && !(allSides && wall.thickness < thick_)) return wall;
    if (!isInside(at.point - kOffset * at.normal) || isInside(at.point + kOffset * at.normal)) {
      return std::nullopt;
    }
    wall.thickness = exit(at.point, -at.normal, wall.thickness);
    if (!(wall.thickness < (allSides ? thick_ : thin_))) return wall;
    const glm::dvec3 middle = at.point - 0.5 * wall.thickness * at.normal;
    const Directions beside = directionsIn(at);
    std::array<double, kDirections> reach{};
    for (std::size_t k = 0; k < kDirections; ++k) {
      reach[k] = tree_.firstHit(middle, beside[k], kOffset);
    }
    // Surfaces inside the solid can make a plate measure as a bar, but not a bar as a plate.
    if (allSides && cutOf(wall.thickness, reach) > 0.0) {
      for (std::size_t k = 0; k < kDirections; ++k) reach[k] = exit(middle, beside[k], reach[k]);
      wall.cut = cutOf(wall.thickness, reach);
    }
    if (wall.thickness < thin_) {
      wall.thickness = thickestBeside(middle, at.normal, wall.thickness, beside, reach);
    }
    return wall;
  }

 private:
  using Directions = std::array<glm::dvec3, kDirections>;

  [[nodiscard]] bool isInside(const glm::dvec3& point) const { return tree_.winding(point) >= 0.5; }

  // Returns the distance at which a ray leaves the solid; `hit` is that of its first surface.
  [[nodiscard]] double exit(const glm::dvec3& from, const glm::dvec3& along, double hit) const {
    for (int passed = 0; passed < kMostSurfaces && hit < thick_; ++passed) {
      if (!isInside(from + (hit + kOffset) * along)) break;
      hit = tree_.firstHit(from, along, hit + kOffset);
    }
    return hit;
  }

  // Returns unit vectors in the surface; k and k + kDirections / 2 are opposite.
  [[nodiscard]] static Directions directionsIn(const SurfaceSample& at) {
    const glm::dvec3 u = at.tangent, v = glm::cross(at.normal, u);
    Directions out;
    for (std::size_t k = 0; k < kDirections; ++k) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / kDirections;
      out[k] = std::cos(angle) * u + std::sin(angle) * v;
    }
    return out;
  }

  // Returns the loss of a box with the wall's thickness, its least width, and the width across
  // that.
  [[nodiscard]] static double cutOf(double thickness,
                                    const std::array<double, kDirections>& reach) {
    constexpr std::size_t kHalf = kDirections / 2;
    const auto width = [&](std::size_t k) { return reach[k % kHalf] + reach[k % kHalf + kHalf]; };
    std::size_t narrowest = 0;
    for (std::size_t k = 1; k < kHalf; ++k) {
      if (width(k) < width(narrowest)) narrowest = k;
    }
    const double across = width(narrowest), along = width(narrowest + kHalf / 2);
    if (across > kPlate * thickness) return 0.0;
    const double a = 1.0 / thickness, b = 1.0 / across,
                 c = along > kBar * thickness ? 0.0 : 1.0 / along;
    return 0.5 * kCut * (a * b + b * c + c * a) / (a + b + c);
  }

  // Steps to thicker walls nearby, as long as there are any.
  [[nodiscard]] double thickestBeside(const glm::dvec3& middle, const glm::dvec3& normal,
                                      double thickness, const Directions& beside,
                                      const std::array<double, kDirections>& reach) const {
    double thickest = thickness;
    for (int step = 0; step < kMostSteps && thickest < thin_; ++step) {
      const double away = kBesideWalls * thickest;
      double found = thickest;
      for (std::size_t k = 0; k < kDirections; ++k) {
        if (!(reach[k] > away)) continue;
        const glm::dvec3 there = middle + away * beside[k];
        found = std::max(found,
                         tree_.firstHit(there, normal, 0.0) + tree_.firstHit(there, -normal, 0.0));
      }
      if (!(found > kThicker * thickest)) break;
      thickest = found;
    }
    return thickest;
  }

  const TriangleTree& tree_;
  double thin_, thick_;
};

int resolutionOf(double voxels) {
  constexpr double kMost = 1e9, kRounding = 1e-6;
  return static_cast<int>(std::ceil(std::clamp(voxels, 0.0, kMost) * (1.0 - kRounding)));
}

}  // namespace

std::vector<SurfaceSample> surfaceSamples(const TriangleMesh& mesh, std::size_t count,
                                          bool scattered) {
  // Two irrational numbers that fill a square evenly.
  // source  Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018
  constexpr double kU = 0.7548776662466927, kV = 0.5698402909980532;
  std::vector<SurfaceSample> out;
  if (!(area(mesh) > 0.0)) return out;
  const SurfaceByArea surface(mesh);
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<double>(i);
    const std::size_t t = surface.triangleAt((n + 0.5) / static_cast<double>(count));
    const double u = scattered ? std::fmod(0.5 + n * kU, 1.0) : 4.0 / 9.0;
    const double v = scattered ? std::fmod(0.5 + n * kV, 1.0) : 0.5;
    const SurfaceTriangle triangle = surface.at(t);
    const glm::dvec3 edge = triangle.corner[1] - triangle.corner[0];
    out.push_back({triangle.pointIn(u, v), triangle.normal(), glm::normalize(edge)});
  }
  return out;
}

WallThickness wallThickness(const SearchedMesh& mesh, double longestSideVoxels, double meshVolume) {
  const std::vector<SurfaceSample> samples = surfaceSamples(mesh.mesh, kSamples, true);
  const Walls walls(*mesh.tree, longestSideVoxels / kLeastAutoResolution);
  std::vector<std::optional<Walls::Wall>> found(samples.size());
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
    found[i] = walls.behind(samples[i], i % kEveryForVolume == 0);
  });
  WallThickness out;
  std::vector<double> thickness;
  double cut = 0.0;
  for (const std::optional<Walls::Wall>& wall : found) {
    if (!wall) continue;
    thickness.push_back(wall->thickness);
    cut += wall->cut;
  }
  if (thickness.empty()) return out;
  std::sort(thickness.begin(), thickness.end());
  const auto thin = std::lower_bound(thickness.begin(), thickness.end(), 1.0) - thickness.begin();
  out.thinShare = static_cast<double>(thin) / static_cast<double>(thickness.size());
  out.thinnest =
      thickness[static_cast<std::size_t>(kThinnestShare * static_cast<double>(thickness.size()))];
  if (std::isfinite(out.thinnest) && out.thinnest > 0.0) {
    out.forWalls = resolutionOf(kWholeWallVoxels * longestSideVoxels / out.thinnest);
  }
  if (meshVolume > 0.0) {
    const double measured = static_cast<double>(samples.size()) / kEveryForVolume;
    const double share = cut / measured * area(mesh.mesh) / meshVolume;
    out.forVolume = resolutionOf(longestSideVoxels * std::sqrt(share / kCutShare));
  }
  const int needed = std::max(out.forWalls, out.forVolume);
  if (needed > longestSideVoxels) out.resolution = needed;
  return out;
}

int automaticResolutionOf(const WallThickness& walls) {
  constexpr int kStep = 8;
  const int needed = std::min(std::max(walls.forWalls, walls.forVolume), kMostAutoResolution);
  return std::max((needed + kStep - 1) / kStep * kStep, kLeastAutoResolution);
}

}  // namespace sherd
