// Level sets as `.vdb` files, byte for byte the same for the same fragment.
#include "io/vdb.h"

#include <openssl/sha.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <sherd/error.h>
#include <sherd/io.h>
#include <sherd/version.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <sstream>

#include "io/atomic_file.h"
#include "io/input_error.h"

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
    Archive::write(out, grids, /*seekable=*/true, metadata);
    if (!out) throw std::bad_alloc();
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

// Houdini shows these as attributes of the same names.  The seed is text: its 64 bits have no sign.
openvdb::MetaMap gridMetadata(const Fragment& fragment, const std::string& source,
                              std::uint64_t seed) {
  const glm::dvec3& centroid = fragment.mass.centroid;
  openvdb::MetaMap metadata;
  metadata.insertMeta(openvdb::GridBase::META_GRID_NAME, openvdb::StringMetadata("surface"));
  metadata.insertMeta(
      openvdb::GridBase::META_GRID_CLASS,
      openvdb::StringMetadata(openvdb::GridBase::gridClassToString(openvdb::GRID_LEVEL_SET)));
  metadata.insertMeta("piece", openvdb::StringMetadata("piece" + std::to_string(fragment.id)));
  metadata.insertMeta("fragment_id", openvdb::Int32Metadata(fragment.id));
  metadata.insertMeta("pivot", openvdb::Vec3DMetadata({centroid.x, centroid.y, centroid.z}));
  metadata.insertMeta("volume", openvdb::DoubleMetadata(fragment.mass.volume));
  metadata.insertMeta("seed", openvdb::StringMetadata(std::to_string(seed)));
  metadata.insertMeta("source", openvdb::StringMetadata(source));
  return metadata;
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
  if (std::filesystem::is_directory(file)) inputError(file, "is a folder; a .vdb file is needed");
  std::ifstream in(file, std::ios::binary);
  if (!in) inputError(file, "cannot be opened: " + reasonOf(errno));
  in.exceptions(std::ios::badbit | std::ios::failbit);  // OpenVDB reads on past a file's end
  try {
    openvdb::initialize();
    openvdb::io::Stream stream(in, /*delayLoad=*/false);
    return read(stream);
  } catch (const std::ios::failure&) {
    inputError(file, "ends too early; the file is cut or is no .vdb file");
  } catch (const std::exception& e) {  // whatever a damaged file makes OpenVDB throw
    inputError(file, std::string("is no .vdb file that OpenVDB can read: ") + e.what());
  }
}

// Write the grid that `make` makes.
template <class Make>
void writeGrid(const std::filesystem::path& file, Make&& make) {
  std::string bytes;
  try {
    openvdb::initialize();
    MemoryArchive archive;
    archive.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
    archive.setGridStatsMetadataEnabled(true);  // Houdini's file browser reads the bounds from it
    // Blender turns a file upright when its creator starts with "Houdini"; ours must not.
    openvdb::MetaMap fileMetadata;
    fileMetadata.insertMeta("creator", openvdb::StringMetadata("sherd " SHERD_VERSION));
    bytes = archive.bytes({make()}, fileMetadata);
  } catch (const openvdb::Exception& e) {
    throw Error(ErrorCode::output, file.string() + ": OpenVDB cannot encode it: " + e.what());
  }
  setUuidFromContent(bytes);
  writeWhole(file, bytes);
}

}  // namespace

void writeVdb(const std::filesystem::path& file, const Fragment& fragment,
              const std::string& source, std::uint64_t seed) {
  writeGrid(file, [&] {
    return fragment.surface->copyGridReplacingMetadata(gridMetadata(fragment, source, seed));
  });
}

void writeCost(const std::filesystem::path& file, const Solid& solid, const Labels& labels) {
  writeGrid(file, [&] {
    const openvdb::Int32Grid::Ptr grid = openvdb::Int32Grid::create(-1);
    grid->setTransform(solid.distance->transform().copy());
    grid->setName("cost");
    openvdb::Int32Grid::Accessor accessor = grid->getAccessor();
    solid.blocks.forEachInside([&](std::size_t place) {
      accessor.setValue(solid.blocks.voxelAt(place), static_cast<std::int32_t>(labels.cost[place]));
    });
    return grid;
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

std::shared_ptr<openvdb::FloatGrid> readLevelSet(const std::filesystem::path& file) {
  const auto found = withStream(file, [](openvdb::io::Stream& stream) {
    const openvdb::GridPtrVecPtr grids = stream.getGrids();
    for (const openvdb::GridBase::Ptr& grid : *grids) {
      if (auto level = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) return level;
    }
    return openvdb::FloatGrid::Ptr();
  });
  if (!found || found->getGridClass() != openvdb::GRID_LEVEL_SET) {
    inputError(file, "holds no level set");
  }
  return found;
}

}  // namespace sherd
