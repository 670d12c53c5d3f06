// The vertices that the input gives to the cells of one leaf.
#pragma once

#include <vector>

#include "surface/creases.h"
#include "surface/field.h"

namespace sherd {

/// Returns the vertices of a leaf's cells in which the input's crossings may differ from those of
/// the distances.
///   field  of the intact solid
[[nodiscard]] std::vector<CreaseVertex> creaseVertices(const Field& field, std::size_t leaf);

}  // namespace sherd
