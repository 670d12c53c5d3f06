// Manifests that nobody of ours wrote: what is wrong with them is reported, and no file outside
// their folder is named.
#include "folder/manifest/read_manifest.h"

#include <gtest/gtest.h>
#include <sherd/error.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "temp_folder.h"

namespace sherd {
namespace {

using Json = nlohmann::json;

Json twoFragments() {
  return Json::parse(R"({
    "schema": "sherd/2",
    "source": {"file": "vase.obj", "unit": {"meters": 0.01, "from": "option"}, "up": {"axis": "y"}},
    "options": {"seed": 18446744073709551615},
    "grid": {"resolution": 24, "voxel_size": 0.5, "dims": [24, 20, 3], "index_min": [-2, 0, 1],
             "origin": [0.25, 0, -1.5],
             "solid_voxels": 700},
    "components": 1,
    "fragments": [
      {"id": 1, "voxels": 300, "share": 0.5, "volume": -0.25, "area": 2.0, "fracture_area": 0.5,
       "surface": "exact", "contacts": [{}], "files": {"mesh": "meshes/a.ply", "vdb": "fragments/a.vdb"}},
      {"id": 2, "voxels": 300, "share": 0.5, "volume": 1.0, "area": 2.0, "fracture_area": 0.5,
       "surface": "exact", "contacts": [{}], "files": {"mesh": ["meshes/b.obj", "meshes/b.ply"]}}],
    "files": ["labels.rle", "fragments/a.vdb", "meshes/a.ply", "meshes/b.obj", "meshes/b.ply"]
  })");
}

// What manifestOf says to `twoFragments` with one value set, or removed where it is discarded.
std::string refusal(const char* place, const Json& value) {
  Json json = twoFragments();
  const Json::json_pointer at(place);
  if (value.is_discarded()) {
    json.at(at.parent_pointer()).erase(at.back());
  } else {
    json[at] = value;
  }
  try {
    (void)manifestOf(json);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input);
    return e.what();
  }
  return "";
}

TEST(ReadManifest, BodiesAreNumbersOfTheInputs) {
  Json json = twoFragments();
  json["bodies"] = {{"input", 3}, {"united", 2}};
  json["fragments"][0]["bodies"] = {0, 2};
  json["fragments"][1]["bodies"] = Json::array();
  const Manifest manifest = manifestOf(json);
  EXPECT_EQ(manifest.bodies, 3);
  EXPECT_EQ(manifest.fragments[0].bodies, (std::vector<int>{0, 2}));
  EXPECT_TRUE(manifest.fragments[1].bodies.empty());
  for (const Json& bad :
       {Json(3), Json({3}), Json({-1}), Json({1, 1}), Json({2, 0}), Json({0.5})}) {
    json["fragments"][0]["bodies"] = bad;
    EXPECT_THROW((void)manifestOf(json), Error) << bad;
  }
  json["fragments"][0].erase("bodies");
  EXPECT_THROW((void)manifestOf(json), Error);
  for (const Json& bad : {Json(3), Json::object(), Json({{"input", 0}}), Json({{"input", "x"}})}) {
    json = twoFragments();
    json["bodies"] = bad;
    EXPECT_THROW((void)manifestOf(json), Error) << bad;
  }
}

TEST(ReadManifest, DecimatedMeshesAreListedFiles) {
  Json json = twoFragments();
  json["fragments"][1]["decimated"] = {{{"asked", 500}, {"file", {"meshes/b.obj", "meshes/b.ply"}}},
                                       {{"asked", 100}, {"file", "meshes/b.ply"}}};
  const Manifest manifest = manifestOf(json);
  EXPECT_TRUE(manifest.fragments[0].decimated.empty());
  ASSERT_EQ(manifest.fragments[1].decimated.size(), 2u);
  EXPECT_EQ(manifest.fragments[1].decimated[0],
            (std::vector<std::string>{"meshes/b.obj", "meshes/b.ply"}));
  EXPECT_EQ(manifest.fragments[1].decimated[1], std::vector<std::string>{"meshes/b.ply"});
  for (const Json& bad :
       {Json(3), Json({3}), Json({{{"asked", 1}}}), Json({{{"file", Json::array()}}}),
        Json({{{"file", "../a.ply"}}}), Json({{{"file", "other.ply"}}})}) {
    EXPECT_NE(refusal("/fragments/0/decimated", bad).find("is damaged: fragment 1"),
              std::string::npos)
        << bad;
  }
}

