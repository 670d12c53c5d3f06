// What files hold, and that they appear whole or not at all.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <sherd/error.h>
#include <sherd/folder.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "base/files/atomic_file.h"
#include "cli/terminal/held_files.h"
#include "folder/manifest/read_manifest.h"
#include "formats/voxels/vdb.h"
#include "full_disk.h"
#include "shapes.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

void writeText(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

// Every file and folder below, hidden ones too.
std::set<std::string> below(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    names.insert(entry.path().lexically_relative(folder).string());
  }
  return names;
}

ErrorCode codeOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& e) {
    return e.code();
  }
  return ErrorCode{0};
}

using AtomicFileTest = TempFolder;
using WritePly = TempFolder;
using WriteVdb = TempFolder;
using WriteFracture = TempFolder;
using CheckFractureFolder = TempFolder;

TEST_F(AtomicFileTest, AppearsOnlyWhenCommitted) {
  AtomicFile file(folder_ / "a");
  file.write("one ");
  file.write("two");
  EXPECT_FALSE(fs::exists(folder_ / "a"));
  file.commit();
  EXPECT_EQ(bytesOf(folder_ / "a"), "one two");
  EXPECT_EQ(below(folder_), std::set<std::string>{"a"});
}

TEST_F(AtomicFileTest, LeavesNothingWithoutCommit) {
  writeText(folder_ / "a", "old");
  { AtomicFile(folder_ / "a").write("new"); }
  EXPECT_EQ(bytesOf(folder_ / "a"), "old");
  EXPECT_EQ(below(folder_), std::set<std::string>{"a"});
}

TEST_F(AtomicFileTest, ReplacesARegularFile) {
  writeText(folder_ / "a", "old and longer");
  writeWhole(folder_ / "a", "new");
  EXPECT_EQ(bytesOf(folder_ / "a"), "new");
}

TEST_F(AtomicFileTest, TakesNamesAsLongAsTheFileSystemDoes) {
  writeWhole(folder_ / std::string(255, 'n'), "x");
  EXPECT_EQ(bytesOf(folder_ / std::string(255, 'n')), "x");
}

TEST_F(AtomicFileTest, RefusesWhatIsNoRegularFile) {
  const auto refused = [](const fs::path& path) {
    return codeOf([&] { writeWhole(path, "x"); }) == ErrorCode::output;
  };
  fs::create_directory(folder_ / "sub");
  fs::create_symlink("elsewhere", folder_ / "link");
  ASSERT_EQ(::mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  EXPECT_TRUE(refused(folder_ / "sub"));
  EXPECT_TRUE(refused(folder_ / "link"));
  EXPECT_TRUE(refused(folder_ / "fifo"));
  EXPECT_TRUE(refused("/dev/full"));
  EXPECT_TRUE(refused("/dev/null"));
  EXPECT_TRUE(refused(folder_ / "absent" / "a"));
  EXPECT_EQ(below(folder_), (std::set<std::string>{"sub", "link", "fifo"}));
  struct stat device {};
  ASSERT_EQ(::stat("/dev/full", &device), 0);
  EXPECT_TRUE(S_ISCHR(device.st_mode));
}

TEST_F(AtomicFileTest, NamesWhereAFullDiskStoppedItAndLeavesNothing) {
  std::string sentence;
  {
    const FullDisk full(3'000'000);
    try {
      AtomicFile file(folder_ / "a");
      for (int i = 0; i < 8; ++i) file.write(std::string(1'000'000, 'x'));
      file.commit();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::output);
      sentence = e.what();
    }
  }
  EXPECT_EQ(sentence, (folder_ / "a").string() + ": file too large after 3 MB");
  EXPECT_TRUE(below(folder_).empty());
}

// What a killed run of the same process number left, as every run in a container has number 1.
TEST_F(AtomicFileTest, TakesAnotherNameWhereATemporaryFileIsLeft) {
  std::string name;
  {
    const AtomicFile file(folder_ / "a");
    name = *below(folder_).begin();
  }
  ASSERT_TRUE(isTemporaryName(name)) << name;
  const std::size_t number = name.find_first_of("0123456789", name.rfind('-'));
  const int next = std::stoi(name.substr(number)) + 1;
  std::set<std::string> left{"a"};
  for (int i = next; i < next + 3; ++i) {
    left.insert(name.substr(0, number) + std::to_string(i) + ".tmp");
  }
  for (const std::string& file : left) writeText(folder_ / file, "left");
  writeWhole(folder_ / "a", "new");
  EXPECT_EQ(bytesOf(folder_ / "a"), "new");
  EXPECT_EQ(below(folder_), left);
}

