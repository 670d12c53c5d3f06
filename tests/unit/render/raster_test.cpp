// Which triangle a sample shows, which light reaches it, and the ground behind.
#include "render/raster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "render/backdrop.h"
#include "render/camera.h"
#include "render/embree_scene.h"
#include "render/light.h"
#include "render/occluders.h"
#include "render/palette.h"
#include "render/scene.h"
#include "shapes.h"

namespace sherd {
namespace {

Fragment fragmentOf(int id, TriangleMesh mesh) {
  Fragment fragment;
  fragment.id = id;
  fragment.mass = massProperties(mesh);
  fragment.mesh = std::move(mesh);
  return fragment;
}

/// A fine ball, a coarse one that covers a part of it, and a cube whose faces cross many tiles.
std::vector<Fragment> threeShapes() {
  return {fragmentOf(1, shapes::ball(1.0, 5)), fragmentOf(2, shapes::ball(0.7, 2, {1.3, 0.2, 1.1})),
          fragmentOf(3, shapes::cube(1.7, {-2.0, -0.9, -0.4}))};
}

struct View {
  std::vector<Fragment> fragments = threeShapes();
  RenderOptions options{.width = 333, .height = 211, .explode = 0.1};
  Scene scene = makeScene(fragments, options);
  Camera camera = frameScene(scene, {}, options);
};

RTCHit hitAt(const View& view, const EmbreeScene& embree, glm::vec2 position) {
  return firstHit(embree.scene.get(), view.camera.eye,
                  view.camera.direction(position.x, position.y));
}

float distanceToEdge(float u, float v) { return std::min({u, v, 1.0f - u - v}); }

// Rays find the nearest triangle by another way.  Only beside an edge may they find another one.
TEST(Raster, ShowsTheTriangleThatARayHitsFirst) {
  constexpr float kBesideEdge = 1e-2f;  // barycentric; triangles are a pixel or more wide
  const View view;
  std::vector<EmbreeMesh> meshes;
  for (const SceneFragment& f : view.scene.fragments) meshes.push_back({f.vertices, f.triangles});
  const EmbreeScene embree = embreeScene(meshes, EmbreeTree::exact);
  const Raster raster(view.scene, view.camera);
  TileHits hits;
  std::array<int, 3> shown{};
  int differences = 0;
  for (int y = 0; y < view.options.height; ++y)
    for (int x = 0; x < view.options.width; ++x) {
      const bool isCovered = raster.draw(x / kTile, y / kTile, hits);
      for (std::size_t s = 0; s < kInPixel.size(); ++s) {
        const glm::vec2 at = kInPixel[s] + glm::vec2(x, y);
        const RTCHit ray = hitAt(view, embree, at);
        const std::uint32_t hit =
            isCovered ? hits.shown[4 * static_cast<std::size_t>(y % kTile * kTile + x % kTile) + s]
                      : TileHits::kNothing;
        if (hit == TileHits::kNothing) {
          if (ray.geomID == RTC_INVALID_GEOMETRY_ID) continue;
          ++differences;
          EXPECT_LT(distanceToEdge(ray.u, ray.v), kBesideEdge) << x << " " << y;
          continue;
        }
        const TileHits::Triangle& found = hits.triangles[hit];
        const glm::vec2 inTriangle = raster.barycentric(found, at);
        ++shown[found.fragment];
        if (found.fragment == ray.geomID && found.triangle == ray.primID) {
          EXPECT_NEAR(inTriangle.x, ray.u, 1e-2f);
          EXPECT_NEAR(inTriangle.y, ray.v, 1e-2f);
          continue;
        }
        ++differences;
        EXPECT_LT(distanceToEdge(inTriangle.x, inTriangle.y), kBesideEdge) << x << " " << y;
      }
    }
  for (const int samples : shown) EXPECT_GT(samples, 5000);
  EXPECT_LT(differences, 200);
}

TEST(Raster, IsEmptyWithoutFragments) {
  const Scene scene = makeScene({}, {});
  const Camera camera = frameScene(scene, {}, {});
  TileHits hits;
  EXPECT_FALSE(Raster(scene, camera).draw(3, 2, hits));
}

// At every vertex of a ball the faces are less than 45 degrees apart, at a cube's they are 90.
TEST(RenderScene, NormalsAreSmoothButForCreases) {
  const View view;
  const SceneFragment &ball = view.scene.fragments[0], &cube = view.scene.fragments[2];
  const Fragment& source = view.fragments[0];
  for (unsigned t = 0; t < ball.triangles.size(); ++t) {
    const glm::dvec3 p = source.mesh.vertices[ball.triangles[t].x] - source.mass.centroid;
    EXPECT_GT(glm::dot(glm::vec3(glm::normalize(p)), ball.normalAt(t, 0.0f, 0.0f)), 0.999f);
  }
  for (unsigned t = 0; t < cube.triangles.size(); ++t) {
    const glm::vec3 a = cube.vertices[cube.triangles[t].x], b = cube.vertices[cube.triangles[t].y],
                    c = cube.vertices[cube.triangles[t].z];
    const glm::vec3 face = glm::normalize(glm::cross(b - a, c - a));
    for (const glm::vec2 at : {glm::vec2(0.0f, 0.0f), glm::vec2(1.0f, 0.0f), glm::vec2(0.0f, 1.0f)})
      EXPECT_GT(glm::dot(face, cube.normalAt(t, at.x, at.y)), 0.99999f);
  }
}

TEST(Occluders, StopRaysAsTheFragmentsDo) {
  const std::vector<Fragment> fragments{fragmentOf(1, shapes::ball(1.0, 5))};
  const Scene scene = makeScene(fragments, {});
  const float radius = 1.0f / std::sqrt(3.0f);  // the box's half diagonal is 1
  const float cell = 0.1f * radius;
  const Occluders occluders(scene, cell);
  const glm::vec3 center(0.0f), across(0.0f, 1.0f, 0.0f);
  for (const glm::vec3 direction : skyDirections(64)) {
    const glm::vec3 surface = radius * direction;
    EXPECT_EQ(occluders.free(center, direction, 0.0f), 0.0f);
    EXPECT_EQ(occluders.free(surface + occluders.lift() * direction, direction, occluders.start()),
              1.0f);
    EXPECT_EQ(occluders.free(surface + occluders.lift() * direction, -direction, 0.0f), 0.0f);
    const glm::vec3 tangent = glm::normalize(glm::cross(direction, across));
    // The merged vertices are less than a cube's side away from the ball.
    EXPECT_EQ(occluders.free((radius + cell) * direction - 2.0f * tangent, tangent, 0.0f), 1.0f);
    EXPECT_EQ(occluders.free((radius - 2.0f * cell) * direction - 2.0f * tangent, tangent, 0.0f),
              0.0f);
  }
}

// Every fourth pixel of every fourth row has its own light, the others lie between those around.
TEST(Backdrop, FillsEveryPixelWithItsLight) {
  const View view;
  const Light light = makeLight(0.5f);
  const GroundLight ground(view.scene, light, Occluders(view.scene, 0.03f));
  const Backdrop backdrop(view.camera, ground, view.scene.groundY);
  const int width = view.options.width, height = view.options.height;
  std::vector<std::uint8_t> rgb(3 * static_cast<std::size_t>(width * height), 0);
  for (int row = 0; row < height; row += Backdrop::kRows) backdrop.fill(row, rgb);
  const auto exact = [&](int x, int y, int k) {
    return byteFromLinear(
        backdrop.at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f)[k]);
  };
  std::size_t i = 0;
  int darkest = 255;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int k = 0; k < 3; ++k, ++i) {
        darkest = std::min<int>(darkest, rgb[i]);
        const int left = x / 4 * 4, top = y / 4 * 4;
        const int right = x == left ? left : left + 4, bottom = y == top ? top : top + 4;
        const auto [low, high] = std::minmax({exact(left, top, k), exact(right, top, k),
                                              exact(left, bottom, k), exact(right, bottom, k)});
        ASSERT_GE(rgb[i] + 1, low) << x << " " << y;  // bytes are rounded
        ASSERT_LE(rgb[i] - 1, high) << x << " " << y;
      }
  EXPECT_LT(darkest, 170);  // the shadow
}

TEST(Palette, SrgbValuesAreTheInverseOfLinearOnes) {
  for (int i = 0; i <= 1000; ++i) {
    const float value = static_cast<float>(i) / 1000.0f;
    EXPECT_NEAR(srgbFromLinear(linearFromSrgb(value)), value, 1e-4f);
  }
  EXPECT_EQ(srgbFromLinear(-1.0f), 0.0f);
  EXPECT_FLOAT_EQ(srgbFromLinear(2.0f), 1.0f);
}

}  // namespace
}  // namespace sherd
