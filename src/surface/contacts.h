// What touches what.
#pragma once

#include <sherd/fragments.h>

#include <span>
#include <vector>

#include "surface/cut.h"

namespace sherd {

/// How far through worn voxels a face is asked what it faced, voxels.
inline constexpr int kDeepestWear = 64;

/// For each triangle of a fragment's mesh, the fragment on its other side, 0 on the original
/// surface.
///   original  [triangles] whether it lies on the solid's surface
///   labels    before wear
///   worn      faces may have receded: the fragment they faced may lie many voxels away
[[nodiscard]] std::vector<std::uint16_t> facingOf(const TriangleMesh& mesh,
                                                  const std::vector<bool>& original,
                                                  std::uint16_t fragment, const Solid& solid,
                                                  const Labels& labels, bool worn = false);

/// Fill in the contacts of all fragments: which touch over a voxel face comes from the labels;
/// area, normal and centroid from the faces of both meshes that face each other.
///   labels  before wear
///   cut     of the labels as they are now
///   rounds  of the solid's leaves
void addContacts(std::span<Fragment> fragments, const Solid& solid, const Labels& labels,
                 const Cut& cut, std::span<const LeafRound> rounds);

}  // namespace sherd
