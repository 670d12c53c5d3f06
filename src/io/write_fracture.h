// A fracture's folder, written while the fragments are made.
#pragma once

#include <sherd/io.h>

#include "fracture_stages.h"

namespace sherd {

/// `extracted` and `writeFracture`, as fractureInto has it.
///   throws  what they throw
[[nodiscard]] WrittenFracture writeGrown(const std::filesystem::path& folder,
                                         const SourceMesh& source, const FractureOptions& options,
                                         GrownFracture grown, const WriteOptions& write,
                                         const Progress* progress);

}  // namespace sherd
