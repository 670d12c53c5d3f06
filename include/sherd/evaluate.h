// Metrics of a finished fracture: mesh quality, fit, convexity, and statistics beside real ones.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// Statistics of a mesh.  Edges of triangles with two equal corners are not counted.
struct MeshQuality {
  /// Bins of MeshQuality::smallestAngles: 5 degrees each, 0..60; 60 is in the last.
  static constexpr std::size_t kAngleBins = 12;

  std::size_t vertices = 0;  ///< used by a triangle
  std::size_t triangles = 0;
  std::size_t components = 0;  ///< connected by shared vertices

  // Each edge is counted at most once.
  std::size_t boundaryEdges = 0;        ///< of one triangle: the mesh is open there
  std::size_t nonManifoldEdges = 0;     ///< of three or more triangles
  std::size_t flippedEdges = 0;         ///< of two triangles with opposite orientation
  std::size_t nonManifoldVertices = 0;  ///< with more than one fan of triangles

  std::size_t degenerateTriangles = 0;  ///< area 0 in double precision
  std::size_t duplicateTriangles = 0;   ///< with the corners of an earlier one, in any order

  double smallestAngle = 0.0;      ///< degrees, of all corners; 0..60
  double meanSmallestAngle = 0.0;  ///< degrees, mean over the triangles of their smallest angle
  double sliverShare = 0.0;        ///< share of triangles with an angle below 10 degrees
  std::array<std::size_t, kAngleBins> smallestAngles{};  ///< triangles by their smallest angle

  double volume = 0.0;  ///< by the divergence theorem; valid if the mesh is closed

  /// No boundary edges, and every edge is used equally often in both directions (touching sheets
  /// included), so the mesh has an inside and a volume.
  bool closed = false;
  /// Every edge has two triangles of equal orientation, and every vertex one fan.
  bool manifold() const {
    return boundaryEdges + nonManifoldEdges + flippedEdges + nonManifoldVertices == 0;
  }
  /// Closed with a positive volume.
  bool outward() const { return closed && volume > 0.0; }
};

/// Measures a mesh.
///   mesh  any, also without triangles
///   cost  triangles * log triangles
[[nodiscard]] MeshQuality meshQuality(const TriangleMesh& mesh);

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
  int split = 0;  ///< that it comes from, 1..splits; 0: none, or not known
};

/// The fragments of one folder.
struct FragmentSet {
  bool manifest = false;                     ///< written by Sherd, with a manifest
  std::string source;                        ///< the mesh's file name, from the manifest
  std::uint64_t seed = 0;                    ///< the fracture's seed, from the manifest
  double voxelSize = 0.0;                    ///< world units, from the manifest, else 0
  std::vector<EvaluatedFragment> fragments;  ///< [>= 1]
  /// [splits] of a fracture by splits, from the manifest: of split i + 1, the split that the piece
  /// comes from which it divides, at most i; 0: none
  std::vector<int> splitParents{};
  /// From the manifest: what positions of the fragments lack to be those of the source.
  std::optional<glm::dvec3> offset{};
  CoordinateSystem coordinates{};  ///< from the manifest, else of the first mesh
};

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

/// How the cracks of a fragment are divided into faces.
enum class FaceRule {
  planes,     ///< a face is a connected part of the cracks that lies in one plane, however many
              ///< neighbors are behind it
  neighbors,  ///< a face is a connected part of the cracks towards one neighbor
  splits,     ///< a face is a connected part of the crack of one split, see
              ///< FragmentSet::splitParents; where none is known it is as for neighbors
  facets      ///< a face is a plane but for relief, as a hand draws them on rough cracks: as for
          ///< `planes`, with a tolerance of 5 % of the root of the fragment's area of cracks, so
          ///< that two equal squares are one up to an angle of 27 degrees, and a least area of
          ///< 2 % of it
};

