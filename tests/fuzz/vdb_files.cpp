// `.vdb` files for fuzzing.
#include "fuzz/vdb_files.h"

#include <openvdb/io/Compression.h>
#include <openvdb/openvdb.h>
#include <sherd/error.h>

#include <cstdint>

#include "formats/voxels/vdb.h"
#include "fuzz/readers.h"
#include "vdb_bytes.h"

namespace sherd::fuzz {
namespace {

template <class Grid>
openvdb::GridBase::Ptr smallGrid(const typename Grid::ValueType& value) {
  openvdb::initialize();
  const auto grid = Grid::create();
  grid->setName("some");
  grid->insertMeta("weight", openvdb::DoubleMetadata(2.0));
  grid->tree().setValue(openvdb::Coord(1, 2, 3), value);
  grid->tree().addTile(3, openvdb::Coord(0, 0, 8192), value, true);
  return grid;
}

// What fits in a file that may be fuzzed in 16 KB needs less.
constexpr std::uint64_t kMemory = 256'000'000;

// OpenVDB's functions may be used on the tree: two ways of counting agree.
void checkGrid(const openvdb::FloatGrid& grid) {
  openvdb::Index64 active = 0;
  for (auto value = grid.cbeginValueOn(); value; ++value) active += value.getVoxelCount();
  check(active == grid.activeVoxelCount());
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    check(grid.tree().probeConstLeaf(leaf->origin()) == &*leaf);
}

}  // namespace

std::vector<std::string> vdbFiles() {
  using openvdb::io::COMPRESS_ACTIVE_MASK;
  using openvdb::io::COMPRESS_BLOSC;
  using openvdb::io::COMPRESS_ZIP;
  std::vector<std::string> files;
  for (const std::uint32_t flags :
       {std::uint32_t{COMPRESS_ACTIVE_MASK}, std::uint32_t{COMPRESS_ZIP},
        std::uint32_t{COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK}}) {
    const openvdb::GridBase::Ptr levels = smallGrid<openvdb::FloatGrid>(-1.5f);
    // OpenVDB does not zip level sets.
    if (flags != COMPRESS_ZIP) levels->setGridClass(openvdb::GRID_LEVEL_SET);
    const openvdb::GridBase::Ptr half = smallGrid<openvdb::FloatGrid>(1.5f);
    half->setSaveFloatAsHalf(true);
    for (const openvdb::GridBase::Ptr& grid : {levels, half, smallGrid<openvdb::BoolGrid>(true),
                                               smallGrid<openvdb::Vec3SGrid>({1, 2, 3})})
      files.push_back(vdbBytes({grid}, flags));
    const openvdb::GridBase::Ptr instance = levels->copyGrid();
    instance->setName("other");
    instance->setTransform(openvdb::math::Transform::createFrustumTransform(
        openvdb::BBoxd({0, 0, 0}, {9, 9, 9}), 0.5, 2.0, 1.0));
    files.push_back(vdbBytes({levels, instance}, flags));
  }
  return files;
}

void readVdb(std::string_view bytes) {
  try {
    (void)describeVdbOf("a.vdb", std::string(bytes), kMemory);
  } catch (const Error& e) {  // perhaps for a grid that is not one of floats
    check(e.code() == ErrorCode::input);
  }
  for (const NamedGrid& grid : floatGridsOf("a.vdb", std::string(bytes), kMemory))
    checkGrid(*grid.grid);
}

}  // namespace sherd::fuzz