TEST_F(AtomicFileTest, NamesItsTemporaryFilesLikeNoOther) {
  EXPECT_TRUE(isTemporaryName(".sherd-4411-65.tmp"));
  for (const char* other : {"", ".sherd-", ".sherd-.tmp", ".sherd-1.tmp", ".sherd--1.tmp",
                            ".sherd-1-.tmp", ".sherd-1-2-3.tmp", ".sherd-a-1.tmp", ".sherd-1-2",
                            ".sherd.tmp", ".sherd-probe-123456", "sherd-1-2.tmp"}) {
    EXPECT_FALSE(isTemporaryName(other)) << other;
  }
}

TEST_F(AtomicFileTest, PutsBackWhatItReplacedUnlessItIsKept) {
  writeText(folder_ / "a", "old");
  const auto inPlace = [this](const char* file, bool keeps) {
    const Uncut whole;
    AtomicFile out(folder_ / file);
    out.write("new");
    out.putInPlace();
    EXPECT_EQ(bytesOf(folder_ / file), "new");
    if (keeps) out.keep();
  };
  inPlace("a", false);
  inPlace("b", false);
  EXPECT_EQ(bytesOf(folder_ / "a"), "old");
  EXPECT_EQ(below(folder_), std::set<std::string>{"a"});
  inPlace("a", true);
  inPlace("b", true);
  EXPECT_EQ(bytesOf(folder_ / "a") + bytesOf(folder_ / "b"), "newnew");
  EXPECT_EQ(below(folder_), (std::set<std::string>{"a", "b"}));
}

TEST_F(AtomicFileTest, OfTwoOfOneNameLeaveTheOriginal) {
  writeText(folder_ / "a", "old");
  HeldFiles files;
  for (const char* text : {"one", "two"}) {
    files.take((folder_ / "a").string(), [&](const ByteSink& sink) { sink(text); });
  }
  const Uncut whole;
  files.putInPlace();
  EXPECT_EQ(bytesOf(folder_ / "a"), "two");
  EXPECT_EQ(files.drop(), "");
  EXPECT_EQ(bytesOf(folder_ / "a"), "old");
  EXPECT_EQ(below(folder_), std::set<std::string>{"a"});
}

// ---- PLY, read back by the format's own rules

struct Ply {
  std::vector<float> positions;
  std::vector<std::int32_t> neighborOfVertices;
  std::vector<std::int32_t> corners;
  std::vector<std::int32_t> neighbor;
  bool whole = false;
};

Ply readPly(const fs::path& path) {
  Ply ply;
  const std::string bytes = bytesOf(path);
  const std::size_t body = bytes.find("end_header\n") + 11;
  std::istringstream header(bytes.substr(0, body));
  std::size_t vertices = 0, faces = 0;
  bool neighbor = false;
  for (std::string line; std::getline(header, line);) {
    if (line.starts_with("element vertex ")) vertices = std::stoul(line.substr(15));
    if (line.starts_with("element face ")) faces = std::stoul(line.substr(13));
    neighbor |= line == "property int neighbor";
  }
  std::size_t at = body;
  const auto take = [&](auto& value) {
    if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
    at += sizeof value;
  };
  for (std::size_t i = 0; i < vertices; ++i) {
    for (int k = 0; k < 3; ++k) take(ply.positions.emplace_back());
    float normal = 0.0f;
    for (int k = 0; k < 3 && neighbor; ++k) take(normal);
    if (neighbor) take(ply.neighborOfVertices.emplace_back());
  }
  for (std::size_t f = 0; f < faces; ++f) {
    std::uint8_t n = 0;
    take(n);
    EXPECT_EQ(n, 3);
    for (int c = 0; c < 3; ++c) take(ply.corners.emplace_back());
    if (neighbor) take(ply.neighbor.emplace_back());
  }
  ply.whole = at == bytes.size();
  return ply;
}

