// The vertices that the input gives to the cells of one leaf.
#pragma once

#include <vector>

#include "surface/crease_vertex.h"
#include "surface/field.h"
#include "surface/input_crossings.h"

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