struct StatisticsOptions {
  std::optional<FaceRule> faces{};  ///< absent: splits where they are known; else planes, or
                                    ///< facets if the cracks are rough, see
                                    ///< FractureStatistics::planeShare
  double unit = 0.0;                ///< world units, 1e-100..1e100, the unit of the next two; 0:
                      ///< FragmentSet::voxelSize, or without one 1/128 of the longest side of all
                      ///< fragments' box
  double planeTolerance = 0.125;  ///< units, 1e-9..1e9: rms distance up to which triangles are in
                                  ///< one plane
  double leastFace = 0.5;  ///< units squared, 0..1e9: faces of a smaller area are not counted
  std::optional<glm::dvec3> propagation{};  ///< of the cracks, not 0: the direction of Hurst
                                            ///< exponents; absent: the coordinate axes
  std::size_t simulations = 2000;           ///< for each p-value; 1..1000000
  std::uint64_t seed = 0;                   ///< of these
  double tolerance = 0.01;  ///< FitOptions::tolerance, where meshes have no neighbors
};

/// The shape of one fragment.  Vertices of a fragment are points where three faces of it meet.
struct FragmentShape {
  int id = 0;
  std::string name;              ///< mesh file, or empty
  double share = 0.0;            ///< of the sum of all fragments' volumes
  double breakShare = 0.0;       ///< share of its surface that is crack
  std::size_t contacts = 0;      ///< fragments it touches, by the manifest, else as `neighbors`
  bool hasMesh = false;          ///< with an area; the values below are 0 without one
  std::size_t object = 0;        ///< 1..FractureStatistics::objects: those that contacts join
  std::size_t neighbors = 0;     ///< those behind cracks of at least the least face's area
  std::size_t faces = 0;         ///< of the cracks
  std::size_t vertices = 0;      ///< of the cracks' faces alone
  bool interior = false;         ///< has less original surface than the least face
  std::size_t flatFaces = 0;     ///< `faces`, and the planes of the original surface
  std::size_t flatVertices = 0;  ///< where three of these meet
  std::optional<std::size_t> corners{};  ///< of a plate's fragment: lines where two faces of cracks
                                         ///< meet, at least half as long, along the thin axis, as
                                         ///< the fragment; absent where it has part of the rim
};

/// The mean of a value over fragments.
struct MeanFigure {
  std::size_t count = 0;  ///< >= 1
  double mean = 0.0;
  double deviation = 0.0;                      ///< standard deviation, of a sample; 0 for one
  [[nodiscard]] double standardError() const;  ///< deviation / sqrt(count)
};

/// A distribution fitted to sizes, and the test of the fit.
struct DistributionFit {
  double parameter = 0.0;
  double standardError = 0.0;
  double distance = 0.0;  ///< of Kolmogorov and Smirnov: the largest between the distributions
  double pValue = 0.0;    ///< share of samples drawn from the fit, each fitted again, with at least
                          ///< this distance: below 0.05 the distribution is rejected
};

/// Fits of sizes.  A fit is absent for fewer than 5 sizes, and where they do not differ.
struct SizeFits {
  std::size_t count = 0;  ///< sizes above 0: others are left out
  double mean = 0.0, least = 0.0, greatest = 0.0;
  std::optional<DistributionFit> exponential{};  ///< parameter: the mean
  std::optional<DistributionFit> lognormal{};  ///< parameter s: standard deviation of the logarithm
  std::optional<DistributionFit> power{};  ///< parameter tau: n(size) ~ size^-tau between the least
                                           ///< and the greatest
};

/// Fits distributions to sizes, by maximum likelihood.
///
/// The p-value is by simulation, so that it is valid for fitted parameters (Lilliefors' tests, of
/// an exponential, and of a normal distribution of logarithms).  Of more than 1000 sizes, samples
/// of 1000 are drawn, and Stephens' modified distances compared.
///   sizes        [n] finite
///   simulations  for each p-value; 0: p-values are 1
///   throws       Error(cancelled)
///   source       Lilliefors, JASA 62:399 (1967) and 64:387 (1969); Stephens, JASA 69:730 (1974);
///                Aban, Meerschaert, Panorska, JASA 101:270 (2006) for the power law of two bounds;
///                Clauset, Shalizi, Newman, SIAM Review 51:661 (2009) for its test
[[nodiscard]] SizeFits fitSizes(std::span<const double> sizes, std::size_t simulations = 2000,
                                std::uint64_t seed = 0, const Progress* progress = nullptr);

