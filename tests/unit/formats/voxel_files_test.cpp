// Voxel files: round trips through every format lose nothing, what contradicts itself is refused.
// The bytes themselves are checked by tests/cli/convert_test.py.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/files.h>

#include <cstdlib>
#include <functional>
#include <random>
#include <set>

#include "formats/voxels/parse_voxels.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Runs = std::vector<Run>;  // within a test, Run is a member of GoogleTest's

std::string encodedBytes(const PlacedVoxels& voxels, VoxelFormat format) {
  std::string bytes;
  encodeVoxels(voxels, format, [&](std::string_view component) { bytes.append(component); });
  return bytes;
}

PlacedVoxels parsed(std::string_view bytes, VoxelFormat format) {
  switch (format) {
    case VoxelFormat::rle:
      return {parseRle(bytes, "x.rle")};
    case VoxelFormat::npy:
      return {parseNpyLabels(bytes, "x.npy")};
    case VoxelFormat::npz:
      return parseNpzLabels(bytes, "x.npz");
    case VoxelFormat::vox:
      return {parseMagicaVoxel(bytes, "x.vox")};
    case VoxelFormat::qstack:
      return {parseQuadStack(bytes, "x.qstack")};
    case VoxelFormat::bing:
      return {parseBing(bytes, "x.bing")};
  }
  return {};
}

constexpr VoxelFormat kAll[] = {VoxelFormat::rle, VoxelFormat::npy,    VoxelFormat::npz,
                                VoxelFormat::vox, VoxelFormat::qstack, VoxelFormat::bing};

// The sentence with which bytes are refused, or nothing.
std::string refusal(std::string_view bytes, VoxelFormat format) {
  try {
    (void)parsed(bytes, format);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input);
    return e.what();
  }
  return "";
}

RunLengthVoxels runsOf(const VoxelLabels& dense) {
  RunLengthVoxels voxels{dense.dims, {}};
  for (const std::uint16_t label : dense.labels) {
    if (voxels.runs.empty() || voxels.runs.back().label != label) voxels.runs.push_back({label, 0});
    ++voxels.runs.back().length;
  }
  return voxels;
}

std::size_t indexIn(const openvdb::Coord& dims, int x, int y, int z) {
  return (static_cast<std::size_t>(x) * static_cast<std::size_t>(dims.y()) +
          static_cast<std::size_t>(y)) *
             static_cast<std::size_t>(dims.z()) +
         static_cast<std::size_t>(z);
}

// Blobs of labels with gaps; the opposite corners are not empty, so that the box is tight.
RunLengthVoxels randomVoxels(unsigned seed, openvdb::Coord dims, std::uint16_t lowest,
                             std::uint16_t highest) {
  std::mt19937 random(seed);
  VoxelLabels dense{dims, {}};
  dense.labels.assign(indexIn(dims, dims.x(), 0, 0), 0);
  const auto label = [&] {
    return static_cast<std::uint16_t>(lowest + random() % (highest - lowest + 1u));
  };
  for (int blob = 0; blob < 60; ++blob) {
    int low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
      const auto side = static_cast<unsigned>(dims[axis]);
      low[axis] = static_cast<int>(random() % side);
      high[axis] = std::min(dims[axis], low[axis] + 1 + static_cast<int>(random() % 9));
    }
    const std::uint16_t value = blob % 4 == 0 ? std::uint16_t{0} : label();
    for (int x = low[0]; x < high[0]; ++x) {
      for (int y = low[1]; y < high[1]; ++y) {
        for (int z = low[2]; z < high[2]; ++z) dense.labels[indexIn(dims, x, y, z)] = value;
      }
    }
  }
  dense.labels.front() = label();
  dense.labels.back() = label();
  return runsOf(dense);
}

RunLengthVoxels cube(const RunLengthVoxels& voxels) {
  return padded({voxels}, Padding::centered, "x").voxels;
}

std::uint64_t voxelsOf(const Runs& runs) {
  std::uint64_t sum = 0;
  for (const Run& run : runs) sum += run.length;
  return sum;
}

struct Case {
  openvdb::Coord dims;
  std::uint16_t lowest, highest;
};
const Case kCases[] = {{{1, 1, 1}, 2, 2},      {{1, 1, 1}, 1, 1},     {{13, 9, 17}, 2, 9},
                       {{9, 17, 13}, 1, 7},    {{1, 40, 3}, 2, 255},  {{30, 1, 30}, 2, 256},
                       {{20, 21, 22}, 1, 255}, {{130, 7, 140}, 2, 4}, {{2, 3, 260}, 2, 40}};