const TriangleMesh kTetrahedron{{{0, 0, 0}, {1.5, 0, 0}, {0, -2.25, 0}, {0, 0, 1e-3}},
                                {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};

TEST_F(WritePly, HoldsVerticesFacesAndWhatTheyFace) {
  writePly(folder_ / "a.ply", shapes::withNeighbor(kTetrahedron, {0, 7, 65534, 0}));
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
      "property int neighbor\nelement face 4\nproperty list uchar int vertex_indices\n"
      "property int neighbor\nend_header\n";
  EXPECT_EQ(bytesOf(folder_ / "a.ply").substr(0, header.size()), header);
  const Ply ply = readPly(folder_ / "a.ply");
  EXPECT_TRUE(ply.whole);
  EXPECT_EQ(ply.positions, (std::vector<float>{0, 0, 0, 1.5f, 0, 0, 0, -2.25f, 0, 0, 0, 1e-3f}));
  EXPECT_EQ(ply.corners, (std::vector<std::int32_t>{0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2}));
  EXPECT_EQ(ply.neighbor, (std::vector<std::int32_t>{0, 7, 65534, 0}));
  EXPECT_EQ(ply.neighborOfVertices, (std::vector<std::int32_t>{7, 7, 65534, 65534}));
}

TEST_F(WritePly, LeavesNeighborsOutWhereTheyAreNotGiven) {
  writePly(folder_ / "a.ply", kTetrahedron);
  const Ply ply = readPly(folder_ / "a.ply");
  EXPECT_TRUE(ply.whole);
  EXPECT_EQ(ply.corners.size(), 12u);
  EXPECT_TRUE(ply.neighbor.empty());
}

// ---- VDB, read back by OpenVDB's own file reader

Fragment ballFragment(int id) {
  openvdb::initialize();
  Fragment fragment;
  fragment.id = id;
  fragment.voxels = 100;
  auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(2.0f, {1, 2, 3}, 0.1f);
  grid->setName("not this name");
  fragment.surface = grid;
  fragment.mesh = kTetrahedron;
  fragment.mesh.neighbor = {0, 0, 0, 0};
  fragment.mass.volume = 33.5;
  fragment.mass.centroid = {1, 2, -0.0};
  return fragment;
}

TEST_F(WriteVdb, IsALevelSetWithItsMetadata) {
  const Fragment fragment = ballFragment(12);
  writeVdb(folder_ / "a.vdb", fragment, {"vase.obj", 0xffffffffffffffff});
  openvdb::io::File file((folder_ / "a.vdb").string());
  file.open();
  EXPECT_TRUE(file.getMetadata()->metaValue<std::string>("creator").starts_with("sherd "));
  ASSERT_EQ(file.getGrids()->size(), 1u);
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("surface"));
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(grid->background(), fragment.surface->background());
  EXPECT_EQ(grid->transform(), fragment.surface->transform());
  EXPECT_TRUE(grid->tree().hasSameTopology(fragment.surface->tree()));
  for (auto it = fragment.surface->cbeginValueOn(); it; ++it) {
    ASSERT_EQ(grid->tree().getValue(it.getCoord()), *it);
  }
  EXPECT_EQ(grid->metaValue<std::string>("piece"), "piece12");
  EXPECT_EQ(grid->metaValue<std::int32_t>("fragment_id"), 12);
  EXPECT_EQ(grid->metaValue<openvdb::Vec3d>("pivot"), openvdb::Vec3d(1, 2, 0));
  EXPECT_EQ(grid->metaValue<double>("volume"), 33.5);
  EXPECT_EQ(grid->metaValue<std::string>("seed"), "18446744073709551615");
  EXPECT_EQ(grid->metaValue<std::string>("source"), "vase.obj");
  EXPECT_EQ(grid->metaValue<openvdb::Vec3i>("file_bbox_min"),
            fragment.surface->evalActiveVoxelBoundingBox().min().asVec3i());
}

TEST_F(WriteVdb, GivesEqualBytesForEqualFragmentsAndAnotherIdForOthers) {
  writeVdb(folder_ / "a.vdb", ballFragment(1), {"vase.obj", 7});
  writeVdb(folder_ / "b.vdb", ballFragment(1), {"vase.obj", 7});
  writeVdb(folder_ / "c.vdb", ballFragment(2), {"vase.obj", 7});
  EXPECT_EQ(bytesOf(folder_ / "a.vdb"), bytesOf(folder_ / "b.vdb"));
  const auto id = [&](const char* name) {
    openvdb::io::File file((folder_ / name).string());
    file.open();
    return file.getUniqueTag();
  };
  EXPECT_EQ(id("a.vdb"), id("b.vdb"));
  EXPECT_NE(id("a.vdb"), id("c.vdb"));
}

