// What touches what.
#pragma once

#include <sherd/fragments.h>

#include <map>
#include <span>
#include <utility>
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

/// The contacts of all fragments: which touch over a voxel face comes from the labels; area, normal
/// and centroid from the faces of both meshes that face each other.
class ContactMeasure {
 public:
  /// Add the faces of a fragment's mesh.  Sums round, so fragments come in the order of their ids.
  void add(const Fragment& fragment);

  /// When all were added: the contacts of fragments 1..fragments.
  ///   labels  before wear
  ///   cut     of the labels as they are now
  ///   rounds  of the solid's leaves
  [[nodiscard]] std::vector<std::vector<Contact>> contacts(std::size_t fragments,
                                                           const Solid& solid, const Labels& labels,
                                                           const Cut& cut,
                                                           std::span<const LeafRound> rounds) const;

  /// What is known of one pair's shared surface.
  struct Touching {
    double area = 0.0;
    glm::dvec3 normal{0.0};    ///< area-weighted, from the lower id to the higher
    glm::dvec3 centroid{0.0};  ///< area-weighted

    void add(double faceArea, const glm::dvec3& faceNormal, const glm::dvec3& at) {
      area += faceArea;
      normal += faceArea * faceNormal;
      centroid += faceArea * at;
    }
  };
  using Pair = std::pair<std::uint16_t, std::uint16_t>;  ///< lower, higher

 private:
  std::map<Pair, Touching> measured_;
};

}  // namespace sherd
