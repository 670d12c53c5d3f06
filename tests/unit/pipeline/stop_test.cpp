// Long work asks whether to stop, and what it was writing can be taken away by somebody else.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <sherd/files.h>
#include <sherd/fragments.h>
#include <sherd/solid.h>
#include <zlib.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/files/atomic_file.h"
#include "base/files/unfinished.h"
#include "cli/terminal/held_files.h"
#include "cut/cut.h"
#include "formats/voxels/voxel_faces.h"
#include "interface/cells/creases.h"
#include "interface/interface_mesh.h"
#include "mesh/repair/repair.h"
#include "remesh/complex.h"
#include "remesh/decimate/decimate.h"
#include "shapes.h"
#include "surface/extract.h"
#include "temp_folder.h"
#include "voxelize/band.h"
#include "voxelize/bodies/bridges.h"
#include "voxelize/fill/flood.h"
#include "voxelize/fill/generalized_winding.h"
#include "voxelize/fill/winding.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// How often `work` asks when nobody wants it to stop; and it has to stop wherever it is asked to.
std::size_t asksOf(const std::function<void(const Progress*)>& work) {
  std::atomic<std::size_t> asked{0};
  const Progress never{.report = {}, .cancelled = [&] {
                         ++asked;
                         return false;
                       }};
  work(&never);
  const std::size_t all = asked;
  for (const std::size_t at : {std::size_t{1}, all / 2 + 1}) {
    asked = 0;
    const Progress then{.report = {}, .cancelled = [&] { return ++asked >= at; }};
    try {
      work(&then);
      ADD_FAILURE() << "not stopped at question " << at << " of " << all;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
  }
  return all;
}

class StopFile : public TempFolder {};

TriangleMesh grown(double factor, TriangleMesh mesh) {
  for (glm::dvec3& v : mesh.vertices) v *= factor;
  return mesh;
}

TEST(Stop, VoxelizingAsksOftenEnough) {
  const TriangleMesh ball = grown(20.3, shapes::ball(1.0, 6));  // 81,920 triangles
  EXPECT_GE(asksOf([&](const Progress* p) { Winding(ball, Winding::Rule::signedCrossings, p); }),
            2 * ball.triangles.size() / 1024);
  const TriangleTree tree(ball);
  const std::size_t leaves = bandOf(tree, 3.0, nullptr).size();
  EXPECT_GE(asksOf([&](const Progress* p) { (void)bandOf(tree, 3.0, p); }), leaves);

  const SearchedMesh mesh = searched(ball);
  const Filling filling = fillingOf(chosenFill(mesh, {}), mesh, ball, {}, 1.0);
  const Solid solid = voxelize(ball, {.voxelSize = 1.0});
  EXPECT_GE(asksOf([&](const Progress* p) { (void)bridgesOf(*solid.blocks, filling, p); }),
            2 * solid.blocks->count());
  EXPECT_GE(asksOf([&](const Progress* p) { (void)voxelize(ball, {.voxelSize = 1.0}, p); }),
            3 * leaves);
}

TEST(Stop, FillingAsksBesidesItsColumns) {
  const TriangleMesh cube = grown(160.0, shapes::cube(1.0));  // of few triangles
  const std::size_t columns = asksOf([&](const Progress* p) { Winding(cube, {}, p); });
  EXPECT_GE(asksOf([&](const Progress* p) { FloodedBox(cube, p); }),
            3 * columns + 160 * 160 * 160 / 65536);
  const TriangleMesh doubled = shapes::append(cube, cube);
  EXPECT_GE(asksOf([&](const Progress* p) {
              GeneralizedWinding(doubled, {}, std::make_shared<TriangleTree>(doubled), p);
            }),
            columns + 160 * 160 / 1024);
}

TEST(Stop, RepairAsksForEachComponent) {
  TriangleMesh mesh = shapes::ball(10.0);
  constexpr int kComponents = 50;
  for (int i = 0; i < kComponents; ++i) {
    TriangleMesh small = shapes::transformed(shapes::cube(1.0), 1.0, {20.0 + 2.0 * i, 0.0, 0.0});
    for (glm::uvec3& t : small.triangles) std::swap(t.x, t.y);
    mesh = shapes::append(mesh, small);
  }
  EXPECT_EQ(repaired(mesh).defects.flippedComponents, std::size_t{kComponents});
  EXPECT_GE(asksOf([&](const Progress* p) { (void)repaired(mesh, p); }), std::size_t{kComponents});
}

TEST(Stop, SmoothingAsksForEachIteration) {
  const TriangleMesh ball = shapes::ball(1.0);
  const SmoothOptions options{.iterations = {100}};
  EXPECT_GE(asksOf([&](const Progress* p) { (void)smoothed(ball, options, 1, p); }), 100u);

  const Solid solid = voxelize(ball, {.resolution = 16});
  Labels labels{.blocks = solid.blocks, .fragmentCount = 1};
  labels.fragment.assign(solid.blocks->count() * 512, 1);
  for (const Interface kind : {Interface::shared, Interface::independent}) {
    const SurfaceOptions surface{.interface = kind, .smooth = options};
    EXPECT_GE(asksOf([&](const Progress* p) {
                (void)extractFragments(solid, labels, {.surface = surface}, p);
              }),
              100u);
  }
}

TEST_F(StopFile, UnpackingAsksForEachPiece) {
  const fs::path path = folder_ / "a.obj.gz";
  constexpr std::size_t kBytes = std::size_t{1} << 24;
  gzFile file = gzopen(path.c_str(), "wb1");
  const std::string blanks(kBytes, ' '),
      triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n#" + blanks;
  gzwrite(file, triangle.data(), static_cast<unsigned>(triangle.size()));
  gzclose(file);
  EXPECT_GE(asksOf([&](const Progress* p) { (void)readMesh(path, {}, p); }), kBytes >> 18);
}

TEST(Stop, TheFacesOfVoxelsAreAskedPlaneByPlane) {
  const RunLengthVoxels voxels{{60, 3, 3}, {{1, 60 * 9}}};
  EXPECT_GE(asksOf([&](const Progress* p) { (void)voxelFaces(voxels, {}, 10'000, p); }), 60u);
}

TEST(Stop, CuttingAsksOftenEnough) {
  const Solid solid = voxelize(shapes::ball(1.0), {.resolution = 40});
  Labels labels{.blocks = solid.blocks, .fragmentCount = 2};
  labels.fragment.assign(solid.blocks->count() * 512, 0);
  for (std::size_t voxelIndex = 0; voxelIndex < labels.fragment.size(); ++voxelIndex) {
    const bool isAny = solid.blocks->isInside(voxelIndex) ||
                       (solid.blocks->exteriorBand[voxelIndex / 64] >> (voxelIndex % 64) & 1) != 0;
    if (isAny) labels.fragment[voxelIndex] = solid.blocks->voxelAt(voxelIndex).x() % 16 < 8 ? 1 : 2;
  }
  const std::vector<LeafNeighbors> rounds = leafNeighbors(solid.blocks->origins);
  EXPECT_GE(
      asksOf([&](const Progress* p) { (void)findCut(labels, rounds, CutExtent::everywhere, p); }),
      solid.blocks->count() / 16);
  const Cut cut = findCut(labels, rounds);
  EXPECT_GE(asksOf([&](const Progress* p) {
              InterfaceSurface(solid, labels, cut, rounds, Creases(), nullptr, SurfaceVertices::all,
                               p);
            }),
            4u);
  const TriangleMesh ball = shapes::ball(1.0, 5);
  const LabeledComplex complex = complexOf(ball);
  const std::vector<std::size_t> triangles{100};
  EXPECT_GE(asksOf([&](const Progress* p) { (void)decimated(complex, triangles, p); }), 2u);
  EXPECT_GE(asksOf([&](const Progress* p) { (void)simplified(complex, 0.1, p); }), 2u);
}

TEST(Stop, MeasuringAsksOftenEnough) {
  const TriangleMesh ball = shapes::ball(1.0);
  constexpr std::size_t kSamples = 6400;
  EXPECT_GE(asksOf([&](const Progress* p) { (void)convexity(ball, kSamples, 0, p); }), 100u);
  const std::vector<FragmentMesh> one{{1, ball}};
  EXPECT_GE(asksOf([&](const Progress* p) { (void)fit(one, nullptr, {.samples = kSamples}, p); }),
            200u);
  FragmentSet set;
  set.fragments.resize(2);
  for (EvaluatedFragment& fragment : set.fragments) fragment.mesh = one.front();
  EXPECT_GE(
      asksOf([&](const Progress* p) { (void)evaluate(set, nullptr, {.samples = kSamples}, p); }),
      600u);
}

class UnfinishedTest : public TempFolder {
 protected:
  std::size_t left() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
};

TEST_F(UnfinishedTest, HeldFilesArePutInPlaceTogetherOrNotAtAll) {
  std::ofstream(folder_ / "a") << "old";
  {
    HeldFiles files;
    OutputFile(files, folder_ / "a").write(std::string_view("new"));
    OutputFile(files, folder_ / "b").write(std::string_view("new"));
    EXPECT_FALSE(fs::exists(folder_ / "b"));
    EXPECT_EQ(fs::file_size(folder_ / "a"), 3u);
  }
  EXPECT_EQ(left(), 1u);
  HeldFiles files;
  const auto fails = [](const ByteSink& sink) {
    sink("half");
    throw Error(ErrorCode::input, "no more");
  };
  EXPECT_THROW(OutputFile(files, folder_ / "c").write(fails), Error);
  OutputFile(files, folder_ / "b").write(std::string_view("new"));
  files.putInPlace();
  files.keep();
  EXPECT_EQ(left(), 2u);  // not the half one
  {
    HeldFiles undone;
    OutputFile(undone, folder_ / "a").write(std::string_view("newer"));
    OutputFile(undone, folder_ / "d").write(std::string_view("new"));
    undone.putInPlace();
    EXPECT_EQ(fs::file_size(folder_ / "a"), 5u);
    EXPECT_TRUE(fs::exists(folder_ / "d"));
  }
  EXPECT_EQ(fs::file_size(folder_ / "a"), 3u);
  EXPECT_EQ(left(), 2u);
}

// What the thread that waits for signals does when work does not heed them.
TEST_F(UnfinishedTest, NothingIsLeftOfWorkThatIsCut) {
  const auto cut = [&] {
    for (int i = 0; i < 3; ++i) {
      std::thread([&, i] {
        for (int k = 0;; ++k) {
          AtomicFile file(folder_ / ("f" + std::to_string(i) + "_" + std::to_string(k)));
          file.write("x");
          if (k % 3 == 0) file.commit();
        }
      }).detach();
    }
    std::thread([&] {
      const fs::path tree = folder_ / "tree";
      fs::create_directories(tree);
      const Unfinished unfinished(tree, Unfinished::Kind::folder);
      for (int k = 0; k < 1000; ++k) {
        std::ofstream(tree / std::to_string(k % 100)) << k;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }).detach();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    endAllWork();
    removeUnfinished();
    bool isClean = !fs::exists(folder_ / "tree");
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      isClean &= !entry.path().filename().string().starts_with(".sherd-");
    }
    fs::remove_all(folder_);  // as no destructor does
    std::_Exit(isClean ? 7 : 8);
  };
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(cut(), testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace sherd
