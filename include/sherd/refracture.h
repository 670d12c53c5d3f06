// Breaking the fragments of a finished fracture again.
#pragma once

#include <sherd/fracture.h>

#include <filesystem>
#include <span>
#include <string>

namespace sherd {

/// A fracture read from its folder.
struct FinishedFracture {
  SourceMesh source;  ///< file name of the original mesh, SHA-256 of the manifest, no mesh
  int resolution = 0;
  int fragments = 0;
  Solid solid;    ///< the union of the fragments, without eroded and withheld voxels
  Labels labels;  ///< 1..fragments on every inside voxel
};

/// Reads a fracture from its `manifest.json`, its labels and the fragments' `.vdb` files.
///   throws  Error(input) not a fracture's manifest, a fracture written without labels or vdb, a
///           file that is absent, damaged or inconsistent with the others
[[nodiscard]] FinishedFracture readFracture(const std::filesystem::path& manifest);

/// Breaks some fragments again, each into options.pieces; the others stay.  Options of the whole
/// (resolution, voxel size, seed file, missing, erosion) are ignored.
///   only    ids of the fragments to break, 1..fragments
///   return  as fracture(); `parents` has the old fragment that each is or comes from
///   throws  Error(usage) an id that does not exist; what placeSeeds and grow throw
[[nodiscard]] FractureResult refracture(const FinishedFracture& finished, std::span<const int> only,
                                        const FractureOptions& options, Device& device,
                                        const Progress* progress = nullptr);

}  // namespace sherd
