// The input's own triangles, cut by the cracks.
#pragma once

#include <sherd/fragments.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "remesh/complex.h"

namespace sherd {

/// A body of a fragment that another one got, as a fragment is one body.
struct MovedBody {
  std::uint16_t from = 0, to = 0;  ///< ids
  TriangleMesh body{};             ///< closed, world space
};

/// The meshes of all fragments, or why there are none.
struct ExactSurface {
  std::vector<LabeledMesh> meshes{};   ///< [fragments] by id, with TriangleMesh::source by the
                                       ///< triangles of the mesh that is cut; their
                                       ///< TriangleMesh::neighbor is empty, or known
  std::string failure{};               ///< a clause; empty if `meshes` are valid
  std::vector<SmoothBodies> smooth{};  ///< whose fragments have no meshes, as others could be cut
  bool isDegenerate = false;           ///< cracks that are displaced a little may succeed
  UnitedBodies united{};               ///< what was cut, if it is not the input's mesh
  std::vector<MovedBody> moved{};  ///< one after the other: those of later ones may hold earlier
};

/// What is known of points away from the cracks.
struct SpaceLabels {
  std::function<std::uint16_t(const glm::dvec3&)> labelAt;       ///< of the nearest voxels; 0: none
  std::function<std::uint16_t(const glm::dvec3&)> nearestLabel;  ///< never 0
  std::function<bool(const glm::dvec3&)> isInside;
};

/// Cuts a mesh by the cracks, all at once, and assembles the fragments: the parts of the mesh on a
/// fragment's side of the cracks, and the parts of the cracks within the mesh, which both sides
/// share bit for bit.  Vertices and triangles of the input that no crack meets stay as they are.
///   source     closed, consistently oriented, without self-intersections where cracks meet it;
///              vertices at one position are one vertex
///   cracks     overhang the source, and do not cross themselves
///   fragments  number of labels; Labels::kEroded has no mesh
///   throws     Error(cancelled)
[[nodiscard]] ExactSurface exactSurface(const TriangleMesh& source, const LabeledComplex& cracks,
                                        std::size_t fragments, const SpaceLabels& space,
                                        const Progress* progress = nullptr);

}  // namespace sherd
