// The meshes of the viewer's page as bytes.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "viewer/scene.h"

namespace sherd {

/// The grid of the positions of all pieces: 2^16 values along the longest side of their box, so
/// that equal positions, as those of neighbors, stay equal.
struct PositionGrid {
  glm::dvec3 low{0.0};
  double step = 1.0;  ///< world units; a position is at most half of it off along each axis

  explicit PositionGrid(const Box& box);
  [[nodiscard]] glm::u16vec3 of(const glm::dvec3& position) const;
};

/// The grid of texture coordinates: 2^16 values along each side of their box.
struct TexcoordGrid {
  glm::vec2 low{0.0f}, step{1.0f};

  explicit TexcoordGrid(const ViewerScene& scene);
  [[nodiscard]] glm::u16vec2 of(const glm::vec2& texcoord) const;
};

/// Which arrays all pieces have beside positions, normals and indices.
struct ViewerArrays {
  bool texcoords = false;
  bool colors = false;

  explicit ViewerArrays(const ViewerScene& scene);
};

/// A mesh as bytes, little-endian; docs/viewer.md describes them.
struct EncodedMesh {
  std::string bytes{};
  std::size_t vertices = 0;  ///< corners that differ
  std::size_t triangles = 0;
  std::size_t lines = 0;  ///< edges between faces of different neighbors
  struct Run {            ///< triangles that follow one another
    std::uint16_t neighbor = 0;
    int material = -1;  ///< an index into ViewerScene::materials; -1: none
    std::size_t triangles = 0;
  };
  std::vector<Run> runs{};
};

/// Encodes a mesh.  Triangles with two equal corners on the grid are left out.
///   materials  ViewerScene::materials
[[nodiscard]] EncodedMesh encodedMesh(const TriangleMesh& mesh, const SurfaceAttributes& attributes,
                                      const std::vector<ViewerScene::Material>& materials,
                                      const ViewerArrays& arrays, const PositionGrid& positions,
                                      const TexcoordGrid& texcoords);

}  // namespace sherd
