// Seeds that a user gives, and the file they come in.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/fracture.h>
#include <sherd/seeds.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "unit/seed/seeds_fixture.h"

namespace sherd {
namespace {

using openvdb::Coord;
namespace fs = std::filesystem;

class SeedFile : public DeviceTest {
 protected:
  void SetUp() override {
    DeviceTest::SetUp();
    file_ = fs::temp_directory_path() / ("sherd-seeds-" + std::to_string(::getpid()) + ".json");
  }
  void TearDown() override { fs::remove(file_); }

  static ShapeSolid make(voxel_shapes::VoxelSolid shape) { return {std::move(shape), device()}; }

  void hold(const std::string& text) const { std::ofstream(file_, std::ios::binary) << text; }

  // The sentence that breaking a solid at the seeds in `text` gives; it must name the file.
  std::string refusal(const ShapeSolid& on, const std::string& text) const {
    hold(text);
    try {
      const GivenSeeds given{file_.string(), readSeedPoints(file_)};
      (void)fracture(PreparedSolid{on.solid, on.components, {}}, {.seeds = {.given = given}},
                     device());
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input);
      EXPECT_EQ(std::string(e.what()).find(file_.string() + ": "), 0u) << e.what();
      return e.what();
    }
    return "";
  }

  fs::path file_;
};

std::string listOf(const std::string& entries) {
  return R"({"schema": "sherd-seeds/1", "seeds": [)" + entries + "]}";
}

Coord voxelOf(const std::vector<Seed>& seeds, std::size_t i) { return seeds.at(i).voxel; }

TEST_F(SeedFile, IsReadBackExactly) {
  for (const voxel_shapes::VoxelSolid& shape :
       {voxel_shapes::ball(12), voxel_shapes::manyComponentsWithin(9)}) {
    ShapeSolid on = make(shape);
    for (const double voxelSize : {1.0, 1.0 / 3, 1e-7, 1234567.891}) {
      on.solid.frame = {{0.1, -1e3 * voxelSize, 0.0}, voxelSize};
      const std::vector<Seed> seeds =
          placeSeeds(on.solid, on.components,
                     {.pieces = 150, .seed = 3, .extraSeeds = 100, .impacts = {{.merge = true}}});
      writeSeeds(file_, seeds, on.solid);
      EXPECT_EQ(seedsFromPoints(readSeedPoints(file_), on.solid, on.components), seeds);
    }
  }
}

TEST_F(SeedFile, HoldsWorldPositionsOfVoxelCenters) {
  ShapeSolid ball = make(voxel_shapes::ball(4));
  ball.solid.frame = {{10, 20, 30.5}, 0.5};
  writeSeeds(file_, std::vector<Seed>{{{0, -1, 2}, 1}, {{1, 1, 1}, 2}}, ball.solid);
  std::ifstream in(file_, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}),
            "{\n \"schema\": \"sherd-seeds/1\",\n \"seeds\": [\n"
            "  {\"fragment\":1,\"position\":[10.0,19.5,31.5]},\n"
            "  {\"fragment\":2,\"position\":[10.5,20.5,31.0]}\n ]\n}\n");
}

TEST_F(SeedFile, HoldsWeightsInSquaredWorldUnits) {
  ShapeSolid ball = make(voxel_shapes::ball(4));
  ball.solid.frame = {{0, 0, 0}, 0.5};
  writeSeeds(file_, std::vector<Seed>{{{0, 0, 2}, 1, glm::ivec3(0), 3 * kSeedSteps * kSeedSteps}},
             ball.solid);
  std::ifstream in(file_, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}),
            "{\n \"schema\": \"sherd-seeds/1\",\n \"seeds\": [\n"
            "  {\"fragment\":1,\"position\":[0.0,0.0,1.0],\"weight\":0.75}\n ]\n}\n");
}

