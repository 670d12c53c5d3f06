// Which of the files that a manifest lists are a fracture's by their names.
#include "folder/manifest/own_files.h"

#include <gtest/gtest.h>
#include <sherd/files.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "base/text/option_names.h"
#include "folder/manifest/file_names.h"
#include "folder/manifest/read_manifest.h"

namespace sherd {
namespace {

using Json = nlohmann::json;
using Files = std::vector<std::string>;

// The names of a fracture's files as its manifest has them, with all that names the stem.
Json manifestWith(const FractureFiles& files) {
  Json json = {{"schema", kManifestSchema}, {"files", files.all()}, {"fragments", Json::array()}};
  const std::size_t fragments = std::max({files.vdb.size(), files.mesh.size(), files.points.size(),
                                          files.sdf.size(), files.proxy.size()});
  for (std::size_t i = 0; i < fragments; ++i) {
    Json own = Json::object();
    if (!files.vdb.empty()) own["vdb"] = files.vdb[i];
    if (!files.mesh.empty()) own["mesh"] = files.mesh[i];
    if (!files.points.empty()) own["points"] = files.points[i];
    if (!files.sdf.empty()) own["sdf"] = files.sdf[i];
    if (!files.proxy.empty()) own["proxy"] = files.proxy[i];
    json["fragments"].push_back({{"files", own}});
  }
  if (!files.solidVdb.empty()) json["solid"]["vdb"] = files.solidVdb;
  if (!files.solidMesh.empty()) json["solid"]["mesh"] = files.solidMesh;
  if (!files.solidSdf.empty()) json["sdf"] = files.solidSdf;
  return json;
}

template <class Value, std::size_t n>
std::vector<Value> allOf(const char* const (&)[n]) {
  std::vector<Value> values;
  for (std::size_t i = 0; i < n; ++i) values.push_back(static_cast<Value>(i));
  return values;
}

TEST(OwnFiles, AreAllThatAnyOptionsName) {
  MaterialTable table;
  for (const char* image : {"wood.png", "bark_2.jpg", "sky.image", "a_001.png"}) {
    table.textures.push_back({image, "", ImageType::other});
  }
  const std::vector<std::string> stems{"vase",  "a b",      "a_001", "vase_001_t2000",
                                       "x_t5",  "..x",      "v.tar", "",
                                       "größe", "a\xff\nb", ".mtl",  std::string(250, 'x')};
  for (const std::string& stem : stems) {
    for (const std::size_t fragments : {0, 1, 12, 1234}) {
      for (unsigned bits = 0; bits < 64; ++bits) {
        if (fragments > 12 && bits != 59) continue;  // one of many files is enough
        WriteOptions write;
        write.labels = write.preview = write.seeds = write.boundaries = write.cost = bits & 1;
        write.scene = write.usd = write.graph = write.houdini = write.viewer = bits & 1;
        write.vdb = bits & 2;
        write.vdbFiles = bits & 4 ? VdbFiles::single : VdbFiles::both;
        write.mesh = bits & 8;
        write.solid = bits & 16;
        write.proxy = bits & 32;
        write.points.count = write.distances.count = bits & 32;
        write.correspondences = bits & 32;
        write.voxelFormats = allOf<VoxelFormat>(names::kVoxelFormat);
        write.meshFormats = allOf<MeshFileFormat>(names::kMeshFileFormat);
        write.usdFormats = allOf<UsdFormat>(names::kUsdFormat);
        write.pointFormats = allOf<PointFormat>(names::kPointFormat);
        SourceMesh source;
        source.stem = stem;
        const FractureFiles files = fileNames(source, fragments, {1, 2000}, table, write);
        const std::optional<OwnFiles> found = ownFiles(manifestWith(files));
        ASSERT_TRUE(found);
        // What a fracture without any fragment names after its stem is of no use to anybody.
        if (fragments > 0) {
          EXPECT_EQ(found->others, Files{}) << stem << ' ' << fragments << ' ' << bits;
        }
        ASSERT_EQ(found->own.size() + found->others.size(),
                  std::set<std::string>(found->own.begin(), found->own.end()).size() +
                      found->others.size());
      }
    }
  }
}

TEST(OwnFiles, AreNoOthersWhateverTheManifestSays) {
  const Files mine{"notes.txt",         "labels.txt",         "src/main.cpp",
                   "meshes/notes.txt",  "meshes/b_001.ply",   "meshes/a_01.ply",
                   "meshes/a_0001.ply", "meshes/a_004.ply",   "meshes/a_000.ply",
                   "meshes/a_001.PLY",  "meshes/x/a_001.ply", "meshes/a_001_t.ply",
                   "points/a_001.txt",  "fragments/b.vdb",    "other/a_001.ply",
                   "meshes/.a.png",     "sdf/a_001.ply",      "meshes/a_001_tx.ply",
                   "a_001.ply",         "meshes/a_t7.ply",    "fragments/a_001.ply"};
  Files listed{"meshes/a_001.ply", "meshes/a_002.ply", "meshes/a_003.ply"};
  Json manifest = {{"schema", kManifestSchema}, {"fragments", Json::array()}};
  for (const std::string& file : listed) {
    manifest["fragments"].push_back({{"files", {{"mesh", file}}}});
  }
  listed.insert(listed.end(), mine.begin(), mine.end());
  manifest["files"] = listed;
  const std::optional<OwnFiles> found = ownFiles(manifest);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->own, (Files{"meshes/a_001.ply", "meshes/a_002.ply", "meshes/a_003.ply"}));
  EXPECT_EQ(found->others, mine);
}

TEST(OwnFiles, AreFewOfAManifestThatNamesNoStem) {
  for (const Json& fragments :
       {Json(), Json(7), Json::array(), Json::array({1}), Json::array({{{"files", 1}}}),
        Json::array({{{"files", {{"mesh", Json::array()}}}}}),
        Json::array({{{"files", {{"mesh", "../../a_001.ply"}, {"vdb", {1}}}}}}),
        Json::array({{{"files", {{"mesh", "meshes/.a_001.ply"}}}}})}) {
    const Json manifest = {{"schema", kManifestSchema},
                           {"fragments", fragments},
                           {"files",
                            {"labels.rle", "meshes/b_001.ply", "meshes/piece_001.ply",
                             "meshes/wood.png", "meshes/piece.ply", "fragments/b.vdb"}}};
    const std::optional<OwnFiles> found = ownFiles(manifest);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->own, Files{"labels.rle"}) << fragments;
  }
}

}  // namespace
}  // namespace sherd
