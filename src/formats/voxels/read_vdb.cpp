// Reads `.vdb` files: OpenVDB parses bytes whose structure has been checked.
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <istream>
#include <map>
#include <memory>
#include <new>
#include <span>
#include <streambuf>
#include <utility>

#include "base/files/atomic_file.h"
#include "base/input_error.h"
#include "base/memory.h"
#include "base/memory_budget.h"
#include "formats/voxels/vdb.h"
#include "formats/voxels/vdb_structure.h"
#include "formats/voxels/vdb_text.h"
#include "formats/voxels/vdb_unit.h"
#include "voxelize/distance.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// A stream of bytes in memory, without a copy.
class BytesBuffer : public std::streambuf {
 public:
  explicit BytesBuffer(std::span<char> bytes) {
    setg(bytes.data(), bytes.data(), bytes.data() + bytes.size());
  }

 protected:
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type size = egptr() - eback();
    off_type at = offset;
    if (from == std::ios_base::cur) at += gptr() - eback();
    if (from == std::ios_base::end) at += size;
    if (at < 0 || at > size) return pos_type(off_type(-1));
    setg(eback(), eback() + at, egptr());
    return pos_type(at);
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override {
    return seekoff(off_type(position), std::ios_base::beg, mode);
  }
};

// What is read of a file: of each grid, null where it is not wanted.
struct VdbGrids {
  VdbStructure structure;
  openvdb::MetaMap metadata;
  std::vector<openvdb::GridBase::Ptr> grids;  // [structure.grids]
};

using IsWanted = std::function<bool(const VdbEntry&)>;

// Reads the wanted grids. io::Stream reads all of them, those of points included, and io::File
// opens files.
class CheckedArchive : public openvdb::io::Archive {
 public:
  void read(std::istream& in, VdbGrids& found, const IsWanted& isWanted) {
    readHeader(in);
    openvdb::io::StreamMetadata::Ptr settings(new openvdb::io::StreamMetadata);
    openvdb::io::setStreamMetadataPtr(in, settings, /*transfer=*/false);
    openvdb::io::setVersion(in, libraryVersion(), fileVersion());
    openvdb::io::setDataCompression(in, compression());
    found.metadata.readMeta(in);
    std::map<std::string, openvdb::GridBase::Ptr> parents;
    for (const VdbEntry& entry : found.structure.grids) {
      openvdb::GridBase::Ptr grid;
      if (entry.content != VdbContent::none && isWanted(entry)) grid = gridAt(in, entry);
      if (grid && entry.parent.empty()) parents[entry.name] = grid;
      found.grids.push_back(std::move(grid));
    }
    for (std::size_t i = 0; i < found.grids.size(); ++i) {
      const std::string& parent = found.structure.grids[i].parent;
      // A copy, because level sets are united in place.
      if (found.grids[i] && !parent.empty())
        found.grids[i]->setTree(parents.at(parent)->baseTree().copy());
    }
  }

 private:
  static openvdb::GridBase::Ptr gridAt(std::istream& in, const VdbEntry& entry) {
    in.seekg(static_cast<std::streamoff>(entry.begin));
    openvdb::io::GridDescriptor descriptor;
    openvdb::GridBase::Ptr grid = descriptor.read(in);
    if (entry.content == VdbContent::topology) {
      readGridCompression(in);
      openvdb::io::setGridClass(in, openvdb::GRID_UNKNOWN);
      openvdb::io::setGridBackgroundValuePtr(in, nullptr);
      grid->readMeta(in);
      grid->readTransform(in);
      if (!descriptor.isInstance()) grid->readTopology(in);
      return grid;
    }
    readGrid(grid, descriptor, in);
    if (in.tellg() != static_cast<std::streamoff>(entry.end)) {
      throw Error(ErrorCode::internal, "OpenVDB reads grid '" + vdbText(entry.name) +
                                           "' in another way than it was checked");
    }
    return grid;
  }
};

