// Run-length voxels: the bytes against the format's description, round trips, refusals, the
// authors' own sample.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/folder.h>
#include <zlib.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "formats/voxels/voxel_lookup.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Runs = std::vector<Run>;  // within a test, Run is a member of GoogleTest's

class ReadRle : public TempFolder {
 protected:
  fs::path file(const std::string& bytes) const {
    const fs::path path = folder_ / "x.rle";
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  // The sentence with which `bytes` are refused.
  std::string refusal(const std::string& bytes) const { return refusalOf(file(bytes)); }
  static std::string refusalOf(const fs::path& path) {
    try {
      (void)readRle(path);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input);
      return e.what();
    }
    return "";
  }
};
using WriteRle = ReadRle;

std::string u32(std::uint32_t v) {
  return {static_cast<char>(v & 255), static_cast<char>(v >> 8 & 255),
          static_cast<char>(v >> 16 & 255), static_cast<char>(v >> 24)};
}
std::string run(std::uint16_t label, std::uint32_t length) {
  return std::string{static_cast<char>(label & 255), static_cast<char>(label >> 8)} + u32(length);
}
std::string box(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return u32(x) + u32(y) + u32(z);
}

TEST_F(WriteRle, IsTheFormatByteForByte) {
  const RunLengthVoxels voxels{{2, 3, 0x104}, {{0, 0x208}, {0x1234, 0x409}, {65535, 7}}};
  writeRle(folder_ / "x.rle", voxels);
  const std::string want(
      "\x02\0\0\0\x03\0\0\0\x04\x01\0\0"
      "\0\0\x08\x02\0\0"
      "\x34\x12\x09\x04\0\0"
      "\xff\xff\x07\0\0\0",
      30);
  EXPECT_EQ(bytesOf(folder_ / "x.rle"), want);
}

TEST_F(WriteRle, ReadsBackAsItWas) {
  std::mt19937 random(1);
  RunLengthVoxels voxels{{300, 1000, 1}, {}};
  std::uint32_t left = 300'000;  // more runs than one block of the reader's
  for (std::uint16_t label = 0; left > 0;
       label = static_cast<std::uint16_t>(label + 1 + random() % 9)) {
    const std::uint32_t length = std::min(left, static_cast<std::uint32_t>(1 + random() % 3));
    voxels.runs.push_back({label, length});
    left -= length;
  }
  writeRle(folder_ / "x.rle", voxels);
  const RunLengthVoxels back = readRle(folder_ / "x.rle");
  EXPECT_EQ(back.dims, voxels.dims);
  EXPECT_EQ(back.runs, voxels.runs);
  EXPECT_GT(voxels.runs.size(), std::size_t{2} << 16);
}

TEST_F(ReadRle, JoinsRunsOfOneLabel) {
  const RunLengthVoxels voxels = readRle(file(box(1, 1, 9) + run(4, 2) + run(4, 3) + run(5, 4)));
  EXPECT_EQ(voxels.runs, (Runs{{4, 5}, {5, 4}}));
}

TEST_F(ReadRle, KeepsRunsThatNeedMoreThan32Bits) {
  // 3 * 2^31 voxels of one label: two runs, and no third.
  const RunLengthVoxels voxels = readRle(
      file(box(3, 1u << 16, 1u << 15) + run(1, 0xffffffff) + run(1, 0x80000000) + run(1, 1)));
  EXPECT_EQ(voxels.runs, (Runs{{1, 0xffffffff}, {1, 0x80000001}}));
}

TEST_F(ReadRle, RefusesAnAbsentFile) { EXPECT_NE(refusalOf(folder_ / "none.rle"), ""); }
TEST_F(ReadRle, RefusesAFolder) { EXPECT_NE(refusalOf(folder_), ""); }
TEST_F(ReadRle, RefusesACutHeader) {
  EXPECT_NE(refusal(""), "");
  EXPECT_NE(refusal(box(1, 1, 1).substr(0, 11)), "");
}
TEST_F(ReadRle, RefusesEveryCutOfAFile) {
  const std::string whole = box(2, 2, 2) + run(0, 3) + run(1, 4) + run(2, 1);
  EXPECT_EQ(refusal(whole), "");
  for (std::size_t n = 0; n < whole.size(); ++n) EXPECT_NE(refusal(whole.substr(0, n)), "") << n;
}
TEST_F(ReadRle, RefusesAnEmptyBox) {
  EXPECT_NE(refusal(box(0, 1, 1)), "");
  EXPECT_NE(refusal(box(1, 1, 0) + run(0, 1)), "");
}
TEST_F(ReadRle, RefusesABoxWithMoreVoxelsThan64BitsCount) {
  // 2^31-1 cubed wraps round in 64 bits; sides above 2^31-1 do not fit a Coord.
  EXPECT_NE(refusal(box(0x7fffffff, 0x7fffffff, 0x7fffffff) + run(0, 1)), "");
  EXPECT_NE(refusal(box(0x80000000, 1, 1) + run(0, 0x80000000)), "");
}
TEST_F(ReadRle, RefusesARunOfLengthZero) {
  EXPECT_NE(refusal(box(1, 1, 2) + run(0, 2) + run(1, 0)), "");
}
TEST_F(ReadRle, RefusesRunsThatDoNotFillTheBox) {
  EXPECT_NE(refusal(box(2, 2, 2) + run(0, 7)), "");
  EXPECT_NE(refusal(box(2, 2, 2) + run(0, 9)), "");
  EXPECT_NE(refusal(box(2, 2, 2) + run(0, 8) + run(1, 1)), "");
}
TEST_F(ReadRle, RefusesAnEndlessFile) { EXPECT_NE(refusalOf("/dev/zero"), ""); }
TEST_F(ReadRle, RefusalsNameTheFile) {
  EXPECT_NE(refusal(box(1, 1, 2)).find((folder_ / "x.rle").string()), std::string::npos);
}

