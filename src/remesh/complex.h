// Meshes of several labels that share vertices and faces, as one complex.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// The mesh of one label, part of a mesh of all labels.
struct LabeledMesh {
  TriangleMesh mesh{};                 ///< world units, closed, manifold, oriented outwards
  std::vector<std::uint16_t> other{};  ///< [triangles] the label on the other side; 0: outside
  std::vector<std::uint32_t>
      positionId{};  ///< [vertices] equal for vertices with one position, of any labels
  std::vector<std::uint32_t>
      chart{};  ///< [triangles] of the input's attributes (see seamCharts), or empty
};

/// A face between two labels, counter-clockwise seen from outside the front label.
struct ComplexFace {
  glm::uvec3 corner{0};
  std::uint16_t front = 0;     ///< label whose surface it is
  std::uint16_t back = 0;      ///< label on the other side, 0 for the outside
  std::uint16_t neighbor = 0;  ///< of the front: `back`, or the label there before erosion
  std::array<std::uint8_t, 3> frontSheet{};  ///< [corners] index among the label's vertices there
  std::array<std::uint8_t, 3> backSheet{};
  std::uint32_t chart = 0;  ///< as LabeledMesh::chart

  bool isOf(std::uint16_t label) const { return front == label || back == label; }
};

/// Closed surfaces of labels 1..labels.  A face between two of them is stored once.
struct LabeledComplex {
  std::vector<glm::dvec3> vertices{};
  std::vector<bool> fixed{};  ///< [vertices] non-manifold: a label has several vertices there;
                              ///< empty: none
  std::vector<ComplexFace> faces{};
  std::uint16_t labels = 0;  ///< 0 for surfaces of which no mesh is made, such as cracks alone

  bool isClosed(std::uint16_t label) const { return label >= 1 && label <= labels; }
  bool isFixed(std::uint32_t vertex) const { return !fixed.empty() && fixed[vertex]; }
};

/// Returns the corners of the faces.
[[nodiscard]] std::vector<glm::uvec3> trianglesOf(const LabeledComplex& complex);

/// Returns the complex of a single closed mesh, as label 1.
///   charts  [triangles] as LabeledMesh::chart, or empty
[[nodiscard]] LabeledComplex complexOf(const TriangleMesh& mesh,
                                       std::span<const std::uint32_t> charts = {});

/// Returns the complex of the meshes of labels 1..n.
[[nodiscard]] LabeledComplex complexOf(std::span<const LabeledMesh> meshes);

/// Returns the meshes of labels 1..labels, with neighbors; positionId is the index of the complex's
/// vertex.
///   vertices  of the complex, possibly moved
///   faces     of the complex; faces whose corners are all 0 are skipped
[[nodiscard]] std::vector<LabeledMesh> meshesOf(std::span<const glm::dvec3> vertices,
                                                std::span<const ComplexFace> faces,
                                                std::uint16_t labels);

}  // namespace sherd
