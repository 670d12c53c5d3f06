// Figures that tell of a finished fracture.
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

/// How convex a body is, measured at points of its surface.
struct Convexity {
  double value = 0.0;  ///< 1 - mean distance; below 1, and may be below 0
  double standardDeviation =
      0.0;                  ///< of the distances; / sqrt(samples): the value's standard error
  std::size_t samples = 0;  ///< points that were kept, <= the points asked for
};

/// One minus the mean distance from the surface, along its normal, to the convex hull.
///
/// The body is moved so that the mean of its vertices is the origin, and divided by its largest
/// absolute coordinate; no further size enters.  Points are uniform over the surface.  A point's
/// normal is interpolated from those of its triangle's vertices, which are means over the faces
/// round them, weighted by angle.  Each point is pushed inwards by 1e-4 of the diagonal of all
/// points' box, and dropped when it is then outside.  The distance runs from the pushed point, so a
/// convex body has 1 - 1e-4 * diagonal, some 0.9997.
///   mesh     closed, oriented outwards, every vertex used; equal vertices merged, or a fold stays
///   a
///            fold (readMesh merges)
///   samples  points to draw, >= 1
///   seed     of the points; the same gives the same value on any number of threads
///   cost     samples * (facets of the hull + log triangles)
///   throws   Error(usage) no samples; Error(input) no area, flat, or no point inside;
///            Error(cancelled)
///   source   Lopez et al., Generating implicit object fragment datasets for machine learning,
///            Computers & Graphics 2024, Figure 14, as its code computes it
[[nodiscard]] Convexity convexity(const TriangleMesh& mesh, std::size_t samples = 5000,
                                  std::uint64_t seed = 0, const Progress* progress = nullptr);

/// How many pieces of equal size would be as evenly broken: (sum of shares)^2 / sum of share^2.
/// n for n equal shares, near 1 when one piece holds nearly all; 0 when no share is above 0.
///   source  the inverse of Simpson's index; Laakso and Taagepera, 1979
[[nodiscard]] double effectiveCount(std::span<const double> shares);

/// A fragment as a folder has it.
struct EvaluatedFragment {
  std::string name;   ///< its mesh's file, relative to the folder; empty without a mesh
  FragmentMesh mesh;  ///< with its id; without triangles where no mesh was written
  std::size_t droppedTriangles = 0;  ///< with two equal corners, which reading leaves out

  // As the manifest has it.  Of a folder without one, evaluate() takes them from the meshes.
  double share = 0.0;
  double volume = 0.0;
  double area = 0.0;
  double fractureArea = 0.0;
  std::size_t contacts = 0;
};

/// The fragments of one folder.
struct FragmentSet {
  bool manifest = false;                     ///< a fracture of Sherd's
  std::string source;                        ///< the mesh's file name, where there is a manifest
  std::uint64_t seed = 0;                    ///< the fracture's, where there is a manifest
  double voxelSize = 0.0;                    ///< world units, where there is a manifest, else 0
  std::vector<EvaluatedFragment> fragments;  ///< [>= 1]
};

/// Read the fragments of a folder: those that its manifest.json lists, else every file in it that
/// readMesh can read by its name, numbered from 1 in natural order: piece_2 before piece_10.
///   throws  Error(input) it is no folder, or holds neither; the manifest is damaged; a mesh cannot
///           be read, or takes more memory than `options` allow beside those read before it;
///           Error(cancelled)
[[nodiscard]] FragmentSet readFragments(const std::filesystem::path& folder,
                                        const ReadOptions& options = {},
                                        const Progress* progress = nullptr);

struct EvaluateOptions {
  std::size_t samples = 5000;  ///< of convexity and of fit
  std::uint64_t seed = 0;
  double tolerance = 0.01;  ///< FitOptions::tolerance
};

/// One fragment in figures.
struct FragmentFigures {
  int id = 0;
  std::string name;
  double share = 0.0;  ///< of all voxels by the manifest, else of the sum of all volumes
  double volume = 0.0;
  double area = 0.0;
  double fractureArea = 0.0;  ///< without a manifest by the points of fit
  std::size_t contacts = 0;   ///< fragments it touches, without a manifest by the points of fit
  std::optional<MeshQuality> quality;  ///< absent without a mesh
  std::optional<Convexity> convexity;
  std::string noConvexity;  ///< why it is absent, where there is a mesh
  FragmentFit fit;          ///< empty without a mesh
};

/// A whole fracture in figures.
struct Evaluation {
  std::vector<FragmentFigures> fragments;  ///< [>= 1]
  double volume = 0.0;
  double area = 0.0;
  double fractureArea = 0.0;
  std::size_t contacts = 0;  ///< pairs of fragments that touch
  double smallestShare = 0.0;
  double largestShare = 0.0;
  double effectiveFragments = 0.0;
  std::optional<double> convexity;               ///< mean over the fragments that have one
  std::optional<double> convexityStandardError;  ///< of that mean, as of a sample of fragments
  std::size_t sound = 0;  ///< fragments whose mesh is closed, manifold, outward, without degenerate
                          ///< or duplicate triangles
  std::size_t open = 0;   ///< fragments whose mesh is not closed: their volume is not reliable
  MeshQuality quality;    ///< counts added up, the smallest angle, means over all triangles
  Fit fit;
  std::vector<std::string> notes;  ///< what to know about the figures, a sentence each
};

/// Measure a folder's fragments.  Nothing that is wrong with a mesh ends it: what cannot be
/// measured is absent.  A closed mesh that is oriented inwards is turned over, after its quality is
/// told.
///   whole   the unbroken mesh, in the place of the fragments, or null
///   throws  Error(usage) an option out of range; Error(input) the unbroken mesh has no area;
///           Error(cancelled)
[[nodiscard]] Evaluation evaluate(const FragmentSet& set, const TriangleMesh* whole,
                                  const EvaluateOptions& options = {},
                                  const Progress* progress = nullptr);

}  // namespace sherd
