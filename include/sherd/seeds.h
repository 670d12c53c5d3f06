// The parts of a solid, and the seeds that fragments grow from.
#pragma once

#include <sherd/coords.h>
#include <sherd/device.h>
#include <sherd/leaf_blocks.h>
#include <sherd/metric.h>
#include <sherd/output_file.h>
#include <sherd/solid.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <span>
#include <variant>
#include <vector>

namespace sherd {

/// The largest fragment id: `labels.rle` stores id + 1 in 16 bits.
inline constexpr int kMaxFragments = 65534;

/// The 6-connected parts of the inside, numbered 0..count()-1 by their first voxel in leaf order.
struct Parts {
  static constexpr std::uint32_t kOneNode = 0xffffffffu;

  std::vector<std::uint32_t> firstNode;   ///< [leaf] number of the leaf's first node
  std::vector<std::uint32_t> firstLocal;  ///< [leaf] where it begins in localNode; kOneNode where
                                          ///< it has but one node, as most have
  std::vector<std::uint16_t> localNode;   ///< [..*512] node of an inside voxel within its leaf
  std::vector<std::uint32_t> partOfNode;  ///< [nodes]
  std::vector<std::uint64_t> voxels;      ///< [count()] inside voxels of each part

  std::size_t count() const { return voxels.size(); }
  /// The part of the inside voxel at a place in the leaf blocks.
  std::uint32_t at(std::size_t place) const {
    const std::size_t leaf = place / 512;
    const std::uint32_t first = firstLocal[leaf];
    const std::uint32_t local =
        first == kOneNode ? 0u : localNode[std::size_t{first} * 512 + place % 512];
    return partOfNode[firstNode[leaf] + local];
  }
};

/// Find the 6-connected parts on the device: a flood inside each leaf, then a union of the nodes
/// that touch across leaf faces.  The result does not depend on the schedule.
///   throws  Error(device)
///   source  Jaiganesh and Burtscher, ECL-CC, HPDC 2018 (the lock-free union)
[[nodiscard]] Parts findParts(const LeafBlocks& blocks, Device& device);

/// One voxel that a fragment grows from.
struct Seed {
  openvdb::Coord voxel;
  std::uint16_t fragment = 0;  ///< 1..kMaxFragments
  bool operator==(const Seed&) const = default;
};

/// Fragments that grow from these seeds: the highest id.
[[nodiscard]] int fragmentsOf(std::span<const Seed> seeds);

/// How seeds are drawn.
enum class Sampler {
  uniform,   ///< each voxel as likely
  halton,    ///< Halton's points over the solid's box, digits scrambled by the seed
  gaussian,  ///< normal about the box's centre, standard deviation a quarter of the box per axis
  poisson,   ///< well apart: darts, and a distance to keep that shrinks until all seeds fit
};

/// Which voxels seeds may lie on.
enum class SeedsOn {
  volume,   ///< all inside voxels
  surface,  ///< inside voxels with a face neighbour that is not inside
};

/// A half line in world space, from a viewer's eye say.
struct Ray {
  WorldPoint origin{};
  glm::dvec3 direction{0.0, 0.0, -1.0};  ///< any length but 0
};

/// A blow: seeds that scatter about a voxel of the surface, in the part that holds it.
struct Impact {
  struct Anywhere {};  ///< a random voxel of the surface

