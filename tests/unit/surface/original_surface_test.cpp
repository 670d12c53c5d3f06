// Where the fragments' original surface lies, against the shapes' own equations.
#include <gtest/gtest.h>
#include <sherd/fracture.h>
#include <sherd/mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <numeric>
#include <span>

#include "base/random.h"
#include "contact_boundaries.h"
#include "kernels/device_fixture.h"
#include "shapes.h"

namespace sherd {
namespace {

// The distance to a polygon of the half plane (r, z), r >= 0.
double distanceToSection(const glm::dvec2& at, std::span<const glm::dvec2> section) {
  double least = 1e300;
  for (std::size_t k = 0; k + 1 < section.size(); ++k) {
    const glm::dvec2 along = section[k + 1] - section[k];
    const double t =
        std::clamp(glm::dot(at - section[k], along) / glm::dot(along, along), 0.0, 1.0);
    least = std::min(least, glm::length(at - section[k] - t * along));
  }
  return least;
}

struct Shape {
  const char* name;
  TriangleMesh mesh;
  std::function<double(const glm::dvec3&)> toSurface;
  std::function<double(const glm::dvec3&)> toEdge;  // where faces of the shape meet at an angle
  double curvature;  // the largest k1 + k2, per unit length; 0 where it has edges
};

std::vector<Shape> shapesOfTheTest() {
  const auto noEdge = [](const glm::dvec3&) { return 1e300; };
  const auto polar = [](const glm::dvec3& p) { return glm::dvec2(std::hypot(p.x, p.y), p.z); };
  std::vector<Shape> all;
  all.push_back({"ball", shapes::ball(1.0, 7),
                 [](const glm::dvec3& p) { return std::abs(glm::length(p) - 1.0); }, noEdge, 2.0});
  all.push_back({"torus", shapes::torus(1.0, 0.4, 800, 320),
                 [=](const glm::dvec3& p) {
                   return std::abs(glm::length(polar(p) - glm::dvec2(1.0, 0.0)) - 0.4);
                 },
                 noEdge, 1 / 0.4 + 1 / 1.4});
  all.push_back({"cube", shapes::cube(2.0),
                 [](const glm::dvec3& p) {
                   const glm::dvec3 d = glm::abs(p) - 1.0;
                   const double outside = glm::length(glm::max(d, glm::dvec3(0.0)));
                   return std::abs(outside + std::min(0.0, std::max({d.x, d.y, d.z})));
                 },
                 [](const glm::dvec3& p) {
                   std::array<double, 3> d;
                   for (int k = 0; k < 3; ++k)
                     d[static_cast<std::size_t>(k)] = std::abs(std::abs(p[k]) - 1.0);
                   std::sort(d.begin(), d.end());
                   return std::hypot(d[0], d[1]);
                 },
                 0.0});
  static const std::vector<glm::dvec2> section{{0, 0},      {1, 0},       {1, 1.5},
                                               {0.75, 1.5}, {0.75, 0.25}, {0, 0.25}};
  all.push_back({"cup", shapes::cup(1.0, 0.25, 1.5, 0.25, 1200),
                 [=](const glm::dvec3& p) { return distanceToSection(polar(p), section); },
                 [=](const glm::dvec3& p) {
                   double least = 1e300;
                   for (std::size_t k = 1; k + 1 < section.size(); ++k) {
                     least = std::min(least, glm::length(polar(p) - section[k]));
                   }
                   return least;
                 },
                 0.0});
  return all;
}

// Turned and shifted at random.
class Placed {
 public:
  explicit Placed(std::uint64_t seed) {
    std::array<double, 7> draw{};
    for (std::size_t i = 0; i < draw.size(); ++i) {
      draw[i] = static_cast<double>(mixed(seed * 1000 + i) >> 11) * 0x1p-53;
    }
    const glm::dvec3 axis = glm::normalize(glm::dvec3(draw[0], draw[1], draw[2]) - 0.5);
    turn_ = glm::mat3_cast(glm::angleAxis(6.28 * draw[3], axis));
    shift_ = {draw[4], draw[5], draw[6]};
  }

  TriangleMesh of(TriangleMesh mesh) const {
    for (glm::dvec3& v : mesh.vertices) v = turn_ * v + shift_;
    return mesh;
  }
  glm::dvec3 back(const glm::dvec3& v) const { return glm::transpose(turn_) * (v - shift_); }

