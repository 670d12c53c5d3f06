// Writes `.vdb` files; equal fragments give equal bytes.
#include <openssl/sha.h>
#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <sherd/error.h>
#include <sherd/files.h>

#include <array>
#include <sstream>

#include "base/files/atomic_file.h"
#include "base/version.h"
#include "cut/level_set.h"
#include "formats/voxels/vdb_unit.h"
#include "grow/fields/check_labels.h"
#include "mesh/principal_inertia.h"
#include "voxelize/distance.h"

namespace sherd {
namespace {

// The header: u64 magic, u32 file version, u32 library major and minor, u8 has-offsets, then a
// random UUID as text.
constexpr std::size_t kUuidAt = 21;
constexpr std::size_t kUuidLength = 36;

// io::File does not detect a full disk, and io::Stream omits the offsets that let readers seek.
// Their common base writes a seekable file into memory, which OutputFile then writes.
class MemoryArchive : public openvdb::io::Archive {
 public:
  std::string bytes(const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) const {
    std::ostringstream out(std::ios::binary);
    // Without exceptions a stream that runs out of memory continues, and OpenVDB crashes on the
    // positions that it then returns.
    out.exceptions(std::ios::badbit | std::ios::failbit);
    Archive::write(out, grids, /*seekable=*/true, metadata);
    return std::move(out).str();
  }
};

// A UUID of version 8 (RFC 9562, custom) from the SHA-256 of the file with zeros in the UUID's
// position.
void setUuidFromContent(std::string& bytes) {
  bytes.replace(kUuidAt, kUuidLength, kUuidLength, '0');
  std::array<unsigned char, SHA256_DIGEST_LENGTH> hash{};
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), hash.data());
  hash[6] = static_cast<unsigned char>((hash[6] & 0x0f) | 0x80);
  hash[8] = static_cast<unsigned char>((hash[8] & 0x3f) | 0x80);
  std::string uuid;
  for (std::size_t i = 0; i < 16; ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) uuid += '-';
    uuid += "0123456789abcdef"[hash[i] >> 4];
    uuid += "0123456789abcdef"[hash[i] & 15];
  }
  bytes.replace(kUuidAt, kUuidLength, uuid);
}

// Houdini shows metadata as attributes with the same names. The seed is text because its 64 bits
// are unsigned.
openvdb::MetaMap commonMetadata(const GridMetadata& gridMetadata) {
  openvdb::MetaMap metadata;
  metadata.insertMeta("seed", openvdb::StringMetadata(std::to_string(gridMetadata.seed)));
  metadata.insertMeta("source", openvdb::StringMetadata(gridMetadata.source));
  metadata.insertMeta("tool_version", openvdb::StringMetadata(SHERD_VERSION));
  return metadata;
}

// In the file's unit, of which one is so many world units: masses are what they are.
openvdb::MetaMap pieceMetadata(const Fragment& fragment, const GridMetadata& gridMetadata,
                               double unit) {
  const double square = unit * unit, cube = square * unit;
  const glm::dvec3 centroid = fragment.mass.centroid / unit;
  const PrincipalInertia inertia = principalInertia(fragment.mass);
  const glm::dvec3 moments = gridMetadata.density * inertia.moments / square;
  const glm::dquat& rotation = inertia.orientation;
  openvdb::MetaMap metadata = commonMetadata(gridMetadata);
  metadata.insertMeta("piece", openvdb::StringMetadata("piece" + std::to_string(fragment.id)));
  metadata.insertMeta("fragment_id", openvdb::Int32Metadata(fragment.id));
  metadata.insertMeta("pivot", openvdb::Vec3DMetadata({centroid.x, centroid.y, centroid.z}));
  metadata.insertMeta("volume", openvdb::DoubleMetadata(fragment.mass.volume / cube));
  metadata.insertMeta("density", openvdb::DoubleMetadata(gridMetadata.density * cube));
  metadata.insertMeta("mass", openvdb::DoubleMetadata(gridMetadata.density * fragment.mass.volume));
  metadata.insertMeta("inertia", openvdb::Vec3DMetadata({moments.x, moments.y, moments.z}));
  metadata.insertMeta("inertia_orient",
                      openvdb::Vec4DMetadata({rotation.x, rotation.y, rotation.z, rotation.w}));
  metadata.insertMeta("area_inside", openvdb::DoubleMetadata(fragment.fractureArea / square));
  metadata.insertMeta("area_outside",
                      openvdb::DoubleMetadata((fragment.area - fragment.fractureArea) / square));
  if (!gridMetadata.parents.empty()) {
    metadata.insertMeta(
        "parent_id",
        openvdb::Int32Metadata(gridMetadata.parents[static_cast<std::size_t>(fragment.id - 1)]));
  }
  return metadata;
}

void addUnit(openvdb::MetaMap& metadata, double unit) {
  if (unit != 1.0) metadata.insertMeta(kVdbUnit, openvdb::DoubleMetadata(unit));
}

