// Warnings of very small fragments.
#pragma once

#include <sherd/fracture.h>

#include <string>
#include <vector>

namespace sherd {

/// Returns a clause for each kind of very small fragments: those with less than 0.1 %
/// of the solid, or a tenth of the mean share if that is less, and those whose surfaces enclose
/// less than a tenth of their voxels.  Empty if there are none.
///   result  with fragments
[[nodiscard]] std::vector<std::string> smallPieces(const FractureResult& result);

}  // namespace sherd
