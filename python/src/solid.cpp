// Objects to break: read, checked and voxelized.
#include "solid.h"

#include <sherd/error.h>
#include <sherd/folder.h>
#include <sherd/options.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <utility>

#include "base/files/atomic_file.h"
#include "base/files/sha256.h"
#include "base/memory.h"
#include "formats/mesh/merge.h"
#include "formats/voxels/voxel_faces.h"
#include "process.h"

namespace pysherd {

using sherd::Error;
using sherd::ErrorCode;
using sherd::Progress;
using sherd::RunOptions;

namespace {

namespace fs = std::filesystem;

// An object as read: a mesh to be voxelized, or a solid on its own voxels.
struct Read {
  sherd::SourceMesh source;
  std::optional<sherd::Solid> solid{};
  double voxelSize = 0.0;              // of voxels that were given
  std::vector<std::string> idle{};     // sentences on options that do nothing with it
  std::optional<glm::dvec3> offset{};  // if it was recentered
};

// A file that is removed again.
class TemporaryFile {
 public:
  ///   throws  Error(output) it cannot be written whole
  explicit TemporaryFile(const std::string& bytes) : TemporaryFile() {
    sherd::writeWhole(path_, bytes);
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  TemporaryFile() {
    std::error_code error;
    const fs::path folder = fs::temp_directory_path(error);
    if (error) {
      throw Error(ErrorCode::output,
                  "no folder for temporary files: " + error.message() + " (set TMPDIR to one)");
    }
    std::string name = (folder / "sherd-XXXXXX.vdb").string();
    const int file = ::mkstemps(name.data(), 4);
    if (file < 0) {
      throw Error(ErrorCode::output, name + ": cannot be made: " + sherd::reasonOf(errno));
    }
    ::close(file);
    path_ = name;
  }

  fs::path path_;
};

Read readVolumeAt(const fs::path& file, const RunOptions& run, const sherd::OptionUse& use,
                  const Progress& progress) {
  sherd::Volume volume = sherd::readVolume(file, run.volume, &progress);
  std::vector<std::string> idle = idleOptions(volume, use);
  return {std::move(volume.source), std::move(volume.solid),
          run.volume.ownVoxels ? volume.voxelSize : 0.0, std::move(idle)};
}

// Reads the level set of a pickle as a file of its own, since it is trusted as little.
Read readLevelSet(const std::string& bytes, RunOptions run, const sherd::OptionUse& use,
                  const Progress& progress) {
  run.volume.grid.clear();  // of the file that was read first; here is one grid
  const TemporaryFile file(bytes);
  try {
    Read read = readVolumeAt(file.path(), run, use, progress);
    if (!read.solid) throw Error(ErrorCode::input, "it is none that a solid is kept as");
    return read;
  } catch (const Error& e) {
    if (e.code() != ErrorCode::input) throw;
    const std::string name = file.path().string() + ": ", what = e.what();
    throw Error(e.code(), "the level set of this pickle cannot be read: " +
                              (what.starts_with(name) ? what.substr(name.size()) : what));
  }
}

// Returns a mesh of arrays as a reader of files does.
sherd::SourceMesh merged(Object& object) {
  sherd::SourceMesh source = sherd::mergeVertices(std::move(object.mesh));
  if (source.mesh.triangles.empty()) {
    throw Error(ErrorCode::input, "faces: none has three different corners");
  }
  return source;
}

template <class Item>
std::string_view bytesOf(const std::vector<Item>& items) {
  return {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item)};
}

std::string sha256Of(const sherd::RawMesh& mesh) {
  sherd::Sha256 sum;
  sum.add(bytesOf(mesh.vertices));
  sum.add(bytesOf(mesh.triangles));
  return sum.text();
}

std::vector<sherd::Run> runsOf(const Mask& mask) {
  std::vector<sherd::Run> runs;
  for (const std::uint8_t solid : mask.solid) {
    const auto label = static_cast<std::uint16_t>(solid != 0);
    const bool isNext = !runs.empty() && runs.back().label == label &&
                        runs.back().length < std::numeric_limits<std::uint32_t>::max();
    if (!isNext) runs.push_back({label, 0});
    ++runs.back().length;
  }
  return runs;
}

sherd::SourceMesh facesOf(const Mask& mask, std::uint64_t memory, const Progress& progress) {
  constexpr std::uint64_t kBytesPerTriangle = 240;  // docs/performance.md, "Memory"
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max() / 2;
  const std::uint64_t most = std::min(memory / kBytesPerTriangle, kMost);
  auto faces = sherd::voxelFaces({mask.dims, runsOf(mask)}, sherd::GridFrame{}, most, &progress);
  if (!faces) sherd::requireMemory("volume: its surface", (most + 1) * kBytesPerTriangle, 0);
  if (faces->triangles.empty()) throw Error(ErrorCode::input, "volume: nothing in it is solid");
  sherd::SourceMesh source;
  source.mesh = std::move(*faces);
  return source;
}

Read readObject(Object& object, const RunOptions& run, const sherd::OptionUse& use,
                const Progress& progress) {
  if (!object.file.empty() && sherd::isVolumeName(object.file)) {
    return readVolumeAt(object.file, run, use, progress);
  }
  if (!object.file.empty()) {
    return {sherd::readMesh(object.file, {.maxMemory = run.volume.maxMemory}, &progress)};
  }
  Read read;
  if (object.source) {
    if (!object.levelSet.empty()) {
      read = readLevelSet(object.levelSet, run, use, progress);
    }
    read.source = std::move(*object.source);
    read.voxelSize = object.ownVoxelSize;
    read.offset = object.offset;
    return read;
  }
  if (object.mask) {
    read.source = facesOf(*object.mask, run.volume.maxMemory, progress);
    read.source.sha256 = sherd::sha256(bytesOf(object.mask->solid));
    read.voxelSize = run.volume.ownVoxels ? 1.0 : 0.0;
  } else {
    std::string sum = sha256Of(object.mesh);
    read.source = merged(object);
    read.source.sha256 = std::move(sum);
  }
  read.source.name = object.name;
  read.source.stem = fs::path(object.name).stem().string();
  return read;
}

void recenter(Read& read) {
  sherd::TriangleMesh& mesh = read.source.mesh;
  const glm::dvec3 offset = read.solid ? boxCenter(*read.solid) : boxCenter(mesh);
  if (read.solid) read.solid = moved(std::move(*read.solid), -offset);
  mesh = moved(std::move(mesh), -offset);
  read.offset = offset;
}

sherd::Solid solidOf(Read& read, sherd::FractureOptions options, std::uint64_t memory,
                     const Progress& progress) {
  if (read.solid) return std::move(*read.solid);
  if (read.voxelSize > 0.0) options.solid.voxelSize = read.voxelSize;
  sherd::requireMemory(read.source.mesh, options, memory);
  options.solid.objects = read.source.objectOfTriangle;
  options.solid.keepMesh = surfaceOf(options) == sherd::Surface::exact;
  return sherd::voxelize(read.source.mesh, options.solid, &progress);
}

}  // namespace

void freeElsewhere(const std::function<void()>& free) {
  if (!isUsableProcess()) return;  // TBB's threads are gone, and nothing may wait for them
  try {
    onWorker(free);
  } catch (const std::system_error&) {  // there is no thread
    free();
  }
}

std::shared_ptr<const sherd::IntactSurface> Solid::surface() const {
  const std::lock_guard lock(surfaceMutex_);
  return surface_;
}

sherd::PreparedSolid Solid::prepared() const {
  sherd::PreparedSolid ready = ready_;
  ready.surface = surface();
  if (!isSmall()) ready.walls.reset();
  return ready;
}

// Whether what fractures share is kept.
bool Solid::isSmall() const {
  constexpr std::size_t kMaxLeaves = 50'000;  // as in a dataset, for its memory
  return solid().blocks->count() <= kMaxLeaves;
}

void Solid::keepSurface() const {
  if (!isSmall()) return;
  std::call_once(surfaceMade_, [&] {
    auto made = sherd::intactSurface(solid());
    const std::lock_guard lock(surfaceMutex_);
    surface_ = std::move(made);
  });
}

SolidPtr voxelized(Object object, const GivenOptions& given, const std::string& device,
                   const Progress& progress) {
  RunOptions run = optionsFrom(given);
  run.volume.maxMemory = sherd::freeMemory();
  const std::string file = object.file;
  std::vector<std::string> names;
  for (const auto& [name, text] : given) names.push_back(name);
  Read read = readObject(object, run, useOf(std::move(names), file), progress);
  if (run.recenter && !read.offset) recenter(read);  // a pickle's is already
  sherd::CoordinateSystem& coordinates = read.source.coordinates;
  if (!file.empty()) coordinates = sherd::coordinatesOfFile(file, coordinates);
  coordinates = coordinatesOf(coordinates, run.write);
  try {
    sherd::Solid solid = solidOf(read, run.fracture, run.volume.maxMemory, progress);
    LeasedDevice leased(device);
    return freedElsewhere(std::make_unique<Solid>(
        given, std::move(read.idle), read.voxelSize, read.offset, std::move(read.source),
        sherd::prepared(std::move(solid), *leased), file));
  } catch (const Error& e) {
    if (e.code() != ErrorCode::input) throw;  // what the stages say of an object without its name
    throw Error(e.code(), (file.empty() ? "mesh" : file) + ": " + e.what(), e.options());
  }
}

}  // namespace pysherd
