// Distances within contacts to their boundaries.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// Of a vertex that has no face with a neighbor; that has faces of several neighbors, or of none
/// too.
inline constexpr std::uint16_t kNoContact = 0, kContactBoundary = 0xffff;

/// Returns [vertices] the neighbor that all faces of a vertex have, or one of the two above.
[[nodiscard]] std::vector<std::uint16_t> contactsOf(const TriangleMesh& mesh);

/// Returns [vertices] how far a vertex within a contact is from its boundary along the edges of its
/// faces, voxels; infinite beyond `most`.
///   contact  contactsOf(mesh)
[[nodiscard]] std::vector<double> boundaryDistances(const TriangleMesh& mesh,
                                                    const std::vector<std::uint16_t>& contact,
                                                    double voxelSize, double most);

}  // namespace sherd
