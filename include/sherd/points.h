// Points that networks learn from: on a mesh's surface, and in the space round it with their
// distance to it.
#pragma once

#include <sherd/fragments.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// The most points that one call draws.
inline constexpr std::size_t kMaxPoints = 10'000'000;

/// How points are spread over a surface.
enum class PointSampler {
  uniform,  ///< each independent of all others
  halton,   ///< Halton's points, digits scrambled by the seed: base 2 picks the triangle by the sum
            ///< of areas, bases 3 and 5 the place in it
  poisson,  ///< well apart: of five times as many uniform ones, those that crowd others are dropped
};

/// How many points a triangle gets.
enum class PointRule {
  area,         ///< as its area has it
  perTriangle,  ///< the paper's: max(1, ceil(count * share of the area)) for each, then shuffled
                ///< and cut to count
};

struct PointOptions {
  std::size_t count = 0;  ///< points, 0..kMaxPoints
  PointSampler sampler = PointSampler::uniform;
  PointRule rule = PointRule::area;  ///< perTriangle does not go with poisson
  std::uint64_t seed = 0;            ///< the same gives the same points on any number of threads
};

/// Points on a surface.  Of those that were read from a file, normals and facing may be empty.
struct SurfacePoints {
  std::vector<glm::dvec3> positions;  ///< [n] world units
  std::vector<glm::dvec3> normals;    ///< [n] of the point's triangle, unit, outwards
  std::vector<std::uint16_t> facing;  ///< [n] of the point's triangle
};

/// Draw points on a mesh.  Triangles without area get none.
///   facing  [triangles], as Fragment::facing; or empty, then every point's is 0
///   return  exactly options.count points, in an order that tells nothing of the triangles, but for
///           halton by area, whose first n are evenly spread for every n
///   cost    count * log triangles; poisson some 20 microseconds and 700 bytes a point
///   throws  Error(usage) an option out of range; Error(input) the mesh has no area
///   source  López et al., Generating implicit object fragment datasets for machine learning, 2024,
///           section 3.4 (perTriangle); Yuksel, Sample Elimination for Generating Poisson Disk
///           Sample Sets, 2015 (poisson)
[[nodiscard]] SurfacePoints samplePoints(const TriangleMesh& mesh,
                                         std::span<const std::uint16_t> facing,
                                         const PointOptions& options);

/// Share `total` points out by areas: each gets the whole number below its part, and what is left
/// goes to those with the largest remainders, ties to the first.
///   areas   0 or more, at least one above 0
///   return  [areas] counts that add up to total
[[nodiscard]] std::vector<std::size_t> shareOut(std::size_t total, std::span<const double> areas);

/// Points on surfaces that two fragments share: as the fragments lie in the whole, a point belongs
/// to both.
struct Correspondences {
  std::vector<std::array<int, 2>> fragments;  ///< [n] ids, the lower first
  std::vector<glm::dvec3> positions;          ///< [n] world units
  std::vector<glm::dvec3> normals;            ///< [n] unit, from the lower id's towards the other
};

/// Draw points on the faces between each two fragments that touch, uniform by area.
///   fragments        [n] of ids 1..n, with the surface between them shared: Interface::shared, not
///                    worn, or Surface::labels as it is meshed; others that they touch are left out
///   countPerContact  0..kMaxPoints; a contact too small to have faces in the meshes gets none
[[nodiscard]] Correspondences sampleCorrespondences(std::span<const Fragment> fragments,
                                                    std::size_t countPerContact,
                                                    std::uint64_t seed);

/// The numbers that samples are stored as.
enum class SampleType { float32, float16 };

struct DistanceOptions {
  std::size_t count = 0;  ///< samples, 0..kMaxPoints
  SampleType type = SampleType::float32;
  double spread = 0.0;     ///< world units, > 0; near points have standard deviations of one and
                           ///< three spreads.  In a fracture: the voxel size
  std::uint64_t seed = 0;  ///< the same gives the same samples on any number of threads
};

/// Points of space, each with its distance to a body.
struct DistanceSamples {
  std::vector<glm::dvec3> positions;  ///< [n] world units, each a number of `type`
  std::vector<double> distances;      ///< [n] world units, negative inside; of positions as they
                                      ///< are stored; not rounded
  SampleType type = SampleType::float32;
};

/// Draw points in the space round a body, and tell their distance.  Every other point is uniform in
/// the mesh's box, widened on every side by a twentieth of its longest side or three spreads,
/// whichever is more.  The others are points of the surface, uniform by area, moved along its
/// normal by a normal draw (a sum of twelve uniforms), in turn of one and of three spreads.
///   mesh    closed, oriented outwards
///   return  exactly options.count samples
///   cost    count * log triangles
///   throws  Error(usage) an option out of range, a box beyond what the type can hold; Error(input)
///           the mesh has no area; Error(cancelled)
[[nodiscard]] DistanceSamples sampleDistances(const TriangleMesh& mesh,
                                              const DistanceOptions& options,
                                              const Progress* progress = nullptr);

/// How far points are from a mesh, negative where it winds round them: the distance to the nearest
/// triangle in double precision.  Right for every closed mesh, bodies that overlap included.
///   mesh    closed, oriented outwards, at least one triangle
///   return  [points]
///   source  Ericson, Real-Time Collision Detection, 2005 (nearest point of a triangle)
[[nodiscard]] std::vector<double> signedDistances(const TriangleMesh& mesh,
                                                  std::span<const glm::dvec3> points,
                                                  const Progress* progress = nullptr);

}  // namespace sherd
