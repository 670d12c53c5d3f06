// Volumes in place of meshes.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>

#include "formats/voxels/voxel_faces.h"
#include "mesh/search/winding_number.h"
#include "shapes.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

class VolumeTest : public TempFolder {
 protected:
  fs::path write(const std::string& name, const openvdb::GridCPtrVec& grids) {
    openvdb::initialize();
    openvdb::io::File file((folder_ / name).string());
    file.write(grids);
    file.close();
    return folder_ / name;
  }
};

openvdb::FloatGrid::Ptr sphere(double radius, const openvdb::Vec3f& center, double voxelSize) {
  return openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
      static_cast<float>(radius), center, static_cast<float>(voxelSize), 3.0f);
}

TEST_F(VolumeTest, ALevelSetsVoxelsAreTheSolidsIndexForIndex) {
  const auto grid = sphere(1.0, {0.3f, -0.2f, 0.1f}, 0.05);
  const Volume volume = readVolume(write("ball.vdb", {grid}));
  ASSERT_TRUE(volume.solid);
  std::uint64_t inside = 0;
  for (int x = -30; x <= 30; ++x) {
    for (int y = -30; y <= 30; ++y) {
      for (int z = -30; z <= 30; ++z) {
        const openvdb::Coord c(x, y, z);
        const double value = grid->tree().getValue(c);
        inside += value < 0.0;
        EXPECT_EQ(volume.solid->distance->tree().getValue(c) < 0.0, value < 0.0);
        if (std::abs(value) > 1e-3 && std::abs(value) < 0.149) {
          EXPECT_EQ(volume.solid->distance->tree().getValue(c), grid->tree().getValue(c));
        }
      }
    }
  }
  EXPECT_EQ(volume.solid->voxels, inside);
  EXPECT_EQ(volume.voxelSize, grid->voxelSize()[0]);
  EXPECT_TRUE(volume.source.mesh.triangles.empty());
}

TEST_F(VolumeTest, AWiderBandIsCutAndANarrowerOneIsMeasuredAnew) {
  openvdb::initialize();
  const auto wide = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
      1.0f, openvdb::Vec3f(0.0f), 0.05f, 6.0f);
  const Volume cut = readVolume(write("wide.vdb", {wide}));
  ASSERT_TRUE(cut.solid);
  for (auto value = cut.solid->distance->cbeginValueOn(); value; ++value) {
    ASSERT_LT(std::abs(*value), 0.15001f);
  }
  EXPECT_NEAR(static_cast<double>(cut.solid->voxels) * std::pow(0.05, 3), shapes::ballVolume(1.0),
              0.02);
  const auto narrow = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
      1.0f, openvdb::Vec3f(0.0f), 0.05f, 1.5f);
  const Volume anew = readVolume(write("narrow.vdb", {narrow}));
  EXPECT_FALSE(anew.solid);
  EXPECT_EQ(openEdges(anew.source.mesh), 0u);
  EXPECT_NEAR(volume(anew.source.mesh), shapes::ballVolume(1.0), 0.02);
}

TEST_F(VolumeTest, ATurnedOrStretchedLevelSetIsTakenWhereItIsInTheWorld) {
  const auto grid = sphere(1.0, {0.0f, 0.0f, 0.0f}, 0.05);
  openvdb::math::Transform::Ptr turned = grid->transform().copy();
  turned->postRotate(0.7, openvdb::math::X_AXIS);
  turned->postScale({1.0, 2.0, -1.0});
  turned->postTranslate({5.0, 0.0, 0.0});
  grid->setTransform(turned);
  const Volume volume = readVolume(write("turned.vdb", {grid}));
  ASSERT_FALSE(volume.solid);
  EXPECT_NEAR(sherd::volume(volume.source.mesh), 2.0 * shapes::ballVolume(1.0), 0.04);
  const Box box = bounds(volume.source.mesh);
  EXPECT_NEAR(box.min.x, 4.0, 0.01);
  EXPECT_NEAR(box.max.y, 2.0, 0.02);
}

