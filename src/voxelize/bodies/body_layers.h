// Bodies of a mesh that stay apart however near they are.
#pragma once

#include <sherd/progress.h>
#include <sherd/solid.h>

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <utility>
#include <vector>

#include "voxelize/fill/fill.h"

namespace sherd {

/// Bodies that come within some voxels of each other are in different layers.
struct BodyLayers {
  std::vector<std::vector<std::uint64_t>> voxels{};  ///< see LeafBlocks::layers
  std::vector<std::uint16_t> ofTriangle{};           ///< [triangles] of the mesh; empty: all in 0
  bool areJoined = false;  ///< too many near each other: those side by side are connected
  std::size_t bodies = 0;  ///< those that come near others
  std::vector<std::uint32_t> bodyOfTriangle{};  ///< SolidMesh::body
  std::size_t kept = 0, hidden = 0;             ///< SolidReport::keptBodies, hiddenBodies
};

/// Returns [bodies] the layer of each: one that none with a lower number has of those that it must
/// not share one with, of the first `spread` if possible, among which bodies are spread.
///   pairs  of bodies that must not share one, both ways round, ascending
[[nodiscard]] std::vector<std::uint16_t> layersApart(
    std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs, std::size_t bodies,
    std::uint32_t spread = 1);

/// Returns the layers of bodies, which are the closed components of a mesh, each with its cavities;
/// those that overlap or touch, or lie within each other, are one body.
///   blocks    of the solid, in the index space of `mesh`
///   mesh      closed, the result of repaired()
///   vertices  of the mesh, as they were given: whether bodies touch is decided with these, exactly
///   throws    Error(cancelled)
[[nodiscard]] BodyLayers bodyLayers(const LeafBlocks& blocks, const SearchedMesh& mesh,
                                    std::span<const glm::dvec3> vertices,
                                    const Progress* progress = nullptr);

}  // namespace sherd
