// What was found wrong with a mesh, and what was done about it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace sherd {

/// How a mesh tells its inside.
enum class Fill {
  automatic,  ///< winding, or shell where the mesh encloses nothing
  winding,    ///< where the generalised winding number is a half or more: overlapping parts unite,
              ///< cavities stay, holes are closed by the smoothest surface that the mesh suggests
  parity,     ///< where a ray meets the mesh an odd number of times, as in the paper: overlaps
              ///< become holes; holes are closed by cones to the mesh's middle
  flood,      ///< regions between surfaces, filled and hollow by turns from the outside; of closed
              ///< meshes, whatever way their triangles are turned
  shell,      ///< all that is near the surface: a sheet of the shell's thickness
};

/// What is wrong with a mesh.
struct MeshDefects {
  std::size_t parts = 0;               ///< connected over shared vertices
  std::size_t boundaryEdges = 0;       ///< of one triangle
  std::size_t nonManifoldEdges = 0;    ///< of more than two triangles
  std::size_t misorientedEdges = 0;    ///< of two triangles that are turned against each other
  std::size_t turnedTriangles = 0;     ///< turned over to agree with their neighbours
  std::size_t turnedParts = 0;         ///< parts that were inside out, turned over
  std::size_t duplicateTriangles = 0;  ///< dropped
  std::size_t zeroAreaTriangles = 0;   ///< corners on a line, kept

  [[nodiscard]] bool closed() const { return boundaryEdges == 0; }
};

/// How thick the solid is, by rays from points on the mesh straight inwards.  Towards a sharp edge
/// a wall counts as thick as it is a little further in.
struct WallThickness {
  double thinShare = 0.0;  ///< 0..1 of the area behind which the wall is thinner than a voxel
  double thinnest = 0.0;   ///< voxels; all but a hundredth of the area has thicker walls
  int forWalls = 0;        ///< voxels along the longest side that hold a wall of `thinnest`
  int forVolume = 0;   ///< at which edges and curves cost a fiftieth of the volume, as they cost
                       ///< thin branches: their meshes are no finer than the voxels
  int resolution = 0;  ///< the larger of both; 0 where this grid has it
};

}  // namespace sherd