TEST(VoxelFiles, EveryFormatGivesBackWhatItWasGiven) {
  unsigned seed = 0;
  for (const Case& c : kCases) {
    const RunLengthVoxels voxels = randomVoxels(++seed, c.dims, c.lowest, c.highest);
    for (const VoxelFormat first : kAll) {
      const RunLengthVoxels once = parsed(encodedBytes({voxels}, first), first).voxels;
      const bool cubic = first == VoxelFormat::bing;
      EXPECT_EQ(once.runs, (cubic ? cube(voxels) : voxels).runs) << seed << " " << int(first);
      EXPECT_EQ(once.dims, (cubic ? cube(voxels) : voxels).dims) << seed << " " << int(first);
      for (const VoxelFormat second : kAll) {  // .vox has no margin, .bing has its own
        const RunLengthVoxels twice = parsed(encodedBytes({once}, second), second).voxels;
        EXPECT_EQ(cube(twice).runs,
                  second == VoxelFormat::vox ? cube(voxels).runs : cube(once).runs)
            << seed << " " << int(first) << " " << int(second);
      }
    }
    EXPECT_TRUE(lossesOf({voxels}, VoxelFormat::vox).empty()) << seed;
  }
}

TEST(VoxelFiles, LabelsOf16BitsSurviveWhereTheFormatHoldsThem) {
  const RunLengthVoxels voxels = randomVoxels(3, {20, 30, 25}, 1, 65535);
  for (const VoxelFormat format :
       {VoxelFormat::rle, VoxelFormat::npy, VoxelFormat::npz, VoxelFormat::qstack}) {
    EXPECT_EQ(parsed(encodedBytes({voxels}, format), format).voxels.runs, voxels.runs)
        << int(format);
  }
}

TEST(VoxelFiles, ABoxOf1024CubedGoesThroughEveryRunFormatWithoutBeingExpanded) {
  // Two voxels in opposite corners.
  const RunLengthVoxels voxels{{1024, 1024, 1024}, {{2, 1}, {0, (1u << 30) - 2}, {3, 1}}};
  for (const VoxelFormat format : {VoxelFormat::rle, VoxelFormat::vox, VoxelFormat::qstack}) {
    EXPECT_EQ(parsed(encodedBytes({voxels}, format), format).voxels.runs, voxels.runs)
        << int(format);
  }
}

TEST(QuadStack, HoldsSidesAndStacksBeyond255) {
  RunLengthVoxels voxels{{300, 520, 3}, {{0, 300 * 520 * 3}}};
  EXPECT_EQ(parseQuadStack(encodedBytes({voxels}, VoxelFormat::qstack), "x").runs, voxels.runs);
  voxels = {{2, 1, 1000}, {}};
  for (std::uint16_t i = 0; i < 2000; ++i) voxels.runs.push_back({std::uint16_t(i % 7), 1});
  EXPECT_EQ(parseQuadStack(encodedBytes({voxels}, VoxelFormat::qstack), "x").runs, voxels.runs);
}

TEST(MagicaVoxel, NeighborsDifferWhereFragmentsShareColors) {
  // 700 fragments, each a cube of 2 voxels a side.
  VoxelLabels dense{{20, 20, 14}, {}};
  dense.labels.resize(20 * 20 * 14);
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 20; ++y) {
      for (int z = 0; z < 14; ++z) {
        dense.labels[indexIn(dense.dims, x, y, z)] =
            static_cast<std::uint16_t>(2 + (x / 2 * 10 + y / 2) * 7 + z / 2);
      }
    }
  }
  const PlacedVoxels voxels{runsOf(dense)};
  EXPECT_EQ(lossesOf(voxels, VoxelFormat::vox).size(), 1u);
  const VoxelLabels back =
      expand(parsed(encodedBytes(voxels, VoxelFormat::vox), VoxelFormat::vox).voxels);
  ASSERT_EQ(back.dims, dense.dims);
  const int steps[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::size_t faces = 0;
  for (int x = 0; x < 19; ++x) {
    for (int y = 0; y < 19; ++y) {
      for (int z = 0; z < 13; ++z) {
        for (const auto& step : steps) {
          const std::size_t a = indexIn(dense.dims, x, y, z);
          const std::size_t b = indexIn(dense.dims, x + step[0], y + step[1], z + step[2]);
          ASSERT_EQ(dense.labels[a] == dense.labels[b], back.labels[a] == back.labels[b]);
          faces += dense.labels[a] != dense.labels[b];
        }
      }
    }
  }
  EXPECT_GT(faces, 1000u);
  EXPECT_EQ(std::set<std::uint16_t>(back.labels.begin(), back.labels.end()).count(0), 0u);
}

