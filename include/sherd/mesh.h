// Triangle meshes: reading and measuring them.
#pragma once

#include <sherd/appearance.h>
#include <sherd/progress.h>
#include <sherd/read_options.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sherd {

/// An indexed triangle mesh in world units, counter-clockwise seen from outside, with the
/// attributes of its triangles.  Functions that make new triangles return a mesh without
/// attributes, unless they say which they keep.
struct TriangleMesh {
  std::vector<glm::dvec3> vertices;   ///< [n] finite
  std::vector<glm::uvec3> triangles;  ///< [m] indices below n
  /// [m] id of the fragment on the other side, 0 for the original surface; empty: unknown
  std::vector<std::uint16_t> neighbor{};
  SurfaceAttributes attributes{};  ///< arrays of [m], each may be empty

  /// Returns the neighbor of a triangle, 0 where it is unknown.
  [[nodiscard]] std::uint16_t neighborOf(std::size_t triangle) const {
    return neighbor.empty() ? std::uint16_t{0} : neighbor[triangle];
  }
};

/// A mesh as read from a file, with statistics of the reader.
struct SourceMesh {
  TriangleMesh mesh;   ///< equal vertices merged, unused ones dropped, node transforms applied;
                       ///< with the file's attributes
  std::string name;    ///< file name without folder
  std::string stem;    ///< file name without folder and extensions, used to name output files
  std::string sha256;  ///< of the file's bytes, 64 hexadecimal digits
  std::size_t fileVertices = 0;         ///< vertices before merging
  std::size_t degenerateTriangles = 0;  ///< triangles with two equal corners, dropped
  std::size_t droppedVertices = 0;      ///< vertices of faces with a coordinate that is not finite
  std::size_t droppedTriangles = 0;     ///< triangles that use such a vertex, dropped
  Appearance appearance{};              ///< what the attributes of `mesh` refer to
  std::vector<std::string> objects{};   ///< names, possibly empty or equal, of the file's objects,
                                        ///< groups, solids or nodes; none if it has only one
  std::vector<std::uint32_t> objectOfTriangle{};  ///< [m] below objects.size(), or empty
  std::vector<std::string> grids{};               ///< the grids used of a `.vdb` file
  std::optional<double> isovalue{};     ///< used to extract their surface; none for level sets
  std::vector<std::string> warnings{};  ///< one sentence for each thing that was left out or
                                        ///< assumed, such as a missing texture
};

/// Reads OBJ, PLY, STL, OFF, glTF, GLB, .binm, FBX, DAE or 3MF, by the file's extension, also
/// compressed as `.gz`.  Polygons are triangulated, exactly equal vertices merged.  Coordinates
/// keep the file's precision, except single precision in the last three formats, which sherd-assimp
/// reads.
///
/// Surface attributes are read too: texture coordinates (the first set; that of the base color in
/// glTF), vertex and face colors (without alpha), materials with names, base colors and base-color
/// textures, and the face property `neighbor` of fragments in PLY (`facing` in sherd/1).  Material
/// libraries and textures are read only from the mesh's folder and below it, after resolving
/// symbolic links; `warnings` lists missing ones.
///   progress  only `cancelled` is called
///   throws    Error(input) absent, unreadable, truncated, malformed, unknown format, no triangle,
///             no finite vertex, more than 1e37 units long, more memory than `options` allow;
///             Error(cancelled) by `progress`, or a signal stopped sherd-assimp
[[nodiscard]] SourceMesh readMesh(const std::filesystem::path& file,
                                  const ReadOptions& options = {},
                                  const Progress* progress = nullptr);

/// Splits a mesh into its file's objects, in the file's order, each with its name in `objects`;
/// objects without triangles are left out.  Counts of the whole file stay with the first.
///   return  only `source` if it has no objects
[[nodiscard]] std::vector<SourceMesh> splitObjects(const SourceMesh& source);

/// Whether readMesh supports the file's extension.
[[nodiscard]] bool isMeshName(const std::filesystem::path& file);

/// Axis-aligned box of all vertices.
struct Box {
  glm::dvec3 min{0.0};
  glm::dvec3 max{0.0};
};
[[nodiscard]] Box bounds(const TriangleMesh& mesh);

/// Length of a box's longest side.
[[nodiscard]] double longestSide(const Box& box);

/// Counts edges that are not used equally often in both directions; 0 for a closed, consistently
/// oriented mesh.  An edge used twice in each direction (two touching sheets) counts as closed.
[[nodiscard]] std::size_t openEdges(const TriangleMesh& mesh);

/// Counts edges that are not used by exactly two triangles, once in each direction; 0 for a closed
/// edge-manifold mesh.
[[nodiscard]] std::size_t nonManifoldEdges(const TriangleMesh& mesh);

/// Defects of a mesh, and how many of them voxelize repaired.
struct MeshDefects {
  std::size_t components = 0;          ///< connected by shared vertices
  std::size_t boundaryEdges = 0;       ///< of one triangle
  std::size_t nonManifoldEdges = 0;    ///< of more than two triangles
  std::size_t misorientedEdges = 0;    ///< of two triangles with opposite orientation
  std::size_t flippedTriangles = 0;    ///< flipped to agree with their neighbors
  std::size_t flippedComponents = 0;   ///< inside-out components that were flipped
  std::size_t duplicateTriangles = 0;  ///< dropped
  std::size_t zeroAreaTriangles = 0;   ///< collinear corners, kept

  [[nodiscard]] bool closed() const { return boundaryEdges == 0; }
};

/// Components connected by shared vertices, numbered in the order of their first triangle.
struct MeshComponents {
  std::vector<std::uint32_t> ofTriangle;  ///< [m] 0..count-1
  std::uint32_t count = 0;
};
[[nodiscard]] MeshComponents meshComponents(const TriangleMesh& mesh);

/// Total area of the triangles, world units squared.
[[nodiscard]] double area(const TriangleMesh& mesh);

/// Volume by the divergence theorem, world units cubed; positive when oriented outwards.
[[nodiscard]] double volume(const TriangleMesh& mesh);

/// Volume integrals of a closed mesh at unit density.
///   source  D. Eberly, Polyhedral Mass Properties, 2002
struct MassProperties {
  double volume = 0.0;
  glm::dvec3 centroid{0.0};
  glm::dmat3 inertia{0.0};  ///< about the centroid, symmetric
};
[[nodiscard]] MassProperties massProperties(const TriangleMesh& mesh);

}  // namespace sherd
