// The stages of a fracture: first on the device, then on the host.
#pragma once

#include <sherd/fracture.h>

#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "grow/sized/shares.h"
#include "pipeline/deciding.h"
#include "surface/exact/exact_surface.h"

namespace sherd {

/// The seconds of consecutive stages; those of a repeated stage are summed.
class StageClock {
 public:
  StageClock() = default;
  ///   earlier  times of other stages, or of the same
  explicit StageClock(std::vector<StageTime> earlier) : times_(std::move(earlier)) {}

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

/// Checks that no stage has pieces, a seed or a longest side of its own.
///   throws  Error(usage)
void checkOptions(const FractureOptions& options);

/// options.seeds with the pieces; `seed` determines every random choice.
[[nodiscard]] SeedOptions seedOptionsFor(const FractureOptions& options, std::uint64_t seed);

/// Grow by options.grow and options.shares; `seed` determines every random choice.
///   seeds  none where growth splits the solid
///   walls  of the solid, or of one with the same leaves that it is a part of
///   other  where splits are decided; null: on the solid
[[nodiscard]] SeededLabels growFor(const FractureOptions& options, const Solid& solid,
                                   const VoxelComponents& components, std::vector<Seed> seeds,
                                   std::uint64_t seed, SolidWalls& walls, Device& device,
                                   const Progress* progress, const OtherSolid* other = nullptr);

/// A fracture after all work on the device.
struct GrownFracture {
  FractureResult result;           ///< all but fragments
  std::optional<Labels> uneroded;  ///< the labels before erosion, if any
  std::shared_ptr<const IntactSurface> surface{};
  std::optional<ExactSurface> exact{};  ///< of refracture or settle(), with Surface::exact
  bool isSettled = false;               ///< the labels are final
  std::uint64_t least = 1;              ///< voxels of a fragment, as its options ask
  std::uint64_t seed = 0;               ///< of the fracture

  [[nodiscard]] const Labels* unerodedOrNull() const { return uneroded ? &*uneroded : nullptr; }

  /// What extraction needs beside the solid and its labels; it takes `exact`.
  [[nodiscard]] ExtractOptions extractOptions(const SurfaceOptions& options) {
    return {.surface = options,
            .uneroded = unerodedOrNull(),
            .intact = surface,
            .exact = exact ? &*exact : nullptr,
            .seed = seed};
  }
};

/// Seed several fractures, grow them together, and erode each; the results equal separate runs.
///   options  growth and shares of the first apply to all
///   clock    of the earlier stages
[[nodiscard]] std::vector<GrownFracture> growTogether(const PreparedSolid& prepared,
                                                      std::span<const FractureOptions> options,
                                                      Device& device, StageClock clock,
                                                      const Progress* progress);

/// The same for one fracture.
[[nodiscard]] GrownFracture grow(const PreparedSolid& prepared, const FractureOptions& options,
                                 Device& device, StageClock clock, const Progress* progress);

/// `fracture` and `refracture` without the fragments.
[[nodiscard]] GrownFracture grown(const TriangleMesh& mesh, const FractureOptions& options,
                                  Device& device, const Progress* progress);
[[nodiscard]] GrownFracture grown(Solid solid, const FractureOptions& options, Device& device,
                                  const Progress* progress);
[[nodiscard]] GrownFracture regrown(const FinishedFracture& finished, std::span<const int> only,
                                    const FractureOptions& options, Device& device,
                                    const Progress* progress);

/// Cuts exact surfaces if the options ask for them and they are not there yet.  The first time
/// labels may give way to their meshes (settledExactMeshes).
void settle(GrownFracture& grown, const SurfaceOptions& options, const Progress* progress);

/// Sets the surfaces and the fragments without meshes.
///   options  of the noise on points
void measureFragments(const GrownFracture& grown, FractureResult& result,
                      const SurfaceOptions& options, const Progress* progress);

/// Cut the fragments out.  Thread-safe; does not use the device.
///   return  with FractureResult::surfaces also where there are meshes that are neither smoothed
///   nor
///           simplified nor decimated: measures of fragments and points are taken of them
[[nodiscard]] FractureResult extracted(GrownFracture grown, const FractureOptions& options,
                                       const Progress* progress);

}  // namespace sherd
