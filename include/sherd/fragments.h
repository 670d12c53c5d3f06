// Fragments: level set, mesh, mass properties and contacts; meshing, smoothing and decimation.
#pragma once

#include <sherd/labels.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// The source of a fragment's mesh.
enum class Surface {
  smooth,  ///< its level set: smooth cuts and an unchanged original surface.
           ///<
           ///< Vertices at creases and corners of the input lie on them, by the planes of the
           ///< triangles that cross the edges between voxel centers.  Creases less than a voxel
           ///< apart share a vertex; the tip of one between voxel centers outside may be half a
           ///< voxel off.  Solids of volumes and shells have the rounded edges of their distances.
  labels,  ///< its voxels: the paper's meshes before smoothing.
           ///<
           ///< The mesh consists of the voxels' faces, two triangles each, not of marching cubes of
           ///< the indicator as in the paper: so neighbors of faces are exact, volumes are voxel
           ///< counts, and fragments fit without a gap, where marching cubes would cut off edges
           ///< and corners on both sides of a crack.  Where voxels of a fragment share only an edge
           ///< or a corner, each sheet has its own vertices, 1/64 voxel apart, so the mesh is edge-
           ///< and vertex-manifold and stays so if a program merges equal vertices.
  exact,   ///< the input's own triangles, cut by the cracks: outside the cracks every vertex and
           ///< triangle stays as it is, bit for bit.  Needs Solid::mesh, whose holes are closed by
           ///< faces of their own; where it does not succeed, fragments of the bodies concerned get
           ///< Surface::smooth, see SmoothBodies
  automatic  ///< exact, or smooth where the input is no mesh or the other options ask for what
             ///< exact surfaces do not have, see surfaceOf
};

/// How the surface between two fragments is meshed with Surface::smooth.
enum class Interface {
  shared,  ///< one mesh of all fragments: both sides of a contact have the same vertices and faces,
           ///< bit for bit, also after smoothing and decimation
  independent  ///< each fragment is meshed by random points of its own surface: no vertex is a
               ///< neighbor's to the bit, after smoothing and decimation neither, and the grid of
               ///< the voxels is not found in them
};

/// A number of iterations: `count`, and `perVoxel` times the solid's longest side in voxels,
/// truncated.
struct Iterations {
  int count = 0;          ///< 0..1000
  double perVoxel = 0.0;  ///< 0..1

  [[nodiscard]] int over(int longestSide) const {
    return count + static_cast<int>(perVoxel * longestSide);
  }
};

/// Smoothing methods; vertices move towards the mean of their neighbors.
enum class Smoothing {
  taubin,    ///< a step with lambda = `weight`, then one with mu < 0, 1 / lambda + 1 / mu =
             ///< kPassBand: long waves stay, so volume and thin features are preserved
  laplacian  ///< a step with `weight` only, as in the paper; shrinks
};

/// For Smoothing::taubin: the pass band, eigenvalues of the mesh's Laplacian (0..2) that stay.
///   source  Taubin, A signal processing approach to fair surface design, 1995
inline constexpr double kPassBand = 0.1;

/// For Smoothing::taubin: above this weight, the shortest waves grow.
inline constexpr double kMostTaubinWeight = 2.0 / 3.0;

/// Smoothing.  Boundary vertices are those of faces with a neighbor, the contact boundary included;
/// they have options of their own.  The paper uses Smoothing::laplacian, weights of 0.9 and 0.2 for
/// the boundary, and 0.048 iterations per voxel for both (its program 0.015 for the boundary).
struct SmoothOptions {
  Iterations iterations{};
  double weight = 0.5;  ///< 0..1: 0 does not move, 1 moves to the neighbors' mean; for
                        ///< Smoothing::taubin at most kMostTaubinWeight if there are iterations
  Iterations boundaryIterations{};
  double boundaryWeight = 0.5;  ///< as `weight`, for boundaryIterations; with 0 boundary vertices
                                ///< stay, and fragments fit as before
  Smoothing method = Smoothing::taubin;
};

/// Self-affine noise by which a surface is displaced along its normals.  Percentages are of the
/// diagonal of the mesh's box.
struct NoiseOptions {
  double rms = 0.0;         ///< rms displacement, 0..5 %; 0: none
  double hurst = 0.6;       ///< Hurst exponent, 0.1..1
  double wavelength = 3.0;  ///< 0.01..100 %: displacements farther apart are nearly independent,
                            ///< and nearer ones differ by distance^hurst.  The defaults are those
                            ///< that fit the joints of a really broken brick, docs/realism.md
};

/// SurfaceOptions::adaptivity: where the input is piecewise flat, the triangles in each plane are
/// merged.  That is so where at least half of the area is flat at the scale of a voxel.
inline constexpr double kAutoAdaptivity = -1.0;

/// How far the triangles merged by kAutoAdaptivity may be from their common plane, voxels: those of
/// the original surface, and those of cracks.
inline constexpr double kPlanarTolerance = 0.005, kPlanarCrackTolerance = 0.1;