 private:
  glm::dmat3 turn_;
  glm::dvec3 shift_;
};

struct Errors {
  std::vector<double> anywhere;  // voxels, ascending
  std::vector<double> away;      // of vertices farther than a voxel from rims and edges
  double mean = 0.0;             // anywhere
};

// How far vertices of faces that face nothing are from the shape.
Errors errorsOf(const FractureResult& result, const Shape& shape, const Placed& placed) {
  const double h = result.solid.frame.voxelSize;
  Errors errors;
  for (const Fragment& fragment : result.fragments) {
    const Boundary boundary(fragment, h);
    std::vector<bool> original(fragment.mesh.vertices.size());
    for (std::size_t t = 0; t < fragment.mesh.neighbor.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (fragment.mesh.neighbor[t] == 0) original[fragment.mesh.triangles[t][k]] = true;
      }
    }
    for (std::size_t v = 0; v < original.size(); ++v) {
      if (!original[v]) continue;
      const glm::dvec3& world = fragment.mesh.vertices[v];
      const glm::dvec3 at = placed.back(world);
      errors.anywhere.push_back(shape.toSurface(at) / h);
      if (shape.toEdge(at) > h && !boundary.isWithin(1.0, world)) {
        errors.away.push_back(errors.anywhere.back());
      }
    }
  }
  std::sort(errors.anywhere.begin(), errors.anywhere.end());
  std::sort(errors.away.begin(), errors.away.end());
  errors.mean = std::accumulate(errors.anywhere.begin(), errors.anywhere.end(), 0.0) /
                static_cast<double>(errors.anywhere.size());
  return errors;
}

using OriginalSurface = DeviceTest;

TEST_F(OriginalSurface, LiesWhereTheShapeHasIt) {
  for (const Shape& shape : shapesOfTheTest()) {
    for (const int pieces : {2, 5, 20}) {
      SCOPED_TRACE(testing::Message() << shape.name << " in " << pieces);
      const Placed placed(static_cast<std::uint64_t>(pieces));
      FractureOptions options{.pieces = pieces, .seed = 3, .solid = {.resolution = 128}};
      options.surface.adaptivity = 0.0;  // vertices in planes, too
      const FractureResult result = fracture(placed.of(shape.mesh), options, device());
      const Errors errors = errorsOf(result, shape, placed);
      ASSERT_GT(errors.away.size(), 1000u);
      EXPECT_LT(errors.mean, shape.curvature > 0.0
                                 ? 0.15 * shape.curvature * result.solid.frame.voxelSize
                                 : 0.02);
      EXPECT_LT(errors.away[errors.away.size() * 99 / 100], 0.05);
      EXPECT_LT(errors.anywhere.back(), 0.75);

      double volumes = 0.0;
      for (const Fragment& fragment : result.fragments) volumes += volume(fragment.mesh);
      const double whole = volume(solidMesh(result.solid));
      EXPECT_NEAR(volumes, whole, (pieces <= 10 ? 0.0025 : 0.005) * whole);
    }
  }
}

// A face is of the original surface where that is nearer than the crack, the plane half way to the
// nearest other seed.  Within half a voxel of the rim both are near, so these are left out; and
// 0.4 more, by which the mesh rounds the cup's own edges, where the rim of a crack crosses them.
TEST_F(OriginalSurface, IsToldFromCracksOnAThinCup) {
  constexpr double kWall = 0.046875;  // 3 voxels
  const std::array<glm::dvec2, 6> section{
      {{0, 0}, {1, 0}, {1, 1.5}, {1 - kWall, 1.5}, {1 - kWall, kWall}, {0, kWall}}};
  const FractureResult result =
      fracture(shapes::cup(1.0, kWall, 1.5, kWall, 512),
               {.pieces = 8, .seed = 2, .solid = {.resolution = 128}}, device());
  const double h = result.solid.frame.voxelSize;
  const auto seedOf = [&](int id) {
    return result.solid.frame.worldFromIndex(
        pointOf(result.seeds.at(static_cast<std::size_t>(id) - 1)));
  };
  std::size_t faces = 0, cracks = 0, wrong = 0, wrongByDistance = 0;
  for (const Fragment& fragment : result.fragments) {
    const Boundary boundary(fragment, h);
    const glm::dvec3 own = seedOf(fragment.id);
    for (std::size_t t = 0; t < fragment.mesh.neighbor.size(); ++t) {
      const glm::uvec3& corner = fragment.mesh.triangles[t];
      const glm::dvec3 center =
          (fragment.mesh.vertices[corner.x] + fragment.mesh.vertices[corner.y] +
           fragment.mesh.vertices[corner.z]) /
          3.0;
      if (boundary.isWithin(0.9, center)) continue;
      double toCrack = 1e300;
      for (const Fragment& other : result.fragments) {
        if (other.id == fragment.id) continue;
        const glm::dvec3 there = seedOf(other.id);
        toCrack = std::min(
            toCrack, std::abs(glm::dot(center - 0.5 * (own + there), glm::normalize(there - own))));
      }
      const double toCup = distanceToSection({std::hypot(center.x, center.y), center.z}, section);
      if (std::abs(toCup - toCrack) < 0.1 * h) continue;  // each lies within 0.05 voxel
      const bool isOriginal = toCup < toCrack;
      ++faces;
      cracks += !isOriginal;
      wrong += isOriginal != (fragment.mesh.neighbor[t] == 0);
      wrongByDistance += !isOriginal && toCup < 0.025 * 2.0;
    }
  }
  EXPECT_GT(cracks, 500u);
  EXPECT_EQ(wrong, 0u) << "of " << faces << " faces, " << cracks << " of them of cracks";
  // What labels by distance, with 0.025 of the box as threshold, would make of the cracks.
  EXPECT_GT(3 * wrongByDistance, cracks);
}

TEST_F(OriginalSurface, ABallsCrackEndsInACircle) {
  const FractureResult result = fracture(
      shapes::ball(1.0, 6), {.pieces = 2, .seed = 3, .solid = {.resolution = 128}}, device());
  const double h = result.solid.frame.voxelSize;
  const auto seedOf = [&](std::size_t i) {
    const openvdb::Coord& c = result.seeds.at(i).voxel;
    return result.solid.frame.worldFromIndex(c);
  };
  const glm::dvec3 between = (seedOf(0) + seedOf(1)) / 2.0;
  const glm::dvec3 normal = glm::normalize(seedOf(1) - seedOf(0));
  const double offset = glm::dot(between, normal);  // of the crack's plane from the center
  const double radius = std::sqrt(1.0 - offset * offset);
  for (const Fragment& fragment : result.fragments) {
    const auto boundaries = boundaryLoops(fragment);
    ASSERT_EQ(boundaries.size(), 1u);
    const auto& curves = boundaries.at(3 - fragment.id);
    ASSERT_EQ(curves.size(), 1u);
    double length = 0.0;
    glm::dvec3 enclosed(0.0);  // twice the area, along the normal of a curve walked left about it
    for (std::size_t i = 0; i < curves[0].size(); ++i) {
      const glm::dvec3& a = fragment.mesh.vertices[curves[0][i]];
      const glm::dvec3& b = fragment.mesh.vertices[curves[0][(i + 1) % curves[0].size()]];
      EXPECT_NEAR(glm::length(a), 1.0, 0.75 * h);
      length += glm::length(b - a);
      enclosed += glm::cross(a, b);
    }
    EXPECT_NEAR(length, 2.0 * M_PI * radius, 0.03 * length);
    const double sign = fragment.id == 1 ? 1.0 : -1.0;
    EXPECT_NEAR(sign * glm::dot(enclosed, normal) / 2.0, M_PI * radius * radius, 0.02);
  }
}

// The area of a plane's section of a box about the origin: its corners on the box's edges, in turn.
double sectionOfBox(const glm::dvec3& half, const glm::dvec3& normal, double offset) {
  std::vector<glm::dvec3> corners;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sides : {0, 1, 2, 3}) {
      glm::dvec3 p;
      p[(axis + 1) % 3] = (sides & 1 ? 1 : -1) * half[(axis + 1) % 3];
      p[(axis + 2) % 3] = (sides & 2 ? 1 : -1) * half[(axis + 2) % 3];
      p[axis] = 0.0;
      p[axis] = (offset - glm::dot(p, normal)) / normal[axis];
      if (std::abs(p[axis]) <= half[axis]) corners.push_back(p);
    }
  }
  glm::dvec3 middle(0.0), doubled(0.0);
  for (const glm::dvec3& p : corners) middle += p / static_cast<double>(corners.size());
  const glm::dvec3 u = glm::normalize(corners.at(0) - middle), v = glm::cross(normal, u);
  std::sort(corners.begin(), corners.end(), [&](const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::dot(a - middle, v), glm::dot(a - middle, u)) <
           std::atan2(glm::dot(b - middle, v), glm::dot(b - middle, u));
  });
  for (std::size_t i = 0; i < corners.size(); ++i) {
    doubled += glm::cross(corners[i], corners[(i + 1) % corners.size()]);
  }
  return glm::length(doubled) / 2.0;
}

