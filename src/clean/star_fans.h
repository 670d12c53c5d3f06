// Whether the surfaces of pieces stay manifold.
#pragma once

#include "clean/change.h"

namespace sherd {

/// Returns whether every piece has as many fans around the merged vertices as it had, less the one
/// of an edge that vanishes: no edge gets more than two faces in a piece, no parts of a piece are
/// joined in a vertex, and no piece folds to a sheet.
[[nodiscard]] bool keepsFans(const Stars& stars, const Change& change);

}  // namespace sherd
