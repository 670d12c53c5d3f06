// The look of a mesh on surfaces near it, where it is known at every point.
#include <gtest/gtest.h>
#include <sherd/mesh.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <set>

#include "appearance/transfer.h"
#include "mesh/attributes/charts.h"
#include "shapes.h"

namespace sherd {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<std::uint16_t> allOriginal(const TriangleMesh& mesh) {
  return std::vector<std::uint16_t>(mesh.triangles.size(), 0);
}

// A color that is linear in the place: what lies between corners is what the function says.
glm::dvec3 colorAt(const glm::dvec3& p) { return 127.0 + 100.0 * p; }

SurfaceAttributes colored(const TriangleMesh& mesh) {
  SurfaceAttributes look;
  for (const glm::uvec3& t : mesh.triangles) {
    auto& corners = look.colors.emplace_back();
    for (int k = 0; k < 3; ++k) {
      corners[static_cast<std::size_t>(k)] = glm::u8vec3(colorAt(mesh.vertices[t[k]]) + 0.5);
    }
  }
  return look;
}

TEST(Appearance, ColorsAreThoseOfTheNearestPlace) {
  TriangleMesh input = shapes::ball(1.0, 4);
  TriangleMesh output = shapes::ball(1.0, 5);
  for (glm::dvec3& v : output.vertices) v = {v.y, -v.z, v.x};  // other triangles
  input.attributes = colored(input);
  std::vector<std::uint16_t> neighbor = allOriginal(output);
  for (std::size_t t = 0; t < neighbor.size(); t += 7) neighbor[t] = 3;
  const SurfaceAttributes found =
      AttributeSource(input).transferTo(shapes::withNeighbor(output, neighbor), 0);
  EXPECT_TRUE(found.texcoords.empty());
  EXPECT_TRUE(found.material.empty());
  ASSERT_EQ(found.colors.size(), output.triangles.size());
  // The input's triangles are up to 0.0013 below the ball; both roundings are half a step.
  const double most = 100.0 * 0.0014 + 1.0;
  for (std::size_t t = 0; t < neighbor.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 color(found.colors[t][static_cast<std::size_t>(k)]);
      const glm::dvec3 expected = colorAt(output.vertices[output.triangles[t][k]]);
      if (neighbor[t] != 0) {
        EXPECT_EQ(color, glm::dvec3(kInsideColor));
      } else {
        const glm::dvec3 apart = glm::abs(color - expected);
        EXPECT_LE(std::max({apart.x, apart.y, apart.z}), most);
      }
    }
  }
}

TEST(Appearance, MovingAndScalingChangesNothing) {
  TriangleMesh input = shapes::ball(1.0, 3);
  const TriangleMesh output = shapes::ball(1.01, 4);
  input.attributes = colored(input);
  const SurfaceAttributes here = AttributeSource(input).transferTo(output, 0);
  const auto seenAt = [&](double scale, const glm::dvec3& offset) {
    const TriangleMesh there = shapes::transformed(output, scale, offset);
    return AttributeSource(shapes::transformed(input, scale, offset)).transferTo(there, 0).colors;
  };
  EXPECT_EQ(seenAt(64.0, glm::dvec3(0.0)), here.colors);
  // The move rounds, so a color half-way between two steps may go to either.
  const auto moved = seenAt(1.0, {4096.0, -8192.0, 1024.0});
  for (std::size_t t = 0; t < moved.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::ivec3 apart = glm::abs(glm::ivec3(moved[t][k]) - glm::ivec3(here.colors[t][k]));
      EXPECT_LE(std::max({apart.x, apart.y, apart.z}), 1);
    }
  }
}

// A tube's outside, open at both ends: u once round, v along it.  Vertices are shared, so the seam
// is in the texture coordinates only.
TriangleMesh tube(double radius, int segments, int rings, double turned) {
  TriangleMesh out;
  for (int j = 0; j <= rings; ++j) {
    for (int i = 0; i < segments; ++i) {
      const double angle = 2.0 * kPi * (i + turned) / segments;
      out.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                                2.0 * j / rings);
    }
  }
  const auto vertex = [&](int i, int j) {
    return static_cast<std::uint32_t>(j * segments + i % segments);
  };
  const auto texcoord = [&](int i, int j) {
    return glm::vec2(static_cast<float>(i) / static_cast<float>(segments),
                     static_cast<float>(j) / static_cast<float>(rings));
  };
  for (int j = 0; j < rings; ++j) {
    for (int i = 0; i < segments; ++i) {
      out.triangles.emplace_back(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1));
      out.attributes.texcoords.push_back(
          {texcoord(i, j), texcoord(i + 1, j), texcoord(i + 1, j + 1)});
      out.triangles.emplace_back(vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1));
      out.attributes.texcoords.push_back(
          {texcoord(i, j), texcoord(i + 1, j + 1), texcoord(i, j + 1)});
    }
  }
  return out;
}

