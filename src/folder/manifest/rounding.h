// What single precision loses far from the origin.
#pragma once

#include <sherd/options.h>
#include <sherd/solid.h>

#include <string>
#include <vector>

namespace sherd {

/// Returns how far single precision moves a point of a solid at most along an axis, world units.
[[nodiscard]] double singleRounding(const Solid& solid);

/// Returns whether vertices of meshes have double precision, in formats that hold it: by
/// WriteOptions::precision.
///   isExact  they have exact surfaces
[[nodiscard]] bool isDouble(const WriteOptions& write, bool isExact, const Solid& solid);

/// Returns whether fragments have exact surfaces, or some of them, once these are made or have
/// failed.
[[nodiscard]] inline bool isExact(const FractureOptions& options, const FractureResult& result) {
  return options.surface.surface == Surface::exact && result.exactFailure.empty();
}

/// Returns whether meshes are written in a format that holds no doubles.
[[nodiscard]] bool hasFloatFormat(const WriteOptions& write);

/// Returns whether meshes are written in single precision, whatever they are of.
[[nodiscard]] inline bool writesFloats(const WriteOptions& write) {
  return write.mesh && (write.precision == Precision::single || hasFloatFormat(write));
}

/// The files in which single precision moves points by more than kMostRoundingVoxels.
struct Rounding {
  std::vector<std::string> files;  ///< kinds: ".glb", "points"; empty if there are none
  double length = 0.0;             ///< world units, singleRounding
};
[[nodiscard]] Rounding roundingOf(const WriteOptions& write, const Solid& solid);

/// Returns a sentence about these files; empty if there are none.
[[nodiscard]] std::string roundingWarning(const WriteOptions& write, const Solid& solid);

}  // namespace sherd
