// Samples that are made and written block by block: the same, and in bounded memory.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/points.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "base/memory_gate.h"
#include "folder/files/write_memory.h"
#include "folder/files/write_points.h"
#include "formats/points/write_blocks.h"
#include "points/contact_sequence.h"
#include "points/distance_sequence.h"
#include "points/point_sequence.h"
#include "shapes.h"
#include "temp_folder.h"

namespace sherd {
namespace {

const std::vector<PointOptions> kEverySampler{
    {.sampler = PointSampler::uniform, .rule = PointRule::area},
    {.sampler = PointSampler::halton, .rule = PointRule::area},
    {.sampler = PointSampler::poisson, .rule = PointRule::area},
    {.sampler = PointSampler::uniform, .rule = PointRule::perTriangle},
    {.sampler = PointSampler::halton, .rule = PointRule::perTriangle}};

// Passes on what `make(first, end)` returns in blocks of a few.
template <class Block, class Make>
Blocks<Block> inFew(std::size_t count, const Make& make) {
  return {count, [count, make](const auto& visit) {
            constexpr std::size_t kFew = 7;
            for (std::size_t first = 0; first < count; first += kFew) {
              visit(make(first, std::min(first + kFew, count)));
            }
          }};
}

using SampleMemory = TempFolder;

TEST_F(SampleMemory, PointsAreTheSameInAnyBlocks) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  const SurfaceByArea surface(ball);
  for (PointOptions options : kEverySampler) {
    options.count = 100;
    options.seed = 5;
    const SurfacePoints all = samplePoints(ball, options);
    const PointSequence sequence(surface, options);
    for (std::size_t first = 0; first < 100; first += 33) {
      const std::size_t end = std::min<std::size_t>(first + 33, 100);
      const SurfacePoints some = sequence.points(first, end);
      ASSERT_EQ(some.positions.size(), end - first);
      for (std::size_t i = first; i < end; ++i) {
        EXPECT_EQ(some.positions[i - first], all.positions[i]);
        EXPECT_EQ(some.normals[i - first], all.normals[i]);
      }
    }
  }
}

TEST_F(SampleMemory, FilesOfPointsAreTheSameInAnyBlocks) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  const SurfaceByArea surface(ball);
  const PointOptions options{.count = 100, .seed = 5};
  const PointSequence sequence(surface, options);
  const auto blocks = inFew<SurfacePoints>(
      100, [&](std::size_t first, std::size_t end) { return sequence.points(first, end); });
  for (const PointFormat format :
       {PointFormat::ply, PointFormat::xyz, PointFormat::npz, PointFormat::binp}) {
    writePoints(folder_ / "whole", samplePoints(ball, options), format);
    writePoints(folder_ / "blocks", blocks, format);
    EXPECT_EQ(bytesOf(folder_ / "whole"), bytesOf(folder_ / "blocks"));
  }
}

TEST_F(SampleMemory, FilesOfDistancesAreTheSameInAnyBlocks) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  for (const SampleType type : {SampleType::float32, SampleType::float16}) {
    const DistanceOptions options{.count = 100, .type = type, .sigma = 0.1, .seed = 5};
    const DistanceSequence sequence(ball, options, nullptr);
    DistanceBlocks blocks = sequence.blocks();
    blocks.samples = inFew<DistanceSamples>(
        100, [&](std::size_t first, std::size_t end) { return sequence.samples(first, end); });
    writeDistances(folder_ / "whole", sampleDistances(ball, options));
    writeDistances(folder_ / "blocks", blocks);
    EXPECT_EQ(bytesOf(folder_ / "whole"), bytesOf(folder_ / "blocks"));
  }
}

// Three boxes in a row, of which the middle one touches both others.
std::vector<Fragment> fragmentRow() {
  std::vector<Fragment> fragments(3);
  for (int i = 0; i < 3; ++i) {
    Fragment& fragment = fragments[static_cast<std::size_t>(i)];
    fragment.id = i + 1;
    fragment.mesh = shapes::cube(1.0, {static_cast<double>(i), 0.0, 0.0});
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      const glm::uvec3& corners = fragment.mesh.triangles[t];
      const auto x = [&](int k) {
        return fragment.mesh.vertices[corners[k]].x - static_cast<double>(i);
      };
      const bool isLow =
          std::max({x(0), x(1), x(2)})<-0.4, isHigh = std::min({x(0), x(1), x(2)})> 0.4;
      const int neighbor = isLow ? i : isHigh && i < 2 ? i + 2 : 0;
      fragment.mesh.neighbor.push_back(static_cast<std::uint16_t>(neighbor));
    }
    for (const int neighbor : {i, i + 2}) {
      if (neighbor < 1 || neighbor > 3) continue;
      fragment.contacts.emplace_back();
      fragment.contacts.back().fragment = neighbor;
    }
  }
  return fragments;
}

