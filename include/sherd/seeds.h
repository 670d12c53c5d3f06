// The seeds from which fragments grow.
#pragma once

#include <sherd/coords.h>
#include <sherd/solid.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/ext/vector_int3_sized.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace sherd {

enum class Metric {
  euclidean,  ///< sqrt(dx^2 + dy^2 + dz^2)
  chebyshev,  ///< max(|dx|, |dy|, |dz|)
  manhattan,  ///< |dx| + |dy| + |dz|
};

/// Returns an integer that orders voxel offsets by distance: the distance in voxels, squared for
/// the Euclidean metric.
constexpr std::int64_t metricOrder(Metric metric, std::int64_t dx, std::int64_t dy,
                                   std::int64_t dz) {
  dx = dx < 0 ? -dx : dx;
  dy = dy < 0 ? -dy : dy;
  dz = dz < 0 ? -dz : dz;
  switch (metric) {
    case Metric::euclidean:
      return dx * dx + dy * dy + dz * dz;
    case Metric::chebyshev:
      return std::max({dx, dy, dz});
    case Metric::manhattan:
      return dx + dy + dz;
  }
  return 0;
}

inline std::int64_t metricOrder(Metric metric, const openvdb::Coord& a, const openvdb::Coord& b) {
  return metricOrder(metric, std::int64_t{a.x()} - b.x(), std::int64_t{a.y()} - b.y(),
                     std::int64_t{a.z()} - b.z());
}

/// The largest fragment id: `labels.rle` stores id + 1 in 16 bits.
inline constexpr int kMaxFragments = 65534;

/// Steps of a seed's shift in a voxel, and the most of them, so that the point lies within.
inline constexpr int kSeedSteps = 64, kMostShift = kSeedSteps / 2 - 1;

/// A point from which a fragment grows.
struct Seed {
  openvdb::Coord voxel;        ///< an inside voxel, which belongs to the fragment
  std::uint16_t fragment = 0;  ///< 1..kMaxFragments
  glm::ivec3 shift{0};         ///< of the point from the voxel's center, 1/kSeedSteps voxel, within
                        ///< kMostShift (in VoronoiSites of thin walls beyond it).  Distances of
                        ///< growths by nearest seed are to the point
  std::int64_t weight = 0;  ///< subtracted from the squared distance to the point, which is in
                            ///< (1/kSeedSteps voxel)^2, so that cells differ in size
  bool operator==(const Seed&) const = default;
};

/// Returns the point of a seed.
[[nodiscard]] inline IndexPoint pointOf(const Seed& seed) {
  return glm::dvec3(seed.voxel.x(), seed.voxel.y(), seed.voxel.z()) +
         glm::dvec3(seed.shift) / static_cast<double>(kSeedSteps);
}

/// Returns the point in steps of 1/kSeedSteps voxel.
[[nodiscard]] inline glm::i64vec3 stepsOf(const Seed& seed) {
  return glm::i64vec3(seed.voxel.x(), seed.voxel.y(), seed.voxel.z()) * std::int64_t{kSeedSteps} +
         glm::i64vec3(seed.shift);
}

/// Returns the number of fragments that grow from these seeds, the highest id.
[[nodiscard]] int fragmentsOf(std::span<const Seed> seeds);

/// How seeds are sampled.
enum class Sampler {
  uniform,   ///< every point with equal probability
  halton,    ///< Halton sequence over the mesh's box, digits scrambled by the seed
  gaussian,  ///< normal about the box's center, standard deviation a quarter of the box per axis
  poisson,   ///< dart throwing with a minimum distance that shrinks until all seeds fit
};

/// Where seeds can be.
enum class SeedsOn {
  automatic,  ///< wall where three quarters of the solid are walls thinner than a cube of a piece's
              ///< volume, as vessels, shells and plates are; else volume
  volume,     ///< anywhere inside
  surface,    ///< at the surface, in inside voxels with a face neighbor that is not inside: points
              ///< within 1/256 of the box's longest side of it, moved onto it
  wall,       ///< anywhere inside, and moved to the middle of the wall where the solid is thinner
              ///< than a cube of a piece's volume: cracks pass straight through thin walls, those
              ///< between Voronoi cells of given seeds and those of splits too
};

/// A ray in world space.
struct Ray {
  WorldPoint origin{};
  glm::dvec3 direction{0.0, 0.0, -1.0};  ///< any length but 0
};

/// An impact: seeds scattered about a point of the surface, in the component there.
struct Impact {
  struct Anywhere {};  ///< a random point of the surface

  /// The point of the surface: random, the nearest to a point, from which fracture() refuses one
  /// that is farther than kMostImpactDistance, or the first on a ray.  Without a mesh it is the
  /// center of a surface voxel (ties: lowest x, then y, then z).
  std::variant<Anywhere, WorldPoint, Ray> target{};
  /// Seeds.  0: all such impacts share half of the pieces beyond one per component, at least 1
  /// each.  Counts that take all pieces include the one that each component has besides.
  int count = 0;
  double sigma = 0.0;  ///< standard deviation per axis, world units; 0: from bias
  /// The paper's n, 1..kMaxBias: sum of n uniforms over the box's side / n, so the standard
  /// deviation per axis is side / sqrt(12 n).
  int bias = 5;
  /// 0: scattered seeds.  Else, 0.01..100, on thin matter seeds in rings about the point, in the
  /// middle of the wall: 8 energy^(1/4) radial cracks and 3 energy^(1/4) ring cracks, the last of
  /// them at `sigma`, or without it at a quarter of the longest side times energy^(1/8).  Rings
  /// follow each other at a constant ratio, so that pieces are about as wide as long and grow with
  /// the distance.  A count of 0 is that of the pattern, as far as the pieces suffice; a lower one
  /// leaves out its outer part, a higher one is met by scattered seeds.  Where the solid is thicker
  /// than half the radius of the last ring, all are scattered about the point.
  double energy = 0.0;
  /// false: each seed is a new fragment, counted in pieces.  true: each seed is added to the
  /// nearest fragment, as extra seeds are.
  bool merge = false;
  /// `target` before recentered() moved it, which manifests record: moving it back would round it.
  /// Anywhere: the same as `target`.
  std::variant<Anywhere, WorldPoint, Ray> given{};
};
inline constexpr int kMaxBias = 1000;