TEST_F(SeedFile, PutsTheFirstSeedOfEachFragmentFirst) {
  const ShapeSolid ball = make(voxel_shapes::ball(4));
  const std::vector<Seed> seeds = seedsFromPoints(
      std::vector<SeedPoint>{{{0, 0, 0}, 2}, {{1, 0, 0}, 2}, {{2, 0, 0}, 1}, {{3, 0, 0}, 1}},
      ball.solid, ball.components);
  EXPECT_EQ(seeds,
            (std::vector<Seed>{{{2, 0, 0}, 1}, {{0, 0, 0}, 2}, {{1, 0, 0}, 2}, {{3, 0, 0}, 1}}));
}

TEST_F(SeedFile, MovesToTheNearestFreeVoxel) {
  const ShapeSolid ball = make(voxel_shapes::ball(4));
  const auto place = [&](std::vector<SeedPoint> points) {
    return seedsFromPoints(points, ball.solid, ball.components);
  };
  EXPECT_EQ(voxelOf(place({{{0.4, -0.4, 2.4}, 1}}), 0), Coord(0, 0, 2));
  EXPECT_EQ(voxelOf(place({{{0.5, 0.5, 0.5}, 1}}), 0), Coord(0, 0, 0));  // ties: lowest
  EXPECT_EQ(voxelOf(place({{{0, 0, 6}, 1}}), 0), Coord(0, 0, 4));        // two voxels away
  // Taken by the first, so the next nearest: (-1, 0, 0) before the other five.
  const std::vector<Seed> twice = place({{{0, 0, 0}, 1}, {{0, 0, 0}, 2}});
  EXPECT_EQ(voxelOf(twice, 1), Coord(-1, 0, 0));
  try {
    (void)place({{{0, 0, 0}, 1}, {{0, 0, 6.01}, 2}});
    ADD_FAILURE() << "a seed beyond two voxels is taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input);
    EXPECT_EQ(std::string(e.what()).find("seed 2 lies 2.01 voxels from the solid"), 0u) << e.what();
  }
  // 33 voxels lie within 2 of the middle; the 34th seed there finds none.
  const std::vector<SeedPoint> crowd(34, {{0, 0, 0}, 1});
  EXPECT_EQ(place({crowd.begin(), crowd.end() - 1}).size(), 33u);
  EXPECT_THROW((void)place(crowd), Error);
}

TEST_F(SeedFile, ComponentsWithoutASeedGetOne) {
  const ShapeSolid many = make(voxel_shapes::manyComponentsWithin(9));
  const std::vector<Seed> placed =
      placeSeeds(many.solid, many.components, {.pieces = 1, .seed = 5});
  hold(listOf(""));
  const std::vector<Seed> all =
      seedsFromPoints(readSeedPoints(file_), many.solid, many.components, 5);
  EXPECT_EQ(voxelsOf(all), voxelsOf(placed));
  EXPECT_EQ(fragmentsOf(all), static_cast<int>(many.components.count()));

  const std::vector<Seed> some = seedsFromPoints(
      std::vector<SeedPoint>{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}}, many.solid, many.components, 5);
  ASSERT_EQ(some.size(), many.components.count() + 1);
  for (std::size_t i = 0; i < many.components.count(); ++i) EXPECT_EQ(some[i].fragment, i + 1);
  EXPECT_EQ(some.back(), (Seed{{1, 0, 0}, 1}));
}

TEST_F(SeedFile, AFragmentLiesInOneComponent) {
  const ShapeSolid plates = make(
      voxel_shapes::solidWhere("plates", 4, [](const Coord& v) { return std::abs(v.z()) == 3; }));
  const std::string text = refusal(plates, listOf(R"({"fragment":1,"position":[0,0,3]},
      {"fragment":1,"position":[1,0,3]}, {"fragment":1,"position":[0,0,-3]})"));
  EXPECT_NE(text.find("seed 3 of fragment 1"), std::string::npos) << text;
  EXPECT_NE(text.find("than seed 1;"), std::string::npos) << text;
}

TEST_F(SeedFile, OtherMembersAreIgnored) {
  const ShapeSolid ball = make(voxel_shapes::ball(4));
  hold(R"({"note": {"by": ["a", {"b": null}]}, "schema": "sherd-seeds/1",
           "seeds": [{"position": [0, 0, 1], "weight": 3, "fragment": 1}]})");
  EXPECT_EQ(seedsFromPoints(readSeedPoints(file_), ball.solid, ball.components),
            (std::vector<Seed>{{{0, 0, 1}, 1}}));
}