/// The roughness of cracks along one direction.
struct RoughnessAlong {
  std::string direction;   ///< "x", "y", "z", or "propagation" and "front", at right angles to it
  std::size_t cracks = 0;  ///< that are long enough, >= 1
  double hurst = 0.0;      ///< slope of second differences, mean over the cracks by area
  double deviation = 0.0;  ///< standard deviation of the slopes, 0 for one crack
  std::vector<double> lags{};         ///< world units, ascending
  std::vector<double> correlation{};  ///< [lags] sqrt <(h(x + lag) - h(x))^2>, world units
};

/// How well the two sides of the cracks fit, for fragments in assembled positions.  Lengths are
/// shares of the diagonal of an object, the box of fragments that contacts join.
struct JointStatistics {
  /// Quantiles, by area, of the distance of points on cracks from the neighbor behind them: 10, 50,
  /// 90 and 99 %.  Points inside the neighbor count as those outside of it.
  std::array<double, 4> gap{};
  /// Rms difference of the heights of both sides over the plane that fits a contact, without its
  /// mean and tilt, which another position would remove; mean square over the contacts by area.
  /// Twice a side's own variance where both are moved independently.  Absent without contacts where
  /// 16 nodes, one unit apart, have both heights.
  std::optional<double> difference{};
  std::optional<double> removed{};  ///< share of the area of cracks towards the fragments that is
                                    ///< farther from them than the tolerance, where neighbors are
                                    ///< known: what was there is lost, or worn off
  double deepShare = 0.0;  ///< share of all fragments' surface that is inside the neighbor behind
                           ///< it and farther from its surface than the tolerance
};

/// What vertices have of the grid of voxels that meshes were made on, along the coordinate axes.
/// Vertices are those within cracks, up to 700 of each of up to 24 fragments.  A plane across an
/// axis has a power of hundreds, grid or not; so cracks along the axes hide what there is.
struct GridTrace {
  std::size_t fragments = 0;  ///< measured, >= 1: those with 100 such vertices
  double pitch = 0.0;         ///< world units
  bool isKnown = false;  ///< by FragmentSet::voxelSize or StatisticsOptions::unit; else the pitch
                         ///< of the greatest power, from a third of a median edge to three
  double power = 0.0;  ///< |mean exp(2 pi i x.d / pitch)|^2 along the axes d, divided by that along
                       ///< random directions, both as geometric means: 1 if there is no grid
  double standardError = 0.0;  ///< of the power, over the fragments; 0 for one
  double found = 0.0;  ///< share of the fragments whose direction of the greatest power is within
                       ///< one degree of an axis; of random ones 0.0005 are
};

/// Statistics of a fracture, to be compared with real ones.
struct FractureStatistics {
  std::vector<FragmentShape> fragments;  ///< [>= 1]
  FaceRule rule = FaceRule::planes;
  double planeShare = 0.0;  ///< the share of a contact that lies in one plane, which is even within
                            ///< the tolerance, mean by area: below
                            ///< 0.5 cracks are rough
  bool knownNeighbors = false;  ///< recorded by the meshes; else by distance, as fit() does
  double unit = 0.0;            ///< world units: what StatisticsOptions::unit came out as
  double leastArea = 0.0;       ///< world units squared: that of the least face counted
  double planeTolerance = 0.0;  ///< world units

