// How a fragment's mesh is made, smoothed and decimated.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// What a fragment's mesh is the surface of.
enum class Surface {
  smooth,  ///< its level set: smooth cuts, the original surface where it was
  labels,  ///< its voxels, stairs and all: the paper's meshes before they are smoothed.
           ///<
           ///< They are the voxels' own faces, two triangles each, and not marching cubes of the
           ///< indicator as in the paper: what a face faces is then exact, volumes are voxel
           ///< counts, and fragments fit without a gap, where marching cubes cut every edge and
           ///< corner off both sides of a crack.  Where voxels of a fragment touch over an edge or
           ///< a corner only, each sheet has vertices of its own, 1/64 voxel apart from the
           ///< other's, so the mesh is edge- and vertex-manifold, and stays so in a program that
           ///< merges equal vertices.
};

/// How the surface between two fragments is made, where it is smooth.
enum class Interface {
  shared,  ///< one mesh of all fragments at once: what two share is the same vertices and faces,
           ///< bit for bit, seen from both sides; smoothed and decimated they share them still
  independent  ///< each fragment's level set meshed by itself, all else being one to it
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

/// How meshes are smoothed, each vertex going towards the mean of its neighbors.
enum class Smoothing {
  taubin,    ///< there by `weight` lambda, then away by mu < 0, 1 / lambda + 1 / mu = kPassBand:
             ///< waves that are long beside the edges stay, so volume and thin parts are kept
  laplacian  ///< there and not back: the paper's, shrinks
};

/// Of Smoothing::taubin: eigenvalues of the mesh's Laplacian (0..2) up to which waves stay.
///   source  Taubin, A signal processing approach to fair surface design, 1995
inline constexpr double kPassBand = 0.1;

/// Of Smoothing::taubin: no more, or the shortest waves grow.
inline constexpr double kMostTaubinWeight = 2.0 / 3.0;

/// Smoothing.  Boundary vertices are those of a face towards another fragment, the rim of the cut
/// included; all others are `other`.  The paper's are Smoothing::laplacian, weights of 0.9 and 0.2
/// and 0.048 iterations a voxel for both (its program has 0.015 for the boundary).
struct SmoothOptions {
  Iterations iterations{};
  double weight = 0.5;  ///< 0..1: 0 stays, 1 goes to the neighbors' mean.  Where there are
                        ///< iterations, 0..kMostTaubinWeight of Smoothing::taubin
  Iterations boundaryIterations{};
  double boundaryWeight = 0.5;  ///< as `weight`, by boundaryIterations; with 0 no boundary vertex
                                ///< moves, and fragments fit as before
  Smoothing method = Smoothing::taubin;
};

struct SurfaceOptions {
  bool levelSets = true;  ///< also make Fragment::surface; without, it is null
  Surface surface = Surface::smooth;
  Interface interface = Interface::shared;
  SmoothOptions smooth{};   ///< of either surface; nothing is smoothed unless iterations are given
  double adaptivity = 0.0;  ///< 0..1, 0 none: then fewer polygons where these change little.  How
                            ///< far a vertex may be, in voxels, from the planes of the faces it
                            ///< stands for (root of the mean square)
  std::vector<std::size_t> triangles{};  ///< then also decimate every mesh to at most so many: each
                                         ///< from 4 up, none twice
};

///   throws  Error(usage) an option out of range
void checkSurfaceOptions(const SurfaceOptions& options);

/// A mesh smoothed: v <- v + weight (m - v), m the mean of its neighbours, for all vertices at once
/// and again, first the other vertices, then the boundary ones.  An iteration of Smoothing::taubin
/// is two such steps, the second with mu for the weight.
///
/// m is taken over the corners of faces, as in the paper's program: a neighbour counts once for
/// each face that both are in, twice on a closed mesh, which is the plain mean.  The program leaves
/// out faces with a boundary vertex in the first pass; the paper does not say so, and here they
/// count: without them the surface draws away from its rims, which then stand out as spikes (an
/// amphora of 128 voxels in 8 pieces loses 4.7 % of its volume by the paper's weights, with
/// them 3.6 %).
///
/// With Interface::shared all fragments are smoothed at once: a vertex that several have goes to
/// the mean of where each of them would move it, so the two sides stay together; and surfaces of
/// pores and crumbs, under 100 triangles, stay as they are, or they would shrink to a point.  Of
/// Surface::labels the two sides' meshes are mirror images inside an interface and move alike, as
/// far from the rim as there are iterations; at the rim and where more than two fragments meet
/// each side has neighbours of its own, and the sides part.
///   facing       [triangles] 0 original surface, else the fragment on the other side
///   longestSide  voxels, for the number of iterations
///   cost         triangles * iterations
///   throws       Error(cancelled)
///   source       Generating implicit object fragment datasets for machine learning, 3.3 and 4.1
[[nodiscard]] TriangleMesh smoothed(TriangleMesh mesh, std::span<const std::uint16_t> facing,
                                    const SmoothOptions& options, int longestSide,
                                    const Progress* progress = nullptr);

/// A mesh of fewer triangles, and what each faces.
struct CoarseMesh {
  TriangleMesh mesh;                  ///< closed and manifold as what it was made from
  std::vector<std::uint16_t> facing;  ///< [triangles]
  std::size_t asked = 0;              ///< triangles asked for
};

/// Decimate by collapsing edges, the least quadric error first, until at most so many triangles are
/// left.  No collapse changes the topology: neither that of the surface nor of the regions of equal
/// facing, whose borders are simplified as lines and held in place by quadrics of their own; where
/// three regions meet the vertex stays where it is.  With Interface::shared all fragments are
/// decimated at once, until none has more, and share their surfaces as before.  So a mesh may keep
/// more triangles than were asked for: CoarseMesh::mesh tells.
///   mesh       closed, edge- and vertex-manifold
///   triangles  [k] any order; each result goes on from the next larger one's
///   return     [k] in the order of `triangles`
///   source     Garland, Heckbert, Surface simplification using quadric error metrics, 1997
[[nodiscard]] std::vector<CoarseMesh> decimated(const TriangleMesh& mesh,
                                                std::span<const std::uint16_t> facing,
                                                std::span<const std::size_t> triangles);

}  // namespace sherd
