// The voxels of a fracture that was written without them.
#pragma once

#include <sherd/folder.h>

#include <filesystem>

namespace sherd {

/// Sets solid and labels from the meshes of the fragments, in the grid of the manifest: a voxel
/// belongs to the fragment whose mesh has its center inside, so that labels of smooth surfaces are
/// those of the fracture but for voxels within its deviation from them.
///   file    the manifest's path
///   throws  Error(input) a fragment has no mesh, or one without a voxel; what readMesh throws
void setVoxelsOfMeshes(FinishedFracture& finished, const std::filesystem::path& file,
                       const Manifest& manifest, const ReadOptions& options);

}  // namespace sherd
