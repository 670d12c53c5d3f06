// Densities: read from meshes and grids, and what the seeds make of them.
#include "seed/draw/density.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/seeds.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "base/text/density_source.h"
#include "kernels/device_fixture.h"
#include "shapes.h"
#include "unit/formats/mesh_folder.h"
#include "unit/seed/seeds_fixture.h"
#include "voxelize/distance.h"

namespace sherd {
namespace {

// A box -1..1 along x whose left and right half are surfaces of their own, without the wall between
// them, and a value for the vertices of each.
struct HalvedBox {
  TriangleMesh mesh;
  std::vector<float> values;

  HalvedBox(float left, float right) {
    for (const double side : {-1.0, 1.0}) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (const double end : {0.0, side}) {
        for (int i = 0; i < 4; ++i) {
          const double y = i == 0 || i == 3 ? -0.5 : 0.5, z = i < 2 ? -0.5 : 0.5;
          mesh.vertices.push_back({end, y, z});
          values.push_back(side < 0.0 ? left : right);
        }
      }
      const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (side < 0.0) std::swap(b, c);
        mesh.triangles.push_back(glm::uvec3(a, b, c) + first);
      };
      for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t next = (i + 1) % 4;
        add(i, i + 4, next);
        add(next, i + 4, next + 4);
      }
      add(4, 6, 5);
      add(4, 7, 6);
    }
  }
};

std::shared_ptr<openvdb::FloatGrid> stepGrid(float left, float right) {
  openvdb::initialize();
  auto grid = uniformGrid(0.0f);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
  grid->fill(openvdb::CoordBBox({-20, -20, -20}, {-1, 20, 20}), left);
  grid->fill(openvdb::CoordBBox({0, -20, -20}, {20, 20, 20}), right);
  return grid;
}

class Densities : public DeviceTest {
 protected:
  static std::pair<int, int> halves(const std::vector<Seed>& seeds, const Solid& solid) {
    std::pair<int, int> count{0, 0};
    for (const Seed& seed : seeds) {
      ++(solid.frame.worldFromIndex(pointOf(seed)).x < 0.0 ? count.first : count.second);
    }
    return count;
  }

  static std::vector<Seed> seedsOf(const HalvedBox& box, SeedOptions options, int resolution) {
    const Solid solid = voxelize(box.mesh, {.resolution = resolution});
    options.density = {"density", surfaceDensity(box.mesh, box.values)};
    return placeSeeds(solid, findComponents(*solid.blocks, device()), options);
  }
};

TEST(DensityField, OfASurfaceIsThatOfItsClosestPoint) {
  const TriangleMesh mesh{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}}};
  const std::vector<float> values{1.0f, 3.0f, 7.0f};
  const auto field = surfaceDensity(mesh, values);
  EXPECT_DOUBLE_EQ(field->most(), 7.0);
  EXPECT_NEAR(field->at({0.5, 0.25, 3.0}), 1.0 + 0.25 * 2.0 + 0.125 * 6.0, 1e-12);
  EXPECT_NEAR(field->at({-1.0, -1.0, 0.0}), 1.0, 1e-12);
  EXPECT_NEAR(field->at({1.0, -5.0, 1.0}), 2.0, 1e-12);
}

TEST(DensityField, RefusesValuesThatAreNoDensity) {
  const TriangleMesh mesh{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}}};
  for (const float bad : {-1.0f, NAN, INFINITY}) {
    EXPECT_THROW((void)surfaceDensity(mesh, std::vector<float>{1.0f, bad, 1.0f}), Error);
    EXPECT_THROW((void)gridDensity(stepGrid(1.0f, bad)), Error);
  }
  EXPECT_THROW((void)surfaceDensity(mesh, std::vector<float>(3, 0.0f)), Error);
  EXPECT_THROW((void)gridDensity(stepGrid(0.0f, 0.0f)), Error);
}

TEST(DensityField, OfAGridIsLinearBetweenVoxels) {
  const auto field = gridDensity(stepGrid(2.0f, 4.0f));
  EXPECT_DOUBLE_EQ(field->most(), 4.0);
  EXPECT_NEAR(field->at({-0.5, 0.03, 0.0}), 2.0, 1e-6);
  EXPECT_NEAR(field->at({-0.05, 0.0, 0.0}), 3.0, 1e-6);
  EXPECT_NEAR(field->at({50.0, 0.0, 0.0}), 0.0, 1e-6);
}

