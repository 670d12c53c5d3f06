// Fractures that are written while they are made.
#include <gtest/gtest.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>

#include <atomic>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <thread>

#include "kernels/device_fixture.h"
#include "shapes.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

std::map<std::string, std::string> filesBelow(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    files[entry.path().lexically_relative(folder).string()] = {std::istreambuf_iterator<char>(in),
                                                               {}};
  }
  return files;
}

class FractureInto : public DeviceTest {
 protected:
  // Write a fracture both ways, which must be the same, and return it as it was made while writing.
  FractureResult bothWays(const FractureOptions& options, const WriteOptions& write) {
    const FractureResult whole = fracture(source_.mesh, options, device());
    (void)writeFracture(folder_.path() / "whole", source_, options, whole, write);
    const WrittenFracture written =
        fractureInto(folder_.path() / "into", {source_}, options, device(), write);
    EXPECT_EQ(written.folder.manifest, folder_.path() / "into" / "manifest.json");
    const auto expected = filesBelow(folder_.path() / "whole"),
               files = filesBelow(folder_.path() / "into");
    EXPECT_EQ(files.size(), expected.size());
    for (const auto& [name, bytes] : expected) {
      EXPECT_TRUE(files.contains(name) && files.at(name) == bytes) << name;
    }
    return written.result;
  }

  OwnFolder folder_;
  SourceMesh source_{.mesh = shapes::torus(1.0, 0.4),
                     .name = "ring.obj",
                     .stem = "ring",
                     .sha256 = std::string(64, 'a')};
  FractureOptions options_{.pieces = 7, .solid = {.resolution = 48}};
};

TEST_F(FractureInto, WritesPointsWithoutMeshes) {
  options_.missing = 2;
  WriteOptions write{.vdb = false, .mesh = false, .preview = false};
  write.points.count = 50;
  for (const bool share : {false, true}) {
    write.sharePoints = share;
    for (const int erosions : {0, 1}) {
      options_.erode.iterations = erosions;
      const FractureResult result = bothWays(optionsFor(options_, write), write);
      EXPECT_NE(result.surfaces, nullptr);
      for (const Fragment& fragment : result.fragments) {
        EXPECT_TRUE(fragment.mesh.vertices.empty());
        EXPECT_GT(fragment.mass.volume, 0.0);
      }
    }
  }
}

TEST_F(FractureInto, RefusesFilesOfMeshesThatWereNotMade) {
  const WriteOptions points{.vdb = false, .mesh = false, .preview = false};
  const FractureOptions bare = optionsFor(options_, points);
  const FractureResult result = fracture(source_.mesh, bare, device());
  const auto folder = folder_.path() / "refused";
  EXPECT_THROW((void)writeFracture(folder, source_, bare, result, {.vdb = false}), Error);
  WriteOptions tooMany = points;
  tooMany.points.count = kMaxPoints + 1;
  EXPECT_THROW((void)writeFracture(folder, source_, bare, result, tooMany), Error);
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(FractureInto, LetsGoOfMeshesAndLevelSetsThatNoFileNeeds) {
  options_.missing = 2;
  const FractureResult result = bothWays(options_, {.preview = false, .graph = true});
  EXPECT_EQ(result.kept(), 5u);
  EXPECT_EQ(result.surfaces, nullptr);
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(fragment.surface, nullptr);
    EXPECT_TRUE(fragment.mesh.triangles.empty());
    EXPECT_GT(fragment.mass.volume, 0.0);
    EXPECT_FALSE(fragment.contacts.empty());
  }
}

// Progress::report is called by the thread that called the function, whatever else runs;
// Progress::cancelled by any.
TEST_F(FractureInto, ReportsFromTheCallersThread) {
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<int> elsewhere{0};
  std::set<std::string> stages;
  const Progress progress{.report =
                              [&](std::string_view stage, double fraction) {
                                if (std::this_thread::get_id() != caller) ++elsewhere;
                                EXPECT_TRUE(fraction >= 0.0 && fraction <= 1.0) << stage;
                                stages.insert(std::string(stage));
                              },
                          .cancelled = [] { return false; }};
  options_.erode.iterations = 1;
  WriteOptions write{.solid = true, .scene = true, .proxy = true};
  write.points.count = write.distances.count = 20;
  (void)fractureInto(folder_.path() / "into", {source_}, options_, device(), write, &progress);
  EXPECT_EQ(elsewhere, 0);
  for (const char* stage : {"voxelize", "erode", "extract", "distances", "write", "render"}) {
    EXPECT_TRUE(stages.contains(stage)) << stage;
  }
}

TEST_F(FractureInto, DrawsWhatItLetsGoOf) {
  const FractureResult result = bothWays(options_, {.vdb = false});
  EXPECT_TRUE(fs::exists(folder_.path() / "into" / "preview.png"));
  for (const Fragment& fragment : result.fragments) {
    EXPECT_TRUE(fragment.mesh.triangles.empty());
  }
}

TEST_F(FractureInto, KeepsWhatFilesOfAllFragmentsNeed) {
  WriteOptions write{
      .preview = true, .seeds = true, .boundaries = true, .solid = true, .scene = true};
  write.vdbFiles = VdbFiles::both;
  write.points.count = 1000;
  write.sharePoints = true;
  write.correspondences = 100;
  write.proxy = true;
  const FractureResult result = bothWays(options_, write);
  for (const Fragment& fragment : result.fragments) {
    EXPECT_NE(fragment.surface, nullptr);
    EXPECT_FALSE(fragment.mesh.triangles.empty());
  }
}

TEST_F(FractureInto, MakesTheSameOfEveryKindOfSurface) {
  const WriteOptions write{.preview = false};
  FractureOptions eroded = options_;
  eroded.erode.iterations = 2;
  (void)bothWays(eroded, write);
  FractureOptions shaped = options_;
  shaped.surface.smooth.iterations = {3, 0.0};
  shaped.surface.adaptivity = 0.1;
  shaped.surface.triangles = {200};
  (void)bothWays(shaped, write);
  FractureOptions alone = options_;
  alone.surface.interface = Interface::independent;
  (void)bothWays(alone, write);
  FractureOptions labels = options_;
  labels.surface.surface = Surface::labels;
  (void)bothWays(labels, write);
}

// Its 27^3 leaves are too many for one round, and to be meshed at once.
TEST_F(FractureInto, MakesTheSameInSeveralRounds) {
  source_.mesh = shapes::cube(1.0);
  options_.solid.resolution = 210;
  options_.pieces = 12;
  const FractureResult result = bothWays(options_, {.preview = false, .boundaries = true});
  double volume = 0.0;
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(openEdges(fragment.mesh), 0u);
    EXPECT_EQ(nonManifoldEdges(fragment.mesh), 0u);
    volume += fragment.mass.volume;
  }
  EXPECT_NEAR(volume, 1.0, 1e-3);
}

}  // namespace
}  // namespace sherd