struct SurfaceOptions {
  bool levelSets = true;  ///< also makes Fragment::surface; else it is null
  bool meshes = true;     ///< makes Fragment::mesh; else it is empty, which takes 0.6 of the time;
                          ///< volume, areas and contacts are the same.  Only without
                          ///< level sets, for Surface::smooth and Interface::shared as they are
                          ///< meshed: neither smoothed nor decimated, with any adaptivity but one
                          ///< above 0
  bool points = false;    ///< makes what points are sampled of, FractureResult::unmerged, so that
                          ///< points do not depend on merged triangles
  Surface surface = Surface::smooth;  ///< RunOptions, of which `sherd fracture` and Python are,
                                      ///< have Surface::automatic
  Interface interface = Interface::shared;
  SmoothOptions smooth{};               ///< for both surfaces; the default does not smooth
  double adaptivity = kAutoAdaptivity;  ///< 0..1 voxels, or kAutoAdaptivity; 0: none.  Merges
                                        ///< polygons in flat regions: the largest rms distance of
                                        ///< a vertex from the planes of the faces it replaces.  Of
                                        ///< Surface::exact only cracks, and if not 0 at least
                                        ///< kPlanarCrackTolerance, as kAutoAdaptivity
  NoiseOptions mismatch{};      ///< displaces each side of a crack by noise of its own, which falls
                                ///< to nothing at the contact boundary, so that meshes stay closed
                                ///< and meet the original surface where they did.  Meshes only:
                                ///< labels, level sets and contacts are those without.  Cracks keep
                                ///< all triangles, so adaptivity must not be above 0
  double mismatchCommon = 0.0;  ///< 0..1, the share of the mismatch's variance by which both sides
                                ///< move alike
  NoiseOptions scanNoise{};     ///< displaces all of a fragment's mesh, as scanning it does.  Not
                                ///< with Surface::exact, whose outside has the input's triangles
  std::vector<std::size_t> triangles{};  ///< also decimates every mesh to at most each of these
                                         ///< numbers: >= 4, no duplicates
};

/// Returns what Surface::automatic stands for where the input is a mesh: Surface::smooth if
/// vertices are smoothed, interfaces are independent, or there are no meshes, else Surface::exact.
/// Other surfaces stand for themselves.
[[nodiscard]] Surface surfaceOf(const SurfaceOptions& options);

/// Checks the options.
///   throws  Error(usage) an option out of range
void checkSurfaceOptions(const SurfaceOptions& options);

/// Returns a smoothed mesh: v <- v + weight (m - v) for all vertices at once, m the mean of the
/// neighbors of v, in two passes: first non-boundary vertices, then boundary vertices.  An
/// iteration of Smoothing::taubin is two such steps, the second with mu as the weight.
///
/// m is taken over the corners of faces, as in the paper's program: a neighbor counts once for each
/// common face, twice on a closed mesh, which is the plain mean.  The program ignores faces with a
/// boundary vertex in the first pass, which the paper does not mention; here they count.  Without
/// them the surface recedes from the contact boundaries, which then stand out as spikes (an amphora
/// of 128 voxels in 8 pieces loses 4.7 % of its volume with the paper's weights, with them 3.6 %).
///
/// With Interface::shared all fragments are smoothed at once: a shared vertex moves to the mean of
/// its positions in each fragment, so the sides stay together.  Components under 100 triangles,
/// such as pores and islands, are not moved, because they would shrink to a point.  With
/// Surface::labels the meshes of the two sides are mirror images and move alike, except within as
/// many edges of the contact boundary as there are iterations: there, and where more than two
/// fragments meet, the sides have different neighbors and separate.
///   mesh         its boundary vertices are those of triangles with a neighbor
///   longestSide  voxels, for the number of iterations
///   cost         triangles * iterations
///   throws       Error(cancelled)
///   source       Generating implicit object fragment datasets for machine learning, 3.3 and 4.1
[[nodiscard]] TriangleMesh smoothed(TriangleMesh mesh, const SmoothOptions& options,
                                    int longestSide, const Progress* progress = nullptr);

/// Decimates a mesh by edge collapses in the order of quadric error, until at most the requested
/// number of triangles is left.  Collapses keep the topology of the surface and of its regions of
/// equal neighbor: borders of regions are simplified as polylines with their own quadrics, and
/// vertices where three regions meet do not move.  So a mesh may keep more triangles than
/// requested.  A fragment's regions also end at seams of the input's attributes, except where a
/// chart meets itself. With Interface::shared all fragments are decimated at once and still share
/// their contact surfaces.
///   mesh       closed, edge- and vertex-manifold
///   triangles  [k] any order; each result continues from the next larger one
///   return     [k] in the order of `triangles`, closed and manifold like `mesh`, with neighbors
///   source     Garland, Heckbert, Surface simplification using quadric error metrics, 1997
[[nodiscard]] std::vector<TriangleMesh> decimated(const TriangleMesh& mesh,
                                                  std::span<const std::size_t> triangles);

