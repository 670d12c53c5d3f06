// All fragments in their assembled positions: nearest surface and containment queries.
#pragma once

#include <sherd/evaluate.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mesh/search/mesh_distance.h"

namespace sherd {

class Assembly {
 public:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  /// Of the diagonal; a point this near lies on a surface.
  static constexpr double kRounding = 2e-6;

  /// Position of a point relative to all fragments except one.
  struct Location {
    double distance = 0.0;         ///< to the nearest surface, world units; infinite without any
    std::size_t nearest = kNone;   ///< index of the fragment with that surface
    glm::dvec3 closestPoint{0.0};  ///< on that surface
    double depth = 0.0;            ///< largest depth below the surface of a fragment that
                                   ///< contains the point; 0 where none does
  };

  ///   fragments  kept by reference
  explicit Assembly(std::span<const FragmentMesh> fragments);

  [[nodiscard]] std::size_t count() const { return fragments_.size(); }
  [[nodiscard]] const FragmentMesh& fragment(std::size_t i) const { return fragments_[i]; }
  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] bool closed(std::size_t i) const { return closed_[i]; }

  /// Locates a point.
  ///   excluded  index of the fragment to ignore, or kNone
  ///   rounding  world units; a point at most this far from a surface lies on it, not inside
  [[nodiscard]] Location locate(const glm::dvec3& point, std::size_t excluded,
                                double rounding) const;

  /// Returns whether any closed fragment except `excluded` contains the point; arguments as above.
  [[nodiscard]] bool anyContains(const glm::dvec3& point, std::size_t excluded,
                                 double rounding) const;

  [[nodiscard]] const MeshDistance& mesh(std::size_t i) const { return *meshes_[i]; }

 private:
  std::span<const FragmentMesh> fragments_;
  std::vector<std::unique_ptr<MeshDistance>> meshes_;  ///< [fragments]
  std::vector<char> closed_;                           ///< [fragments]
  Box box_;
};

}  // namespace sherd