// Parses a file's bytes, which the check may change.
VdbGrids parsed(const fs::path& file, std::span<char> bytes, MemoryBudget& memory,
                const IsWanted& isWanted) {
  VdbGrids found;
  found.structure = checkedVdb(file, bytes);
  memory.charge(found.structure.memory);
  for (const VdbEntry& entry : found.structure.grids) {
    if (isWanted(entry)) memory.charge(entry.memory);
  }
  BytesBuffer buffer(bytes);
  std::istream in(&buffer);
  in.exceptions(std::ios::badbit | std::ios::failbit);  // otherwise OpenVDB reads past the end
  try {
    CheckedArchive().read(in, found, isWanted);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    inputError(file, "needs more memory than there is", OptionNames{"max-memory"});
  } catch (const std::exception& e) {  // such as a block that cannot be decompressed
    inputError(file, "is damaged; OpenVDB cannot read it: " + vdbText(e.what()));
  }
  return found;
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

// Of a type that OpenVDB does not know.
VdbGrid describe(const VdbEntry& entry) {
  VdbGrid grid;
  grid.name = openvdb::io::GridDescriptor::stripSuffix(entry.name);
  grid.type = entry.type;
  grid.gridClass = openvdb::GridBase::gridClassToString(openvdb::GRID_UNKNOWN);
  return grid;
}

VdbFile described(const fs::path& file, std::span<char> bytes, MemoryBudget& memory) {
  const VdbGrids read = parsed(file, bytes, memory, [](const VdbEntry&) { return true; });
  VdbFile found;
  found.metadata = textOf(read.metadata);
  for (std::size_t i = 0; i < read.grids.size(); ++i) {
    found.grids.push_back(read.grids[i] ? describe(*read.grids[i])
                                        : describe(read.structure.grids[i]));
  }
  return found;
}

std::vector<NamedGrid> floatGrids(const fs::path& file, std::span<char> bytes,
                                  MemoryBudget& memory) {
  const VdbGrids read = parsed(
      file, bytes, memory, [](const VdbEntry& entry) { return entry.type == "Tree_float_5_4_3"; });
  std::vector<NamedGrid> all;
  for (const openvdb::GridBase::Ptr& base : read.grids) {
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(base);
    if (!grid) continue;
    intoWorldUnits(*grid);
    all.push_back(
        {vdbText(grid->getName()), grid->getGridClass() == openvdb::GRID_LEVEL_SET, grid});
  }
  return all;
}

MemoryBudget budgetFor(const fs::path& file, const ReadOptions& options) {
  return {file.string(), std::min(options.maxMemory, freeMemory())};
}

// A whole file in memory that was not filled with zeros before, in large pages if the system has
// them: for a file of 200 MB these take a third of the time in which OpenVDB parses it.
class FileBytes {
 public:
  FileBytes(const fs::path& file, MemoryBudget& memory) {
    const fs::file_type type = whatIsAt(file);
    if (type == fs::file_type::directory) inputError(file, "is a folder; a .vdb file is needed");
    if (type == fs::file_type::not_found) inputError(file, "there is no such file");
    if (type != fs::file_type::regular) inputError(file, "is not a regular file");
    std::ifstream in(file, std::ios::binary);
    if (!in) inputError(file, "cannot be opened: " + reasonOf(errno));
    std::error_code error;
    size_ = static_cast<std::size_t>(fs::file_size(file, error));
    if (error) inputError(file, "cannot be read: " + error.message());
    memory.charge(size_);
    bytes_.reset(static_cast<char*>(std::aligned_alloc(kPage, (size_ / kPage + 1) * kPage)));
    if (!bytes_) inputError(file, "needs more memory than there is", OptionNames{"max-memory"});
    if (size_ >= kPage) ::madvise(bytes_.get(), size_, MADV_HUGEPAGE);
    if (!in.read(bytes_.get(), static_cast<std::streamsize>(size_)))
      inputError(file, "cannot be read to its end");
  }
  [[nodiscard]] std::span<char> span() { return {bytes_.get(), size_}; }

 private:
  static constexpr std::size_t kPage = std::size_t{2} << 20;
  struct Free {
    void operator()(char* bytes) const { std::free(bytes); }
  };
  std::unique_ptr<char, Free> bytes_;
  std::size_t size_ = 0;
};

}  // namespace

VdbFile describeVdbOf(const fs::path& file, std::string bytes, std::uint64_t maxMemory) {
  MemoryBudget memory(file.string(), maxMemory);
  return described(file, bytes, memory);
}

VdbFile describeVdb(const fs::path& file, const ReadOptions& options) {
  MemoryBudget memory = budgetFor(file, options);
  return described(file, FileBytes(file, memory).span(), memory);
}

std::vector<NamedGrid> floatGridsOf(const fs::path& file, std::string bytes,
                                    std::uint64_t maxMemory) {
  MemoryBudget memory(file.string(), maxMemory);
  return floatGrids(file, bytes, memory);
}

std::vector<NamedGrid> readFloatGrids(const fs::path& file, const ReadOptions& options) {
  MemoryBudget memory = budgetFor(file, options);
  std::vector<NamedGrid> found = floatGrids(file, FileBytes(file, memory).span(), memory);
  if (found.empty()) inputError(file, "holds no grid of floats");
  return found;
}

std::vector<NamedGrid> readLevelSets(const fs::path& file, const ReadOptions& options) {
  std::vector<NamedGrid> found = readFloatGrids(file, options);
  std::erase_if(found, [](const NamedGrid& grid) { return !grid.isLevelSet; });
  if (found.empty()) inputError(file, "holds no level set");
  for (const NamedGrid& grid : found) requireFinite(file, grid);
  return found;
}

std::shared_ptr<openvdb::FloatGrid> readLevelSet(const fs::path& file, const ReadOptions& options) {
  return readLevelSets(file, options).front().grid;
}

void requireBox(const fs::path& file, const Solid& solid) {
  if (solid.voxels == 0) return;
  double voxels = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    voxels *= static_cast<double>(solid.box.max[axis]) - solid.box.min[axis] + 1.0;
  }
  constexpr double kMost = 1e12;
  if (voxels > kMost) {
    inputError(file, "its voxels lie in a box of more than 1e12 voxels; choose a resolution",
               OptionNames{"resolution"});
  }
}

void requireFinite(const fs::path& file, const NamedGrid& grid) {
  if (!hasFiniteValues(*grid.grid))
    inputError(file, "grid '" + grid.name + "' has values that are not finite");
}

}  // namespace sherd
