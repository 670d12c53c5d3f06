// The bodies of a closed mesh that have nothing in common.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "voxelize/bodies/component_meshes.h"

namespace sherd {

/// Returns [components] the name of each one's body, which is that of its first component: cavities
/// are joined to the smallest component around them.
[[nodiscard]] std::vector<std::uint32_t> withCavities(const ComponentMeshes& components);

/// Returns [components] the name of each one's body, which is that of one of its components.
/// Components are one body if they touch or cross, decided exactly, if one is a cavity of the
/// other, or if one lies within the other's solid.
///   vertices  of the mesh, as they were given
///   mesh      closed, the result of repaired()
///   near      [components] 0 or 1: whether it matters if this one lies within another's solid
///   throws    Error(cancelled)
[[nodiscard]] std::vector<std::uint32_t> disjointBodies(std::span<const glm::dvec3> vertices,
                                                        const TriangleMesh& mesh,
                                                        const MeshComponents& components,
                                                        std::span<const std::uint8_t> near,
                                                        const Progress* progress = nullptr);

}  // namespace sherd