TEST_F(WriteVdb, OfAllHasTheIdOfEveryVoxel) {
  Solid solid;
  const auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1.0f, {0, 0, 0}, 0.1f);
  solid.distance = grid;
  LeafBlocks blocks{.origins = {{-8, 0, 0}, {0, 0, 0}}};
  blocks.inside.assign(16, 0);
  blocks.exteriorBand.assign(16, 0);
  Labels labels;
  labels.fragment.assign(1024, 0);
  for (std::size_t voxelIndex = 0; voxelIndex < 1024; voxelIndex += 3) {
    blocks.inside[voxelIndex / 64] |= std::uint64_t{1} << (voxelIndex % 64);
    labels.fragment[voxelIndex] = static_cast<std::uint16_t>(1 + voxelIndex % 4);  // of 2 fragments
  }
  labels.fragment[3] = Labels::kEroded;
  solid.blocks = labels.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  std::vector<Fragment> fragments(2);
  for (std::size_t i = 0; i < 2; ++i) {
    fragments[i].id = static_cast<int>(i) + 1;
    fragments[i].surface = grid;
  }
  writeVdbOfAll(folder_ / "all.vdb", fragments, labels, {"ball.obj", 7});
  openvdb::io::File file((folder_ / "all.vdb").string());
  file.open();
  std::vector<std::string> names;
  for (auto name = file.beginName(); name != file.endName(); ++name) names.push_back(*name);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"fragment_id", "surface_1", "surface_2"}));
  const auto ids = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid("fragment_id"));
  ASSERT_TRUE(ids);
  EXPECT_EQ(ids->background(), 0);
  EXPECT_EQ(ids->transform(), grid->transform());
  openvdb::Index64 active = 0;
  solid.blocks->forEachInside([&](std::size_t voxelIndex) {
    const openvdb::Coord at = solid.blocks->voxelAt(voxelIndex);
    const std::uint16_t label = labels.fragment[voxelIndex];
    EXPECT_EQ(ids->tree().getValue(at), label <= 2 ? label : 0);
    EXPECT_TRUE(ids->tree().isValueOn(at));
    ++active;
  });
  EXPECT_EQ(ids->activeVoxelCount(), active);
}

