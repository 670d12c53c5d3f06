// Triangle meshes with their attributes, and what is measured on them.
#pragma once

#include <sherd/progress.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/gtc/type_precision.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// Face-varying attributes of a mesh of m triangles; each array may be empty.
struct SurfaceAttributes {
  std::vector<std::array<glm::vec2, 3>> texcoords;  ///< [m] u to the right, v upwards: (0, 0) is
                                                    ///< the image's lower left corner, as in OBJ
  std::vector<std::array<glm::u8vec3, 3>> colors;   ///< [m] sRGB
  std::vector<std::uint32_t> material;              ///< [m] index into Appearance::materials
  std::vector<std::array<glm::vec3, 3>> normals;    ///< [m] unit, of any direction; those of a
                                                    ///< file that has some, see readMesh

  [[nodiscard]] bool empty() const { return hasOnlyNormals() && normals.empty(); }

  /// Whether no other array has content.
  [[nodiscard]] bool hasOnlyNormals() const {
    return texcoords.empty() && colors.empty() && material.empty();
  }
};

/// An image used by materials.
struct Texture {
  std::string name;   ///< from the mesh's file; generated where the file has none
  std::string bytes;  ///< the undecoded image file, not empty
};

struct Material {
  std::string name;       ///< may be empty, may repeat
  glm::vec3 color{1.0f};  ///< 0..1, linear; the texture is multiplied by it
  int texture = -1;       ///< index into Appearance::textures; -1: none
  /// The whole material as an object of glTF 2.0, JSON without a name, base color included; empty:
  /// rough and not metallic.  Every `index` of a texture is into Appearance::textures, and a key
  /// `sampler` beside it has the sampler, if the file has one.  Texture coordinates are those of
  /// SurfaceAttributes.
  std::string gltf{};
};

/// The materials and textures of a mesh that was read.  They have no influence on the fracture.
struct Appearance {
  std::vector<Material> materials;  ///< empty where the file has none
  std::vector<Texture> textures;
};

/// The color of fracture surfaces, sRGB.
inline constexpr glm::u8vec3 kInsideColor{224, 214, 196};

/// Detects the image format from a file's first bytes.
enum class ImageType { png, jpeg, other };
[[nodiscard]] ImageType imageType(std::string_view bytes);

/// The sRGB transfer function and its inverse, per channel; linear values are 0..1.
[[nodiscard]] glm::vec3 linearFromSrgb(glm::u8vec3 color);
[[nodiscard]] glm::u8vec3 srgbFromLinear(glm::vec3 color);  ///< clamps to 0..1

/// An indexed triangle mesh in world units, counter-clockwise seen from outside, with the
/// attributes of its triangles.  Functions that make new triangles return a mesh without
/// attributes, unless they say which they keep.
struct TriangleMesh {
  std::vector<glm::dvec3> vertices;   ///< [n] finite
  std::vector<glm::uvec3> triangles;  ///< [m] indices below n
  /// [m] id of the fragment on the other side, 0 for the original surface; empty: unknown
  std::vector<std::uint16_t> neighbor{};
  SurfaceAttributes attributes{};  ///< arrays of [m], each may be empty
  /// [m] for Surface::exact: index of the input's triangle that a triangle is, or is a part of;
  /// kNoSource on fracture surfaces and where a hole was closed; empty: unknown
  std::vector<std::uint32_t> source{};

  static constexpr std::uint32_t kNoSource = 0xffffffffu;

  bool isMerged = false;  ///< the triangles in each plane are merged, see kAutoAdaptivity: edges of
                          ///< more than 30 degrees are creases, and corners beside one have normals
                          ///< of their own in files

  /// Returns the neighbor of a triangle, 0 where it is unknown.
  [[nodiscard]] std::uint16_t neighborOf(std::size_t triangle) const {
    return neighbor.empty() ? std::uint16_t{0} : neighbor[triangle];
  }
};

/// The place of a triangle in the face of a file, a polygon, that it is a part of.
struct PolygonPart {
  std::uint32_t polygon = 0;  ///< index of the face in the file; its triangles are consecutive
  glm::uvec3 corner{0};       ///< the triangle's corners, as corners of the face, from 0
};

/// What decides the length unit, or the upward axis, of a mesh's coordinates.
enum class CoordinateBasis {
  format,  ///< assumed, as is usual in files of the format
  file,    ///< the file, or the definition of its format, says so
  option,  ///< given by the user
};

/// What a mesh's coordinates mean in space.  Nothing scales or rotates them by it: meshes keep the
/// coordinates of their file, and what is derived from these uses it.
struct CoordinateSystem {
  double metersPerUnit = 1.0;  ///< above 0
  char up = 'y';               ///< the axis that points up: 'x', 'y' or 'z'
  CoordinateBasis unitFrom = CoordinateBasis::format;
  CoordinateBasis upFrom = CoordinateBasis::format;
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
  std::vector<PolygonPart> polygons{};  ///< [m], or empty if triangle t is face t of the file
  std::vector<std::string> grids{};     ///< the grids used of a `.vdb` file
  std::optional<double> isovalue{};     ///< used to extract their surface; none for level sets
  std::vector<std::string> warnings{};  ///< one sentence for each thing that was left out or
                                        ///< assumed, such as a missing texture
  CoordinateSystem coordinates{};       ///< of `mesh`
};

/// Splits a mesh into its file's objects, in the file's order, each with its name in `objects`;
/// objects without triangles are left out.  Counts of the whole file stay with the first.
///   return  only `source` if it has no objects
[[nodiscard]] std::vector<SourceMesh> splitObjects(const SourceMesh& source);

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
  std::size_t sheetTriangles = 0;      ///< of these, both sides of sheets, which enclose nothing
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