TEST(DensityField, SourceIsAnAttributeOrAFile) {
  EXPECT_EQ(densitySourceOf("wear").withoutFolders(), "wear");
  EXPECT_EQ(densitySourceOf("/a/b/f.vdb").withoutFolders(), "f.vdb");
  EXPECT_EQ(densitySourceOf("/a/b/f.VDB:stress/x").withoutFolders(), "f.VDB:stress/x");
  EXPECT_EQ(densitySourceOf("/a/b/f.vdb:stress").file, "/a/b/f.vdb");
}

// Of 9 seeds one lies in the left half: 4000 draws of a binomial distribution.
TEST_F(Densities, SeedsFollow) {
  const HalvedBox box(1.0f, 8.0f);
  constexpr int kPieces = 400;
  for (const Sampler sampler : {Sampler::uniform, Sampler::halton, Sampler::gaussian}) {
    int left = 0, all = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const Solid solid = voxelize(box.mesh, {.resolution = 48});
      SeedOptions options{.pieces = kPieces, .seed = seed, .sampler = sampler};
      const auto [l, r] = halves(seedsOf(box, options, 48), solid);
      left += l;
      all += l + r;
    }
    ASSERT_EQ(all, 10 * kPieces);
    const double expected = all / 9.0, sigma = std::sqrt(all * 8.0 / 81.0);
    EXPECT_NEAR(left, expected, 4.0 * sigma) << static_cast<int>(sampler);
  }
}

TEST_F(Densities, ZeroHasNoSeedsAndOtherResolutionsTheSame) {
  const HalvedBox box(0.0f, 3.0f);
  const SeedOptions options{.pieces = 100, .seed = 4};
  std::vector<glm::dvec3> before;
  for (const int resolution : {48, 96}) {
    const Solid solid = voxelize(box.mesh, {.resolution = resolution});
    std::vector<glm::dvec3> points;
    for (const Seed& seed : seedsOf(box, options, resolution)) {
      points.push_back(solid.frame.worldFromIndex(pointOf(seed)));
      EXPECT_GT(points.back().x, 0.0);
    }
    for (std::size_t i = 0; i < before.size(); ++i) {
      // Points are moved into a voxel that no other seed has, mostly by the rounding to 1/64.
      EXPECT_NEAR(glm::distance(before[i], points[i]), 0.0, 2.0 * 2.0 / 48.0);
    }
    before = points;
  }
}

// Draws hardly ever meet a ten thousandth of the box: voxels are drawn instead.
TEST_F(Densities, AreFollowedWhereDrawsDoNotSuffice) {
  openvdb::initialize();
  auto grid = uniformGrid(0.0f);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.02));
  grid->fill(openvdb::CoordBBox({-2, -2, -2}, {2, 2, 2}), 1.0f);
  const Solid solid = voxelize(shapes::cube(2.0), {.resolution = 100});
  const VoxelComponents components = findComponents(*solid.blocks, device());
  SeedOptions options{.pieces = 60, .seed = 1};
  options.density = {"f.vdb", gridDensity(grid)};
  for (const Seed& seed : placeSeeds(solid, components, options)) {
    const glm::dvec3 at = glm::abs(glm::dvec3(solid.frame.worldFromIndex(pointOf(seed))));
    EXPECT_LT(std::max({at.x, at.y, at.z}), 3.0 * 0.02 + 0.02);
  }
  options.pieces = 2000;
  EXPECT_THROW((void)placeSeeds(solid, components, options), Error);
}

TEST_F(Densities, GiveEachComponentASeed) {
  const TriangleMesh two = shapes::append(shapes::cube(1.0), shapes::cube(1.0, {3, 0, 0}));
  std::vector<float> values(two.vertices.size(), 1.0f);
  std::fill(values.begin(), values.begin() + 8, 0.0f);
  const Solid solid = voxelize(two, {.resolution = 48});
  SeedOptions options{.pieces = 10};
  options.density = {"density", surfaceDensity(two, values)};
  int left = 0;
  for (const Seed& seed : placeSeeds(solid, findComponents(*solid.blocks, device()), options)) {
    left += solid.frame.worldFromIndex(pointOf(seed)).x < 1.5 ? 1 : 0;
  }
  EXPECT_EQ(left, 1);
  options.sampler = Sampler::poisson;
  EXPECT_THROW((void)placeSeeds(solid, findComponents(*solid.blocks, device()), options), Error);
}