TEST(MagicaVoxel, AnEmptyBoxIsNotWritten) {
  EXPECT_THROW((void)encodedBytes({{{2, 2, 2}, {{0, 8}}}}, VoxelFormat::vox), Error);
}

TEST(Padded, PlacesTheBoxInTheCubeAndInTheWorld) {
  const PlacedVoxels voxels{{{1, 4, 2}, {{7, 3}, {0, 2}, {8, 3}}},
                            VoxelTransform{{{10.0, 20.0, 30.0}, 0.5}, {1, 2, 3}}};
  const PlacedVoxels end = padded(voxels, Padding::atEnd, "x");
  const PlacedVoxels middle = padded(voxels, Padding::centered, "x");
  for (const PlacedVoxels* cubic : {&end, &middle}) {
    const int x0 = cubic == &end ? 0 : 1, y0 = 0, z0 = cubic == &end ? 0 : 1;
    const VoxelLabels dense = expand(cubic->voxels), small = expand(voxels.voxels);
    ASSERT_EQ(dense.dims, openvdb::Coord(4, 4, 4));
    for (int x = 0; x < 4; ++x) {
      for (int y = 0; y < 4; ++y) {
        for (int z = 0; z < 4; ++z) {
          const bool within = x == x0 && z >= z0 && z < z0 + 2;
          EXPECT_EQ(dense.labels[indexIn(dense.dims, x, y, z)],
                    within ? small.labels[indexIn(small.dims, 0, y - y0, z - z0)] : 0);
        }
      }
    }
    EXPECT_EQ(cubic->transform->frame.origin,
              glm::dvec3(10.0 - 0.5 * x0, 20.0 - 0.5 * y0, 30.0 - 0.5 * z0));
    EXPECT_EQ(cubic->transform->indexMin, openvdb::Coord(1 - x0, 2 - y0, 3 - z0));
  }
}

TEST(NpzLabels, KeepThePlace) {
  const PlacedVoxels voxels{randomVoxels(5, {5, 6, 7}, 1, 9),
                            VoxelTransform{{{-0.1, 1e-9, 3e8}, 0.007}, {-5, 0, 2147483647}}};
  const PlacedVoxels back = parseNpzLabels(encodedBytes(voxels, VoxelFormat::npz), "x.npz");
  ASSERT_TRUE(back.transform);
  EXPECT_EQ(back.transform->frame.origin, voxels.transform->frame.origin);
  EXPECT_EQ(back.transform->frame.voxelSize, 0.007);
  EXPECT_EQ(back.transform->indexMin, voxels.transform->indexMin);
  EXPECT_EQ(back.voxels.runs, voxels.voxels.runs);
  EXPECT_EQ(lossesOf(voxels, VoxelFormat::npz).size(), 0u);
  EXPECT_EQ(lossesOf(voxels, VoxelFormat::rle).size(), 1u);
}

TEST(VoxelFiles, EveryCutIsRefused) {
  const PlacedVoxels voxels{randomVoxels(6, {6, 5, 7}, 1, 9), VoxelTransform{{{1, 2, 3}, 0.5}, {}}};
  for (const VoxelFormat format : kAll) {
    const std::string whole = encodedBytes(voxels, format);
    EXPECT_EQ(refusal(whole, format), "");
    for (std::size_t n = 0; n < whole.size(); ++n) {
      ASSERT_NE(refusal(std::string_view(whole).substr(0, n), format), "")
          << int(format) << " " << n;
    }
    EXPECT_NE(refusal(whole + std::string(1, '\0'), format), "") << int(format);
  }
}

