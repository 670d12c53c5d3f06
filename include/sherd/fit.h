// How well fragments fit: to the unbroken mesh, and to one another.
#pragma once

#include <sherd/mesh.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sherd {

/// A fragment as its mesh tells, in the place it had in the whole.
struct FragmentMesh {
  int id = 0;
  TriangleMesh mesh;                  ///< world units; at least one triangle, with area
  std::vector<std::uint16_t> facing;  ///< [triangles], as Fragment::facing; empty: not known
};

/// Distances of points, world units.
struct DistanceSummary {
  std::size_t samples = 0;  ///< >= 1
  double mean = 0.0;
  double p99 = 0.0;  ///< the least that 99 % are not above
  double max = 0.0;
};

struct FitOptions {
  std::size_t samples = 5000;  ///< points on each fragment's surface, and as many inside it; >= 1
  std::uint64_t seed = 0;      ///< the same gives the same figures on any number of threads
  double tolerance = 0.01;     ///< out of the diagonal: how near surfaces may belong together,
                               ///< where facing is not known; > 0
};

/// How one fragment fits.  A figure is absent where there is nothing to take it from.
struct FragmentFit {
  double originalShare = 0.0;     ///< of the points on its surface
  double fractureShare = 0.0;     ///< of these
  std::vector<int> neighbours{};  ///< ids, ascending, of fragments that are the nearest to a
                                  ///< fracture point, and within the tolerance or round it
  std::optional<DistanceSummary> surfaceError;  ///< of original points, to the unbroken mesh
  std::optional<DistanceSummary> gap;   ///< of fracture points, to the nearest other fragment; 0
                                        ///< inside one
  std::optional<double> overlapShare;   ///< of points inside it: those inside another one
  std::optional<double> insideShare{};  ///< of points on its surface: those inside another one
  double overlapDepth = 0.0;  ///< the most that one of these lies below that one's surface
};

/// How all fit.  Fragments weigh as their area, or as their volume in `overlapShare`.
struct Fit {
  double diagonal = 0.0;  ///< of the unbroken mesh's box, else of all fragments'
  std::vector<FragmentFit> fragments;
  std::optional<DistanceSummary> surfaceError;
  std::optional<DistanceSummary> missing;  ///< of points on the unbroken mesh, to the nearest
                                           ///< fragment: large where surface is lost
  std::optional<DistanceSummary> gap;
  std::optional<double> overlapShare;
  double overlapDepth = 0.0;
  std::optional<double> voidShare;    ///< of points inside the unbroken mesh: those in no fragment
  std::optional<double> wholeVolume;  ///< the unbroken mesh's, where it is closed
};

/// Measure by points that are drawn on the fragments' surfaces, uniform by area, and inside them,
/// uniform by volume.
///
/// Which points are of the original surface, and which of a fracture?  Where facing is known, it
/// tells; points that face a fragment which is not there are neither.  Where it is not known,
/// points inside another fragment are of a fracture, and those that face one: it is within the
/// tolerance, and the way to its nearest point goes out of the surface, at most 60 degrees off the
/// normal. All others are original.  With the unbroken mesh, they have to be nearer to the other
/// fragment than to that; all others are original where they are within the tolerance of it, else
/// neither. So neither a gap nor an error above the tolerance is told, and where neighbours leave a
/// gap, a strip as wide as that along each rim counts as original.
///
/// Points nearer to a surface than single precision can tell, 2e-6 of the diagonal, are on it, and
/// so in no other fragment.  Inside are only closed fragments: overlapShare is absent for an open
/// one, and no point lies inside it.
///   fragments  any number; closed or not
///   whole      the unbroken mesh, in the same place, or null
///   cost       fragments * samples * (log triangles) * fragments that are near
///   throws     Error(usage) an option out of range; Error(input) a mesh has no area;
///              Error(cancelled)
[[nodiscard]] Fit fit(std::span<const FragmentMesh> fragments, const TriangleMesh* whole,
                      const FitOptions& options = {}, const Progress* progress = nullptr);

}  // namespace sherd