TEST(Appearance, NoTriangleSpansASeam) {
  constexpr int kSegments = 50;
  const TriangleMesh input = tube(1.0, 64, 10, 0.0);
  const TriangleMesh output = tube(1.002, kSegments, 13, 0.37);
  const SurfaceAttributes found = AttributeSource(input).transferTo(output, 0);
  int beside = 0;
  for (std::size_t t = 0; t < output.triangles.size(); ++t) {
    float low = 1.0f, high = 0.0f;
    bool crosses = false;
    for (int k = 0; k < 3; ++k) {
      const glm::vec2 at = found.texcoords[t][static_cast<std::size_t>(k)];
      low = std::min(low, at.x), high = std::max(high, at.x);
      const glm::dvec3& p = output.vertices[output.triangles[t][k]];
      const glm::dvec3& q = output.vertices[output.triangles[t][(k + 1) % 3]];
      crosses |= p.x > 0.0 && (p.y < 0.0) != (q.y < 0.0);
      EXPECT_NEAR(at.y, p.z / 2.0, 1e-6);
    }
    EXPECT_LE(high - low, 1.01f / kSegments);
    beside += crosses;
    for (int k = 0; k < 3 && !crosses; ++k) {
      const glm::dvec3& p = output.vertices[output.triangles[t][k]];
      const double turn = std::atan2(p.y, p.x) / (2.0 * kPi);
      // What lies 0.002 outside a chord is that much farther from its middle when it is projected,
      // at most 1/128 away; and chords are not spread as their angles are, which is (1/64)^3.
      EXPECT_NEAR(found.texcoords[t][static_cast<std::size_t>(k)].x, turn < 0.0 ? turn + 1.0 : turn,
                  2e-5);
    }
  }
  EXPECT_EQ(beside, 26);  // the seam is crossed by two triangles of each of 13 rings
}

TEST(Appearance, ThinWallsKeepTheirSides) {
  TriangleMesh input = shapes::hollowBall(1.0, 0.99, 4);
  SurfaceAttributes& look = input.attributes;
  for (const glm::uvec3& t : input.triangles) {
    const bool outer = glm::length(input.vertices[t.x]) > 0.995;
    const glm::u8vec3 color = outer ? glm::u8vec3(255, 0, 0) : glm::u8vec3(0, 0, 255);
    look.colors.push_back({color, color, color});
    look.material.push_back(outer ? 0 : 1);
  }
  // Each side lies nearer to the other's triangles than to its own.
  const TriangleMesh outside = shapes::ball(0.985, 4);
  const TriangleMesh cavity = shapes::inverted(shapes::ball(1.001, 4));
  for (const bool flipped : {false, true}) {  // an input turned inside out is turned back
    const TriangleMesh mesh = flipped ? shapes::inverted(input) : input;
    const AttributeSource source(mesh);
    for (const auto& [output, material] : {std::pair(outside, 0u), std::pair(cavity, 1u)}) {
      const SurfaceAttributes found = source.transferTo(output, 2);
      for (std::size_t t = 0; t < output.triangles.size(); ++t) {
        ASSERT_EQ(found.material[t], material) << flipped;
        ASSERT_EQ(found.colors[t][0].x, material == 0 ? 255 : 0);
      }
    }
  }
}

TEST(Charts, EndAtSeamsAndMaterials) {
  const TriangleMesh whole = tube(1.0, 16, 4, 0.0);
  const Charts one = charts(whole);
  EXPECT_EQ(one.ids, std::vector<std::uint32_t>(128, 0));
  EXPECT_EQ(one.selfSeam.size(), 8u);  // a triangle on each side of the seam in each of four rings
  ASSERT_EQ(one.seams.size(), 4u);
  for (const Charts::Seam& seam : one.seams) {
    for (std::size_t side = 0; side < 2; ++side) {
      EXPECT_TRUE(
          std::binary_search(one.selfSeam.begin(), one.selfSeam.end(), seam.triangle[side]));
      const glm::uvec3& t = whole.triangles[seam.triangle[side]];
      for (const std::uint32_t v : {t[seam.corner[side]], t[(seam.corner[side] + 1) % 3]}) {
        EXPECT_NEAR(whole.vertices[v].y, 0.0, 1e-12);
        EXPECT_GT(whole.vertices[v].x, 0.0);
      }
    }
  }
  const Charts plain = charts({whole.vertices, whole.triangles});
  EXPECT_EQ(plain.ids, std::vector<std::uint32_t>(128, 0));
  EXPECT_TRUE(plain.selfSeam.empty());
  EXPECT_TRUE(plain.seams.empty());
  TriangleMesh halves = whole;
  for (std::uint32_t t = 0; t < 128; ++t) halves.attributes.material.push_back(t / 64);
  const Charts two = charts(halves);
  for (std::uint32_t t = 0; t < 128; ++t) EXPECT_EQ(two.ids[t], t < 64 ? 0u : 64u);
  EXPECT_EQ(two.seams.size(), 4u + 16u);
  TriangleMesh cube = shapes::cube(1.0);
  SurfaceAttributes& faces = cube.attributes;  // each triangle has texture coordinates of its own
  for (std::size_t t = 0; t < 12; ++t) {
    const auto u = static_cast<float>(t);
    faces.texcoords.push_back({glm::vec2(u, 0), glm::vec2(u + 0.5f, 0), glm::vec2(u, 0.5f)});
  }
  const Charts each = charts(cube);
  EXPECT_EQ(std::set<std::uint32_t>(each.ids.begin(), each.ids.end()).size(), 12u);
  EXPECT_TRUE(each.selfSeam.empty());
  for (const auto& beyond : each.neighbors) {
    for (const std::uint32_t triangle : beyond) EXPECT_EQ(triangle, kNoTriangle);
  }
}

}  // namespace
}  // namespace sherd
