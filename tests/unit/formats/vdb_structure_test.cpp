// Damaged `.vdb` files are refused before OpenVDB parses them, and all others read as OpenVDB does.
#include "formats/voxels/vdb_structure.h"

#include <gtest/gtest.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <sherd/error.h>
#include <sherd/files.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "formats/voxels/vdb.h"
#include "vdb_bytes.h"

namespace sherd {
namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kMegabyte = 1'000'000;
using openvdb::io::COMPRESS_ACTIVE_MASK;
using openvdb::io::COMPRESS_BLOSC;
using openvdb::io::COMPRESS_ZIP;

openvdb::FloatGrid::Ptr smallBall() {
  auto ball = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(4.0f, {1, 2, 3}, 1.0f, 3.0f);
  ball->setName("ball");
  return ball;
}

// A leaf, an active tile of each size, and an inactive one.
template <class Grid>
typename Grid::Ptr smallGrid(const typename Grid::ValueType& value) {
  openvdb::initialize();
  const auto grid = Grid::create();
  grid->setName("some");
  for (int i = 0; i < 30; ++i) grid->tree().setValue(openvdb::Coord(i / 5, 2 * i % 7, -i), value);
  grid->tree().addTile(1, openvdb::Coord(64, 0, 0), value, true);
  grid->tree().addTile(2, openvdb::Coord(0, 512, 0), value, true);
  grid->tree().addTile(3, openvdb::Coord(0, 0, 8192), value, false);
  return grid;
}

std::vector<openvdb::GridBase::Ptr> gridsOfAllTypes() {
  return {smallGrid<openvdb::FloatGrid>(1.5f),
          smallGrid<openvdb::DoubleGrid>(-2.5),
          smallGrid<openvdb::Int32Grid>(7),
          smallGrid<openvdb::Int64Grid>(-7),
          smallGrid<openvdb::Vec3IGrid>({1, 2, 3}),
          smallGrid<openvdb::Vec3SGrid>({1.0f, 2.0f, 4.0f}),
          smallGrid<openvdb::Vec3DGrid>({1.0, 2.0, 4.0}),
          smallGrid<openvdb::BoolGrid>(true),
          smallGrid<openvdb::MaskGrid>(true)};
}

std::string sentenceOf(const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
    return e.what();
  }
  return "";
}

std::string sentenceOf(const std::string& bytes) {
  return sentenceOf([&] { (void)describeVdbOf("a.vdb", bytes, kNoLimit); });
}

template <class T>
std::string with(std::string bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return bytes;
}

