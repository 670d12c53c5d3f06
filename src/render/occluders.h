// The fragments as obstacles of light.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "render/embree_scene.h"
#include "render/scene.h"

namespace sherd {

/// All fragments as one mesh, the vertices in each cube of a grid merged.
class Occluders {
 public:
  ///   cell  side of the cubes, scene units
  Occluders(const Scene& scene, float cell);

  /// Returns 1 if a ray is unoccluded, else 0.
  ///   start  distance within which it meets nothing
  [[nodiscard]] float free(glm::vec3 origin, glm::vec3 direction, float start) const;

  /// Offset of a ray's origin above the fragments' surfaces, and the distance within which it
  /// meets nothing: the merged surface may lie above.
  [[nodiscard]] float lift() const { return 0.2f * cell_; }
  [[nodiscard]] float start() const { return 0.3f * cell_; }

 private:
  float cell_;
  std::vector<glm::vec3> vertices_;
  std::vector<glm::uvec3> triangles_;
  EmbreeScene embree_;
};

}  // namespace sherd