TEST_F(VolumeTest, LevelSetsOfOneFileUniteAndOneCanBeNamed) {
  const auto one = sphere(1.0, {0.0f, 0.0f, 0.0f}, 0.1);
  const auto two = sphere(1.0, {1.5f, 0.0f, 0.0f}, 0.1);
  one->setName("one");
  two->setName("two");
  const fs::path file = write("two.vdb", {one, two});
  const Volume both = readVolume(file), named = readVolume(file, {.grid = "two"});
  ASSERT_TRUE(both.solid && named.solid);
  // Two balls less the lens that they share: each cap is 0.25 high.
  const double lens = 2.0 * (M_PI * 0.25 * 0.25 * (3.0 - 0.25) / 3.0);
  EXPECT_NEAR(static_cast<double>(both.solid->voxels) * 1e-3, 2.0 * shapes::ballVolume(1.0) - lens,
              0.1);
  EXPECT_NEAR(static_cast<double>(named.solid->voxels) * 1e-3, shapes::ballVolume(1.0), 0.05);
  try {
    (void)readVolume(file, {.grid = "three"});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input);
    EXPECT_NE(std::string(e.what()).find("'one', 'two'"), std::string::npos) << e.what();
  }
}

TEST_F(VolumeTest, FogIsSolidAboveItsIsovalue) {
  const auto grid = sphere(1.0, {0.0f, 0.0f, 0.0f}, 0.05);
  openvdb::tools::sdfToFogVolume(*grid);  // 0 at the surface, 1 three voxels below it
  const fs::path file = write("fog.vdb", {grid});
  EXPECT_NEAR(volume(readVolume(file).source.mesh), shapes::ballVolume(1.0 - 1.5 * 0.05), 0.05);
  const Volume larger = readVolume(file, {.grid = "", .isovalue = 0.25});
  EXPECT_NEAR(volume(larger.source.mesh), shapes::ballVolume(1.0 - 0.75 * 0.05), 0.05);
}

TEST_F(VolumeTest, WhatIsSolidNowhereIsRefused) {
  const auto nothing = openvdb::FloatGrid::create(0.3f);
  nothing->setGridClass(openvdb::GRID_LEVEL_SET);
  EXPECT_THROW((void)readVolume(write("nothing.vdb", {nothing})), Error);
  EXPECT_THROW((void)readVolume(write("int.vdb", {openvdb::Int32Grid::create()})), Error);
  EXPECT_THROW((void)readVolume(folder_ / "absent.vdb"), Error);
  writeVoxels(folder_ / "empty.rle", {{{2, 2, 2}, {{0, 8}}}}, VoxelFormat::rle);
  EXPECT_THROW((void)readVolume(folder_ / "empty.rle"), Error);
}

void expectRefusalForMemory(const fs::path& file, const VolumeOptions& options,
                            ErrorCode code = ErrorCode::usage) {
  try {
    (void)readVolume(file, options);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code);
    EXPECT_EQ(e.options(), OptionNames{"max-memory"}) << e.what();
  }
}

