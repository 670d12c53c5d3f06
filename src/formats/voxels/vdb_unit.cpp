// The unit of `.vdb` files.
#include "formats/voxels/vdb_unit.h"

#include <openvdb/openvdb.h>

#include <cmath>

#include "voxelize/distance.h"

namespace sherd {
namespace {

using openvdb::FloatGrid;

constexpr double kStep = 1024.0;
constexpr double kSmallestInFile = 0x1p-16;  // its cube is 3.55e-15
constexpr double kLargestOfHalf = 0x1p14;    // three of them are 49152
constexpr double kSmallestUnit = 0x1p-200, kLargestUnit = 0x1p200;

}  // namespace

double vdbUnitOf(double voxelSize, bool half) {
  double unit = 1.0;
  while (voxelSize / unit < kSmallestInFile && unit > kSmallestUnit) unit /= kStep;
  while (half && voxelSize / unit > kLargestOfHalf && unit < kLargestUnit) unit *= kStep;
  return unit;
}

std::shared_ptr<FloatGrid> inVdbUnit(const FloatGrid& levelSet, double unit) {
  const FloatGridPtr copy = copyOf(levelSet);
  setFrame(*copy, inUnit(frameOf(levelSet), unit));
  multiplyValues(*copy, 1.0 / unit);
  return copy;
}

void intoWorldUnits(FloatGrid& grid) {
  const auto stored = grid.getMetadata<openvdb::DoubleMetadata>(kVdbUnit);
  if (!stored) return;
  const double unit = stored->value();
  int exponent = 0;
  if (!(unit >= kSmallestUnit && unit <= kLargestUnit) || std::frexp(unit, &exponent) != 0.5)
    return;  // not ours
  setFrame(grid, inUnit(frameOf(grid), 1.0 / unit));
  grid.removeMeta(kVdbUnit);
  if (grid.getGridClass() == openvdb::GRID_LEVEL_SET) multiplyValues(grid, unit);
}

}  // namespace sherd
