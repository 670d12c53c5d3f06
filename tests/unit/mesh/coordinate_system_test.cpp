// Units and axes of meshes' coordinates.
#include "mesh/coordinate_system.h"

#include <gtest/gtest.h>
#include <sherd/options.h>

#include <nlohmann/json.hpp>

#include "formats/gltf/gltf_root.h"
#include "formats/mesh/mesh_stream.h"

namespace sherd {
namespace {

TEST(CoordinateSystem, LengthsAreInTheirOwnUnitUnlessLongOrSmall) {
  EXPECT_EQ(lengthText(495.0, 0.001), "495 mm");
  EXPECT_EQ(lengthText(495.0, 1.0), "495 m");
  EXPECT_EQ(lengthText(12.0, 0.0254), "12 in");
  EXPECT_EQ(lengthText(0.005, 1.0), "5 mm");
  EXPECT_EQ(lengthText(25000.0, 0.001), "25 m");
  EXPECT_EQ(lengthText(25000.0, 1.0), "25 km");
  EXPECT_EQ(lengthText(2.0, 0.7), "1.4 m");  // a unit without a name
  EXPECT_EQ(lengthText(0.0, 1.0), "0 m");
}

TEST(CoordinateSystem, UnitsAreKnownUpToRoundingOfAFloat) {
  for (const LengthUnit& unit : kLengthUnits) {
    const LengthUnit* const found = unitOf(static_cast<double>(static_cast<float>(unit.meters)));
    ASSERT_NE(found, nullptr);
    EXPECT_STREQ(found->name, unit.name);
    EXPECT_EQ(metersOf(unit.name), unit.meters);
  }
  EXPECT_EQ(unitOf(0.7), nullptr);
  EXPECT_FALSE(metersOf("yard").has_value());
}

TEST(CoordinateSystem, OptionsHaveTheLastWord) {
  const CoordinateSystem read{0.01, 'x', CoordinateBasis::file, CoordinateBasis::file};
  WriteOptions write;
  EXPECT_EQ(coordinatesOf(read, write).metersPerUnit, 0.01);
  EXPECT_EQ(coordinatesOf(read, write).upFrom, CoordinateBasis::file);
  write.up = 'z';
  const CoordinateSystem given = coordinatesOf(read, write);
  EXPECT_EQ(given.up, 'z');
  EXPECT_EQ(given.upFrom, CoordinateBasis::option);
  EXPECT_EQ(given.unitFrom, CoordinateBasis::file);
}

TEST(CoordinateSystem, ARootIsOursOnlyWithJustItsTransform) {
  const CoordinateSystem own{0.001, 'z', CoordinateBasis::file, CoordinateBasis::file};
  const nlohmann::json asset = {{"extras", assetExtras(own)}};
  nlohmann::json root = rootTransform(own);
  const auto read = coordinatesBelow(asset, root);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->metersPerUnit, 0.001);
  EXPECT_EQ(read->up, 'z');
  EXPECT_FALSE(coordinatesBelow(nlohmann::json::object(), root).has_value());
  EXPECT_FALSE(coordinatesBelow({{"extras", "sherd"}}, root).has_value());
  for (const char* key : {"scale", "rotation"}) {
    nlohmann::json less = root;
    less.erase(key);
    EXPECT_FALSE(coordinatesBelow(asset, less).has_value()) << key;
  }
  root["translation"] = {1.0, 0.0, 0.0};
  EXPECT_FALSE(coordinatesBelow(asset, root).has_value());
}

TEST(CoordinateSystem, StreamsOfMeshesHoldWhatFilesSay) {
  RawMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_FALSE(meshFromStream(streamOf(mesh))->metersPerUnit.has_value());
  EXPECT_FALSE(meshFromStream(streamOf(mesh))->up.has_value());
  mesh.metersPerUnit = 0.0254;
  mesh.up = 'x';
  EXPECT_EQ(meshFromStream(streamOf(mesh))->metersPerUnit, 0.0254);
  EXPECT_EQ(meshFromStream(streamOf(mesh))->up, 'x');
  mesh.up = 'q';
  mesh.metersPerUnit = -1.0;
  EXPECT_FALSE(meshFromStream(streamOf(mesh))->metersPerUnit.has_value());
  EXPECT_FALSE(meshFromStream(streamOf(mesh))->up.has_value());
}

}  // namespace
}  // namespace sherd
