// Fragments in their places, to be asked which is near a point, and which holds it.
#pragma once

#include <sherd/fit.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mesh/mesh_distance.h"

namespace sherd {

class Assembly {
 public:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// Where a point lies with regard to all fragments but one.
  struct Place {
    double distance = 0.0;        ///< to the nearest one's surface; infinite without any
    std::size_t nearest = kNone;  ///< index
    glm::dvec3 point{0.0};        ///< the nearest point of its surface
    double depth = 0.0;  ///< below the surface of one that holds it; the most; 0: none does
  };

  ///   fragments  kept by reference
  explicit Assembly(std::span<const FragmentMesh> fragments);

  [[nodiscard]] std::size_t count() const { return fragments_.size(); }
  [[nodiscard]] const FragmentMesh& fragment(std::size_t i) const { return fragments_[i]; }
  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] bool closed(std::size_t i) const { return closed_[i]; }

  /// Where a point lies; `rounding` is how near a surface it is on it.
  [[nodiscard]] Place placeOf(const glm::dvec3& point, std::size_t without, double rounding) const;

  /// Whether any fragment but one holds the point; open ones hold none.  Points nearer to
  /// a surface than `rounding` are in none.
  [[nodiscard]] bool anyHolds(const glm::dvec3& point, std::size_t without, double rounding) const;

  /// A fragment's own mesh.
  [[nodiscard]] const MeshDistance& mesh(std::size_t i) const { return *meshes_[i]; }

 private:
  std::span<const FragmentMesh> fragments_;
  std::vector<std::unique_ptr<MeshDistance>> meshes_;  ///< [fragments]
  std::vector<char> closed_;                           ///< [fragments]
  Box box_;
};

}  // namespace sherd
