// A local change of the faces of all pieces.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "clean/stars.h"

namespace sherd {

/// Merges a vertex, or an edge, with another vertex.  All faces that change have that vertex
/// afterwards.
struct Change {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  /// A face that has other corners, or is a new part of another face.
  struct Face {
    std::uint32_t number = 0;  ///< of the face, or of the one that it is a part of
    glm::uvec3 corner{0};
  };

  /// A new face, in a gap that moved faces leave.
  struct Patch {
    CleanFace face;
    std::uint32_t beside =
        0;  ///< a face whose points are about as near to all of it as points move
  };

  std::uint32_t at = 0;        ///< the vertex that they are merged with
  glm::dvec3 position{0.0};    ///< its position afterwards
  std::uint32_t gone = kNone;  ///< the vertex that is merged with it, which has no faces afterwards
  std::vector<std::uint32_t> removed{};  ///< faces that lose their area
  std::vector<Face> moved{};
  std::vector<Face> added{};
  std::vector<Patch> patches{};
  double distance = 0.0;  ///< how far points of faces move
};

/// Returns the change by which the vertex `gone` goes to the vertex `at`.
[[nodiscard]] Change collapse(const Stars& stars, std::uint32_t gone, std::uint32_t at,
                              const std::vector<glm::dvec3>& positions);

/// Returns the change by which the edge ab goes through the vertex `at`, which is one of a face's
/// corners opposite the edge; the face is removed, and others at the edge are split.
///   position  of `at` afterwards
[[nodiscard]] Change attach(const Stars& stars, std::uint32_t a, std::uint32_t b, std::uint32_t at,
                            const glm::dvec3& position, const std::vector<glm::dvec3>& positions);

}  // namespace sherd
