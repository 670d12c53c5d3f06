// Volumes: level sets, fog and voxels that are broken in place of a mesh.
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
  std::string grid;       ///< of a `.vdb` file; empty: all its level sets, united, or where it
                          ///< has none its only grid of floats
  double isovalue = 0.5;  ///< what is not a level set is solid where its values are above
  bool ownVoxels = true;  ///< take a level set's voxels as the solid's where that is possible
  std::uint64_t maxMemory = std::numeric_limits<std::uint64_t>::max();  ///< bytes that breaking
                                                                        ///< such a solid may take
};

/// A volume as a file has it.
struct Volume {
  SourceMesh source;           ///< its name and checksum; its surface, unless `solid` is there
  double voxelSize = 0.0;      ///< its own, world units; 1 where the file tells none
  std::optional<Solid> solid;  ///< on the file's own voxels
  bool isLevelSet = false;     ///< it is all level sets, so that no isovalue was used
};

/// Whether readVolume knows the format: `.vdb` or a voxel file, by the extension.
[[nodiscard]] bool isVolumeName(const std::filesystem::path& file);

/// Read a volume.
///
/// A level set's voxels become the solid's, index for index, where its grid is neither turned,
/// sheared nor mirrored, has one voxel size, and values to three voxels from the surface.  All else
/// becomes a mesh, to be voxelized again: other level sets and fog by OpenVDB's mesher, voxel files
/// by the faces between voxels with a label and those without, which gives the same voxels back at
/// the same voxel size.
///   throws  Error(input) absent, damaged, of no grid or voxel that is solid, no such grid, several
///           grids of which none is named; Error(usage) more voxels or faces than `maxMemory`
///           holds; Error(cancelled)
[[nodiscard]] Volume readVolume(const std::filesystem::path& file,
                                const VolumeOptions& options = {},
                                const Progress* progress = nullptr);

}  // namespace sherd
