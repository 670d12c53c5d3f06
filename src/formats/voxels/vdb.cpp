// Grids as `.vdb` files, byte for byte the same for the same fragments.
#include "formats/voxels/vdb.h"

#include <openssl/sha.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <sherd/error.h>
#include <sherd/vdb_files.h>
#include <sherd/version.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <new>
#include <sstream>

#include "base/atomic_file.h"
#include "base/input_error.h"
#include "mesh/principal_inertia.h"
#include "surface/level_set.h"

namespace sherd {
namespace {

// The header: u64 magic, u32 file version, u32 library major and minor, u8 has-offsets, then a
// random UUID as text.
constexpr std::size_t kUuidAt = 21;
constexpr std::size_t kUuidLength = 36;

// io::File writes to a disk and does not notice when that is full, io::Stream leaves out the
// offsets that let readers seek.  Their common base writes a seekable file into memory, which is
// then ours to check.
class MemoryArchive : public openvdb::io::Archive {
 public:
  std::string bytes(const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) const {
    std::ostringstream out(std::ios::binary);
    // Where memory ends, a stream notes it and goes on, but OpenVDB crashes on what it then tells.
    out.exceptions(std::ios::badbit | std::ios::failbit);
    Archive::write(out, grids, /*seekable=*/true, metadata);
    return std::move(out).str();
  }
};

// A UUID of version 8 (RFC 9562: made as one likes) from the SHA-256 of the file with zeros in its
// place.
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

// Houdini shows metadata as attributes of the same names.  The seed is text: its 64 bits have no
// sign.
openvdb::MetaMap commonMetadata(const VdbNotes& notes) {
  openvdb::MetaMap metadata;
  metadata.insertMeta("seed", openvdb::StringMetadata(std::to_string(notes.seed)));
  metadata.insertMeta("source", openvdb::StringMetadata(notes.source));
  metadata.insertMeta("tool_version", openvdb::StringMetadata(SHERD_VERSION));
  return metadata;
}

openvdb::MetaMap pieceMetadata(const Fragment& fragment, const VdbNotes& notes) {
  const glm::dvec3& centroid = fragment.mass.centroid;
  const PrincipalInertia inertia = principalInertia(fragment.mass);
  const glm::dvec3 moments = notes.density * inertia.moments;
  const glm::dquat& turn = inertia.orientation;
  openvdb::MetaMap metadata = commonMetadata(notes);
  metadata.insertMeta("piece", openvdb::StringMetadata("piece" + std::to_string(fragment.id)));
  metadata.insertMeta("fragment_id", openvdb::Int32Metadata(fragment.id));
  metadata.insertMeta("pivot", openvdb::Vec3DMetadata({centroid.x, centroid.y, centroid.z}));
  metadata.insertMeta("volume", openvdb::DoubleMetadata(fragment.mass.volume));
  metadata.insertMeta("density", openvdb::DoubleMetadata(notes.density));
  metadata.insertMeta("mass", openvdb::DoubleMetadata(notes.density * fragment.mass.volume));
  metadata.insertMeta("inertia", openvdb::Vec3DMetadata({moments.x, moments.y, moments.z}));
  metadata.insertMeta("inertia_orient", openvdb::Vec4DMetadata({turn.x, turn.y, turn.z, turn.w}));
  metadata.insertMeta("area_inside", openvdb::DoubleMetadata(fragment.fractureArea));
  metadata.insertMeta("area_outside",
                      openvdb::DoubleMetadata(fragment.area - fragment.fractureArea));
  if (!notes.parents.empty()) {
    metadata.insertMeta("parent_id", openvdb::Int32Metadata(
                                         notes.parents[static_cast<std::size_t>(fragment.id - 1)]));
  }
  return metadata;
}

// The level set under a name and, where asked for, its fog under another.
void addGrids(openvdb::GridCPtrVec& grids, const openvdb::FloatGrid& levelSet,
              const std::string& number, const openvdb::MetaMap& metadata,
              const VdbOptions& options) {
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

VdbMetadata textOf(const openvdb::MetaMap& metadata) {
  VdbMetadata text;
  for (auto it = metadata.beginMeta(); it != metadata.endMeta(); ++it) {
    if (it->second) text.emplace_back(it->first, it->second->str());
  }
  return text;
}

VdbGrid describe(const openvdb::GridBase& grid) {
  const openvdb::Vec3d size = grid.voxelSize();
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  const openvdb::Metadata::Ptr background = grid.constBaseTree().getBackgroundValue();
  return {.name = grid.getName(),
          .type = grid.constBaseTree().type(),
          .gridClass = openvdb::GridBase::gridClassToString(grid.getGridClass()),
          .voxelSize = {size.x(), size.y(), size.z()},
          .background = background ? background->str() : "",
          .activeVoxels = grid.activeVoxelCount(),
          .activeBox = {box.min(), box.max()},
          .metadata = textOf(grid)};
}

// Open a file and let `read` take what it wants from its stream.
template <class Read>
auto withStream(const std::filesystem::path& file, Read&& read) {
  if (whatIsAt(file) == std::filesystem::file_type::directory)
    inputError(file, "is a folder; a .vdb file is needed");
  std::ifstream in(file, std::ios::binary);
  if (!in) inputError(file, "cannot be opened: " + reasonOf(errno));
  in.exceptions(std::ios::badbit | std::ios::failbit);  // OpenVDB reads on past a file's end
  try {
    openvdb::initialize();
    openvdb::io::Stream stream(in, /*delayLoad=*/false);
    return read(stream);
  } catch (const std::ios::failure&) {
    inputError(file, "ends too early; the file is cut or is no .vdb file");
  } catch (const std::bad_alloc&) {
    inputError(file, "asks for more memory than there is; is it damaged?");
  } catch (const std::exception& e) {  // whatever a damaged file makes OpenVDB throw
    inputError(file, std::string("is no .vdb file that OpenVDB can read: ") + e.what());
  }
}

// Write the grids that `make` makes.
template <class Make>
void writeGrids(const OutputFile& file, VdbCompression compression, Make&& make) {
  std::string bytes;
  try {
    openvdb::initialize();
    MemoryArchive archive;
    archive.setCompression(flagsOf(compression));
    archive.setGridStatsMetadataEnabled(true);  // Houdini's file browser reads the bounds from it
    // Blender turns a file upright when its creator starts with "Houdini"; ours must not.
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

// Values of all voxels of the solid.
//   valueOf  (place) in the solid's blocks
template <class ValueOf>
openvdb::Int32Grid::Ptr voxelGrid(const Solid& solid, const char* name, std::int32_t background,
                                  const ValueOf& valueOf) {
  const openvdb::Int32Grid::Ptr grid = openvdb::Int32Grid::create(background);
  grid->setTransform(solid.distance->transform().copy());
  grid->setName(name);
  openvdb::Int32Grid::Accessor accessor = grid->getAccessor();
  solid.blocks.forEachInside(
      [&](std::size_t place) { accessor.setValue(solid.blocks.voxelAt(place), valueOf(place)); });
  return grid;
}

}  // namespace

void writeVdb(const OutputFile& file, const Fragment& fragment, const VdbNotes& notes,
              const VdbOptions& options) {
  writeGrids(file, options.compression, [&](openvdb::GridCPtrVec& grids) {
    addGrids(grids, *fragment.surface, "", pieceMetadata(fragment, notes), options);
  });
}

void writeVdbOfAll(const OutputFile& file, std::span<const Fragment> fragments, const Solid& solid,
                   const Labels& labels, const VdbNotes& notes, const VdbOptions& options) {
  writeGrids(file, options.compression, [&](openvdb::GridCPtrVec& grids) {
    for (const Fragment& fragment : fragments) {
      addGrids(grids, *fragment.surface, "_" + std::to_string(fragment.id),
               pieceMetadata(fragment, notes), options);
    }
    const openvdb::Int32Grid::Ptr ids = voxelGrid(solid, "fragment_id", 0, [&](std::size_t place) {
      const std::uint16_t id = labels.fragment[place];
      return id <= fragments.size() ? std::int32_t{id} : 0;
    });
    ids->insertMeta(commonMetadata(notes));
    grids.push_back(ids);
  });
}

void writeVdbOfSolid(const OutputFile& file, const Solid& solid, const VdbNotes& notes,
                     const VdbOptions& options) {
  writeGrids(file, options.compression, [&](openvdb::GridCPtrVec& grids) {
    addGrids(grids, *solid.distance, "", commonMetadata(notes), options);
  });
}

void writeCost(const OutputFile& file, const Solid& solid, const Labels& labels) {
  writeGrids(file, VdbCompression::blosc, [&](openvdb::GridCPtrVec& grids) {
    grids.push_back(voxelGrid(solid, "cost", -1, [&](std::size_t place) {
      return static_cast<std::int32_t>(labels.cost[place]);
    }));
  });
}

VdbFile describeVdb(const std::filesystem::path& file) {
  return withStream(file, [](openvdb::io::Stream& stream) {
    VdbFile found;
    if (const auto metadata = stream.getMetadata()) found.metadata = textOf(*metadata);
    const openvdb::GridPtrVecPtr grids = stream.getGrids();
    for (const openvdb::GridBase::Ptr& grid : *grids) found.grids.push_back(describe(*grid));
    return found;
  });
}

std::vector<NamedGrid> readFloatGrids(const std::filesystem::path& file) {
  std::vector<NamedGrid> found = withStream(file, [](openvdb::io::Stream& stream) {
    std::vector<NamedGrid> all;
    const openvdb::GridPtrVecPtr grids = stream.getGrids();
    for (const openvdb::GridBase::Ptr& base : *grids) {
      const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(base);
      if (!grid) continue;
      all.push_back({grid->getName(), grid->getGridClass() == openvdb::GRID_LEVEL_SET, grid});
    }
    return all;
  });
  if (found.empty()) inputError(file, "holds no grid of floats");
  return found;
}

std::vector<NamedGrid> readLevelSets(const std::filesystem::path& file) {
  std::vector<NamedGrid> found = readFloatGrids(file);
  std::erase_if(found, [](const NamedGrid& grid) { return !grid.isLevelSet; });
  if (found.empty()) inputError(file, "holds no level set");
  return found;
}

std::shared_ptr<openvdb::FloatGrid> readLevelSet(const std::filesystem::path& file) {
  return readLevelSets(file).front().grid;
}

}  // namespace sherd