TEST_F(OriginalSurface, ThinContactsHaveTheAreaOfTheirPlanes) {
  // A plate three voxels thick, where contacts are 3 wide and some 60 long.
  const glm::dvec3 half(0.5, 0.5, 1.5 / 64);
  TriangleMesh plate = shapes::cube(2.0);
  for (glm::dvec3& v : plate.vertices) v *= half;
  // (Seed 6 draws two points that lie 1.6 voxels apart, nearly above each other.)
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 7}) {
    SCOPED_TRACE(seed);
    const Placed placed(seed);
    const FractureResult result = fracture(
        placed.of(plate), {.pieces = 2, .seed = seed, .solid = {.voxelSize = 1.0 / 64}}, device());
    const auto seedOf = [&](std::size_t i) {
      return placed.back(result.solid.frame.worldFromIndex(pointOf(result.seeds.at(i))));
    };
    const glm::dvec3 normal = glm::normalize(seedOf(1) - seedOf(0));
    const double area = sectionOfBox(half, normal, glm::dot((seedOf(0) + seedOf(1)) / 2.0, normal));
    ASSERT_EQ(result.labels.disconnected.at(0), 0u);  // else the crack is no plane
    ASSERT_EQ(result.fragments[0].contacts.size(), 1u);
    EXPECT_NEAR(result.fragments[0].contacts[0].area, area, 0.03 * area);
    EXPECT_NEAR(result.fragments[1].contacts[0].area, result.fragments[0].contacts[0].area,
                1e-12 * area);
  }
}