TEST_F(VolumeTest, ATileThatStandsForMoreVoxelsThanFitIsRefused) {
  const auto grid = sphere(1.0, {0.0f, 0.0f, 0.0f}, 0.05);
  const fs::path ball = write("ball.vdb", {grid});
  EXPECT_TRUE(readVolume(ball, {.grid = "", .maxMemory = 1'000'000'000}).solid);
  grid->tree().addTile(3, openvdb::Coord(1 << 14), -0.15f, false);  // 4096 voxels wide
  const fs::path file = write("tile.vdb", {grid});
  EXPECT_LT(fs::file_size(file), 1'000'000u);
  // Its voxels are too many, and so are its faces.
  expectRefusalForMemory(file, {.grid = "", .maxMemory = 500'000'000'000}, ErrorCode::input);
  expectRefusalForMemory(file, {.grid = "", .ownVoxels = false, .maxMemory = 10'000'000'000},
                         ErrorCode::input);
}

ErrorCode codeOfReading(const fs::path& file) {
  try {
    (void)readVolume(file, {.grid = "", .maxMemory = 1'000'000'000});
  } catch (const Error& e) {
    return e.code();
  }
  return ErrorCode::internal;
}

TEST_F(VolumeTest, ValuesThatAreNotFiniteAreRefused) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto voxel = sphere(1.0, {0.0f, 0.0f, 0.0f}, 0.05);
  voxel->tree().setValueOff(openvdb::Coord(0, 0, 19), kNan);
  EXPECT_EQ(codeOfReading(write("voxel.vdb", {voxel})), ErrorCode::input);
  const auto tile = sphere(1.0, {0.0f, 0.0f, 0.0f}, 0.05);
  tile->tree().addTile(1, openvdb::Coord(160, 0, 0), std::numeric_limits<float>::infinity(), false);
  EXPECT_EQ(codeOfReading(write("tile.vdb", {tile})), ErrorCode::input);
  const auto background = openvdb::FloatGrid::create(kNan);
  EXPECT_EQ(codeOfReading(write("background.vdb", {background})), ErrorCode::input);
  // Only the grid that is read matters.
  const auto other = openvdb::FloatGrid::create(kNan);
  other->setName("other");
  EXPECT_TRUE(
      readVolume(write("beside.vdb", {sphere(1.0, {0.0f, 0.0f, 0.0f}, 0.05), other})).solid);
}

TEST_F(VolumeTest, LevelSetsOfOneTreeAreOneSolid) {
  const auto ball = sphere(1.0, {0.0f, 0.0f, 0.0f}, 0.05);
  ball->setName("ball");
  const openvdb::GridBase::Ptr twin = ball->copyGrid();  // shares the tree, also in the file
  twin->setName("twin");
  const Volume once = readVolume(write("once.vdb", {ball}));
  const Volume twice = readVolume(write("twice.vdb", {ball, twin}));
  ASSERT_TRUE(once.solid && twice.solid);
  EXPECT_EQ(twice.source.grids.size(), 2u);
  EXPECT_EQ(twice.solid->voxels, once.solid->voxels);
}

TEST_F(VolumeTest, VoxelsTooFarApartForTheirBoxAreRefused) {
  const auto grid = sphere(1.0, {0.0f, 0.0f, 0.0f}, 0.05);
  grid->tree().setValueOn(openvdb::Coord(4000, 4000, 4000), -0.01f);
  EXPECT_TRUE(readVolume(write("near.vdb", {grid})).solid);
  grid->tree().setValueOn(openvdb::Coord(100'000, 100'000, 100'000), -0.01f);
  EXPECT_EQ(codeOfReading(write("far.vdb", {grid})), ErrorCode::input);
}

TEST_F(VolumeTest, ATileInASolidBackgroundIsRefusedForItsFaces) {
  const auto grid = openvdb::FloatGrid::create(-1.0f);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->tree().addTile(3, openvdb::Coord(0), 1.0f, true);  // 4096 voxels wide
  expectRefusalForMemory(write("inverted.vdb", {grid}), {.grid = "", .maxMemory = 1'000'000'000},
                         ErrorCode::input);
}

// ---- Voxel files

RunLengthVoxels voxelsAt(const openvdb::Coord& dims,
                         const std::function<std::uint16_t(int, int, int)>& label) {
  RunLengthVoxels voxels{dims, {}};
  for (int x = 0; x < dims.x(); ++x) {
    for (int y = 0; y < dims.y(); ++y) {
      for (int z = 0; z < dims.z(); ++z) {
        const std::uint16_t value = label(x, y, z);
        if (!voxels.runs.empty() && voxels.runs.back().label == value) {
          ++voxels.runs.back().length;
        } else {
          voxels.runs.push_back({value, 1});
        }
      }
    }
  }
  return voxels;
}

TEST(VoxelFaces, WindOnceRoundLabeledVoxelsAndNowhereElse) {
  std::mt19937 random(3);
  std::vector<std::uint16_t> labels(5 * 4 * 6);
  for (std::uint16_t& label : labels) label = static_cast<std::uint16_t>(random() % 3);
  const auto at = [&](int x, int y, int z) {
    return labels[static_cast<std::size_t>((x * 4 + y) * 6 + z)];
  };
  const RunLengthVoxels voxels = voxelsAt({5, 4, 6}, at);
  const GridFrame frame{{10.0, 20.0, 30.0}, 0.5};
  const TriangleMesh mesh = voxelFaces(voxels, frame, 1000).value();
  std::size_t solid = 0;
  for (int x = 0; x < 5; ++x) {
    for (int y = 0; y < 4; ++y) {
      for (int z = 0; z < 6; ++z) {
        const glm::dvec3 center = glm::dvec3(10.0, 20.0, 30.0) + 0.5 * glm::dvec3(x, y, z);
        EXPECT_NEAR(windingNumber(mesh, center), at(x, y, z) != 0 ? 1.0 : 0.0, 1e-9);
        solid += at(x, y, z) != 0;
      }
    }
  }
  EXPECT_NEAR(volume(mesh), 0.125 * static_cast<double>(solid), 1e-9);
  EXPECT_TRUE(voxelFaces(voxels, frame, mesh.triangles.size()));
  EXPECT_FALSE(voxelFaces(voxels, frame, mesh.triangles.size() - 1));
  EXPECT_TRUE(voxelFaces({{2, 2, 2}, {{0, 8}}}, {}, 0).value().triangles.empty());
}

TEST_F(VolumeTest, RunsThatStandForMoreFacesThanFitAreRefused) {
  // A solid box of 34 bytes: its planes are many, or its faces.
  for (const openvdb::Coord& dims :
       {openvdb::Coord(2, 30'000, 60'000), openvdb::Coord(20'000, 400, 400)}) {
    const fs::path file = folder_ / "box.rle";
    const std::uint32_t count = static_cast<std::uint32_t>(dims.x()) *
                                static_cast<std::uint32_t>(dims.y()) *
                                static_cast<std::uint32_t>(dims.z());
    writeVoxels(file, {{dims, {{1, count}}}}, VoxelFormat::rle);
    expectRefusalForMemory(file, {.grid = "", .maxMemory = 1'000'000'000});
  }
}

// Which voxels have a label.
std::vector<Run> solidRuns(const RunLengthVoxels& voxels) {
  std::vector<Run> runs;
  for (Run run : voxels.runs) {
    run.label = run.label != 0;
    if (!runs.empty() && runs.back().label == run.label) {
      runs.back().length += run.length;
    } else {
      runs.push_back(run);
    }
  }
  return runs;
}

TEST_F(VolumeTest, AFracturesVoxelsBreakAgainAsTheSameSolid) {
  Device device;
  const TriangleMesh mesh = shapes::torus(10.0, 4.0);
  FractureOptions options{.pieces = 5, .solid = {.resolution = 48}};
  const FractureResult first = fracture(mesh, options, device);
  const RunLengthVoxels runs = encodeRuns(first.solid, first.labels);
  const openvdb::Coord& low = first.solid.box.min;
  const GridFrame frame{first.solid.frame.worldFromIndex(low), first.solid.frame.voxelSize};
  writeVoxels(folder_ / "labels.npz", {runs, VoxelTransform{frame, low}}, VoxelFormat::npz);
  const Volume volume = readVolume(folder_ / "labels.npz");
  options.solid.voxelSize = volume.voxelSize;
  const FractureResult second = fracture(volume.source.mesh, options, device);
  const RunLengthVoxels again = encodeRuns(second.solid, second.labels);
  EXPECT_EQ(again.dims, runs.dims);
  EXPECT_EQ(solidRuns(again), solidRuns(runs));

  writeVdbOfSolid(folder_ / "solid.vdb", first.solid, {.source = "torus"});
  const Volume grid = readVolume(folder_ / "solid.vdb");
  ASSERT_TRUE(grid.solid);
  // A level set has no mesh to draw seeds in; from the same seeds the fragments are the same.
  options.seeds.given.emplace();
  for (const Seed& seed : first.seeds) {
    options.seeds.given->points.push_back(
        {first.solid.frame.worldFromIndex(pointOf(seed)), seed.fragment});
  }
  const FractureResult third = fracture(*grid.solid, options, device);
  EXPECT_EQ(third.solid.box.min, first.solid.box.min);
  EXPECT_EQ(encodeRuns(third.solid, third.labels).runs, runs.runs);
}

}  // namespace
}  // namespace sherd