TEST(Expand, FillsZFirst) {
  const VoxelLabels dense = expand({{2, 1, 3}, {{7, 2}, {8, 2}, {9, 2}}});
  EXPECT_EQ(dense.labels, (std::vector<std::uint16_t>{7, 7, 8, 8, 9, 9}));
}
TEST(Expand, RefusesBoxesOfMoreThan2To31Voxels) {
  EXPECT_THROW((void)expand({{1 << 16, 1 << 15, 2}, {{0, 0xffffffff}, {0, 1}}}), Error);
}

// A solid of random leaves, and beside it the dense box that encodeRuns must give, filled voxel by
// voxel.
struct Sample {
  Solid solid;
  Labels labels;
  VoxelLabels dense;
};

Sample randomSample(unsigned seed, openvdb::Coord lowestLeaf, int leaves) {
  std::mt19937 random(seed);
  Sample sample;
  LeafBlocks blocks;
  VoxelBox& tight = sample.solid.box;
  tight = {openvdb::Coord::max(), openvdb::Coord::min()};
  for (int x = 0; x < leaves; ++x) {
    for (int y = 0; y < leaves; ++y) {
      for (int z = 0; z < leaves; ++z) {
        if (random() % 3 == 0) continue;
        const openvdb::Coord origin = lowestLeaf + openvdb::Coord(8 * x, 8 * y, 8 * z);
        blocks.origins.push_back(origin);
        const bool exteriorBandOnly = random() % 4 == 0;
        for (std::uint32_t slab = 0; slab < 8; ++slab) {
          std::uint64_t inside = std::uint64_t{random()} << 32 | random();
          inside &= std::uint64_t{random()} << 32 | random();
          if (exteriorBandOnly || random() % 4 == 0) inside = 0;
          blocks.inside.push_back(inside);
          blocks.exteriorBand.push_back(~inside);
          for (std::uint32_t bit = 0; bit < 64; ++bit) {
            // labels lie on outer voxels too, and some inside voxels have none
            sample.labels.fragment.push_back(static_cast<std::uint16_t>(random() % 4));
            if ((inside >> bit & 1) == 0) continue;
            const openvdb::Coord voxel = origin + coordFromOffset(slab << 6 | bit);
            tight.min.minComponent(voxel);
            tight.max.maxComponent(voxel);
          }
        }
      }
    }
  }
  sample.solid.blocks = sample.labels.blocks = std::make_shared<const LeafBlocks>(blocks);
  sample.labels.fragmentCount = 3;
  if (tight.empty()) return sample;
  sample.dense.dims = tight.dims();
  const auto side = [&](std::size_t axis) {
    return static_cast<std::size_t>(sample.dense.dims[axis]);
  };
  sample.dense.labels.resize(side(0) * side(1) * side(2));
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    for (std::uint32_t i = 0; i < 512; ++i) {
      if ((blocks.inside[leaf * 8 + (i >> 6)] >> (i & 63) & 1) == 0) continue;
      const openvdb::Coord at = blocks.origins[leaf] + coordFromOffset(i) - tight.min;
      const std::size_t index =
          (static_cast<std::size_t>(at.x()) * side(1) + static_cast<std::size_t>(at.y())) *
              side(2) +
          static_cast<std::size_t>(at.z());
      sample.dense.labels[index] =
          static_cast<std::uint16_t>(sample.labels.fragment[leaf * 512 + i] + 1);
    }
  }
  return sample;
}

TEST(EncodeRuns, HoldsEveryInsideVoxelAndNoOther) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Sample sample =
        randomSample(seed, {-16, 8, -8 * static_cast<int>(seed)}, 1 + static_cast<int>(seed % 5));
    if (sample.solid.box.empty()) continue;
    const RunLengthVoxels runs = encodeRuns(sample.solid, sample.labels);
    EXPECT_EQ(runs.dims, sample.dense.dims);
    EXPECT_EQ(expand(runs).labels, sample.dense.labels) << "seed " << seed;
    for (std::size_t i = 1; i < runs.runs.size(); ++i) {
      ASSERT_NE(runs.runs[i - 1].label, runs.runs[i].label) << "seed " << seed << ", run " << i;
    }
  }
}

