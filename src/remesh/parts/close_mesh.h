// A closed mesh for Surface::exact, where the input has holes.
#pragma once

#include <sherd/progress.h>
#include <sherd/solid.h>

#include <memory>
#include <string>

namespace sherd {

struct ClosedMesh {
  std::shared_ptr<const SolidMesh> mesh{};  ///< null if the mesh has no holes and is no shell
  std::size_t holes = 0;
  bool isCrossed = false;  ///< faces that close holes cross others
  std::string failure{};   ///< a clause; empty if `mesh` is valid
};

/// Closes the mesh of a solid: all its triangles, and after them faces that fill its boundary
/// loops, whose source is TriangleMesh::kNoSource; of a shell its two sides, by shellMesh.  It
/// fails where these enclose other voxels than the solid has: more than kOtherVoxels of them and,
/// beyond that, than a layer along the faces that close holes, or the rim of a shell.
///   solid   filled by winding numbers, or a shell
///   throws  Error(cancelled)
[[nodiscard]] ClosedMesh closedMesh(const Solid& solid, const Progress* progress = nullptr);

/// Returns a mesh with the faces that close its holes after its own triangles.
///   throws  Error(cancelled)
[[nodiscard]] SolidMesh withHolesFilled(const SolidMesh& open, const Progress* progress = nullptr);

/// Whether a solid is a shell of its mesh.
[[nodiscard]] bool isShell(const Solid& solid);

/// Returns a mesh without bodies of less than a volume that have faces that close holes: sheets
/// that enclose hardly anything, such as a fin on an edge.  A solid has no voxels of theirs.
///   closed  not all of it is left out
///   least   world units
[[nodiscard]] SolidMesh withoutSmallClosed(const SolidMesh& closed, double least);

/// The share of voxels that may be on the other side.
inline constexpr double kOtherVoxels = 0.05;

}  // namespace sherd
