// Passes of erosion: the options in voxels.
#pragma once

#include <sherd/labels.h>

namespace sherd {

/// The passes of an erosion, and the size of its shape, voxels.
struct ErosionPasses {
  int count = 0;
  int size = 3;
};

/// Returns the passes where the longest side has so many voxels.
///   throws  Error(usage) the size or the number of passes is out of range
[[nodiscard]] ErosionPasses passesOf(const ErodeOptions& options, double longestSide);

}  // namespace sherd