  /// A point is moved to the nearest voxel of the surface (ties: lowest x, then y, then z); a ray
  /// hits the first inside voxel that it meets.
  std::variant<Anywhere, WorldPoint, Ray> place{};
  /// Seeds; 0: of the pieces beyond one per part, half are shared among all impacts, at least 1
  /// each.
  int count = 0;
  double spread = 0.0;  ///< standard deviation per axis, world units; 0: from bias
  /// The paper's n, 1..kMaxBias: sum of n uniforms over the box's side / n, so the standard
  /// deviation per axis is side / sqrt(12 n).
  int bias = 5;
  /// false: each seed is a new fragment, counted in pieces.  true: each shapes the nearest fragment
  /// there is, as an extra seed does.
  bool merge = false;
};
inline constexpr int kMaxBias = 1000;

struct SeedOptions {
  int pieces = 8;          ///< fragments wanted, 1..kMaxFragments
  std::uint64_t seed = 0;  ///< every random choice is a hash of this, a stage and an item
  Sampler sampler = Sampler::uniform;
  SeedsOn on = SeedsOn::volume;
  int extraSeeds = 0;                      ///< further seeds, each given to the nearest fragment
  Metric mergeMetric = Metric::chebyshev;  ///< what nearest means for extra and merged seeds
  std::vector<Impact> impacts{};
  int randomImpacts = 0;  ///< this many more, each an Impact{}
};

/// Place the seeds of N = max(pieces, parts) fragments on distinct voxels: one in each part, those
/// of the impacts, the rest by the sampler.  Ids are a random permutation of 1..N, so they tell
/// nothing of the place.  Then the seeds that shape these fragments: merged impacts', and extra
/// ones by the sampler; each has the id of the nearest of the N that lies in its own part, by
/// mergeMetric, ties to the lower id.
///
/// An impact scatters its seeds by a normal distribution (a sum of uniforms), cut to its part and
/// to voxels that are free; where most of the neighbourhood is taken it is widened.  A sampler that
/// cannot hit a free voxel any more (Halton's points and normal ones are tried a bounded number of
/// times) leaves the rest to the uniform one.
///   return  [N, ascending by fragment id][merged][extra]
///   throws  Error(usage) more seeds than voxels, more fragments than kMaxFragments, impacts that
///           do not fit in pieces or in their part, a ray that misses, a value out of range
///   cost    N log N and a pass over the masks; poisson some 5,000 darts, and 10 to 40 more a seed
///   source  López et al., Generating implicit object fragment datasets for machine learning, 2024,
///           sections 3.2, 3.2.1, 3.2.2
[[nodiscard]] std::vector<Seed> placeSeeds(const Solid& solid, const Parts& parts,
                                           const SeedOptions& options);

/// A seed as a user gives it.
struct SeedPoint {
  WorldPoint position{};
  int fragment = 0;  ///< 1..kMaxFragments
};

/// Seeds at given points.  Each moves to the nearest inside voxel that is free, at most 2 voxels
/// from it (ties: lowest x, then y, then z), in the order given.  A part without a seed gets one,
/// where placeSeeds would put it, with a new id.
///   points  ids 1..n without gaps; seeds of one id in one part
///   seed    places the seeds of parts that have none
///   return  [fragments, ascending by id: the first seed of each][the others, in the order given]
///   throws  Error(input) naming the entry, 1 the first: too far from the solid, an id out of range
///           or missing, one id in two parts; Error(usage) more fragments than kMaxFragments
[[nodiscard]] std::vector<Seed> seedsFromPoints(std::span<const SeedPoint> points,
                                                const Solid& solid, const Parts& parts,
                                                std::uint64_t seed = 0);

/// Read and write seeds as JSON: positions are voxel centres in world units, and what was written
/// is read back exactly.  Other members of the objects are ignored.
///
///     {"schema": "sherd-seeds/1", "seeds": [{"fragment": 1, "position": [x, y, z]}, ...]}
///
///   throws  Error(input) with the file's name: absent, larger than 64 MiB, not JSON, another
///           schema, an entry that is not as above, and what seedsFromPoints refuses; Error(output)
[[nodiscard]] std::vector<Seed> readSeeds(const std::filesystem::path& file, const Solid& solid,
                                          const Parts& parts, std::uint64_t seed = 0);
void writeSeeds(const OutputFile& file, std::span<const Seed> seeds, const Solid& solid);

}  // namespace sherd