// Any bytes are read or refused; what is read fills its box.
TEST(VoxelFiles, DamagedFilesAreReadOrRefused) {
  std::mt19937 random(11);
  const PlacedVoxels voxels{randomVoxels(7, {6, 5, 7}, 2, 9), VoxelTransform{{{1, 2, 3}, 0.5}, {}}};
  for (const VoxelFormat format : kAll) {
    const std::string whole = encodedBytes(voxels, format);
    std::size_t refused = 0;
    for (int round = 0; round < 1500; ++round) {
      std::string bytes = whole;
      for (auto edits = 1 + random() % 3; edits > 0; --edits) {
        const std::size_t at =
            random() % std::min<std::size_t>(bytes.size(), random() % 2 ? 200 : 1u << 20);
        bytes[at] = static_cast<char>(random() % 3 == 0 ? 255 : random());
      }
      try {
        const RunLengthVoxels read = parsed(bytes, format).voxels;
        ASSERT_EQ(voxelsOf(read.runs), static_cast<std::uint64_t>(read.dims.x()) *
                                           static_cast<std::uint64_t>(read.dims.y()) *
                                           static_cast<std::uint64_t>(read.dims.z()));
      } catch (const Error& e) {
        ASSERT_EQ(e.code(), ErrorCode::input);
        ++refused;
      }
    }
    EXPECT_GT(refused, 50u) << int(format);
  }
}

std::string u16(unsigned v) {
  return {static_cast<char>(v & 255), static_cast<char>(v >> 8 & 255)};
}
std::string bytes32(unsigned v) { return u16(v & 0xffff) + u16(v >> 16); }
std::string u64(std::uint64_t v) {
  return bytes32(static_cast<unsigned>(v & 0xffffffff)) + bytes32(static_cast<unsigned>(v >> 32));
}

TEST(ParseRle, ReadsTheOldRecordsOf16Bytes) {
  const std::string junk = "\1\2\3\4\5\6";
  const std::string head = bytes32(2) + bytes32(3) + bytes32(8);
  const std::string old = u16(0) + junk + u64(40) + u16(3) + junk + u64(8);
  EXPECT_EQ(parseRle(head + old, "x").runs, (Runs{{0, 40}, {3, 8}}));
  EXPECT_NE(refusal(head + u16(0) + junk + u64(40) + u16(3) + junk + u64(9), VoxelFormat::rle), "");
  EXPECT_NE(refusal(head + u16(0) + junk + u64(0xffffffffffffffd8) + u16(3) + junk + u64(88),
                    VoxelFormat::rle),
            "");
}

// A count that lies would take all memory if it were believed.
TEST(VoxelFiles, CountsThatLieAreRefused) {
  EXPECT_NE(refusal(bytes32(60000) + bytes32(60000) + bytes32(60000), VoxelFormat::bing), "");
  EXPECT_NE(
      refusal(u64(2) + u16(65535) + u16(65535) + u16(65535) + u64(~0ull), VoxelFormat::qstack), "");
  EXPECT_NE(refusal(u64(2) + u16(65535) + u16(65535) + u16(65535) + u64(1) + u64(~0ull) +
                        bytes32(65535) + bytes32(65535) + bytes32(0) + bytes32(0) + bytes32(0xffff),
                    VoxelFormat::qstack),
            "");
  const std::string dense =
      "{'descr': '<u2', 'fortran_order': True, 'shape': (90000, 90000, 90000)}";
  const std::string npy =
      std::string("\x93NUMPY\1\0", 8) + u16(static_cast<unsigned>(dense.size()));
  EXPECT_NE(refusal(npy + dense + std::string(100, '\0'), VoxelFormat::npy), "");
  const std::string size =
      "SIZE" + bytes32(12) + bytes32(0) + bytes32(126) + bytes32(126) + bytes32(126);
  const auto vox = [](const std::string& chunks) {
    return "VOX " + bytes32(150) + "MAIN" + bytes32(0) +
           bytes32(static_cast<unsigned>(chunks.size())) + chunks;
  };
  EXPECT_NE(refusal(vox(size + "XYZI" + bytes32(8) + bytes32(0) + bytes32(0x3fffffff) + bytes32(0)),
                    VoxelFormat::vox),
            "");
  EXPECT_EQ(refusal(vox(size + "XYZI" + bytes32(8) + bytes32(0) + bytes32(1) + bytes32(0x01000000)),
                    VoxelFormat::vox),
            "");
}

