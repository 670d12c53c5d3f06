// The edges of triangles that share vertices, with any number of triangles each.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Edges are numbered by their ends, ascending.
class FaceEdges {
 public:
  /// The use of an edge by a face, from its corner k to the next.
  struct Use {
    std::uint32_t face = 0;
    std::uint8_t corner = 0;
    bool isForward = false;  ///< from the lower vertex to the higher
  };

  ///   triangles  indices below `vertices`
  FaceEdges(std::span<const glm::uvec3> triangles, std::size_t vertices);

  [[nodiscard]] std::size_t count() const { return ends_.size(); }

  /// Returns the vertices of an edge, the lower first.
  [[nodiscard]] const std::array<std::uint32_t, 2>& ends(std::size_t edge) const {
    return ends_[edge];
  }
  static constexpr std::uint32_t kNone = 0xffffffffu;

  /// Returns the edge between two vertices, or kNone.
  [[nodiscard]] std::uint32_t between(std::uint32_t a, std::uint32_t b) const;

  /// Returns the edges of a face, [corner] to the next.
  [[nodiscard]] const std::array<std::uint32_t, 3>& of(std::size_t face) const {
    return edgesOf_[face];
  }
  /// Returns an edge's uses, ascending by face.
  [[nodiscard]] std::span<const Use> uses(std::size_t edge) const {
    return {&uses_[first_[edge]], first_[edge + 1] - first_[edge]};
  }

 private:
  std::vector<std::array<std::uint32_t, 2>> ends_;
  std::vector<std::array<std::uint32_t, 3>> edgesOf_;
  std::vector<std::uint32_t> first_;  // [edges + 1] into uses_
  std::vector<Use> uses_;
};

}  // namespace sherd
