// Fractures that are not too much like each other.
#pragma once

#include <sherd/labels.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// The fractures of one object so far.
class Distinct {
 public:
  /// Add a fracture, unless it differs from one before in a lesser share of the solid's voxels.
  /// Two differ where fragments that are paired, each with at most one, do not overlap; pairs are
  /// made by the greatest overlap first.  Of large solids 131,072 voxels are looked at, evenly
  /// spread.
  ///   always  add it in any case
  ///   return  whether it was far enough from all
  bool add(const LeafBlocks& blocks, const Labels& labels, int fragments, double share,
           bool always = false);

 private:
  struct Sample {
    std::vector<std::uint16_t> labels;
    int fragments = 0;
  };
  std::vector<Sample> samples_;
};

}  // namespace sherd
