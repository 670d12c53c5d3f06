// Triangle meshes: what a reader gives, and what can be measured on them.
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

/// An indexed triangle mesh in world units, counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<glm::dvec3> vertices;   ///< [n] finite
  std::vector<glm::uvec3> triangles;  ///< [m] indices below n
};

/// A mesh as read from a file, and what was done to it on the way.
struct SourceMesh {
  TriangleMesh mesh;   ///< equal vertices merged, unused ones dropped, node transforms applied
  std::string name;    ///< file name without folder
  std::string stem;    ///< file name without folder and extensions: names the pieces
  std::string sha256;  ///< of the file's bytes, 64 hexadecimal digits
  std::size_t fileVertices = 0;         ///< vertices before merging
  std::size_t degenerateTriangles = 0;  ///< triangles with two equal corners, dropped
  std::size_t droppedVertices = 0;      ///< vertices of faces that are not finite
  std::size_t droppedTriangles = 0;     ///< triangles that use one of these, dropped
  Appearance appearance{};              ///< of `mesh`; empty for a plain one
  std::vector<std::string> objects{};  ///< names (which may be empty or equal) of the file's parts:
                                       ///< objects, groups, solids, nodes; none where it has one
  std::vector<std::uint32_t> objectOfTriangle{};  ///< [m] below objects.size(), or empty
  std::vector<std::string> grids{};     ///< of a `.vdb` file: the grids that it was read from
  std::optional<double> isovalue{};     ///< where their surface was taken to be; none of level sets
  std::vector<std::string> warnings{};  ///< a sentence for whatever was left out or taken for
                                        ///< granted, such as a texture that is not there
};

/// Read OBJ, PLY, STL, OFF, glTF, GLB, .binm, FBX, DAE or 3MF, by the file's extension; `.gz` of
/// any is unpacked.  Polygons are triangulated, exactly equal vertices merged.  Coordinates keep
/// the file's precision; the last three formats', which sherd-assimp reads, are a float's.
///
/// The look comes along: texture coordinates (the first set; that of the base colour in glTF),
/// vertex and face colours (their alpha is left out), materials with names, base colours and
/// base-colour textures.  Material libraries and textures are read from the mesh's folder and below
/// it, symbolic links followed, and from nowhere else; what is not there is told in `warnings`.
///   progress  asked to stop every now and then
///   throws    Error(input) absent, unreadable, cut, malformed, unknown format, no triangle, no
///             finite vertex, more than 1e37 units long, more memory than `options` allow;
///             Error(cancelled) as `progress` says, or a signal stopped sherd-assimp
[[nodiscard]] SourceMesh readMesh(const std::filesystem::path& file,
                                  const ReadOptions& options = {},
                                  const Progress* progress = nullptr);

/// The file's parts as meshes of their own, in its order, each with its name as `objects`; those
/// without a triangle are left out.  What was counted of the whole file stays with the first.
///   return  the mesh itself where it has no parts
[[nodiscard]] std::vector<SourceMesh> splitObjects(const SourceMesh& source);

/// Whether readMesh knows the format, by the file's extension.
[[nodiscard]] bool isMeshName(const std::filesystem::path& file);

/// Axis-aligned box of all vertices.
struct Box {
  glm::dvec3 min{0.0};
  glm::dvec3 max{0.0};
};
[[nodiscard]] Box bounds(const TriangleMesh& mesh);

/// The length of a box's longest side.
[[nodiscard]] double longestSide(const Box& box);

/// Edges that are not used exactly once in each direction; 0 for a closed, consistently oriented
/// mesh. An edge used twice in each direction (two sheets touching) counts as closed.
[[nodiscard]] std::size_t openEdges(const TriangleMesh& mesh);

/// Edges that are not used by exactly two triangles, once in each direction; 0 for an edge-manifold
/// closed mesh.
[[nodiscard]] std::size_t nonManifoldEdges(const TriangleMesh& mesh);

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

/// Connected components over shared vertices: a number 0..count-1 per triangle, in order of first
/// triangle.
struct Components {
  std::vector<std::uint32_t> ofTriangle;  ///< [m]
  std::uint32_t count = 0;
};
[[nodiscard]] Components components(const TriangleMesh& mesh);

/// Total area of the triangles, world units squared.
[[nodiscard]] double area(const TriangleMesh& mesh);

/// Volume by the divergence theorem, world units cubed; positive when oriented outwards.
[[nodiscard]] double volume(const TriangleMesh& mesh);

/// Volume integrals of a closed mesh at unit density.
/// source  D. Eberly, Polyhedral Mass Properties, 2002
struct MassProperties {
  double volume = 0.0;
  glm::dvec3 centroid{0.0};
  glm::dmat3 inertia{0.0};  ///< about the centroid, symmetric
};
[[nodiscard]] MassProperties massProperties(const TriangleMesh& mesh);

}  // namespace sherd
