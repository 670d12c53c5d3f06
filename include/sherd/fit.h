// How well fragments fit the intact mesh and one another.
#pragma once

#include <sherd/mesh.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sherd {

/// A fragment's mesh, assembled: in the coordinates of the whole.
struct FragmentMesh {
  int id = 0;
  TriangleMesh mesh;  ///< world units; at least one triangle, area above 0; neighbors if known
};

/// Distances of points, world units.
struct DistanceSummary {
  std::size_t samples = 0;  ///< >= 1
  double mean = 0.0;
  double p99 = 0.0;  ///< 99th percentile
  double max = 0.0;
};

struct FitOptions {
  std::size_t samples = 5000;  ///< points on each fragment's surface, and as many inside it; >= 1
  std::uint64_t seed = 0;      ///< results do not depend on the number of threads
  double tolerance = 0.01;     ///< share of the diagonal: the largest distance at which surfaces
                               ///< are matched where neighbors are unknown; > 0
};

/// The fit of one fragment.  A value is absent where there are no points to compute it from.
struct FragmentFit {
  double originalShare = 0.0;    ///< share of its surface points on the original surface
  double fractureShare = 0.0;    ///< share of its surface points on a fracture
  std::vector<int> neighbors{};  ///< ids, ascending, of fragments that are nearest to a fracture
                                 ///< point and contain it or are within the tolerance
  std::optional<DistanceSummary> surfaceError;  ///< original points to the intact mesh
  std::optional<DistanceSummary> gap;   ///< fracture points to the nearest other fragment; 0 inside
  std::optional<double> overlapShare;   ///< share of its inside points that are inside another one
  std::optional<double> insideShare{};  ///< share of its surface points inside another fragment
  double overlapDepth = 0.0;  ///< largest depth of a surface point below another's surface
};

/// The fit of all fragments.  Fragments are weighted by area, in `overlapShare` by volume.
struct Fit {
  double diagonal = 0.0;  ///< of the intact mesh's box, else of the box of all fragments
  std::vector<FragmentFit> fragments;
  std::optional<DistanceSummary> surfaceError;
  std::optional<DistanceSummary> missing;  ///< points on the intact mesh to the nearest fragment:
                                           ///< large where surface is lost
  std::optional<DistanceSummary> gap;
  std::optional<double> overlapShare;
  double overlapDepth = 0.0;
  std::optional<double> voidShare;    ///< share of points inside the intact mesh in no fragment
  std::optional<double> wholeVolume;  ///< of the intact mesh, where it is closed
};

/// Measures the fit by points sampled on the fragments' surfaces, uniform by area, and inside them,
/// uniform by volume.
///
/// Surface points are classified as original or fracture.  Where neighbors are known, they decide;
/// points whose neighbor is not among `fragments` are neither.  Where they are unknown, a point is
/// on a fracture if it is inside another fragment or opposite one: within the tolerance, with the
/// direction to the closest point outward and at most 60 degrees off the normal.  All others are
/// original.  With the intact mesh, a fracture point must also be closer to the other fragment than
/// to that mesh, and an original point within the tolerance of it; all others are neither.  So gaps
/// and errors above the tolerance go undetected, and where neighbors leave a gap, a strip of its
/// width along each contact boundary counts as original.
///
/// A point within 2e-6 of the diagonal of a surface, the error of single precision, is on it and in
/// no other fragment.  Only closed fragments have an inside: for an open one overlapShare is
/// absent, and no point is inside it.
///   fragments  any number; closed or not
///   whole      the intact mesh in the same coordinates, or null
///   cost       fragments * samples * (log triangles) * fragments that are near
///   throws     Error(usage) an option out of range; Error(input) a mesh has no area;
///              Error(cancelled)
[[nodiscard]] Fit fit(std::span<const FragmentMesh> fragments, const TriangleMesh* whole,
                      const FitOptions& options = {}, const Progress* progress = nullptr);

}  // namespace sherd
