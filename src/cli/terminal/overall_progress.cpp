// How much of a fracture is done, over all stages.
#include "cli/terminal/overall_progress.h"

#include <algorithm>
#include <cmath>

namespace sherd::cli {
namespace {

// Shares of the time of a run, in between those of 16 runs on four meshes (2,000 to 350,000
// triangles; 128 to 256 voxels, 8 to 50 pieces; smooth, exact, rough and eroded): reading 0 to 6 %,
// voxels 5 to 56 %, growth and erosion 0 to 18 %, surfaces 17 to 74 %, files and preview 13 to
// 36 %.
constexpr double kRead = 0.03;
constexpr double kVoxelize = 0.34;
constexpr double kGrow = 0.06;
constexpr double kErode = 0.02;
constexpr double kExtract = 0.30;
// Of exact surfaces: where bodies overlap or touch, their union takes 4 to 35 % of the run, and the
// cut as much.
constexpr double kUniteOfExtract = 0.2;
constexpr double kCutOfExtract = 0.55;
constexpr double kWrite = 0.20;
constexpr double kRender = 0.05;

}  // namespace

OverallProgress::OverallProgress(bool isExact)
    : stages_{{{"read", 0, kRead},
               {"voxelize", 1, kVoxelize},
               {"grow", 2, kGrow},
               {"erode", 3, kErode},
               {"unite", 4, isExact ? kUniteOfExtract * kExtract : 0.0},
               {"cut", 4, isExact ? kCutOfExtract * kExtract : 0.0},
               {"extract", 4, (isExact ? 1.0 - kUniteOfExtract - kCutOfExtract : 1.0) * kExtract},
               {"write", 4, kWrite},
               {"render", 5, kRender}}} {}

void OverallProgress::nextPart() {
  ++part_;
  for (Stage& stage : stages_) {
    if (stage.rank > 0) stage.done = 0.0;  // all are read at once
  }
}

double OverallProgress::update(std::string_view stage, double fraction) {
  const auto* const current = std::find_if(stages_.begin(), stages_.end(),
                                           [&](const Stage& known) { return known.name == stage; });
  if (current == stages_.end()) return overall_;
  double ofPart = 0.0;
  for (Stage& own : stages_) {
    if (own.rank < current->rank) own.done = 1.0;
    // A stage may begin anew, as growth does until all shares are large enough.
    if (&own == current && std::isfinite(fraction))
      own.done = std::max(own.done, std::min(fraction, 1.0));
    if (own.rank > 0) ofPart += own.share * own.done;
  }
  const double all =
      kRead * stages_.front().done +
      (static_cast<double>(part_) * (1.0 - kRead) + ofPart) / static_cast<double>(parts_);
  overall_ = std::max(overall_, std::min(all, 1.0));
  return overall_;
}

}  // namespace sherd::cli
