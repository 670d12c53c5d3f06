// Writes a fracture's folder while the fragments are made.
#pragma once

#include <sherd/folder.h>

#include "folder/fracture_folder.h"
#include "pipeline/fracture_stages.h"

namespace sherd {

/// A fracture whose files are written but not yet moved to their folder.
struct StagedFracture {
  FractureResult result;  ///< as returned by fractureInto
  FractureReplacement replacement;
};

/// Makes and writes the fragments as fractureInto does, without the final renames.
///   throws  what `extracted` and `writeFracture` throw
[[nodiscard]] StagedFracture writeStaged(const std::filesystem::path& folder,
                                         const SourceMesh& source, const FractureOptions& options,
                                         GrownFracture grown, const WriteOptions& write,
                                         const Progress* progress);

}  // namespace sherd
