// The principal axes of a solid.
#pragma once

#include <sherd/mesh.h>

#include <glm/gtc/quaternion.hpp>

namespace sherd {

/// The inertia about the centroid, in a frame where it is diagonal.
struct PrincipalInertia {
  glm::dvec3 moments{0.0};                     ///< at unit density
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};  ///< rotates that frame into the world's
};
[[nodiscard]] PrincipalInertia principalInertia(const MassProperties& mass);

}  // namespace sherd
