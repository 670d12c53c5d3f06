// Metrics of a finished fracture.
#pragma once

#include <sherd/fit.h>
#include <sherd/mesh.h>
#include <sherd/mesh_quality.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// The convexity of a closed mesh, measured at points on its surface.
struct Convexity {
  double value = 0.0;  ///< 1 - mean distance; below 1, and may be below 0
  double standardDeviation =
      0.0;                  ///< of the distances; / sqrt(samples): the value's standard error
  std::size_t samples = 0;  ///< points used, at most the number requested
};

/// Returns one minus the mean distance from the surface, along its normal, to the convex hull.
///
/// The mesh is translated so that the mean of its vertices is the origin, and divided by its
/// largest absolute coordinate, so the value does not depend on size.  Points are uniform over the
/// surface. A point's normal is interpolated from the vertex normals of its triangle, which are
/// angle-weighted means of the adjacent faces' normals.  Each point is moved inwards by 1e-4 of the
/// diagonal of all points' box, and dropped if it is then outside.  The distance starts at the
/// moved point, so a convex mesh has 1 - 1e-4 * diagonal, about 0.9997.
///   mesh     closed, oriented outwards, every vertex used, equal vertices merged as readMesh does
///   samples  points to draw, >= 1
///   seed     of the points; the value does not depend on the number of threads
///   cost     samples * (facets of the hull + log triangles)
///   throws   Error(usage) no samples; Error(input) no area, flat, or no point inside;
///            Error(cancelled)
///   source   Lopez et al., Generating implicit object fragment datasets for machine learning,
///            Computers & Graphics 2024, Figure 14, as its code computes it
[[nodiscard]] Convexity convexity(const TriangleMesh& mesh, std::size_t samples = 5000,
                                  std::uint64_t seed = 0, const Progress* progress = nullptr);

/// Returns the effective number of fragments, (sum of shares)^2 / sum of share^2: n for n equal
/// shares, near 1 when one share dominates, 0 when no share is above 0.
///   source  the inverse of Simpson's index; Laakso and Taagepera, 1979
[[nodiscard]] double effectiveCount(std::span<const double> shares);

/// A fragment read from a folder.
struct EvaluatedFragment {
  std::string name;                  ///< mesh file, relative to the folder; empty without a mesh
  FragmentMesh mesh;                 ///< no triangles where no mesh was written
  std::size_t droppedTriangles = 0;  ///< triangles with two equal corners, dropped by the reader

  // From the manifest.  Without one, evaluate() computes them from the meshes.
  double share = 0.0;
  double volume = 0.0;
  double area = 0.0;
  double fractureArea = 0.0;
  std::size_t contacts = 0;
};

/// The fragments of one folder.
struct FragmentSet {
  bool manifest = false;                     ///< written by Sherd, with a manifest
  std::string source;                        ///< the mesh's file name, from the manifest
  std::uint64_t seed = 0;                    ///< the fracture's seed, from the manifest
  double voxelSize = 0.0;                    ///< world units, from the manifest, else 0
  std::vector<EvaluatedFragment> fragments;  ///< [>= 1]
};

/// Reads the fragments of a folder: those that its manifest.json lists, else every file with an
/// extension of readMesh, numbered from 1 in natural order: piece_2 before piece_10.
///   throws  Error(input) `folder` is not a folder, or has neither; the manifest is damaged; a mesh
///           cannot be read, or all meshes together take more memory than `options` allow;
///           Error(cancelled)
[[nodiscard]] FragmentSet readFragments(const std::filesystem::path& folder,
                                        const ReadOptions& options = {},
                                        const Progress* progress = nullptr);

struct EvaluateOptions {
  std::size_t samples = 5000;  ///< for convexity and for fit
  std::uint64_t seed = 0;
  double tolerance = 0.01;  ///< FitOptions::tolerance
};

/// The metrics of one fragment.
struct FragmentMetrics {
  int id = 0;
  std::string name;
  double share = 0.0;  ///< of all voxels by the manifest, else of the sum of all volumes
  double volume = 0.0;
  double area = 0.0;
  double fractureArea = 0.0;  ///< without a manifest estimated by fit()
  std::size_t contacts = 0;   ///< fragments it touches; without a manifest estimated by fit()
  std::optional<MeshQuality> quality;  ///< absent without a mesh
  std::optional<Convexity> convexity;
  std::string noConvexity;  ///< why `convexity` is absent although there is a mesh
  FragmentFit fit;          ///< empty without a mesh
};

/// The metrics of a fracture.
struct Evaluation {
  std::vector<FragmentMetrics> fragments;  ///< [>= 1]
  double volume = 0.0;
  double area = 0.0;
  double fractureArea = 0.0;
  std::size_t contacts = 0;  ///< pairs of fragments that touch
  double smallestShare = 0.0;
  double largestShare = 0.0;
  double effectiveFragments = 0.0;
  std::optional<double> convexity;               ///< mean over the fragments that have one
  std::optional<double> convexityStandardError;  ///< of that mean, over the fragments
  std::size_t sound = 0;  ///< fragments with a closed, manifold, outward-oriented mesh without
                          ///< degenerate or duplicate triangles
  std::size_t open = 0;   ///< fragments with an open mesh: their volume is not reliable
  MeshQuality quality;    ///< sums of counts, the smallest angle, means over all triangles
  Fit fit;
  std::vector<std::string> notes;  ///< caveats about the metrics, one sentence each
};

/// Measures a folder's fragments.  A defective mesh is not an error: what cannot be measured is
/// absent.  A closed mesh that is oriented inwards is flipped after its quality is measured.
///   whole   the intact mesh in the fragments' coordinates, or null
///   throws  Error(usage) an option out of range; Error(input) the intact mesh has no area;
///           Error(cancelled)
[[nodiscard]] Evaluation evaluate(const FragmentSet& set, const TriangleMesh* whole,
                                  const EvaluateOptions& options = {},
                                  const Progress* progress = nullptr);

}  // namespace sherd