TEST(VoxelLookup, FindsEveryVoxelOfABox) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Sample sample =
        randomSample(seed, {-16, 8, -8 * static_cast<int>(seed)}, 1 + static_cast<int>(seed % 5));
    if (sample.solid.box.empty()) continue;
    const RunLengthVoxels runs = encodeRuns(sample.solid, sample.labels);
    const VoxelLookup lookup(runs);
    std::size_t i = 0, wrong = 0;
    for (int x = 0; x < runs.dims.x(); ++x) {
      for (int y = 0; y < runs.dims.y(); ++y) {
        for (int z = 0; z < runs.dims.z(); ++z) {
          wrong += lookup.at({x, y, z}) != sample.dense.labels[i++];
        }
      }
    }
    EXPECT_EQ(wrong, 0u) << "seed " << seed;
    for (const openvdb::Coord& beyond : {openvdb::Coord(-1, 0, 0), {0, runs.dims.y(), 0}}) {
      EXPECT_EQ(lookup.at(beyond), 0);
    }
  }
}

// A box of 2^33 voxels takes the memory of its four runs.
TEST(VoxelLookup, FindsVoxelsOfAHugeBox) {
  const RunLengthVoxels runs{{2048, 2048, 2048},
                             {{2, 1}, {0, 0xffffffff}, {0, 0xffffffff}, {3, 1}}};
  const VoxelLookup lookup(runs);
  EXPECT_EQ(lookup.at({0, 0, 0}), 2);
  EXPECT_EQ(lookup.at({0, 0, 1}), 0);
  EXPECT_EQ(lookup.at({1024, 1024, 1024}), 0);
  EXPECT_EQ(lookup.at({2047, 2047, 2046}), 0);
  EXPECT_EQ(lookup.at({2047, 2047, 2047}), 3);
}

TEST(EncodeRuns, SplitsRunsThat32BitsCannotHold) {
  // Two voxels in opposite corners of a box of 2^33: 2 * (2^32 - 1) voxels lie between them.
  Solid solid;
  LeafBlocks blocks{.origins = {{0, 0, 0}, {2040, 2040, 2040}},
                    .inside = std::vector<std::uint64_t>(16)};
  blocks.inside[0] = 1;
  blocks.inside[15] = std::uint64_t{1} << 63;
  solid.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  solid.box = {{0, 0, 0}, {2047, 2047, 2047}};
  Labels labels{.blocks = solid.blocks, .fragmentCount = 2};
  labels.fragment.assign(1024, 0);
  labels.fragment[0] = 1;
  labels.fragment[1023] = 2;
  EXPECT_EQ(encodeRuns(solid, labels).runs,
            (Runs{{2, 1}, {0, 0xffffffff}, {0, 0xffffffff}, {3, 1}}));
}

std::vector<std::uint8_t> unpacked(const fs::path& path, std::size_t size) {
  std::vector<std::uint8_t> bytes(size + 1);
  gzFile in = gzopen(path.c_str(), "rb");
  const int n = in ? gzread(in, bytes.data(), static_cast<unsigned>(bytes.size())) : -1;
  if (in) gzclose(in);
  bytes.resize(n < 0 ? 0 : static_cast<std::size_t>(n));
  return bytes;
}

// The authors' reader flips y "only for our dataset" and pads to a cube with zeros at the end.
TEST(ReadRleSample, DecodesToWhatTheAuthorsReaderMade) {
  const char* meshes = std::getenv("SHERD_TEST_DATA");
  if (!meshes) GTEST_SKIP() << "SHERD_TEST_DATA does not name the folder of test meshes";
  const fs::path samples = fs::path(meshes).parent_path() / "samples";
  const VoxelLabels ours = expand(readRle(samples / "AL_12B_grid_128r.rle"));
  const std::vector<std::uint8_t> theirs =
      unpacked(samples / "AL_12B_grid_128r.npy.gz", 128 * 128 * 128);
  ASSERT_EQ(theirs.size(), std::size_t{128 * 128 * 128});
  ASSERT_EQ(ours.dims, openvdb::Coord(128, 110, 128));
  std::size_t differing = 0;
  for (std::size_t x = 0; x < 128; ++x) {
    for (std::size_t y = 0; y < 128; ++y) {
      for (std::size_t z = 0; z < 128; ++z) {
        const std::uint16_t label = y < 110 ? ours.labels[(x * 110 + 109 - y) * 128 + z] : 0;
        differing += label != theirs[(x * 128 + y) * 128 + z];
      }
    }
  }
  EXPECT_EQ(differing, 0u);
}

}  // namespace
}  // namespace sherd
