// The seeds from which fragments grow.
#pragma once

#include <sherd/solid.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
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

/// A voxel from which a fragment grows.
struct Seed {
  openvdb::Coord voxel;
  std::uint16_t fragment = 0;  ///< 1..kMaxFragments
  bool operator==(const Seed&) const = default;
};

/// Returns the number of fragments that grow from these seeds, the highest id.
[[nodiscard]] int fragmentsOf(std::span<const Seed> seeds);

/// How seeds are sampled.
enum class Sampler {
  uniform,   ///< every voxel with equal probability
  halton,    ///< Halton sequence over the solid's box, digits scrambled by the seed
  gaussian,  ///< normal about the box's center, standard deviation a quarter of the box per axis
  poisson,   ///< dart throwing with a minimum distance that shrinks until all seeds fit
};

/// Which voxels can be seeds.
enum class SeedsOn {
  volume,   ///< all inside voxels
  surface,  ///< inside voxels with a face neighbor that is not inside
};

/// A ray in world space.
struct Ray {
  glm::dvec3 origin{};
  glm::dvec3 direction{0.0, 0.0, -1.0};  ///< any length but 0
};

/// An impact: seeds scattered about a surface voxel, in the component of that voxel.
struct Impact {
  struct Anywhere {};  ///< a random surface voxel

  /// The surface voxel: random, the nearest to a point (ties: lowest x, then y, then z), or the
  /// first inside voxel on a ray.
  std::variant<Anywhere, glm::dvec3, Ray> target{};
  /// Seeds.  0: all such impacts share half of the pieces beyond one per component, at least 1
  /// each.
  int count = 0;
  double sigma = 0.0;  ///< standard deviation per axis, world units; 0: from bias
  /// The paper's n, 1..kMaxBias: sum of n uniforms over the box's side / n, so the standard
  /// deviation per axis is side / sqrt(12 n).
  int bias = 5;
  /// false: each seed is a new fragment, counted in pieces.  true: each seed is added to the
  /// nearest fragment, as extra seeds are.
  bool merge = false;
};
inline constexpr int kMaxBias = 1000;

/// A seed given by the user.
struct SeedPoint {
  glm::dvec3 position{};
  int fragment = 0;  ///< 1..kMaxFragments
};

/// Seeds given by the user.
struct GivenSeeds {
  std::string
      file{};  ///< where they come from: named in messages and, without folders, in manifests
  std::vector<SeedPoint> points{};
};

struct SeedOptions {
  int pieces = 8;          ///< number of fragments, 1..kMaxFragments
  std::uint64_t seed = 0;  ///< every random number is a hash of this, a stage and an item
  Sampler sampler = Sampler::uniform;
  SeedsOn on = SeedsOn::volume;
  int extraSeeds = 0;                      ///< further seeds, each added to the nearest fragment
  int extraSeedsPerPiece = 0;              ///< the same for each fragment, 0..1000
  Metric mergeMetric = Metric::chebyshev;  ///< distance of extra and merged seeds to fragments
  std::vector<Impact> impacts{};
  int randomImpacts = 0;              ///< additional impacts, each an Impact{}
  std::optional<GivenSeeds> given{};  ///< in place of all these in a fracture; see seedsFromPoints
};

/// Places the seeds of N = max(pieces, components) fragments on distinct voxels: one in each
/// component, those of the impacts, the rest by the sampler.  Ids are a random permutation of 1..N,
/// independent of position.  Then it places the seeds added to these fragments, those of merged
/// impacts and extra ones by the sampler.  Each gets the id of the nearest of the N seeds in its
/// component, by mergeMetric, ties to the lower id.
///
/// An impact scatters its seeds by a normal distribution (a sum of uniforms), truncated to free
/// voxels of its component; the distribution is widened where most of these are taken.  Halton and
/// gaussian sampling are limited to a number of attempts per seed, after which the rest is uniform.
///   return  [N, ascending by fragment id][merged][extra]
///   throws  Error(usage) more seeds than voxels, more fragments than kMaxFragments, impacts that
///           do not fit in pieces or in their component, a ray that misses, a value out of range
///   cost    N log N and a pass over the masks; poisson about 5,000 darts, and 10 to 40 per seed
///   source  López et al., Generating implicit object fragment datasets for machine learning, 2024,
///           sections 3.2, 3.2.1, 3.2.2
[[nodiscard]] std::vector<Seed> placeSeeds(const Solid& solid, const VoxelComponents& components,
                                           const SeedOptions& options);

/// Converts points to seeds.  In the order given, each moves to the nearest free inside voxel
/// within 2 voxels (ties: lowest x, then y, then z).  A component without a seed gets one with a
/// new id, at the position that placeSeeds uses.
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
