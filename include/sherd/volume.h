// Volumes as input instead of a mesh: level sets, fog volumes and voxels.
#pragma once

#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

namespace sherd {

struct VolumeOptions {
  std::string grid;       ///< of a `.vdb` file; empty: the union of its level sets, or if it has
                          ///< none, its only float grid
  double isovalue = 0.5;  ///< grids that are not level sets are solid above this value
  bool ownVoxels = true;  ///< uses a level set's voxels as the solid's where that is possible
  std::uint64_t maxMemory =
      std::numeric_limits<std::uint64_t>::max();  ///< bytes for breaking the solid
};

/// A volume read from a file.
struct Volume {
  SourceMesh source;           ///< name and checksum; the surface's mesh if there is no `solid`
  double voxelSize = 0.0;      ///< of the file, world units; 1 where the file has none
  std::optional<Solid> solid;  ///< on the file's own voxels
  bool isLevelSet = false;     ///< only level sets were read, so no isovalue was used
};

/// Whether readVolume supports the file's extension: `.vdb` or a voxel file.
[[nodiscard]] bool isVolumeName(const std::filesystem::path& file);

/// Reads a volume.
///
/// A level set's voxels become the solid's, with the same indices, if its transform is a uniform
/// scale and translation and its band is at least three voxels wide.  All others become a mesh to
/// be voxelized: level sets and fog volumes by OpenVDB's mesher, voxel files by the faces between
/// labeled and unlabeled voxels, which reproduces the same voxels at the same voxel size.
///   throws  Error(input) absent, damaged, no solid voxel, no such grid, several grids without
///           options.grid; Error(usage) more voxels or faces than `maxMemory` holds;
///           Error(cancelled)
[[nodiscard]] Volume readVolume(const std::filesystem::path& file,
                                const VolumeOptions& options = {},
                                const Progress* progress = nullptr);

}  // namespace sherd
