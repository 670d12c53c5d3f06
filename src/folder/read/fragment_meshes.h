// The meshes of a fracture's fragments with their surface attributes, read from their files.
#pragma once

#include <sherd/fracture.h>
#include <sherd/mesh.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sherd {

/// The materials of several files, by their names.  A fracture's own material "inside" is left out:
/// every fracture has it.
class JoinedMaterials {
 public:
  /// What add returns for "inside".
  static constexpr std::uint32_t kInside = 0xffffffffu;

  /// Returns [materials] the indices of another file's materials here.
  std::vector<std::uint32_t> add(const Appearance& other);

  /// Replaces materials by those of the same name in a file of a format that says more of them.
  void complete(const Appearance& other);

  /// Whether each material was completed.
  [[nodiscard]] bool isComplete() const;

  [[nodiscard]] Appearance appearance() && { return std::move(joined_); }

 private:
  // Returns a material with its textures, which are added here.
  Material withTextures(Material material, const Appearance& other);
  int addTexture(const Texture& texture);

  Appearance joined_;
  std::vector<bool> isCompleted_;  // [materials]
};

/// The meshes of all fragments, one after another.
struct FragmentMeshes {
  TriangleMesh faces{};                   ///< with neighbor and attributes; materials are those of
                                          ///< `appearance`, or JoinedMaterials::kInside
  std::vector<std::size_t> firstFace{0};  ///< [fragments + 1]
  std::vector<PolygonPart> polygons{};    ///< [faces], or empty
  Appearance appearance{};
};

/// Appends a fragment's mesh; what one of the two lacks of the attributes has default values.
///   materials  [own materials] their indices in all.appearance
void appendFragment(FragmentMeshes& all, SourceMesh own,
                    const std::vector<std::uint32_t>& materials);

/// Sets the neighbors of meshes without: two fragments have the faces between them in common. Where
/// a crack of one was cut later and that of the other was not, the neighbor is the fragment of the
/// voxels behind the face.
///   return  whether any faces are shared, or there is one fragment
bool setNeighbors(FragmentMeshes& all, const GridFrame& frame, const Labels& labels);

/// Returns the mesh file that has neighbors, else the first; empty if there are none.
///   meshes  ManifestFragment::meshes
[[nodiscard]] std::string meshWithNeighbors(const std::vector<std::string>& meshes);

/// Returns the faces of the original surface, without attributes.
///   faces  with neighbors
[[nodiscard]] TriangleMesh originalOf(const TriangleMesh& faces);

/// Returns the faces of the original surface with their attributes, as the source of what fragments
/// that are broken again get.
///   sourceOf  receives [faces] the index of each in it, or TriangleMesh::kNoSource
[[nodiscard]] SourceMesh originalSurface(const FragmentMeshes& all, SourceMesh source,
                                         std::vector<std::uint32_t>& sourceOf);

}  // namespace sherd
