// The connectivity of a closed mesh whose vertices are replaced by others.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// A closed, edge- and vertex-manifold mesh of one label.  Edges that are features stay: chains of
/// them may be refined and coarsened, and end where other than two meet.
class SampledMesh {
 public:
  using Index = std::uint32_t;
  static constexpr Index kNone = 0xffffffffu;

  struct Face {
    std::array<Index, 3> corner{};    ///< counter-clockwise; all kNone once it is gone
    std::array<bool, 3> isFeature{};  ///< of the edges from each corner to the next
    Index source = 0;                 ///< the face of the first mesh that it comes from

    [[nodiscard]] bool isGone() const { return corner[0] == kNone; }
    [[nodiscard]] int indexOf(Index v) const {
      return corner[0] == v ? 0 : corner[1] == v ? 1 : corner[2] == v ? 2 : -1;
    }
  };

  /// Two faces at an edge from a to b: `left` has it in this direction.
  struct Sides {
    Index left = kNone, right = kNone;
    Index leftApex = kNone, rightApex = kNone;
  };

  ///   faces  with features marked on both sides
  SampledMesh(std::vector<glm::dvec3> vertices, std::vector<Face> faces);

  [[nodiscard]] const std::vector<glm::dvec3>& vertices() const { return at_; }
  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }
  [[nodiscard]] std::span<const Index> around(Index v) const { return around_[v]; }
  [[nodiscard]] Sides sidesOf(Index a, Index b) const;
  [[nodiscard]] bool isFeature(Index a, Index b) const;

  /// Marks the edge from corner `k` of a face, on that face only.
  void markFeature(Index face, std::size_t k, bool isFeature) {
    faces_[face].isFeature[k] = isFeature;
  }
  [[nodiscard]] std::size_t indexIn(Index face, Index v) const {
    return static_cast<std::size_t>(faces_[face].indexOf(v));
  }

  /// Returns the other ends of the feature edges at a vertex.
  [[nodiscard]] std::vector<Index> featuresAt(Index v) const;

  void move(Index v, const glm::dvec3& to) { at_[v] = to; }

  /// Adds a vertex on an edge, which splits its two faces; returns it.
  Index splitEdge(Index a, Index b, const glm::dvec3& at);

  /// Adds a vertex in a face, which becomes three; returns it.
  Index splitFace(Index face, const glm::dvec3& at);

  /// Returns whether the edge from `gone` to `kept` can be collapsed into `kept`: the mesh stays
  /// closed and manifold, and no region between features loses its last face.
  [[nodiscard]] bool mayCollapse(Index gone, Index kept) const;
  void collapse(Index gone, Index kept);

  /// Returns whether the edge can be replaced by the other diagonal of its two faces.
  [[nodiscard]] bool mayFlip(Index a, Index b) const;
  void flip(Index a, Index b);

 private:
  void replaceFace(Index v, Index from, Index to);
  void removeFace(Index v, Index face);

  std::vector<glm::dvec3> at_;
  std::vector<Face> faces_;
  std::vector<std::vector<Index>> around_;  // [vertices] faces
};

}  // namespace sherd
