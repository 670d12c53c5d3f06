// Whether the input of a solid is flat.
#include "interface/flat_input.h"

#include <algorithm>

#include "mesh/repair/flat_share.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

// The share of its input's surface that is flat in a piecewise flat solid, at a scale of voxels,
// and of the solid: at a high resolution every triangle of a scan is flat.
constexpr double kLeastFlat = 0.5;
constexpr double kFlatVoxels = 0.5, kFlatShareOfSide = 0.002;

}  // namespace

bool isPiecewiseFlat(const Solid& solid) {
  const TriangleTree* const input = solid.region ? solid.region->boundary() : nullptr;
  if (input == nullptr || !solid.hasLinearAttributes) return false;
  const double reach = std::max(kFlatVoxels, kFlatShareOfSide * solid.box.longestSide());
  return flatShare(*input, reach) >= kLeastFlat;
}

}  // namespace sherd