TEST(VdbStructure, EveryTypeOfGridAndCompressionIsReadAsOpenVdbReadsIt) {
  for (const std::uint32_t packing :
       {std::uint32_t{0}, std::uint32_t{COMPRESS_ZIP}, std::uint32_t{COMPRESS_BLOSC}}) {
    for (const std::uint32_t mask : {std::uint32_t{0}, std::uint32_t{COMPRESS_ACTIVE_MASK}}) {
      for (const bool half : {false, true}) {
        const auto grids = gridsOfAllTypes();
        for (const auto& grid : grids) grid->setSaveFloatAsHalf(half);
        std::string bytes = vdbBytes(grids, packing | mask);
        std::istringstream in(bytes);
        openvdb::io::Stream stream(in, /*delayLoad=*/false);
        const VdbFile found = describeVdbOf("a.vdb", bytes, kNoLimit);
        const VdbStructure structure = checkedVdb("a.vdb", bytes);
        ASSERT_EQ(found.grids.size(), grids.size());
        EXPECT_EQ(structure.grids.back().end, bytes.size());
        for (std::size_t i = 0; i < grids.size(); ++i) {
          const openvdb::GridBase& expected = *stream.getGrids()->at(i);
          EXPECT_EQ(found.grids[i].type, expected.type());
          EXPECT_EQ(found.grids[i].activeVoxels, expected.activeVoxelCount());
          EXPECT_EQ(found.grids[i].activeBox.max, expected.evalActiveVoxelBoundingBox().max());
          EXPECT_GT(structure.grids[i].memory, expected.memUsage());
          EXPECT_LT(structure.grids[i].memory, 2 * expected.memUsage() + 200'000);
        }
      }
    }
  }
}

TEST(VdbStructure, ValuesAreThoseThatWereWritten) {
  const auto ball = smallBall();
  for (const std::uint32_t packing : {std::uint32_t{0}, std::uint32_t{COMPRESS_ZIP},
                                      std::uint32_t{COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK}}) {
    const auto found = floatGridsOf("a.vdb", vdbBytes({ball}, packing), kNoLimit);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(found[0].isLevelSet);
    EXPECT_TRUE(found[0].grid->tree().hasSameTopology(ball->tree()));
    for (auto it = ball->cbeginValueAll(); it; ++it)
      ASSERT_EQ(found[0].grid->tree().getValue(it.getCoord()), *it);
  }
}

// Trees that OpenVDB's functions may be used on: their counts agree by two ways.
void expectSound(const openvdb::FloatGrid& grid) {
  openvdb::Index64 active = 0;
  for (auto it = grid.cbeginValueOn(); it; ++it) active += it.getVoxelCount();
  EXPECT_EQ(grid.activeVoxelCount(), active);
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    EXPECT_EQ(grid.tree().probeConstLeaf(leaf->origin()), &*leaf);
}

struct Counts {
  int read = 0, refused = 0;
};

void readDamaged(const std::string& bytes, Counts& counts) {
  try {
    if ((counts.read + counts.refused) % 3 == 0)
      (void)describeVdbOf("a.vdb", bytes, 100 * kMegabyte);
    for (const NamedGrid& grid : floatGridsOf("a.vdb", bytes, 100 * kMegabyte))
      expectSound(*grid.grid);
    ++counts.read;
  } catch (const Error& e) {
    ASSERT_EQ(e.code(), ErrorCode::input) << e.what();
    ++counts.refused;
  }
}

std::vector<std::string> filesToDamage() {
  const auto ball = smallBall();
  const auto fog = ball->deepCopy();
  openvdb::tools::sdfToFogVolume(*fog);
  const auto half = ball->deepCopy();
  half->setSaveFloatAsHalf(true);
  const auto plain = ball->deepCopy();  // level sets are not compressed by zip
  plain->setGridClass(openvdb::GRID_UNKNOWN);
  return {vdbBytes({ball}, COMPRESS_ACTIVE_MASK),
          vdbBytes({fog}, COMPRESS_ACTIVE_MASK),
          vdbBytes({half}, COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK),
          vdbBytes({ball, smallGrid<openvdb::BoolGrid>(true), fog}, COMPRESS_BLOSC),
          vdbBytes({ball}, COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK),
          vdbBytes({plain}, COMPRESS_ZIP)};
}

TEST(VdbStructure, AChangedWordIsRefusedOrHarmless) {
  std::minstd_rand random(57);
  Counts counts;
  for (const std::string& file : filesToDamage()) {
    constexpr std::size_t kHeader = 1500, kMost = 80;
    const auto damage = [&](std::size_t at) {
      const std::uint32_t kinds[] = {0u, 1u, 0xffffffffu, 0x7fffffffu,
                                     static_cast<std::uint32_t>(random())};
      readDamaged(with(file, at, kinds[random() % 5]), counts);
    };
    for (std::size_t at = 0; at < std::min(kHeader, file.size() - 4); at += 19) damage(at);
    for (std::size_t i = 0; i < kMost; ++i) damage(random() % (file.size() - 4));
  }
  EXPECT_GT(counts.read, 100);
  EXPECT_GT(counts.refused, 100);
}

TEST(VdbStructure, ACutFileIsRefused) {
  for (const std::string& file : filesToDamage()) {
    for (std::size_t n = 0; n < file.size(); n += 1 + n / 9)
      EXPECT_NE(sentenceOf(file.substr(0, n)), "");
    EXPECT_NE(sentenceOf(file.substr(0, file.size() - 1)), "");
  }
}

// ---- What a damaged word may say, each at its place

// Of the file's header: magic, version, library, whether there are offsets, and the identifier.
constexpr std::size_t kMetadata = 57, kGridCount = 61, kName = 65;

class DamagedBall : public testing::Test {
 protected:
  // Behind the background, where each file has the numbers of the root's tiles and children.
  std::size_t root() const {
    const float background = ball_->background();
    std::string pattern(20, '\0');
    const std::uint32_t numbers[] = {1, 0, 0,
                                     static_cast<std::uint32_t>(ball_->tree().root().childCount())};
    std::memcpy(numbers_, numbers, sizeof numbers);
    std::memcpy(&numbers_[1], &background, 4);
    return bytes_.find(std::string(reinterpret_cast<const char*>(numbers_), 16)) + 8;
  }
  std::size_t firstNode() const { return root() + 8 + 12; }

  openvdb::FloatGrid::Ptr ball_ = smallBall();
  std::string bytes_ = vdbBytes({ball_}, COMPRESS_ACTIVE_MASK);
  mutable std::uint32_t numbers_[4]{};
};

TEST_F(DamagedBall, LengthsAndCountsAreHeldAgainstTheFile) {
  EXPECT_EQ(sentenceOf(bytes_), "");
  for (const std::size_t at : {kMetadata, kGridCount, kName, root(), root() + 4}) {
    for (const std::uint32_t value : {0x7fffffffu, 0xffffffffu, 0x00ffffffu})
      EXPECT_NE(sentenceOf(with(bytes_, at, value)), "") << at;
  }
}

TEST_F(DamagedBall, AChildIsNoActiveTile) {
  std::string bytes = bytes_;
  const std::size_t mask = firstNode(), bytesOfMask = 4096;
  std::memcpy(&bytes[mask + bytesOfMask], &bytes[mask], bytesOfMask);
  EXPECT_NE(sentenceOf(bytes).find("is a child and an active tile"), std::string::npos);
}

TEST_F(DamagedBall, NodesLieWhereTreesHaveThem) {
  const std::size_t position = root() + 8;
  EXPECT_NE(sentenceOf(with(bytes_, position, 8)).find("no multiple of 4096"), std::string::npos);
  EXPECT_NE(sentenceOf(with(bytes_, position, 0x7ffff000)).find("2^30"), std::string::npos);
  std::int32_t first[3];
  std::memcpy(first, &bytes_[position], sizeof first);
  ASSERT_GT(ball_->tree().root().childCount(), 1u);
  std::string twice = bytes_;
  // The second child is found by its position: the ball lies around the origin.
  for (std::size_t at = position + 12; at + 12 < twice.size(); ++at) {
    std::int32_t other[3];
    std::memcpy(other, &twice[at], sizeof other);
    const bool isRoot = other[0] == first[0] && other[1] == first[1] && other[2] == 0;
    if (!isRoot) continue;
    std::memcpy(&twice[at], first, sizeof first);
    break;
  }
  EXPECT_NE(sentenceOf(twice).find("two nodes at one position"), std::string::npos);
}

TEST_F(DamagedBall, MemoryIsHeldAgainstTheLimitBeforeItIsTaken) {
  const auto read = [&](std::uint64_t limit) {
    return sentenceOf([&] { (void)floatGridsOf("a.vdb", bytes_, limit); });
  };
  EXPECT_EQ(read(10 * kMegabyte), "");
  EXPECT_NE(read(kMegabyte).find("may be used"), std::string::npos);
  // Upper nodes of 0.3 MB that Blosc packs to 9 KB, 400 of them.
  const auto sparse = openvdb::FloatGrid::create();
  for (int i = 0; i < 400; ++i)
    sparse->tree().addTile(2, openvdb::Coord(4096 * i, 0, 0), 1.0f, true);
  const std::string bomb = vdbBytes({sparse}, COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK);
  EXPECT_LT(bomb.size(), 4 * kMegabyte);
  EXPECT_NE(
      sentenceOf([&] { (void)floatGridsOf("a.vdb", bomb, 100 * kMegabyte); }).find("may be used"),
      std::string::npos);
  EXPECT_EQ(sentenceOf([&] { (void)floatGridsOf("a.vdb", bomb, 150 * kMegabyte); }), "");
}

TEST_F(DamagedBall, NamesAreOfAReasonableLength) {
  const auto ball = smallBall();
  ball->setName(std::string(100'000, 'a'));
  EXPECT_NE(sentenceOf(vdbBytes({ball}, 0)).find("a name has 100"), std::string::npos);
}

TEST_F(DamagedBall, LeavesOfBitsLieInTheirNodes) {
  const auto grid = openvdb::BoolGrid::create();
  grid->tree().setValue(openvdb::Coord(8, 16, 24), true);
  const std::string bytes = vdbBytes({grid}, 0);
  const std::size_t origin = bytes.size() - 64 - 12;
  std::int32_t x;
  std::memcpy(&x, &bytes[origin], 4);
  ASSERT_EQ(x, 8);
  EXPECT_NE(sentenceOf(with(bytes, origin, 16)).find("not at its place"), std::string::npos);
}

TEST_F(DamagedBall, BlocksHoldWhatTheirNodesNeed) {
  const auto grid = openvdb::FloatGrid::create();
  grid->tree().setValue(openvdb::Coord(1, 2, 3), 1.0f);
  for (const std::uint32_t packing : {std::uint32_t{COMPRESS_ZIP}, std::uint32_t{COMPRESS_BLOSC}}) {
    const std::string bytes = vdbBytes({grid}, packing);
    // The only leaf's block is the last thing in the file.
    std::size_t at = bytes.size() - 9;
    for (std::int64_t size = 0; size != static_cast<std::int64_t>(bytes.size() - at - 8); --at)
      std::memcpy(&size, &bytes[at - 1], 8);
    ++at;
    for (const std::int64_t size :
         {std::int64_t{0}, std::int64_t{-1}, std::int64_t{-4096}, std::int64_t{1} << 40,
          std::numeric_limits<std::int64_t>::min()})
      EXPECT_NE(sentenceOf(with(bytes, at - 1, size)), "") << size;
    if (packing == COMPRESS_ZIP) continue;
    for (const std::size_t field : {4u, 8u, 12u})
      EXPECT_NE(sentenceOf(with(bytes, at - 1 + 8 + field, 0x7fffffff)), "") << field;
  }
}

// ---- Files that other versions of OpenVDB write

TEST(VdbVersions, OtherVersionsAreReadOrNamed) {
  const std::string bytes = vdbBytes({smallBall()}, COMPRESS_ACTIVE_MASK);
  EXPECT_EQ(sentenceOf(with(bytes, 8, 225)), "");
  EXPECT_NE(sentenceOf(with(bytes, 8, 226)).find("version 226"), std::string::npos);
  EXPECT_NE(sentenceOf(with(bytes, 8, 219)).find("version 219"), std::string::npos);
}

// Version 221 as OpenVDB 1 wrote it: compression for the whole file, no byte of how inactive values
// are stored, only the values that are no children, and leaves with origins.
std::string bytesOfVersion221() {
  std::string out;
  const auto put = [&](auto value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const auto text = [&](const std::string& s) {
    put(static_cast<std::uint32_t>(s.size()));
    out += s;
  };
  put(std::int64_t{0x56444220});
  put(std::uint32_t{221});
  put(std::uint32_t{1});
  put(std::uint32_t{1});
  out += std::string(2, '\0');  // no offsets, no compression
  out += "01234567-89ab-cdef-0123-456789abcdef";
  put(std::uint32_t{0});
  put(std::int32_t{1});
  text("old");
  text("Tree_float_5_4_3");
  text("");
  out += std::string(24, '\0');
  put(std::uint32_t{0});
  text("UniformScaleMap");
  for (const double number : {0.5, 0.5, 2.0, 4.0, 1.0}) {
    for (int i = 0; i < 3; ++i) put(number);
  }
  put(std::int32_t{1});
  put(0.0f);
  put(std::uint32_t{0});
  put(std::uint32_t{1});
  out += std::string(12, '\0');
  for (const std::size_t entries : {32768u, 4096u}) {
    out += '\1' + std::string(entries / 8 - 1, '\0') + std::string(entries / 8, '\0');
    out += std::string(4 * (entries - 1), '\0');
  }
  out += '\3' + std::string(63, '\0');
  out += '\3' + std::string(63, '\0') + std::string(12, '\0') + '\1';
  put(2.5f);
  put(3.5f);
  return out + std::string(4 * 510, '\0');
}

TEST(VdbVersions, FilesOfTheFirstVersionsAreRead) {
  const auto found = floatGridsOf("old.vdb", bytesOfVersion221(), kNoLimit);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].grid->activeVoxelCount(), 2u);
  EXPECT_EQ(found[0].grid->tree().getValue(openvdb::Coord(0, 0, 1)), 3.5f);
  const std::string bytes = bytesOfVersion221();
  for (std::size_t n = 0; n < bytes.size(); n += 101) EXPECT_NE(sentenceOf(bytes.substr(0, n)), "");
}

TEST(VdbVersions, TypesThatAreNotReadDoNotHideTheOthers) {
  openvdb::initialize();
  const openvdb::GridBase::Ptr points = openvdb::GridBase::createGrid("Tree_ptdataidx32_5_4_3");
  points->setName("points");
  std::string bytes = vdbBytes({smallGrid<openvdb::DoubleGrid>(1.0), points, smallBall()}, 0);
  std::string other = "Tree_other!_5_4_3";
  bytes.replace(bytes.find("Tree_double_5_4_3"), other.size(), other);
  const VdbFile file = describeVdbOf("a.vdb", bytes, kNoLimit);
  ASSERT_EQ(file.grids.size(), 3u);
  EXPECT_EQ(file.grids[0].type, other);
  EXPECT_EQ(file.grids[0].name, "some");
  EXPECT_EQ(file.grids[1].name, "points");
  EXPECT_EQ(file.grids[2].activeVoxels, smallBall()->activeVoxelCount());
  EXPECT_EQ(floatGridsOf("a.vdb", bytes, kNoLimit).size(), 1u);
  bytes[20] = '\0';  // a stream, in which nothing can be skipped
  EXPECT_NE(sentenceOf(bytes).find(other), std::string::npos);
}

TEST(VdbVersions, InstancesHaveTreesOfTheirOwn) {
  const auto ball = smallBall();
  const openvdb::GridBase::Ptr other = ball->copyGrid();  // shares the tree
  other->setName("other");
  const std::string bytes = vdbBytes({ball, other}, COMPRESS_ACTIVE_MASK);
  EXPECT_LT(bytes.size(), vdbBytes({ball}, COMPRESS_ACTIVE_MASK).size() + 3000);
  const auto found = floatGridsOf("a.vdb", bytes, kNoLimit);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[1].name, "other");
  EXPECT_NE(found[0].grid->treePtr(), found[1].grid->treePtr());
  EXPECT_TRUE(found[0].grid->tree().hasSameTopology(found[1].grid->tree()));
  std::string orphan = bytes;
  const std::size_t second = orphan.rfind("ball", orphan.rfind("Tree_float_5_4_3") + 30);
  orphan[second] = 'B';
  EXPECT_NE(sentenceOf(orphan), "");
}

}  // namespace
}  // namespace sherd