  std::optional<MeanFigure> interiorFaces, interiorVertices;  ///< of interior fragments
  std::optional<MeanFigure> interiorNeighbors;
  std::optional<MeanFigure> faces, vertices;          ///< of cracks, of all fragments
  std::optional<MeanFigure> flatFaces, flatVertices;  ///< absent where the original surface is bent
  std::optional<MeanFigure> corners;                  ///< absent unless a plate
  std::optional<int> thinAxis;  ///< 0..2 of a plate, whose box is at most a quarter as thick as the
                                ///< middle one of its sides
  std::optional<MeanFigure> contacts, neighbors;  ///< per fragment
  double breakShare = 0.0;                        ///< median over the fragments
  SizeFits sizes;                                 ///< of the shares
  std::optional<glm::dvec3> orientation;        ///< eigenvalues of the mean of n n^T over the area
                                                ///< of cracks, descending; 1/3 each if isotropic
  std::array<glm::dvec3, 3> orientationAxes{};  ///< their eigenvectors
  std::optional<double> roughness;        ///< rms height of cracks over their planes, world units;
                                          ///< absent where they are not rough
  std::vector<RoughnessAlong> hurst;      ///< absent directions: no crack is long enough
  std::optional<JointStatistics> joints;  ///< absent without meshes that touch
  std::optional<GridTrace> grid{};        ///< absent without enough vertices within cracks
  double unmatched = 0.0;   ///< share of the area of cracks whose neighbor has no mesh here
  double coincident = 0.0;  ///< share of vertices that have one of another fragment within 2e-6 of
                            ///< the diagonal
  std::size_t objects = 0;  ///< sets of fragments that no contact joins, of those with a mesh: in
                            ///< assembled positions several objects, or parts of one between which
                            ///< fragments are missing
  std::optional<double> consecutiveExcess;  ///< share of pairs with consecutive ids that touch,
                                            ///< less that of all pairs; 0 in the mean if the order
                                            ///< says nothing; absent for fewer than 3 fragments
  std::vector<std::string> notes;           ///< what is absent, and why, one sentence each
};

/// Measures the shapes of fragments, their sizes and their cracks.
///
/// Planes grow by merging the two adjacent ones that are nearest to a common plane, first.  The
/// limit is the tolerance, for the rms distance of each from the common plane beyond that from its
/// own, and three times the tolerance for the distance itself.  They start as the contacts with one
/// neighbor that are planar, within that limit, since meshes bend a little where cracks meet, and
/// else as triangles.  Faces smaller than the least are given to the neighbor with the longest
/// common boundary.  Points at which three faces meet are one vertex if they are within half a
/// unit, or within two units with the same three faces.
///
/// Heights of rough cracks are those over the plane that fits the contact of two fragments, in a
/// grid of one unit.  A Hurst exponent is the slope of the logarithm of the rms second difference
/// over lags from 4 units to a tenth of the crack's length or 10 units, of contacts that are 30
/// units long or more; one of 30 to 60 units varies by 0.1 to 0.2, so the mean of many is needed.
///   set     meshes need not be closed; without any, only sizes and contacts are measured
///   cost    triangles * log triangles; fragments * simulations * log fragments
///   throws  Error(usage) an option out of range; Error(cancelled)
///   source  Garland, Willmott, Heckbert, Hierarchical face clustering, 2001; for the correlation
///           Ponson, Bonamy, Bouchaud, PRL 96:035506 (2006); for exponents of second differences
///           Kent, Wood, J. R. Stat. Soc. B 59:679 (1997)
[[nodiscard]] FractureStatistics statistics(const FragmentSet& set,
                                            const StatisticsOptions& options = {},
                                            const Progress* progress = nullptr);

/// A figure of real fragments, or of a model, from the literature.
struct PublishedFigure {
  const char* quantity;  ///< the JSON key of the value measured: "interior_faces", ...
  double low, high;      ///< equal for one value
  const char* of;        ///< what was measured
  const char* source;
};

/// Returns the figures that statistics are printed beside.
[[nodiscard]] std::span<const PublishedFigure> publishedFigures();

/// Plots faces, sizes with their fits, and cracks or contacts, as SVG.
///   title  headline
[[nodiscard]] std::string statisticsPlot(const FractureStatistics& statistics,
                                         const std::string& title);

/// Plots shares, convexity and smallest angles as SVG.
///   title      headline
///   voxelSize  world units, for the surface error in voxels; 0: as a share of the diagonal
[[nodiscard]] std::string evaluationPlot(const Evaluation& evaluation, const std::string& title,
                                         double voxelSize = 0.0);

}  // namespace sherd
