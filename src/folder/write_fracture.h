// A fracture's folder, written while the fragments are made.
#pragma once

#include <sherd/io.h>

#include "folder/fracture_folder.h"
#include "pipeline/fracture_stages.h"

namespace sherd {

/// A fracture whose files are written, and not yet in place.
struct AsideFracture {
  FractureResult result;  ///< as fractureInto has it
  FractureReplacement replacement;
};

/// `extracted` and `writeFracture`, as fractureInto has it, but for the renames.
///   throws  what they throw
[[nodiscard]] AsideFracture writeAside(const std::filesystem::path& folder,
                                       const SourceMesh& source, const FractureOptions& options,
                                       GrownFracture grown, const WriteOptions& write,
                                       const Progress* progress);

}  // namespace sherd
