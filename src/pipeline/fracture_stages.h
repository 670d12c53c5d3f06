// The stages of a fracture: on the device, and then on the host.
#pragma once

#include <sherd/fracture.h>
#include <sherd/refracture.h>

#include <chrono>
#include <optional>
#include <span>
#include <vector>

namespace sherd {

/// The seconds of one stage after another; to a stage that comes again they are added.
class StageClock {
 public:
  void done(const char* stage) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    for (StageTime& time : times_) {
      if (time.stage != stage) continue;
      time.seconds += seconds;
      return;
    }
    times_.push_back({stage, seconds});
  }
  const std::vector<StageTime>& times() const { return times_; }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::vector<StageTime> times_;
};

/// The part of the options that is about the solid.
[[nodiscard]] inline SolidOptions solidOptionsOf(const FractureOptions& options) {
  return {.resolution = options.resolution,
          .voxelSize = options.voxelSize,
          .fill = options.fill,
          .shellThickness = options.shellThickness};
}

/// options.seeds for a solid of these parts, with every choice from `seed`.
[[nodiscard]] SeedOptions seedOptionsFor(const FractureOptions& options, const Parts& parts,
                                         std::uint64_t seed);

/// Grow as options.grow and options.shares say, with every choice from `seed`.
[[nodiscard]] SeededLabels growFor(const FractureOptions& options, const LeafBlocks& blocks,
                                   const Parts& parts, std::vector<Seed> seeds, std::uint64_t seed,
                                   Device& device, const Progress* progress);

/// A fracture half way: everything that needs the device is done.
struct GrownFracture {
  FractureResult result;         ///< all but fragments
  int fragments = 0;             ///< how many there are, withheld ones too
  std::optional<Labels> unworn;  ///< the labels before erosion, where there was any
  std::shared_ptr<const UnbrokenSurface> surface{};
};

/// Seed several fractures, grow them together, and wear each; all come out as they would alone.
///   options  growth and shares are the first one's for all of them
///   clock    of what was done before
[[nodiscard]] std::vector<GrownFracture> growTogether(const PreparedSolid& prepared,
                                                      std::span<const FractureOptions> options,
                                                      Device& device, StageClock clock,
                                                      const Progress* progress);

/// The same for one.
[[nodiscard]] GrownFracture grow(const PreparedSolid& prepared, const FractureOptions& options,
                                 Device& device, StageClock clock, const Progress* progress);

/// `fracture`, and `refracture`, but for the fragments.
[[nodiscard]] GrownFracture grown(const TriangleMesh& mesh, const FractureOptions& options,
                                  Device& device, const Progress* progress);
[[nodiscard]] GrownFracture grown(Solid solid, const FractureOptions& options, Device& device,
                                  const Progress* progress);
[[nodiscard]] GrownFracture regrown(const FinishedFracture& finished, std::span<const int> only,
                                    const FractureOptions& options, Device& device,
                                    const Progress* progress);

/// Cut the fragments out.  Any thread may ask.
[[nodiscard]] FractureResult extracted(GrownFracture grown, const FractureOptions& options,
                                       const Progress* progress);

}  // namespace sherd
