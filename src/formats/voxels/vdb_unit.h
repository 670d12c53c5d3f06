// The unit of `.vdb` files.
//
// OpenVDB refuses matrices whose determinant is below 3e-15, so those of voxels under 1.44e-5
// units, and Blender, Houdini and OpenImageIO ask each grid for its matrix.  And 16-bit values end
// at 65504.  So a grid beyond these bounds is written in another unit, a power of 1024 world units,
// which its metadata have.  Powers of two change no digit: what is read back is what was written.
#pragma once

#include <sherd/solid.h>

#include <memory>

namespace sherd {

/// Key of the metadata with a file's unit, a double; absent where the unit is 1.
inline constexpr const char* kVdbUnit = "world_units_per_unit";

/// Returns the unit, in world units, of a file of grids with these voxels.
///   half  16-bit values
[[nodiscard]] double vdbUnitOf(double voxelSize, bool half);

/// Returns a frame of world units in a file's unit.
[[nodiscard]] inline GridFrame inUnit(const GridFrame& frame, double unit) {
  return {frame.origin / unit, frame.voxelSize / unit};
}

/// Returns a level set in a file's unit.
[[nodiscard]] std::shared_ptr<openvdb::FloatGrid> inVdbUnit(const openvdb::FloatGrid& levelSet,
                                                            double unit);

/// Moves a grid of a file whose metadata have a unit back into world units.
void intoWorldUnits(openvdb::FloatGrid& grid);

}  // namespace sherd