// --- Files ---------------------------------------------------------------------------------------

class ReadDensity : public MeshFolder {};

// Returns the sentence with which a file is refused, one line; empty if it is read.
template <class Work>
std::string sentenceOf(const Work& work) {
  try {
    work();
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    return e.what();
  }
  return "";
}

std::string plyText(bool isBinary, const std::string& name) {
  std::string text = std::string("ply\nformat ") + (isBinary ? "binary_little_endian" : "ascii") +
                     " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
                     "z\nproperty uchar red\nproperty float " +
                     name +
                     "\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  if (!isBinary) return text + "0 0 0 9 1\n1 0 0 9 2\n0 1 0 9 4\n3 0 1 2\n";
  const auto put = [&](auto value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const float rows[3][4] = {{0, 0, 0, 1}, {1, 0, 0, 2}, {0, 1, 0, 4}};
  for (const auto& row : rows) {
    put(row[0]), put(row[1]), put(row[2]), put(std::uint8_t{9}), put(row[3]);
  }
  put(std::uint8_t{3}), put(0), put(1), put(2);
  return text;
}

void expectRead(const Density& density) {
  EXPECT_NEAR(density.field->at({0, 0, 0}), 1.0, 1e-6);
  EXPECT_NEAR(density.field->at({1, 0, 0}), 2.0, 1e-6);
  EXPECT_NEAR(density.field->at({0.5, 0.5, 7}), 3.0, 1e-6);
}

TEST_F(ReadDensity, OfPlyVertices) {
  for (const bool isBinary : {false, true}) {
    expectRead(readDensity("wear", write("a.ply", plyText(isBinary, "wear"))));
    const Density red = readDensity("red", write("a.ply", plyText(isBinary, "wear")));
    EXPECT_NEAR(red.field->at({0, 0, 0}), 9.0, 1e-6);
  }
}

TEST_F(ReadDensity, OfObjColors) {
  const auto file = write("a.obj", "v 0 0 0 1 0 0.5\nv 1 0 0 2 0 0\nv 0 1 0 4 0 0\nf 1 2 3\n");
  expectRead(readDensity("red", file));
  EXPECT_EQ(sentenceOf([&] { (void)readDensity("green", file); }),
            file.string() + ": the density is 0 at all vertices");
}

// Positions as in the others, the values 1 2 4 as _WEAR, and colors whose red is a quarter of them.
std::string gltfText() {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,)"
         R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAAEAAAIBAQAAA/4AAAP//AAD/"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12},)"
         R"({"buffer":0,"byteOffset":48,"byteLength":12}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
         R"({"bufferView":1,"componentType":5126,"count":3,"type":"SCALAR"},)"
         R"({"bufferView":2,"componentType":5121,"count":3,"type":"VEC4","normalized":true}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"_WEAR":1,"COLOR_0":2}}]}]})";
}

TEST_F(ReadDensity, OfGltfAttributes) {
  const auto file = write("a.gltf", gltfText());
  for (const char* name : {"wear", "WEAR", "_WEAR"}) expectRead(readDensity(name, file));
  const Density red = readDensity("red", file);
  EXPECT_NEAR(red.field->at({0, 0, 0}), 64.0 / 255.0, 1e-6);
  EXPECT_NEAR(readDensity("alpha", file).field->at({0, 0, 0}), 1.0, 1e-6);
}

TEST_F(ReadDensity, ListsWhatThereIs) {
  const auto ply = write("a.ply", plyText(false, "wear"));
  EXPECT_EQ(sentenceOf([&] { (void)readDensity("none", ply); }),
            "a.ply: its vertices have no attribute 'none', but 'red', 'wear'");
  const auto gltf = write("a.gltf", gltfText());
  EXPECT_EQ(sentenceOf([&] { (void)readDensity("none", gltf); }),
            "a.gltf: its vertices have no attribute 'none', but 'red', 'green', 'blue', 'alpha', "
            "'WEAR'");
  const auto stl = write("a.stl",
                         "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                         "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n");
  EXPECT_EQ(sentenceOf([&] { (void)readDensity("none", stl); }),
            "a.stl: its vertices have no attribute 'none', nor another one that is read");
  EXPECT_NE(sentenceOf([&] { (void)readDensity("none", "seeds.json"); }), "");
  EXPECT_NE(sentenceOf([&] { (void)readDensity("absent.vdb", ply); }), "");
}

}  // namespace
}  // namespace sherd