TEST_F(SeedFile, HostileFilesAreRefused) {
  const ShapeSolid ball = make(voxel_shapes::ball(4));
  const std::string good = R"({"fragment":1,"position":[0,0,0]},)";
  const auto expect = [&](const std::string& text, const std::string& sentence) {
    const std::string found = refusal(ball, text);
    EXPECT_NE(found.find(sentence), std::string::npos) << found;
  };
  expect("", "is not JSON from byte");
  expect(std::string("\0\xff\xfe", 3), "is not JSON from byte");
  expect("{\"schema\": \"sherd-seeds/1\", \"seeds\": [", "is not JSON from byte");
  expect(listOf("") + "x", "is not JSON from byte");
  expect(listOf("\"\xff\""), "is not JSON from byte");
  expect(std::string(1'000'000, '['), "nested too deeply");
  expect(listOf(std::string(100, '[') + std::string(100, ']')), "nested too deeply");
  expect(R"("[[[[[[[[[[[[[[[[[[[[[[[[[[\"[[[")", "is not a JSON object");
  expect("[]", "is not a JSON object");
  expect("{}", "its \"schema\" is not");
  expect(R"({"schema": 1, "seeds": []})", "its \"schema\" is not");
  expect(R"({"schema": "sherd-seeds/2", "seeds": []})", "its \"schema\" is not");
  expect(R"({"schema": "sherd-seeds/1"})", "no list \"seeds\"");
  expect(R"({"schema": "sherd-seeds/1", "seeds": {}})", "no list \"seeds\"");
  expect(listOf(good + "7"), "seed 2 is not an object");
  expect(listOf(good + "{}"), "seed 2 has no whole number \"fragment\"");
  for (const char* fragment : {"\"1\"", "1.0", "null", "1e2", "[1]"}) {
    expect(listOf(good + "{\"position\":[0,0,0],\"fragment\":" + fragment + "}"),
           "seed 2 has no whole number \"fragment\"");
  }
  for (const char* fragment : {"0", "-1", "65535", "4294967297", "18446744073709551615"}) {
    expect(listOf(good + "{\"position\":[0,0,0],\"fragment\":" + fragment + "}"),
           std::string("seed 2 belongs to fragment ") + fragment);
  }
  for (const char* position : {"0", "[]", "[0,0]", "[0,0,0,0]", "[0,0,\"0\"]", "[0,0,null]",
                               "{\"0\":0,\"1\":0,\"2\":0}"}) {
    expect(listOf(good + "{\"fragment\":2,\"position\":" + position + "}"),
           "seed 2 has no \"position\" of three numbers");
  }
  for (const char* far : {"1e308", "-1e308", "99", "18446744073709551615"}) {
    expect(listOf(good + "{\"fragment\":2,\"position\":[0,0," + far + "]}"), "seed 2 lies");
  }
  expect(listOf(good + "{\"fragment\":2,\"position\":[0,0,1e999]}"), "no double can hold");
  expect(listOf(R"({"fragment":3,"position":[0,0,0]},)" + good.substr(0, good.size() - 1)),
         "fragment 2 has no seed");
}

TEST_F(SeedFile, WhatIsNoFileIsRefused) {
  EXPECT_THROW((void)readSeedPoints(file_), Error);  // absent
  EXPECT_THROW((void)readSeedPoints(fs::temp_directory_path()), Error);
  EXPECT_THROW((void)readSeedPoints("/dev/zero"), Error);
  hold("");
  fs::resize_file(file_, std::uintmax_t{1} << 40);  // a hole
  try {
    (void)readSeedPoints(file_);
    ADD_FAILURE() << "a file of 1 TiB is read";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("at most 67108864 are read"), std::string::npos);
  }
}

}  // namespace
}  // namespace sherd
