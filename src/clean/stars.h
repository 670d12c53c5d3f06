// The faces around vertices, while faces change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "clean/clean_face.h"

namespace sherd {

/// Faces by their numbers, which stay, and those around each vertex.
class Stars {
 public:
  ///   vertices  their number
  Stars(std::vector<CleanFace> faces, std::size_t vertices);

  [[nodiscard]] std::size_t count() const { return faces_.size(); }
  [[nodiscard]] const CleanFace& face(std::uint32_t number) const { return faces_[number]; }
  [[nodiscard]] bool isThere(std::uint32_t number) const { return isThere_[number]; }

  /// Returns the faces around a vertex.
  [[nodiscard]] std::span<const std::uint32_t> around(std::uint32_t vertex) const {
    const std::uint32_t list = list_[vertex];
    if (list != 0) return lists_[list - 1];
    return std::span(inOrder_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

  /// Returns the faces that have both of two vertices.
  [[nodiscard]] std::vector<std::uint32_t> atEdge(std::uint32_t a, std::uint32_t b) const;

  void remove(std::uint32_t number);
  void setCorners(std::uint32_t number, const glm::uvec3& corner);

  /// Returns the number of a new vertex, without faces.
  std::uint32_t addVertex();

  /// Returns the number of the new face.
  std::uint32_t add(const CleanFace& face);

 private:
  std::vector<std::uint32_t>& listOf(std::uint32_t vertex);
  void forget(std::uint32_t vertex, std::uint32_t number);

  std::vector<CleanFace> faces_;
  std::vector<bool> isThere_;
  std::vector<std::uint32_t> first_;               // [vertices + 1] into inOrder_
  std::vector<std::uint32_t> inOrder_;             // faces around vertices that have not changed
  std::vector<std::uint32_t> list_;                // [vertices] 1 + index into lists_; 0: none
  std::vector<std::vector<std::uint32_t>> lists_;  // around those that have
};

}  // namespace sherd
