// Meshes of several labels that share vertices and faces, as one.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// One label's mesh, out of a mesh of all labels.
struct LabelledMesh {
  TriangleMesh mesh;                 ///< world units, closed, manifold, oriented outwards
  std::vector<std::uint16_t> other;  ///< [triangles] the label on the other side; 0: outside
  std::vector<std::uint32_t>
      place;  ///< [vertices] equal where labels share a vertex, and where a label has several
};

/// A face between two labels, counter-clockwise seen from outside the front label.
struct ComplexFace {
  glm::uvec3 corner{0};
  std::uint16_t front = 0;   ///< whose surface it is
  std::uint16_t back = 0;    ///< whose it is seen from the other side, where that has a mesh
  std::uint16_t facing = 0;  ///< what the front faces: `back`, or what was there before wear
  std::array<std::uint8_t, 3> frontSheet{};  ///< [corners] which of its label's vertices there
  std::array<std::uint8_t, 3> backSheet{};

  bool isOf(std::uint16_t label) const { return front == label || back == label; }
};

/// Surfaces of labels 1..labels, each closed; a face between two of them is there once.
struct Complex {
  std::vector<glm::dvec3> vertices;
  std::vector<bool> fixed;  ///< [vertices] where a label's surface touches itself: it has several
                            ///< vertices there
  std::vector<ComplexFace> faces;
  std::uint16_t labels = 0;

  bool isClosed(std::uint16_t label) const { return label >= 1 && label <= labels; }
};

/// A closed mesh alone, as label 1.
///   facing  [triangles] what its faces face
[[nodiscard]] Complex complexOf(const TriangleMesh& mesh, std::span<const std::uint16_t> facing);

/// The meshes of labels 1..n together.
///   facing  [n][triangles] what their faces face
[[nodiscard]] Complex complexOf(std::span<const LabelledMesh> meshes,
                                std::span<const std::vector<std::uint16_t>> facing);

/// A label's mesh out of faces of a complex.
struct LabelledFaces {
  LabelledMesh mesh;                  ///< `place` counts the complex's vertices
  std::vector<std::uint16_t> facing;  ///< [triangles]
};

/// The meshes of labels 1..labels.
///   vertices  in place of the complex's own
///   faces     in place of the complex's own; those whose corners are all 0 are left out
[[nodiscard]] std::vector<LabelledFaces> meshesOf(std::span<const glm::dvec3> vertices,
                                                  std::span<const ComplexFace> faces,
                                                  std::uint16_t labels);

}  // namespace sherd
