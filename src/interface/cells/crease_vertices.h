// The vertices that the input gives to the cells of one leaf.
#pragma once

#include <vector>

#include "interface/cells/crease_vertex.h"
#include "interface/cells/field.h"
#include "interface/cells/input_crossings.h"

namespace sherd {

/// The cells of a leaf in which the input's crossings may differ from those of the distances.
struct LeafCreases {
  std::vector<CreaseVertex> vertices;
  std::vector<KnownCrossing> crossings;  ///< of these cells' edges
};

/// Returns those of a leaf.
///   field  of the intact solid
[[nodiscard]] LeafCreases creaseVertices(const Field& field, std::size_t leaf);

}  // namespace sherd