/// How far the point of an impact may be from the surface, in longest sides of the solid.
inline constexpr double kMostImpactDistance = 0.05;

/// A seed given by the user.
struct SeedPoint {
  WorldPoint position{};
  int fragment = 0;  ///< 1..kMaxFragments
};

/// Seeds given by the user.
struct GivenSeeds {
  std::string
      file{};  ///< where they come from: named in messages and, without folders, in manifests
  std::vector<SeedPoint> points{};
};

/// How small pieces are at each point, see seed/draw/density.h.
class DensityField;

/// Where pieces are small: the number of pieces per volume is proportional to a field.
struct Density {
  std::string source{};  ///< the attribute or the file, as recorded in manifests; empty: none
  std::shared_ptr<const DensityField> field{};
};

/// A distribution of fragment sizes.
enum class Sizes : std::uint8_t {
  grown,        ///< what growth gives
  uniform,      ///< all equal
  lognormal,    ///< the logarithm is normal with a standard deviation of sizeParameter
  power,        ///< the density falls by size to the power -sizeParameter
  exponential,  ///< exponential
};

inline constexpr double kMostSizeSpread = 4.0;

struct SeedOptions {
  int pieces = 8;          ///< number of fragments, 1..kMaxFragments
  std::uint64_t seed = 0;  ///< every random number is a hash of this, a stage and an item
  Sampler sampler = Sampler::uniform;
  SeedsOn on = SeedsOn::automatic;  ///< growths by splits have no seeds: cracks cross thin walls at
                                    ///< right angles, but with `volume`
  int extraSeeds = 0;               ///< further seeds, each added to the nearest fragment
  int extraSeedsPerPiece = 0;       ///< the same for each fragment, 0..1000
  Metric mergeMetric = Metric::chebyshev;  ///< distance of extra and merged seeds to fragments
  /// Makes sizes uneven: the distance of extra and merged seeds to a fragment is divided by its
  /// reach, a random number whose logarithm to the base 2 has this standard deviation,
  /// 0..kMostSizeSpread.  A fragment of small reach gets few seeds or none.
  double sizeSpread = 0.0;
  std::vector<Impact> impacts{};
  int randomImpacts = 0;              ///< additional impacts, each an Impact{}
  Density density{};                  ///< of seeds, but those of impacts, and of splits; not with
                                      ///< Sampler::poisson
  std::optional<GivenSeeds> given{};  ///< in place of all these in a fracture; see seedsFromPoints
};

/// Places the seeds of N = max(pieces, components) fragments on distinct voxels: one in each
/// component, those of the impacts, the rest by the sampler.  Ids are a random permutation of 1..N,
/// independent of position.  Then it places the seeds added to these fragments, those of merged
/// impacts and extra ones by the sampler.  Each gets the id of the nearest of the N seeds in its
/// component, by mergeMetric and sizeSpread, ties to the lower id.
///
/// Seeds are drawn as points of the mesh's box, and the mesh decides which are inside, so that
/// solids of one mesh at several resolutions have the same seeds.  (Solids without a mesh use their
/// voxels and the box of these.)  A seed has random numbers of its own: where one has to be drawn
/// again, such as in a wall that the voxels do not resolve, the others stay.
///
/// An impact scatters its seeds by a normal distribution (a sum of uniforms), truncated to free
/// voxels of its component; the distribution is widened where most of these are taken.  The number
/// of draws is limited; what they do not find is a random free voxel.
///
/// With a density, the sampler's points are accepted with a probability proportional to it, so that
/// none lies where it is 0, but for the one seed of a component where it is 0 everywhere.
///   return  [N, ascending by fragment id][merged][extra]
///   throws  Error(usage) more seeds than voxels, or than voxels of a density above 0, more
///   fragments than kMaxFragments, impacts that
///           do not fit in pieces or in their component, a ray that misses, a value out of range;
///           Error(cancelled)
///   cost    N log N and a pass over the masks; poisson about 5,000 darts at the solid,
///           and 10 to 40 per seed, of which those near the surface take some microseconds
///   source  López et al., Generating implicit object fragment datasets for machine learning, 2024,
///           sections 3.2, 3.2.1, 3.2.2
[[nodiscard]] std::vector<Seed> placeSeeds(const Solid& solid, const VoxelComponents& components,
                                           const SeedOptions& options,
                                           const Progress* progress = nullptr);

/// Converts points to seeds.  In the order given, each takes the nearest free inside voxel within 2
/// voxels (ties: lowest x, then y, then z), and moves into it.  A component without a seed gets one
/// at random, with a new id.
///   points  ids 1..n without gaps; all seeds of one id in one component
///   seed    random seed for the components without a seed
///   return  [fragments, ascending by id: the first seed of each][the others, in the order given]
///   throws  Error(input) naming the entry, counted from 1: too far from the solid, an id out of
///           range or missing, one id in two components; Error(usage) more fragments than
///           kMaxFragments
[[nodiscard]] std::vector<Seed> seedsFromPoints(std::span<const SeedPoint> points,
                                                const Solid& solid,
                                                const VoxelComponents& components,
                                                std::uint64_t seed = 0);

}  // namespace sherd
