// Short edges and thin faces.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <tuple>
#include <vector>

#include "clean/change.h"
#include "clean/stars.h"

namespace sherd {

/// An edge with its length, or with a vertex opposite it and the height of the face.
struct Defect {
  double size = 0.0;
  std::uint32_t a = 0, b = 0;         ///< the edge's ends, a < b
  std::uint32_t tip = Change::kNone;  ///< the vertex

  bool operator<(const Defect& other) const {
    return std::tie(size, a, b, tip) < std::tie(other.size, other.a, other.b, other.tip);
  }
  bool operator==(const Defect&) const = default;
};

/// Returns the edges of a face, the shortest first.
[[nodiscard]] std::array<Defect, 3> edgesOf(const glm::uvec3& corner,
                                            const std::vector<glm::dvec3>& positions);

/// Returns the longest edge of a face, the corner opposite it, and its height.
[[nodiscard]] Defect thinnest(const glm::uvec3& corner, const std::vector<glm::dvec3>& positions);

/// Returns the edges below a length of some faces, the shortest first.
///   isFixed  [vertices] edges between two of them are left out
[[nodiscard]] std::vector<Defect> shortEdges(const Stars& stars,
                                             const std::vector<std::uint32_t>& faces,
                                             const std::vector<glm::dvec3>& positions,
                                             const std::vector<bool>& isFixed, double below);

/// Returns the faces below a height of some, the thinnest first.
[[nodiscard]] std::vector<Defect> thinFaces(const Stars& stars,
                                            const std::vector<std::uint32_t>& faces,
                                            const std::vector<glm::dvec3>& positions, double below);

}  // namespace sherd
