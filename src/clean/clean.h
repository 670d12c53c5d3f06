// Removes what cuts leave: edges shorter and triangles thinner than a tolerance.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <cstddef>
#include <vector>

#include "clean/clean_face.h"

namespace sherd {

/// A vertex at which a piece touches itself.
struct Pinch {
  std::uint16_t piece = 0;
  std::uint32_t vertex = 0;
};

/// The faces of all pieces.
struct CleanMesh {
  std::vector<glm::dvec3> vertices{};  ///< of different positions
  std::vector<bool> isFixed{};         ///< [vertices] of the mesh that was cut: they do not move
  std::vector<CleanFace> faces{};      ///< closed surfaces of pieces
  std::vector<Pinch> pinches{};        ///< all that there are
};

struct CleanOptions {
  double tolerance = 0.0;  ///< world units
  double spacing = 0.0;    ///< of floats where they are farthest apart: pieces are to be sound with
                           ///< their vertices rounded to these too; 0: in double precision only
};

struct Cleaned {
  CleanMesh mesh{};
  std::size_t changes = 0;
};

/// Merges vertices that are nearer than a tolerance to each other or to an edge.  Cracks move by
/// a few tolerances at most; the outside stays the same set of points, as a point of a triangle or
/// an edge of the mesh moves within that alone.  All faces at a vertex change together, so that
/// pieces stay equal bit for bit where they touch.  A change that would join parts of a piece,
/// flip a face, or let faces meet is not made, so that some short edges may stay; those between
/// vertices of the mesh do.
///   cut     the mesh to whose triangles CleanFace::source refers
///   return  `changes` 0: the same mesh; its vertices keep their numbers, some have no faces
///   cost    faces * log(faces), and changes
///   throws  Error(cancelled)
[[nodiscard]] Cleaned cleaned(CleanMesh mesh, const TriangleMesh& cut, const CleanOptions& options,
                              const Progress* progress = nullptr);

}  // namespace sherd