// A node that is its own grandchild.
TEST(MagicaVoxel, ATreeThatIsNoneIsRefused) {
  const std::string voxel = "SIZE" + bytes32(12) + bytes32(0) + bytes32(1) + bytes32(1) +
                            bytes32(1) + "XYZI" + bytes32(8) + bytes32(0) + bytes32(1) +
                            bytes32(0x05000000);
  const auto group = [](unsigned node, std::initializer_list<unsigned> children) {
    std::string content =
        bytes32(node) + bytes32(0) + bytes32(static_cast<unsigned>(children.size()));
    for (const unsigned child : children) content += bytes32(child);
    return "nGRP" + bytes32(static_cast<unsigned>(content.size())) + bytes32(0) + content;
  };
  const auto vox = [](const std::string& chunks) {
    return "VOX " + bytes32(150) + "MAIN" + bytes32(0) +
           bytes32(static_cast<unsigned>(chunks.size())) + chunks;
  };
  EXPECT_NE(refusal(vox(voxel + group(0, {1}) + group(1, {0})), VoxelFormat::vox), "");
  EXPECT_NE(refusal(vox(voxel + group(0, {7})), VoxelFormat::vox), "");
  std::string wide = voxel + group(0, {1, 1, 1, 1});
  for (unsigned i = 1; i < 60; ++i) wide += group(i, {i + 1, i + 1, i + 1, i + 1});
  EXPECT_NE(refusal(vox(wide + group(60, {})), VoxelFormat::vox), "");
}

class VoxelFilesOnDisk : public TempFolder {};

TEST_F(VoxelFilesOnDisk, AreReadByTheirExtension) {
  const PlacedVoxels voxels{randomVoxels(8, {6, 6, 6}, 2, 9)};
  for (const char* name : {"a.RLE", "a.npy", "a.npz", "a.vox", "a.qstack", "a.bing"}) {
    const auto format = voxelFormatOf(name);
    ASSERT_TRUE(format) << name;
    writeVoxels(folder_ / name, voxels, *format);
    EXPECT_EQ(readVoxels(folder_ / name).voxels.runs, voxels.voxels.runs) << name;
  }
  EXPECT_FALSE(voxelFormatOf("a.ply"));
  EXPECT_THROW((void)readVoxels(folder_ / "a.ply"), Error);
  EXPECT_THROW((void)readVoxels(folder_ / "none.rle"), Error);
}

TEST_F(VoxelFilesOnDisk, NothingIsLeftOfAFileThatCannotBeWritten) {
  EXPECT_THROW(writeVoxels(folder_ / "a.vox", {{{2, 2, 2}, {{0, 8}}}}, VoxelFormat::vox), Error);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(VoxelFilesOnDisk, TheAuthorsVesselGoesThroughEveryFormat) {
  const char* meshes = std::getenv("SHERD_TEST_DATA");
  if (!meshes) GTEST_SKIP() << "SHERD_TEST_DATA does not name the folder of test meshes";
  const fs::path sample = fs::path(meshes).parent_path() / "samples" / "AL_12B_grid_128r.rle";
  if (!fs::exists(sample)) GTEST_SKIP() << sample << " is not there";
  const PlacedVoxels vessel = readVoxels(sample);
  const std::string tight = encodedBytes(
      {parsed(encodedBytes(vessel, VoxelFormat::vox), VoxelFormat::vox)}, VoxelFormat::rle);
  for (const VoxelFormat format : kAll) {
    const PlacedVoxels back = parsed(encodedBytes(vessel, format), format);
    if (format == VoxelFormat::bing) {
      EXPECT_EQ(back.voxels.runs, cube(vessel.voxels).runs);
    } else if (format == VoxelFormat::vox) {
      EXPECT_EQ(encodedBytes({back}, VoxelFormat::rle), tight);
      EXPECT_EQ(back.voxels.dims.y(), 109);  // the authors' voxelization has nothing at y = 0
    } else {
      EXPECT_EQ(back.voxels.runs, vessel.voxels.runs) << int(format);
    }
  }
}

// Found by fuzzing: one run of 64 bits became two thousand million of 32.
TEST(VoxelFiles, AnOldRunOfAHugeBoxTakesNoMemory) {
  std::string bytes;
  for (int axis = 0; axis < 3; ++axis) bytes += std::string("\0\0\x1f\0", 4);
  bytes += std::string("\1\0\0\0\0\0\0\0", 8) + std::string("\0\0\0\0\0\0\0\x10", 8);
  EXPECT_THROW((void)parseRle(bytes, "huge.rle"), Error);
}

}  // namespace
}  // namespace sherd