TEST_F(WriteVdb, NoticesAFullDisk) {
  const Fragment fragment = ballFragment(1);
  const FullDisk full(10'000);
  EXPECT_EQ(codeOf([&] { writeVdb(folder_ / "a.vdb", fragment, {}); }), ErrorCode::output);
  EXPECT_TRUE(below(folder_).empty());
}

TEST_F(WriteVdb, IsDescribedAsItIs) {
  writeVdb(folder_ / "a.vdb", ballFragment(3), {"vase.obj", 7});
  const VdbFile file = describeVdb(folder_ / "a.vdb");
  ASSERT_EQ(file.grids.size(), 1u);
  EXPECT_EQ(file.grids[0].name, "surface");
  EXPECT_EQ(file.grids[0].gridClass, "level set");
  EXPECT_EQ(file.grids[0].activeVoxels, ballFragment(3).surface->activeVoxelCount());
}

TEST_F(WriteVdb, IsRefusedByDescribeVdbWhenCut) {
  writeVdb(folder_ / "a.vdb", ballFragment(3), {"vase.obj", 7});
  const std::string bytes = bytesOf(folder_ / "a.vdb");
  for (std::size_t n = 0; n < bytes.size(); n += 1 + n / 7) {
    writeText(folder_ / "cut.vdb", bytes.substr(0, n));
    EXPECT_EQ(codeOf([&] { (void)describeVdb(folder_ / "cut.vdb"); }), ErrorCode::input) << n;
  }
}

// ---- A fracture's folder.  The fragments are not those of the solid: the folder's rules do not
// ask.

struct Fracture {
  SourceMesh source;
  FractureOptions options;
  FractureResult result;
};

Fracture tinyFracture(int fragments) {
  Fracture f;
  f.source = {
      .mesh = kTetrahedron, .name = "vase.obj", .stem = "vase", .sha256 = std::string(64, 'a')};
  f.options.pieces = fragments;
  Solid& solid = f.result.solid;
  LeafBlocks blocks{.origins = {{0, 0, 0}}, .inside = std::vector<std::uint64_t>(8)};
  blocks.inside[0] = 1;
  solid.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  solid.box = {{0, 0, 0}, {0, 0, 0}};
  solid.voxels = 1;
  f.result.components = 1;
  f.result.labels.blocks = solid.blocks;
  f.result.labels.fragmentCount = fragments;
  f.result.labels.fragment.assign(512, 1);
  for (int id = 1; id <= fragments; ++id) {
    f.result.fragments.push_back(ballFragment(id));
    f.result.fragments.back().voxels = id == 1 ? 1 : 0;
  }
  f.result.eroded.assign(static_cast<std::size_t>(fragments) + 1, 0);
  return f;
}

const WriteOptions kNoPreview{.preview = false};

void writeTiny(const fs::path& folder, int fragments, const Progress* progress = nullptr) {
  const Fracture f = tinyFracture(fragments);
  (void)writeFracture(folder, f.source, f.options, f.result, kNoPreview, progress);
}

const std::set<std::string> kTwoPieces{
    "manifest.json",          "labels.rle", "fragments",           "fragments/vase_001.vdb",
    "fragments/vase_002.vdb", "meshes",     "meshes/vase_001.ply", "meshes/vase_002.ply"};

TEST_F(WriteFracture, MakesTheFolderAndFillsItWithWhatTheManifestLists) {
  writeTiny(folder_ / "a" / "b", 2);
  EXPECT_EQ(below(folder_ / "a" / "b"), kTwoPieces);
  const auto manifest = manifestJson(folder_ / "a" / "b" / "manifest.json");
  ASSERT_TRUE(manifest);
  EXPECT_EQ(
      listedFiles(*manifest),
      (std::vector<std::string>{"labels.rle", "fragments/vase_001.vdb", "fragments/vase_002.vdb",
                                "meshes/vase_001.ply", "meshes/vase_002.ply"}));
}

TEST_F(WriteFracture, ManifestHoldsNoMinusZero) {
  writeTiny(folder_ / "out", 2);
  EXPECT_EQ(bytesOf(folder_ / "out" / "manifest.json").find("-0.0"), std::string::npos);
}

TEST_F(WriteFracture, ReplacesAnEarlierOneAndLeavesOtherFiles) {
  writeTiny(folder_ / "out", 3);
  writeText(folder_ / "out" / "notes.txt", "mine");
  writeText(folder_ / "out" / "meshes" / "mine.ply", "mine");
  writeTiny(folder_ / "out", 2);
  std::set<std::string> want = kTwoPieces;
  want.insert({"notes.txt", "meshes/mine.ply"});
  EXPECT_EQ(below(folder_ / "out"), want);
}

TEST_F(WriteFracture, RefusesAForeignFolder) {
  writeText(folder_ / "out" / "notes.txt", "mine");
  EXPECT_EQ(codeOf([&] { writeTiny(folder_ / "out", 2); }), ErrorCode::output);
  writeText(folder_ / "json" / "manifest.json", R"({"schema": "another/1", "files": []})");
  EXPECT_EQ(codeOf([&] { writeTiny(folder_ / "json", 2); }), ErrorCode::output);
  writeText(folder_ / "list" / "manifest.json",
            R"({"schema": "sherd/2", "files": ["a", "../notes"]})");
  EXPECT_EQ(codeOf([&] { writeTiny(folder_ / "list", 2); }), ErrorCode::output);
  EXPECT_EQ(below(folder_),
            (std::set<std::string>{"out", "out/notes.txt", "json", "json/manifest.json", "list",
                                   "list/manifest.json"}));
}

TEST_F(WriteFracture, RefusesAFileInItsWay) {
  writeTiny(folder_ / "out", 1);
  writeText(folder_ / "out" / "meshes" / "vase_002.ply", "mine");
  const std::set<std::string> before = below(folder_ / "out");
  EXPECT_EQ(codeOf([&] { writeTiny(folder_ / "out", 2); }), ErrorCode::output);
  EXPECT_EQ(below(folder_ / "out"), before);
  EXPECT_EQ(bytesOf(folder_ / "out" / "meshes" / "vase_002.ply"), "mine");
}

TEST_F(WriteFracture, DoesNotFollowALinkOutOfTheFolder) {
  writeTiny(folder_ / "out", 1);
  fs::rename(folder_ / "out" / "meshes", folder_ / "elsewhere");
  fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "out" / "meshes");
  EXPECT_EQ(codeOf([&] { writeTiny(folder_ / "out", 1); }), ErrorCode::output);
  EXPECT_TRUE(fs::exists(folder_ / "elsewhere" / "vase_001.ply"));
}

