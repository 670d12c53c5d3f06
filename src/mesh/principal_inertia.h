// The principal axes of a body.
#pragma once

#include <sherd/mesh.h>

#include <glm/gtc/quaternion.hpp>

namespace sherd {

/// A body's inertia about its centroid, in a frame where it is diagonal.
struct PrincipalInertia {
  glm::dvec3 moments{0.0};                     ///< at unit density
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};  ///< turns that frame into the world's
};
[[nodiscard]] PrincipalInertia principalInertia(const MassProperties& mass);

}  // namespace sherd
