// The plane of a contact.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <span>

#include "mesh/plane_moments.h"

namespace sherd {

/// The plane nearest to triangles.
struct ContactPlane {
  FittedPlane plane{};
  double area = 0.0;        ///< of the triangles
  double meanSquare = 0.0;  ///< of the distance from the plane
};

/// Fits a plane to triangles of a mesh, as well far from the origin as near it.
[[nodiscard]] ContactPlane contactPlane(const TriangleMesh& mesh,
                                        std::span<const std::uint32_t> triangles);

}  // namespace sherd