TEST_F(WriteFracture, LeavesNothingOnAFullDisk) {
  const Fracture f = tinyFracture(2);
  const FullDisk full(10'000);
  try {
    (void)writeFracture(folder_ / "a" / "out", f.source, f.options, f.result, kNoPreview);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::output);
    EXPECT_EQ(std::string(e.what()).find(".sherd-partial"), std::string::npos) << e.what();
  }
  EXPECT_TRUE(below(folder_).empty());
}

TEST_F(WriteFracture, KeepsTheOldOneWhenStopped) {
  writeTiny(folder_ / "out", 2);
  const std::string manifest = bytesOf(folder_ / "out" / "manifest.json");
  for (int stopAt = 0; stopAt < 4; ++stopAt) {
    int asked = 0;
    const Progress progress{.report = {}, .cancelled = [&] { return asked++ == stopAt; }};
    const ErrorCode code = codeOf([&] { writeTiny(folder_ / "out", 30, &progress); });
    EXPECT_EQ(code, ErrorCode::cancelled) << stopAt;
    EXPECT_EQ(below(folder_ / "out"), kTwoPieces);
    EXPECT_EQ(bytesOf(folder_ / "out" / "manifest.json"), manifest);
  }
}

TEST_F(WriteFracture, ClearsUpAfterARunThatWasKilledHalfWayIntoPlace) {
  // As the killed run left it: the old manifest set aside, one new file in place, one not yet; a
  // stranger's file.
  writeTiny(folder_ / "out", 3);
  const fs::path partial = folder_ / "out" / ".sherd-partial";
  fs::create_directories(partial / "old");
  fs::create_directories(partial / "new");
  fs::rename(folder_ / "out" / "manifest.json", partial / "old" / "manifest.json");
  writeText(partial / "new" / "manifest.json",
            R"({"schema": "sherd/2", "files": ["labels.npy", "preview.png"]})");
  writeText(partial / "new" / "preview.png", "x");
  writeText(folder_ / "out" / "labels.npy", "x");
  writeText(folder_ / "out" / "notes.txt", "mine");
  writeTiny(folder_ / "out", 2);
  std::set<std::string> want = kTwoPieces;
  want.insert("notes.txt");
  EXPECT_EQ(below(folder_ / "out"), want);
}

TEST_F(WriteFracture, RefusesAFolderThatAnotherRunIsWriting) {
  int inner = 0;
  const Progress progress{.report =
                              [&](std::string_view, double) {
                                if (inner++ == 0) {
                                  EXPECT_EQ(codeOf([&] { writeTiny(folder_ / "out", 1); }),
                                            ErrorCode::output);
                                }
                              },
                          .cancelled = {}};
  writeTiny(folder_ / "out", 2, &progress);
  EXPECT_GT(inner, 0);
  EXPECT_EQ(below(folder_ / "out"), kTwoPieces);
}

TEST_F(WriteFracture, TakesStemsThatNoFileSystemOrJsonTakes) {
  Fracture f = tinyFracture(1);
  for (const std::string& stem :
       {std::string(""), std::string("a\xff\nb"), std::string(250, 'x')}) {
    f.source.stem = stem;
    (void)writeFracture(folder_ / "out", f.source, f.options, f.result, kNoPreview);
    const auto files = listedFiles(*manifestJson(folder_ / "out" / "manifest.json"));
    ASSERT_TRUE(files);
    for (const std::string& file : *files)
      EXPECT_TRUE(fs::is_regular_file(folder_ / "out" / file)) << file;
  }
}

TEST_F(CheckFractureFolder, LeavesNothingBehind) {
  checkFractureFolder(folder_);
  checkFractureFolder(folder_ / "absent" / "too");
  EXPECT_TRUE(below(folder_).empty());
}

TEST_F(CheckFractureFolder, RefusesWhatCannotBeWritten) {
  writeText(folder_ / "file", "");
  const auto refused = [](const fs::path& path) {
    return codeOf([&] { checkFractureFolder(path); }) == ErrorCode::output;
  };
  EXPECT_TRUE(refused(""));
  EXPECT_TRUE(refused(folder_ / "file"));
  EXPECT_TRUE(refused(folder_ / "file" / "out"));
  EXPECT_TRUE(refused("/proc/out"));
  EXPECT_TRUE(refused("/dev/null"));
}

}  // namespace
}  // namespace sherd