TEST(ReadManifest, GivesWhatIsThere) {
  const Manifest manifest = manifestOf(twoFragments());
  EXPECT_EQ(manifest.source, "vase.obj");
  EXPECT_EQ(manifest.seed, 18446744073709551615u);
  EXPECT_EQ(manifest.resolution, 24);
  EXPECT_FALSE(manifest.automatic);
  EXPECT_EQ(manifest.voxelSize, 0.5);
  EXPECT_EQ(manifest.dims, openvdb::Coord(24, 20, 3));
  EXPECT_EQ(manifest.indexMin, openvdb::Coord(-2, 0, 1));
  EXPECT_EQ(manifest.files.size(), 5u);
  ASSERT_EQ(manifest.fragments.size(), 2u);
  EXPECT_EQ(manifest.fragments[0].volume, -0.25);
  EXPECT_EQ(manifest.fragments[0].vdb, "fragments/a.vdb");
  EXPECT_EQ(manifest.fragments[0].contacts, 1u);
  EXPECT_EQ(manifest.fragments[1].meshes,
            (std::vector<std::string>{"meshes/b.obj", "meshes/b.ply"}));
  EXPECT_EQ(manifest.fragments[1].vdb, "");
}

TEST(ReadManifest, RefusesWhatIsMissing) {
  const Json gone = Json::parse("", nullptr, /*allow_exceptions=*/false);
  for (const char* place : {"/schema",
                            "/source",
                            "/source/file",
                            "/source/unit",
                            "/source/up",
                            "/options",
                            "/options/seed",
                            "/grid",
                            "/grid/resolution",
                            "/grid/voxel_size",
                            "/grid/dims",
                            "/grid/index_min",
                            "/grid/origin",
                            "/grid/solid_voxels",
                            "/components",
                            "/fragments",
                            "/files",
                            "/fragments/1/id",
                            "/fragments/1/voxels",
                            "/fragments/1/share",
                            "/fragments/1/volume",
                            "/fragments/1/area",
                            "/fragments/1/fracture_area",
                            "/fragments/1/surface",
                            "/fragments/1/contacts",
                            "/fragments/1/files"}) {
    EXPECT_NE(refusal(place, gone), "") << place;
  }
  EXPECT_EQ(refusal("/fragments/1/area", gone), "is damaged: fragment 2 has no \"area\"");
}

TEST(ReadManifest, RefusesOtherKinds) {
  for (const char* place : {"",
                            "/source",
                            "/source/file",
                            "/options",
                            "/options/seed",
                            "/grid",
                            "/grid/resolution",
                            "/grid/voxel_size",
                            "/grid/dims",
                            "/grid/dims/0",
                            "/grid/index_min",
                            "/grid/origin",
                            "/grid/solid_voxels",
                            "/components",
                            "/fragments",
                            "/fragments/0",
                            "/fragments/1/id",
                            "/fragments/1/voxels",
                            "/fragments/1/share",
                            "/fragments/1/contacts",
                            "/fragments/1/files",
                            "/fragments/1/files/mesh",
                            "/fragments/0/files/vdb",
                            "/files",
                            "/files/0",
                            "/vdb"}) {
    for (const Json& value :
         {Json(true), Json(nullptr), Json("text"), Json({{"a", 1}}), Json({7}), Json(-1.5)}) {
      const std::string at = place;
      const bool fits =
          ((at == "/source/file" || at == "/files/0") && value == "text") ||
          (at == "/fragments/1/files" && value.is_object()) ||
          (at == "/fragments/1/contacts" && value.is_array());  // they are only counted
      EXPECT_EQ(refusal(place, value) == "", fits) << place << " " << value;
    }
  }
}

