// Rejects fractures that are too similar to earlier ones.
#pragma once

#include <sherd/labels.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// The accepted fractures of one object.
class Distinct {
 public:
  /// Adds a fracture unless it is too similar to an earlier one: the share of differing voxels is
  /// below `share`.  Fragments of two fractures are matched one to one, greedily by overlap; voxels
  /// outside matched overlaps differ.  At most 131,072 evenly spaced voxels are compared.
  ///   share   0..1
  ///   always  adds it in any case
  ///   return  whether it was added
  bool add(const Labels& labels, double share, bool always = false);

 private:
  struct Sample {
    std::vector<std::uint16_t> labels;
    int fragments = 0;
  };
  std::vector<Sample> samples_;
};

}  // namespace sherd
