// Breaking the fragments of a finished fracture again.
#pragma once

#include <sherd/fracture.h>

#include <filesystem>
#include <span>
#include <string>

namespace sherd {

/// A fracture read back from its folder.
struct FinishedFracture {
  SourceMesh source;  ///< the first mesh's file name; the manifest's SHA-256; no mesh
  int resolution = 0;
  int fragments = 0;
  Solid solid;    ///< the union of the fragments: what was worn off or withheld is gone
  Labels labels;  ///< 1..fragments on every inside voxel
};

/// Read a fracture by its `manifest.json`, from its labels and the fragments' `.vdb` files.
///   throws  Error(input) no manifest of a fracture, written without labels or vdb, a file that is
///           absent, damaged or does not belong to the others
[[nodiscard]] FinishedFracture readFracture(const std::filesystem::path& manifest);

/// Break some fragments again, each into options.pieces; the others stay.  Options that are about
/// the whole (resolution, voxel size, seed file, missing, erosion) are not used.
///   only    ids of fragments to break, 1..fragments
///   return  as fracture(); `parents` says which old fragment each is or comes from
///   throws  Error(usage) an id that does not exist; what placeSeeds and grow throw
[[nodiscard]] FractureResult refracture(const FinishedFracture& finished, std::span<const int> only,
                                        const FractureOptions& options, Device& device,
                                        const Progress* progress = nullptr);

}  // namespace sherd