TEST(ReadManifest, RefusesNumbersOutOfRange) {
  const std::vector<std::pair<const char*, Json>> wrong{
      {"/options/seed", -1},
      {"/grid/resolution", 0},
      {"/grid/resolution", 1ull << 40},
      {"/grid/voxel_size", 0.0},
      {"/grid/voxel_size", -0.5},
      {"/grid/dims/1", 0},
      {"/grid/dims/1", 1ull << 33},
      {"/grid/dims", {1, 2}},
      {"/grid/dims", {1, 2, 3, 4}},
      {"/grid/index_min/2", -(1ll << 31)},
      {"/grid/solid_voxels", -5},
      {"/components", -1},
      {"/fragments/0/share", 1.5},
      {"/fragments/0/area", -1.0},
      {"/fragments/0/fracture_area", -1.0},
      {"/fragments/0/voxels", -1},
      {"/fragments", Json::array()},
      {"/fragments", std::vector<Json>(65535, Json::object())}};
  for (const auto& [place, value] : wrong) EXPECT_NE(refusal(place, value), "") << place;
}

TEST(ReadManifest, RefusesIdsThatDoNotGoUpByOne) {
  for (const Json& id : {Json(1), Json(3), Json(0), Json(-2), Json(65536 + 2), Json(1ull << 63)}) {
    EXPECT_NE(refusal("/fragments/1/id", id), "") << id;
  }
  EXPECT_EQ(refusal("/fragments/1/id", 1),
            "is damaged: fragment 2 has id 1, ids go up from 1 by 1");
}

TEST(ReadManifest, RefusesFilesThatLeaveTheFolder) {
  for (const std::string& name :
       {std::string("../a"), std::string("a/../../b"), std::string("/etc/passwd"), std::string(""),
        std::string("a/"), std::string("./a"), std::string("a\0b", 3), std::string(256, 'x'),
        "a/" + std::string(256, 'x'), std::string(5000, '/'), std::string("manifest.json"),
        std::string(".sherd-partial/new/a"), std::string("..")}) {
    EXPECT_NE(refusal("/files/0", name), "") << name;
  }
  EXPECT_EQ(refusal("/files/0", "..a/b.."), "");
}

TEST(ReadManifest, RefusesFilesThatItDoesNotList) {
  EXPECT_NE(refusal("/fragments/0/files/mesh", "../a.ply"), "");
  EXPECT_NE(refusal("/fragments/1/files/mesh/1", "meshes/c.ply"), "");
  EXPECT_NE(refusal("/fragments/0/files/vdb", "/etc/passwd"), "");
  EXPECT_NE(refusal("/vdb", "fragments.vdb"), "");
}

using ListedFile = TempFolder;

TEST_F(ListedFile, MayBeALinkWithinTheFolderOnly) {
  namespace fs = std::filesystem;
  const fs::path folder = folder_ / "out", manifest = folder / "manifest.json";
  fs::create_directories(folder / "meshes");
  std::ofstream(folder / "meshes" / "a.ply") << "inside";
  std::ofstream(folder_ / "b.ply") << "outside";
  fs::create_symlink("meshes/a.ply", folder / "link.ply");
  fs::create_symlink("../b.ply", folder / "out.ply");
  fs::create_directory_symlink("..", folder / "up");
  fs::create_symlink("loop.ply", folder / "loop.ply");
  fs::create_directory_symlink("out", folder_ / "alias");
  EXPECT_EQ(listedFile(manifest, "meshes/a.ply"), folder / "meshes/a.ply");
  EXPECT_EQ(listedFile(manifest, "link.ply"), folder / "link.ply");
  EXPECT_EQ(listedFile(folder_ / "alias" / "manifest.json", "link.ply"),
            folder_ / "alias" / "link.ply");
  EXPECT_EQ(listedFile(manifest, "meshes/absent.ply"), folder / "meshes/absent.ply");
  for (const char* name : {"out.ply", "up/b.ply", "up/absent.ply", "loop.ply"}) {
    EXPECT_THROW((void)listedFile(manifest, name), Error) << name;
  }
}

}  // namespace
}  // namespace sherd