TEST_F(OriginalSurface, CracksBetweenTwoSeedsArePlanes) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    for (const double strength : {0.0, 2.0}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", grain " << strength);
      const Anisotropy anisotropy{{1, 2, -1}, strength};
      const FractureResult result = fracture(shapes::ball(1.0, 6),
                                             {.pieces = 2,
                                              .seed = seed,
                                              .solid = {.resolution = 96},
                                              .grow = {.anisotropy = anisotropy}},
                                             device());
      const GridFrame& frame = result.solid.frame;
      // Half way between the seeds, all lengths along the grain divided by 1 + strength; growth
      // measures by a matrix of 64ths.
      const glm::dvec3 g = glm::normalize(anisotropy.direction);
      const glm::dmat3 stretching =
          glm::dmat3(1.0) - (1.0 - 1.0 / (1.0 + strength)) * glm::outerProduct(g, g);
      glm::dmat3 rounded(0.0);
      for (int k = 0; k < 3; ++k) rounded[k] = glm::round(64.0 * stretching[k]) / 64.0;
      const glm::dvec3 a = pointOf(result.seeds.at(0)), b = pointOf(result.seeds.at(1));
      const glm::dvec3 normal = glm::normalize(rounded * (rounded * (b - a)));
      const Fragment& fragment = result.fragments[0];
      const Boundary boundary(fragment, frame.voxelSize);
      std::vector<double> inner, boundaries;
      for (std::size_t t = 0; t < fragment.mesh.neighbor.size(); ++t) {
        if (fragment.mesh.neighbor[t] == 0) continue;
        for (int k = 0; k < 3; ++k) {
          const glm::dvec3& v = fragment.mesh.vertices[fragment.mesh.triangles[t][k]];
          const double off = glm::dot(frame.indexFromWorld(v) - 0.5 * (a + b), normal);
          (boundary.isWithin(1.0, v) ? boundaries : inner).push_back(off * off);
        }
      }
      ASSERT_GT(inner.size(), 1000u);
      const auto rms = [](const std::vector<double>& squares) {
        return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) /
                         static_cast<double>(squares.size()));
      };
      // A voxel's center keeps a twentieth of a voxel from the cut (Cut::kLeastDepth).
      EXPECT_LT(rms(inner), 0.05);
      EXPECT_LT(*std::max_element(inner.begin(), inner.end()), 0.5 * 0.5);
      EXPECT_LT(rms(boundaries), 0.15);
    }
  }
}

}  // namespace
}  // namespace sherd
