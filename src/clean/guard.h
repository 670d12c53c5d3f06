// Decides which changes are allowed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <unordered_map>
#include <vector>

#include "clean/change.h"
#include "clean/rounded_faults.h"
#include "mesh/search/near_boxes.h"

namespace sherd {

/// Keeps the surface that cracks have not made in its planes, and all faces apart.
class Guard {
 public:
  ///   mesh   to whose triangles CleanFace::source refers
  ///   reach  how far a point of a face may ever move
  Guard(const Stars& stars, CleanPositions& positions, const TriangleMesh& mesh, double reach);

  /// Returns whether a change keeps the pieces manifold, faces of the outside in their planes and
  /// facing outwards, gives every face an area, and lets no faces meet that did not.
  ///   reach  how far a point of a face may move in all, at most that of the guard
  [[nodiscard]] bool allows(const Change& change, double reach);

  /// The same without the number of fans.
  [[nodiscard]] bool keepsFaces(const Change& change, double reach);

  /// Returns whether a change that is allowed leaves fewer faces that cross others, or have no
  /// area, in single precision.
  [[nodiscard]] bool mends(const Change& change);

  /// Records a face that is a new part of another, or beside it.
  void addPart(std::uint32_t number, std::uint32_t of);

  /// Records that points of a face have moved.
  void addDistance(std::uint32_t number, double distance) { distance_[number] += distance; }

 private:
  using Positions = std::vector<glm::dvec3>;

  // A face after a change.
  struct NewFace {
    std::uint32_t number = 0;  // of the face, or of the one that it is a part of or beside
    glm::uvec3 corner{0};
    bool isPrimary = false, isPatch = false;
  };

  [[nodiscard]] bool keepsShape(const NewFace& face, const Positions& at, const Change& change,
                                const glm::dvec3& before) const;
  [[nodiscard]] bool keepsApart(Positions& at, const Change& change, const glm::dvec3& before);
  [[nodiscard]] bool crossedBefore(Positions& at, const Change& change, const glm::dvec3& before,
                                   std::uint32_t other) const;
  [[nodiscard]] std::size_t faultsOf(const std::vector<glm::uvec3>& faces) const;
  [[nodiscard]] std::vector<std::uint32_t> near(const Box& box) const;
  void mark(const Change& change);

  const Stars& stars_;
  CleanPositions& positions_;
  const TriangleMesh& mesh_;
  const double reach_;
  std::vector<std::uint32_t> primary_;  // [boxes] faces
  BoxTree tree_;                        // of the primary faces as they were in the beginning
  std::vector<std::uint32_t> home_;     // [faces] the first face that it is a part of
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> parts_;  // of homes
  std::vector<double> distance_;                                         // [faces]
  std::vector<NewFace> faces_;        // of the change that is tested
  std::vector<std::uint32_t> stamp_;  // [faces] of the change that removes or moves it
  std::uint32_t now_ = 0;
};

}  // namespace sherd
