// Positions of sheets in their cells that depend on the cell's labels only.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "interface/cells/leaf_cells.h"

namespace sherd {

/// Returns [loops] the middle of the loop's cell or, in cells with several positions, the mean of
/// the middles of the edges that the sheets at the loop's position cross: two sheets in one cell
/// must not coincide.  In the unit cell.
[[nodiscard]] std::vector<glm::dvec3> middlesOf(const LeafCells& cells);

}  // namespace sherd
