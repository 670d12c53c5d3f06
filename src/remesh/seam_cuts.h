// Cuts the faces of fragments along the seams of the input's attributes.
#pragma once

#include <sherd/fragments.h>
#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "remesh/complex.h"

namespace sherd {

class Seams;

/// A mesh whose faces are cut along seams.  The vertices are those of the uncut mesh, with new ones
/// after them; the parts of a face take its place in the order of faces.
struct SeamCutMesh {
  TriangleMesh mesh;  ///< with neighbors, if the uncut mesh has them
  std::vector<CutFace> faces;
  std::vector<std::uint32_t> uncut;  ///< [triangles] the face that each is of
  /// [new vertices] the ends of the edge that it is on, and its number along the edge from the end
  /// that is first by position; within a face a corner twice.
  std::vector<std::array<std::uint32_t, 3>> parent;
};

/// Cuts faces where their edges pass seams, so that each part lies on one side of them.
///
/// An edge is cut where Seams has it: by the positions of its ends alone, so that fragments that
/// share the edge get the same vertices.  A face of the original surface also gets a vertex where a
/// seam turns or several meet in it.  The surface does not move: new vertices lie on their faces.
///   mesh  world units, without attributes; faces with neighbor 0 are of the original surface
///   cost  of edges a few voxels around seams
[[nodiscard]] SeamCutMesh cutAlong(TriangleMesh mesh, const Seams& seams, const GridFrame& frame);

/// The same for all labels of a complex, in place; new vertices with the same position get the same
/// number, and faces their charts.
///   return  [meshes] their cut faces
std::vector<std::vector<CutFace>> cutTogether(std::span<LabeledMesh> meshes, const Seams& seams,
                                              const GridFrame& frame);

}  // namespace sherd