/// The contact of a fragment with another one.
struct Contact {
  int fragment = 0;        ///< id of the other fragment
  double area = 0.0;       ///< world units squared, equal on both sides
  glm::dvec3 normal{0.0};  ///< mean direction towards the other fragment, unit length
  glm::dvec3 centroid;     ///< of the shared surface, equal on both sides
  bool isThin = false;     ///< the surfaces alone touch: no voxels of the two share a face
};

/// A face that was cut along seams of the input's attributes.
struct CutFace {
  std::uint32_t first = 0;  ///< index of the first of its parts in the mesh
  std::uint32_t count = 0;  ///< of its parts, which follow one another
  glm::uvec3 corner{0};     ///< of the whole face
};

/// One fragment.  Volume, centroid, inertia and areas are those of its mesh; without
/// SurfaceOptions::meshes those of the surface before triangles are merged.
struct Fragment {
  int id = 0;  ///< 1..n
  std::uint64_t voxels = 0;
  VoxelBox voxelBox;          ///< of its inside voxels
  ConstFloatGridPtr surface;  ///< level set, world units, transform and background of the solid;
                              ///< null without SurfaceOptions::levelSets
  TriangleMesh mesh;  ///< closed, edge-manifold, oriented outwards, world units, with neighbors;
                      ///< empty without SurfaceOptions::meshes
  Surface meshedAs = Surface::smooth;  ///< SurfaceOptions::surface, or what replaced it
  MassProperties mass;
  double area = 0.0;
  double fractureArea = 0.0;      ///< area of the triangles with neighbor > 0
  std::vector<Contact> contacts;  ///< ascending by fragment
  std::vector<TriangleMesh>
      coarse{};  ///< [SurfaceOptions::triangles] decimated meshes, with neighbors
  std::vector<CutFace> cutFaces{};  ///< ascending; none where the mesh was simplified afterwards
};

/// Bodies of the input whose fragments have Surface::smooth, since Surface::exact fails for them
/// and succeeds for others.
struct SmoothBodies {
  std::string reason{};                    ///< a clause
  std::vector<int> fragments{};            ///< ids, ascending
  std::vector<std::uint32_t> triangles{};  ///< of the input, ascending
};

/// Returns a fragment's mesh with its cut faces whole, as it is without attributes of the input.
/// Vertices of the cuts stay, without faces.
[[nodiscard]] TriangleMesh uncut(const Fragment& fragment);

/// Meshes made by Surface::exact.
struct ExactSurface;

/// The mesh of the intact solid's surface, from which fragments copy what the cuts do not change.
struct IntactSurface;

/// The surfaces of all fragments of a fracture, of which points are sampled.
class FragmentSurfaces;

/// Meshes the intact solid.  Saves time if a solid is broken several times with Surface::smooth and
/// Interface::shared.
[[nodiscard]] std::shared_ptr<const IntactSurface> intactSurface(const Solid& solid);

struct ExtractOptions {
  SurfaceOptions surface{};          ///< how meshes are made; level sets do not depend on it
  const Labels* uneroded = nullptr;  ///< the labels before erosion, or null without erosion;
                                     ///< neighbors of eroded faces and contacts are computed from
                                     ///< them
  std::shared_ptr<const IntactSurface>
      intact{};                   ///< of this solid, or null; affects only the speed
  ExactSurface* exact = nullptr;  ///< what Surface::exact is, which is taken; null: it is made
  std::uint64_t seed = 0;         ///< where the vertices of Interface::independent are
};

/// Cuts every fragment out of the solid.  A fragment's level set is max(solid, distance to the
/// cut). Where labels are the Voronoi cells of two seeds, the cut is the plane half way between
/// them; elsewhere it is where the labels' indicators, smoothed by two binomial passes, are equal.
/// So the cut is smooth, neighbors share it bit for bit, and the original surface does not move.
/// Every inside voxel's center lies in its owner's level set and in no other.
///   labels  of this solid's blocks: each id 1..fragmentCount with at least one voxel
///   return  [fragmentCount] ascending by id
///   throws  Error(usage) the labels are of other blocks, an inside voxel has none, an option is
///   out
///           of range; Error(cancelled)
[[nodiscard]] std::vector<Fragment> extractFragments(const Solid& solid, const Labels& labels,
                                                     const ExtractOptions& options = {},
                                                     const Progress* progress = nullptr);

/// Returns the boundary loops of a fragment's contacts.
///   return  for each neighbor id: closed loops of indices of the mesh's vertices, with the
///           contact's faces on the left seen from outside.  A loop may visit a vertex twice
[[nodiscard]] std::map<int, std::vector<std::vector<std::uint32_t>>> boundaryLoops(
    const Fragment& fragment);

/// Returns the smooth mesh of the intact solid, equal to that of a fracture into one fragment.
///   adaptivity  0 or kAutoAdaptivity
[[nodiscard]] TriangleMesh solidMesh(const Solid& solid, double adaptivity = kAutoAdaptivity);

}  // namespace sherd
