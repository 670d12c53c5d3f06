// Labels: the fragment of each voxel, by growth and after erosion.
#pragma once

#include <sherd/device.h>
#include <sherd/progress.h>
#include <sherd/seeds.h>
#include <sherd/solid.h>

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace sherd {

/// A row of kGrowthRules (growth.h), by its index.  The named ones grow as described; further rows,
/// which are kernels of their own, have no name here: see growthNamed.
enum class Growth : std::uint8_t {
  flood,    ///< breadth-first; distances are measured around gaps
  nearest,  ///< nearest seed by the metric, across gaps: the paper's straightforward method
  chain,    ///< Discrete Voronoi Chain: across faces, in the order of the largest distance to the
            ///< seed along the path (rounded up to half voxels)
  euclid,   ///< nearest seed; voxels disconnected from their seed are regrown by a 5^3 chamfer
  sequential,  ///< pieces are split in two one after another, without seeds: a crack ends at the
               ///< border of its piece, so older cracks stop newer ones
};

/// An anisotropic metric: lengths along `direction` are divided by 1 + strength.
struct Anisotropy {
  glm::dvec3 direction{0.0, 0.0, 1.0};  ///< any length but 0
  double strength = 0.0;  ///< -0.75..9; > 0: splinters along `direction` (wood); < 0: plates across
                          ///< it (slate); 0: isotropic
};

/// A length: voxels, or a percentage of the longest side, which is the same length at any
/// resolution.
struct Length {
  double voxels = 0.0;
  double percent = 0.0;  ///< of the longest side

  constexpr Length(double inVoxels = 0.0) : voxels(inVoxels) {}
  [[nodiscard]] static constexpr Length ofSide(double percent) {
    Length length;
    length.percent = percent;
    return length;
  }

  [[nodiscard]] constexpr bool isZero() const { return voxels == 0.0 && percent == 0.0; }

  /// Returns the voxels where the longest side has so many.
  [[nodiscard]] constexpr double over(double longestSide) const {
    return voxels + percent / 100.0 * longestSide;
  }

  bool operator==(const Length&) const = default;
};

/// Seeds whose Voronoi cells are the fragments.
struct VoronoiSites {
  std::vector<Seed> seeds;
  Anisotropy anisotropy{};  ///< scales the Euclidean distances
};

/// How pieces are split one after another, by growths that do.
struct SplitOptions {
  double power = 1.0;   ///< the next piece to split is drawn by its size to this power, 0..10
  double offset = 0.1;  ///< standard deviation of the share that a crack cuts off, from one half,
                        ///< 0..0.5
  double tilt = 10.0;   ///< standard deviation of the angle between a crack's normal and the
                        ///< piece's long axis, degrees, 0..90
};

/// Surfaces of cracks that are given, see grow/splits/guide_sides.h.
class GivenCracks;

/// The middle of thin walls, see voxelize/wall_middles.h.
class WallMiddles;

/// A crack that splits a piece in two.  Voxels of the piece on its positive side become the piece
/// `added`, the others keep the id; components that the crack would cut off besides stay with what
/// they touch, so that both are connected.
struct Split {
  std::uint16_t fragment = 0;  ///< the piece, by the id that stays on the negative side
  std::uint16_t added = 0;     ///< the new piece
  int generation = 0;          ///< number of splits that the piece comes from
  glm::ivec3 normal{0};        ///< of the plane, each at most 2^14; 0: the crack is no plane
  std::int64_t offset = 0;   ///< positive: dot(normal, voxel) * 64 > offset; of a crack that is no
                             ///< plane its number in Labels::cracks
  std::uint64_t voxels = 0;  ///< of the piece before the split
  bool isSphere = false;  ///< the crack is a sphere: positive where |64 voxel - center|^2 is above
                          ///< `offset`; its normal is 0
  glm::ivec3 center{0};   ///< of a sphere, 1/64 voxel
};

/// The fragment of each voxel of leaf blocks.
struct Labels {
  static constexpr std::uint16_t kEroded = 65535;  ///< an eroded voxel

  std::shared_ptr<const LeafBlocks> blocks{};  ///< whose voxels are labeled, such as Solid::blocks
  int fragmentCount = 0;                       ///< ids are 1..fragmentCount, at most kMaxFragments

  std::vector<std::uint16_t> fragment{};  ///< [blocks->count()*512] an id or kEroded on inside
                                          ///< voxels and, extended, on the exterior band; else 0
  /// [blocks->count()*512] arrival cost of inside voxels in the unit of the growth, else 0; empty
  /// without GrowOptions::keepCost.  Regrown and roughened voxels keep the cost of the first
  /// growth.
  std::vector<std::uint32_t> cost{};
  /// Per search, the number of voxels disconnected from their fragment's first seed.  All of them
  /// were regrown.
  std::vector<std::uint64_t> disconnected{};
  VoronoiSites sites{};  ///< if not empty, voxels belong to the nearest of these seeds except
                         ///< where they were regrown or eroded, so cuts are planes, unless walls
                         ///< bend them.  Empty for growths without this property
  std::vector<Split> splits{};  ///< of growths by splits, a piece before those that come of it: the
                                ///< crack between two fragments lies on the plane that parted
                                ///< them.  Normals are 0 where cracks are rough
  /// Of splits without a plane: on their positive side the signed distance to a crack is positive.
  /// Null if there are none, and where cracks are rough.
  std::shared_ptr<const GivenCracks> cracks{};
  /// In thin walls: the planes and spheres of splits, and sites, are compared with the middle of
  /// the wall at a voxel, so that cracks pass straight through it.  Null: with the voxel itself.
  std::shared_ptr<const WallMiddles> walls{};
};

/// How work is given to the device.  Results are the same.
struct DeviceTuning {
  int stepsPerReadback = 0;  ///< layers between reads of the device's counter; 0: automatic
  int workGroupSize = 0;     ///< work-items per work-group; 0: automatic
  bool warmUp = false;  ///< also runs passes that have no work, so that a later growth over the
                        ///< same leaf blocks allocates buffers only for the leaves around
                        ///< voxels that are disconnected from their seed
};

struct GrowOptions {
  Growth growth = Growth::euclid;
  int neighborhood = 6;               ///< for flood: 6 (von Neumann) or 26 (Moore)
  Metric metric = Metric::euclidean;  ///< for nearest and chain
  Anisotropy anisotropy{};
  SplitOptions split{};
  Length roughness = 0.0;      ///< rms height of a crack over a window, 0..100 voxels; 0: smooth
  double hurst = 0.8;          ///< Hurst exponent of rough cracks, 0.1..1; 0.8 is measured on most
                               ///< brittle materials (Bouchaud 1997)
  Length roughnessWindow = 0;  ///< side of that window; 0: a tenth of longestSideVoxels
  double propagationHurst = 0.0;  ///< Hurst exponent along the propagation of cracks, 0.1..1; 0: as
                                  ///< `hurst`, which else is that along their front
  glm::dvec3 propagation{0.0, 0.0, 1.0};  ///< direction of propagation, any length but 0; the
                                          ///< nearest axis of the grid is taken
  double longestSideVoxels = 0.0;  ///< longest side of the mesh's box, voxels, not rounded.  With
                                   ///< it, rough cracks are a function of space: the same noise
                                   ///< seed displaces points of the mesh alike at every voxel size.
                                   ///< 0: of the inside voxels
  bool regrowIsolated = true;  ///< gives voxels disconnected from their fragment's first seed to
                               ///< neighbors, so that every fragment is 6-connected
  std::vector<std::uint64_t> noiseSeeds{};  ///< [seed sets] for rough cracks; missing ones are 0
  /// [seed sets] voxels that roughness does not move, such as where an impact strikes; missing ones
  /// are none.
  std::vector<std::optional<openvdb::Coord>> noiseAnchors{};
  /// [seed sets] for growths that give Voronoi cells, by Euclidean distances: those of the same
  /// leaf blocks, at whose middle voxels are compared with seeds, see Labels::walls; missing ones
  /// are null.  All that are not null are the same.
  std::vector<std::shared_ptr<const WallMiddles>> walls{};
  bool keepCost = false;  ///< also returns the arrival cost
  int outerSteps = 6;     ///< steps by which labels are extended into the exterior band, 0..64
  DeviceTuning tuning{};
};

/// Grows fragments from all seeds at once over the inside.  A voxel belongs to the fragment that
/// reaches it at the lowest (cost, id), so the result does not depend on device, work-group size or
/// batch.
///   seedSets  one per fracture, grown together over the same leaf blocks, in batches that fit the
///             device's memory and largest allocation; every seed on an inside voxel; a fragment
///             stays connected to its first seed
///   return    one Labels per seed set; inside voxels of components without a seed stay 0
///   throws    Error(device); Error(cancelled); Error(usage) a seed outside the solid, an option
///             out of range
///   source    Velic, May, Moresi, A fast robust algorithm for computing discrete Voronoi diagrams,
///             2009
[[nodiscard]] std::vector<Labels> grow(std::shared_ptr<const LeafBlocks> blocks,
                                       std::span<const std::vector<Seed>> seedSets, Device& device,
                                       const GrowOptions& options = {},
                                       const Progress* progress = nullptr);

/// Extends the labels of inside voxels (eroded ones included) `steps` face steps into the exterior
/// band, so that cuts reach past the surface.  Labels that the band already has are replaced.
///   throws  Error(device)
[[nodiscard]] Labels extendLabels(Labels labels, Device& device, int steps = 6);

/// Counts the inside voxels of each fragment: [fragmentCount+1], [0] those without a label.  Eroded
/// voxels are not counted.
///   throws  Error(usage) no blocks, another number of labels than voxels, a label above the
///           fragmentCount
[[nodiscard]] std::vector<std::uint64_t> countVoxels(const Labels& labels);

/// ShareOptions::minShare: no fragment is smaller than kSmallComponentVoxels, or a quarter of the
/// mean if that is less, once grown and once eroded.  A smaller one gets the voxels of its
/// neighbors that are nearest to it; none gets a seed elsewhere, so cracks stay where they are.
inline constexpr double kAutoShare = -1.0;

/// Control of fragment sizes in a fracture.  Drawn shares are met by weights of the seeds, so that
/// cells are those of a power diagram and cracks stay planes, by growths whose cells are Voronoi's;
/// growths by splits cut to them.  Each component of the solid gets those of the shares that fill
/// it best, scaled to fill it.  Growths are repeated until each share is met within 2 %
/// or 8 voxels, at most 100 times; FractureResult::sizeError is what remained.
struct ShareOptions {
  Sizes sizes = Sizes::grown;    ///< from which the fragments' shares are drawn
  double sizeParameter = 0.0;    ///< of lognormal, 0.01..3; of power, 1..4
  double minShare = kAutoShare;  ///< least share of the solid's voxels in a fragment, 0..1, or
                                 ///< kAutoShare; 0: one voxel is enough
  int balance = 0;  ///< Lloyd iterations before that: seeds move to their fragment's center, 0..100
  int tries = 64;   ///< most growths to reach minShare

  /// Whether an option is set.
  bool isSet() const { return minShare > 0.0 || balance != 0 || sizes != Sizes::grown; }
};

/// The structuring element: the cells around a voxel that are counted, for a size of 2r + 1:
///
///     cross      the three axes, r to either side   |x|, |y|, |z| <= r, at least two of them 0
///     square     the whole cube                     |x|, |y|, |z| <= r
///     ellipse    a ball                             x^2 + y^2 + z^2 <= r^2
///
/// Cross and ellipse of size 3 are the same 7 cells.
enum class ErodeShape { cross, square, ellipse };

/// Which voxels of a fragment's shell can erode.
enum class ErodeOn {
  fracture,  ///< those that touch another fragment or an eroded voxel
  all,       ///< all, the original surface included
  rims       ///< as fracture, but cells outside the solid are empty: where cracks meet the original
             ///< surface less is filled than within, so that rims wear first, as handled sherds do.
             ///< A threshold just below the filled share of a plane, as 0.6, wears rims alone
};

/// What happens to the smaller components of a fragment that erosion disconnects.
enum class Islands {
  eroded,  ///< they are eroded too, so that every fragment is 6-connected
  kept     ///< they stay in their fragment
};

struct ErodeOptions {
  ErodeShape shape = ErodeShape::ellipse;
  Length size = 3;        ///< across the shape: odd, 3..13 voxels; a percentage is rounded to the
                          ///< nearest odd number, at least 3; 14 voxels and more are refused
  bool planes = false;    ///< 2-D: uses the shape's section in each of the three axis planes; a
                          ///< voxel erodes if any section is filled below the threshold
  Length iterations = 0;  ///< whole, 0..1000; 0: no erosion.  Each removes at most one layer, so
                          ///< that a percentage is a depth, rounded to voxels
  double threshold = 1;  ///< least share of the shape's cells that must be filled, above 0, at most
                         ///< 1, rounded to a millionth; lower erodes less
  double probability = 1;  ///< of testing a voxel in an iteration, above 0, at most 1
  ErodeOn on = ErodeOn::fracture;
  Islands islands = Islands::eroded;
  std::uint64_t least = 1;  ///< voxels that a fragment keeps, connected if islands are eroded: it
                            ///< is not eroded further than to these
  std::uint64_t seed = 0;   ///< used only when probability < 1
  double longestSideVoxels = 0.0;  ///< of percentages; 0: of the inside voxels
};

struct Erosion {
  Labels labels;  ///< eroded voxels are Labels::kEroded, others unchanged
  std::vector<std::uint64_t>
      eroded;  ///< [fragmentCount+1] voxels lost, islands included; [0] the sum
};

/// Erodes fragments.  Each iteration tests the voxels of a fragment's shell, each with
/// `probability` (drawn anew); a voxel erodes if fewer than threshold * cells of its shape are
/// filled.  Cells are counted in the state before the iteration, so the order does not matter.
///
/// The shell is the fragment minus its erosion by 26 neighbors.  A cell is filled if it belongs to
/// the same fragment.  With ErodeOn::fracture only shell voxels are tested that have an inside
/// voxel of another fragment, an eroded voxel or an unlabeled one among their 26 neighbors, and
/// cells outside the solid count as filled, so the original surface does not move away from the
/// cracks; with ErodeOn::rims the same voxels are tested, and these cells are empty.
///
/// A fragment never disappears: an iteration that would leave less than ErodeOptions::least of it
/// is skipped for it; one that had less is not eroded.
/// Islands are handled once, after the last iteration: the 6-connected component with the most
/// voxels stays; of equal ones, the one with the first voxel in leaf order.
///
///   labels  labels of the exterior band are neither read nor changed: call extendLabels afterwards
///           where they matter
///   cost    leaves * iterations, and shell voxels * size^2 * iterations on the host; islands are
///           found on the device
///   throws  Error(usage) options out of range, a label above the fragmentCount; Error(device);
///           Error(cancelled)
///   source  Generating implicit object fragment datasets for machine learning, 3.2.3
[[nodiscard]] Erosion erode(const Labels& labels, const ErodeOptions& options, Device& device,
                            const Progress* progress = nullptr);

}  // namespace sherd
