// Objects to break: read, checked and voxelized.
#pragma once

#include <nanobind/nanobind.h>
#include <sherd/files.h>
#include <sherd/fracture.h>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "formats/mesh/mesh_reader.h"
#include "job.h"
#include "options.h"

namespace pysherd {

/// Frees grids by onWorker(), since OpenVDB does that with TBB.
void freeElsewhere(const std::function<void()>& free);

/// Shares an object that is deleted so.
template <class Owned>
[[nodiscard]] std::shared_ptr<Owned> freedElsewhere(std::unique_ptr<Owned> owned) {
  return {owned.release(), [](Owned* p) { freeElsewhere([p] { delete p; }); }};
}

/// Voxels of an array, of size 1 about whole positions.
struct Mask {
  openvdb::Coord dims;
  std::vector<std::uint8_t> solid;  ///< [dims.x * dims.y * dims.z] not 0 inside, z fastest
};

/// What is to be broken, as given.
///
/// This and what follows is shared by std::enable_shared_from_this: a pointer that nanobind makes
/// for another type refers to the Python object, and the thread of a job would need the
/// interpreter's lock to free it.
struct Object : std::enable_shared_from_this<Object> {
  std::string file{};                         ///< a mesh or a volume; empty: one of the others
  sherd::RawMesh mesh{};                      ///< of arrays
  std::optional<Mask> mask{};                 ///< of an array
  std::optional<sherd::SourceMesh> source{};  ///< of a pickle
  std::string levelSet{};                     ///< of one without a mesh: the bytes of a `.vdb` file
  std::optional<glm::dvec3> offset{};         ///< of a pickle, see Solid::offset
  double ownVoxelSize = 0.0;                  ///< of a pickle: of the voxels that were given
  std::string name = "mesh";                  ///< without a file
};

/// A solid that is prepared for any number of fractures.
class Solid : public std::enable_shared_from_this<Solid> {
 public:
  Solid(GivenOptions given, std::vector<std::string> idle, double ownVoxelSize,
        std::optional<glm::dvec3> offset, sherd::SourceMesh source, sherd::PreparedSolid ready,
        std::string file)
      : given_(std::move(given)),
        idle_(std::move(idle)),
        ownVoxelSize_(ownVoxelSize),
        offset_(std::move(offset)),
        source_(std::move(source)),
        ready_(std::move(ready)),
        file_(std::move(file)) {}

  [[nodiscard]] const GivenOptions& given() const { return given_; }
  /// A sentence for each given option that does nothing with the volume that was read.
  [[nodiscard]] const std::vector<std::string>& idle() const { return idle_; }
  [[nodiscard]] const sherd::SourceMesh& source() const { return source_; }
  [[nodiscard]] const sherd::Solid& solid() const { return ready_.solid; }
  [[nodiscard]] double ownVoxelSize() const { return ownVoxelSize_; }
  /// What positions lack to be the input's, of an object that was recentered.
  [[nodiscard]] const std::optional<glm::dvec3>& offset() const { return offset_; }
  [[nodiscard]] std::size_t components() const { return ready_.components.count(); }

  /// The file that it was read from; empty without one, also after unpickling.
  [[nodiscard]] const std::string& file() const { return file_; }

  /// The prepared solid, with the intact surface if that is kept.
  [[nodiscard]] sherd::PreparedSolid prepared() const;

  /// Makes the intact surface, once, unless the solid is too large to keep it.
  void keepSurface() const;

  /// The box of the intact surface, or of the voxels without one, world units.
  [[nodiscard]] sherd::Box surfaceBox() const;

  /// Bytes that the solid takes, about: grid, leaf blocks, mesh, the surface if it is kept, and the
  /// walls that its fractures will find.
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  GivenOptions given_;
  std::vector<std::string> idle_;
  double ownVoxelSize_;  // of voxels that were given, else 0
  std::optional<glm::dvec3> offset_;
  sherd::SourceMesh source_;
  sherd::PreparedSolid ready_;  // without a surface
  std::string file_;
  [[nodiscard]] std::shared_ptr<const sherd::IntactSurface> surface() const;
  [[nodiscard]] bool isSmall() const;

  mutable std::once_flag surfaceMade_;
  mutable std::mutex surfaceMutex_;
  mutable std::shared_ptr<const sherd::IntactSurface> surface_;
};

using SolidPtr = std::shared_ptr<Solid>;

/// Reads and voxelizes an object as `sherd fracture` does.
[[nodiscard]] SolidPtr voxelized(Object object, const GivenOptions& given,
                                 const std::string& device, const sherd::Progress& progress);

void bindSolids(nanobind::module_& module);

}  // namespace pysherd
