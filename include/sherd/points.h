// Point sampling for training data: points on a mesh's surface, points in space with their signed
// distance, and corresponding points of neighboring fragments.
#pragma once

#include <sherd/fragments.h>
#include <sherd/labels.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

namespace sherd {

/// The most points that one call samples.
inline constexpr std::size_t kMaxPoints = 10'000'000;

/// How points are distributed over a surface.
enum class PointSampler {
  uniform,  ///< independent
  halton,   ///< Halton sequence, digits scrambled by the seed: base 2 selects the triangle by
            ///< cumulative area, bases 3 and 5 the position in it
  poisson,  ///< blue noise: sample elimination from five times as many uniform points
};

/// How many points a triangle gets.
enum class PointRule {
  area,         ///< in proportion to its area
  perTriangle,  ///< the paper's: max(1, ceil(count * share of the area)) each, then shuffled and
                ///< truncated to count
};

struct PointOptions {
  std::size_t count = 0;  ///< points, 0..kMaxPoints
  PointSampler sampler = PointSampler::uniform;
  PointRule rule = PointRule::area;  ///< perTriangle cannot be combined with poisson
  std::uint64_t seed = 0;            ///< points do not depend on the number of threads
};

/// Points on a surface.  If read from a file, normals and neighbors may be empty.
struct SurfacePoints {
  std::vector<glm::dvec3> positions;    ///< [n] world units
  std::vector<glm::dvec3> normals;      ///< [n] of the point's triangle, unit, outwards
  std::vector<std::uint16_t> neighbor;  ///< [n] of the point's triangle
};

/// Samples points on a mesh.  Triangles with area 0 get none.
///   return    exactly options.count points in random order; with halton and PointRule::area in
///             sequence order, so that every prefix is evenly distributed
///   cost      count * log triangles; poisson about 20 microseconds and 700 bytes per point
///   throws    Error(usage) an option out of range; Error(input) the mesh has no area
///   source  López et al., Generating implicit object fragment datasets for machine learning, 2024,
///           section 3.4 (perTriangle); Yuksel, Sample Elimination for Generating Poisson Disk
///           Sample Sets, 2015 (poisson)
[[nodiscard]] SurfacePoints samplePoints(const TriangleMesh& mesh, const PointOptions& options);

/// What samplePoints needs of a fracture beside its labels.
struct FragmentPointOptions {
  PointOptions points{};             ///< `count` of each fragment; each has a seed of its own,
                                     ///< derived from `seed` as in a fracture's folder
  const Labels* uneroded = nullptr;  ///< the labels before erosion, or null without erosion
  std::shared_ptr<const IntactSurface> intact{};  ///< of the solid, or null; affects only the speed
};

/// Samples points on all fragments of a fracture without making their meshes: the points are those
/// that would be sampled on the meshes of extractFragments, on the same triangles but where
/// rounding decides between two.  Leaves without a crack are the intact solid's, so a fracture of a
/// solid with an IntactSurface costs what its cracks cost.
///   labels  of this solid's blocks: each id 1..fragmentCount with at least one voxel
///   return  [fragmentCount] ascending by id.  Without `uneroded`, the neighbor of points towards
///           eroded voxels is Labels::kEroded
///   throws  Error(usage) as extractFragments, an intact surface of another solid, an option out of
///           range; Error(input) a fragment has no surface; Error(cancelled)
[[nodiscard]] std::vector<SurfacePoints> samplePoints(const Solid& solid, const Labels& labels,
                                                      const FragmentPointOptions& options,
                                                      const Progress* progress = nullptr);

/// The same of the surfaces of a fracture, FractureResult::surfaces or unmerged.
[[nodiscard]] std::vector<SurfacePoints> samplePoints(const FragmentSurfaces& surfaces,
                                                      const PointOptions& options,
                                                      const Progress* progress = nullptr);

/// Distributes `total` points in proportion to areas by the largest-remainder method, ties to the
/// first.
///   areas   >= 0, at least one above 0
///   return  [areas] counts with the sum `total`
[[nodiscard]] std::vector<std::size_t> shareOut(std::size_t total, std::span<const double> areas);

/// Points on contacts between two fragments, in the coordinates of the whole.
struct Correspondences {
  std::vector<std::array<int, 2>> fragments;  ///< [n] ids, the lower first
  std::vector<glm::dvec3> positions;          ///< [n] world units
  std::vector<glm::dvec3> normals;            ///< [n] unit, from the lower id to the higher
};

/// Samples points on the contact faces of each pair of touching fragments, uniform by area.
///   fragments        [n] with ids 1..n whose contact surfaces are shared: Interface::shared
///                    without erosion, or Surface::labels before smoothing.  Contacts with other
///                    ids are skipped
///   countPerContact  0..kMaxPoints; a contact without faces in the meshes gets none
[[nodiscard]] Correspondences sampleCorrespondences(std::span<const Fragment> fragments,
                                                    std::size_t countPerContact,
                                                    std::uint64_t seed);

/// The number type of stored samples.
enum class SampleType { float32, float16 };

struct DistanceOptions {
  std::size_t count = 0;  ///< samples, 0..kMaxPoints
  SampleType type = SampleType::float32;
  double sigma = 0.0;      ///< world units, > 0; points near the surface have standard deviations
                           ///< of sigma and 3 sigma.  A fracture's default is the voxel size
  std::uint64_t seed = 0;  ///< samples do not depend on the number of threads
};

/// Points in space, each with its signed distance to a mesh.
struct DistanceSamples {
  std::vector<glm::dvec3> positions;  ///< [n] world units, rounded to `type`
  std::vector<double> distances;      ///< [n] world units, negative inside; of the rounded
                                      ///< positions, themselves not rounded
  SampleType type = SampleType::float32;
};

/// Samples points in space with their signed distance to a mesh.  Every other point is uniform in
/// the mesh's box, enlarged on every side by the larger of a twentieth of its longest side and 3
/// sigma.  The others are surface points, uniform by area, moved along the normal by a normal
/// variate (a sum of twelve uniforms) with standard deviation alternating between sigma and 3
/// sigma.
///   mesh    closed, oriented outwards
///   return  exactly options.count samples
///   cost    count * log triangles
///   throws  Error(usage) an option out of range, a box beyond the range of the type; Error(input)
///           the mesh has no area; Error(cancelled)
[[nodiscard]] DistanceSamples sampleDistances(const TriangleMesh& mesh,
                                              const DistanceOptions& options,
                                              const Progress* progress = nullptr);

/// Returns signed distances to the nearest triangle in double precision, negative where the winding
/// number is above 0.  Correct for every closed mesh, also with overlapping components.
///   mesh    closed, oriented outwards, at least one triangle
///   return  [points]
///   source  Ericson, Real-Time Collision Detection, 2005 (closest point on a triangle)
[[nodiscard]] std::vector<double> signedDistances(const TriangleMesh& mesh,
                                                  std::span<const glm::dvec3> points,
                                                  const Progress* progress = nullptr);

}  // namespace sherd