TEST_F(SampleMemory, CorrespondencesAreTheSameContactByContact) {
  const std::vector<Fragment> fragments = fragmentRow();
  const Correspondences whole = sampleCorrespondences(fragments, 50, 5);
  ASSERT_EQ(whole.positions.size(), 100u);  // of two contacts
  for (std::size_t i = 0; i < 100; ++i) {
    const double x = i < 50 ? 0.5 : 1.5;
    EXPECT_NEAR(whole.positions[i].x, x, 1e-12);
    EXPECT_NEAR(whole.normals[i].x, 1.0, 1e-12);
  }
  writeCorrespondences(folder_ / "whole", whole);
  const ContactSequence sequence(fragments, 50, 5);
  writeCorrespondences(folder_ / "blocks", sequence.blocks());
  EXPECT_EQ(bytesOf(folder_ / "whole"), bytesOf(folder_ / "blocks"));
}

// Four gibibytes hold 134 million correspondences of 32 bytes.
TEST_F(SampleMemory, MoreCorrespondencesThanAFileHoldsAreRefusedFirst) {
  std::vector<Fragment> fragments = fragmentRow();
  const std::size_t tooMany = 70'000'000;
  try {
    writeAllCorrespondences(folder_ / "c.npz", fragments, tooMany, 5);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.options(), OptionNames{"correspondences"});
    const std::uint64_t fit = (std::uint64_t{4} << 30) - (64 << 10);  // beside the directory
    EXPECT_NE(std::string(e.what()).find(std::to_string(fit / 32 / 2) + " points on each of 2"),
              std::string::npos)
        << e.what();
  }
}

TEST_F(SampleMemory, ARefusalNamesTheOptionAndTheNumberThatFits) {
  const std::uint64_t limit = 1'000'000'000, fracture = 300'000'000;
  const auto check = [&](const WriteOptions& write) {
    requireSampleMemory(write, 4, limit, [&](std::uint64_t) { return fracture; });
  };
  WriteOptions poisson, octree, shuffled, distances;
  poisson.points = {.count = kMaxPoints, .sampler = PointSampler::poisson};
  octree.points.count = kMaxPoints;
  octree.pointFormats = {PointFormat::binp};
  EXPECT_NO_THROW(check(octree));  // one fragment at a time, 40 bytes a point
  WriteOptions uniform;
  uniform.points.count = kMaxPoints;
  uniform.correspondences = kMaxPoints;
  EXPECT_NO_THROW(check(uniform));  // in blocks
  distances.distances.count = kMaxPoints;
  EXPECT_NO_THROW(check(distances));
  try {
    check(poisson);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::usage);
    EXPECT_EQ(e.options(), (OptionNames{"points", "max-memory"}));
    poisson.points.count = static_cast<std::size_t>(std::stoull(e.what()));
    EXPECT_NO_THROW(check(poisson)) << e.what();
    ++poisson.points.count;
    EXPECT_THROW(check(poisson), Error);
  }
}

TEST_F(SampleMemory, TheGateKeepsTheLimitAndLetsALargeTaskRunAlone) {
  MemoryGate gate(100);
  std::atomic<int> held{0}, most{0};
  std::vector<std::thread> threads;
  for (const int bytes : {60, 60, 40, 40, 30, 250, 90, 10}) {
    threads.emplace_back([&, bytes] {
      for (int i = 0; i < 20; ++i) {
        const MemoryGate::Hold hold(gate, static_cast<std::uint64_t>(bytes));
        const int now = held += bytes;
        if (bytes <= 100) {
          int before = most;
          while (before < now && !most.compare_exchange_weak(before, now)) {
          }
        } else {
          EXPECT_EQ(now, bytes);
        }
        held -= bytes;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_LE(most, 100);
}

}  // namespace
}  // namespace sherd