// Adds the level set and, with options.fog, its fog volume under another name.
void addGrids(openvdb::GridCPtrVec& grids, const openvdb::FloatGrid& ofWorld,
              const std::string& number, openvdb::MetaMap metadata, double unit,
              const VdbOptions& options) {
  addUnit(metadata, unit);
  const FloatGridPtr inFile = unit == 1.0 ? nullptr : inVdbUnit(ofWorld, unit);
  const openvdb::FloatGrid& levelSet = inFile ? *inFile : ofWorld;
  const auto add = [&](const openvdb::GridBase::Ptr& grid, const std::string& name) {
    grid->setName(name + number);
    grid->setSaveFloatAsHalf(options.half);
    grids.push_back(grid);
  };
  openvdb::MetaMap surface = metadata;
  surface.insertMeta(
      openvdb::GridBase::META_GRID_CLASS,
      openvdb::StringMetadata(openvdb::GridBase::gridClassToString(openvdb::GRID_LEVEL_SET)));
  add(openvdb::ConstPtrCast<openvdb::GridBase>(levelSet.copyGridReplacingMetadata(surface)),
      "surface");
  if (!options.fog) return;
  const openvdb::FloatGrid::Ptr fog = fogVolume(levelSet);
  fog->clearMetadata();
  fog->insertMeta(metadata);
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  add(fog, "density");
}

std::uint32_t flagsOf(VdbCompression compression) {
  switch (compression) {
    case VdbCompression::zip:
      return openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK;
    case VdbCompression::none:
      return openvdb::io::COMPRESS_ACTIVE_MASK;
    case VdbCompression::blosc:
      break;
  }
  return openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK;
}

// Writes the grids that `make` appends.
template <class Make>
void writeGrids(const OutputFile& file, VdbCompression compression, Make&& make) {
  std::string bytes;
  try {
    openvdb::initialize();
    MemoryArchive archive;
    archive.setCompression(flagsOf(compression));
    archive.setGridStatsMetadataEnabled(true);  // Houdini's file browser reads the bounds from it
    // Blender rotates a file whose creator starts with "Houdini"; ours must not.
    openvdb::MetaMap fileMetadata;
    fileMetadata.insertMeta("creator", openvdb::StringMetadata("sherd " SHERD_VERSION));
    openvdb::GridCPtrVec grids;
    make(grids);
    bytes = archive.bytes(grids, fileMetadata);
  } catch (const openvdb::Exception& e) {
    throw Error(ErrorCode::output, file.string() + ": OpenVDB cannot encode it: " + e.what());
  }
  setUuidFromContent(bytes);
  file.write(bytes);
}

double unitOf(const openvdb::FloatGrid& levelSet, const VdbOptions& options) {
  return vdbUnitOf(frameOf(levelSet).voxelSize, options.half);
}

// Returns a grid with a value for each inside voxel.
//   like     a grid on the same voxels
//   valueOf  (voxel) an index into the blocks
template <class ValueOf>
openvdb::Int32Grid::Ptr voxelGrid(const LeafBlocks& blocks, const openvdb::FloatGrid& like,
                                  double unit, std::int32_t background, const ValueOf& valueOf) {
  const openvdb::Int32Grid::Ptr grid = openvdb::Int32Grid::create(background);
  const FloatGridPtr frame = uniformGrid(0.0f);
  setFrame(*frame, inUnit(frameOf(like), unit));
  grid->setTransform(frame->transformPtr());
  addUnit(*grid, unit);
  openvdb::Int32Grid::Accessor accessor = grid->getAccessor();
  blocks.forEachInside(
      [&](std::size_t voxel) { accessor.setValue(blocks.voxelAt(voxel), valueOf(voxel)); });
  return grid;
}

}  // namespace

void writeVdb(const OutputFile& file, const Fragment& fragment, const GridMetadata& gridMetadata,
              const VdbOptions& options) {
  writeGrids(file, options.compression, [&](openvdb::GridCPtrVec& grids) {
    const double unit = unitOf(*fragment.surface, options);
    addGrids(grids, *fragment.surface, "", pieceMetadata(fragment, gridMetadata, unit), unit,
             options);
  });
}

void writeVdbOfAll(const OutputFile& file, std::span<const Fragment> fragments,
                   const Labels& labels, const GridMetadata& gridMetadata,
                   const VdbOptions& options) {
  writeGrids(file, options.compression, [&](openvdb::GridCPtrVec& grids) {
    const double unit = unitOf(*fragments.front().surface, options);
    for (const Fragment& fragment : fragments) {
      addGrids(grids, *fragment.surface, "_" + std::to_string(fragment.id),
               pieceMetadata(fragment, gridMetadata, unit), unit, options);
    }
    const openvdb::Int32Grid::Ptr ids =
        voxelGrid(*labels.blocks, *fragments.front().surface, unit, 0, [&](std::size_t voxel) {
          const std::uint16_t id = labels.fragment[voxel];
          return id <= fragments.size() ? std::int32_t{id} : 0;
        });
    ids->setName("fragment_id");
    ids->insertMeta(commonMetadata(gridMetadata));
    grids.push_back(ids);
  });
}

void writeVdbOfSolid(const OutputFile& file, const Solid& solid, const GridMetadata& gridMetadata,
                     const VdbOptions& options) {
  writeGrids(file, options.compression, [&](openvdb::GridCPtrVec& grids) {
    addGrids(grids, *solid.distance, "", commonMetadata(gridMetadata),
             unitOf(*solid.distance, options), options);
  });
}

void writeCost(const OutputFile& file, const Solid& solid, const Labels& labels) {
  checkLabels(labels, solid);
  if (labels.cost.size() != labels.fragment.size()) {
    throw Error(ErrorCode::usage, "the labels have no arrival costs");
  }
  writeGrids(file, VdbCompression::blosc, [&](openvdb::GridCPtrVec& grids) {
    const openvdb::Int32Grid::Ptr cost =
        voxelGrid(*labels.blocks, *solid.distance, unitOf(*solid.distance, {}), -1,
                  [&](std::size_t voxel) { return static_cast<std::int32_t>(labels.cost[voxel]); });
    cost->setName("cost");
    grids.push_back(cost);
  });
}

}  // namespace sherd
