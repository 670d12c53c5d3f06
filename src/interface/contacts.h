// Contacts between fragments.
#pragma once

#include <sherd/fragments.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "cut/cut.h"
#include "cut/label_reader.h"
#include "mesh/surface_by_area.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// How far a neighbor is searched through eroded voxels, voxels.
inline constexpr int kMaxErosionDepth = 64;

/// Sums over the faces between a pair of fragments.
struct ContactSum {
  double area = 0.0;
  glm::dvec3 normal{0.0};    ///< area-weighted, from the lower id to the higher
  glm::dvec3 centroid{0.0};  ///< area-weighted
  bool isThin = false;       ///< see Contact

  void add(double faceArea, const glm::dvec3& faceNormal, const glm::dvec3& at) {
    area += faceArea;
    normal += faceArea * faceNormal;
    centroid += faceArea * at;
  }
};

/// By pair of fragments, the lower id first.
using ContactSums = std::map<std::pair<std::uint16_t, std::uint16_t>, ContactSum>;

/// Returns the pairs of fragments that share voxel faces, with the sums over these faces.
///   labels         before erosion
///   cut            of the eroded labels, of any extent
///   neighborhoods  of the solid's leaves
[[nodiscard]] ContactSums voxelContacts(const Solid& solid, const Labels& labels, const Cut& cut,
                                        std::span<const LeafNeighbors> neighborhoods);

/// Finds the fragments on the other side of fracture faces.
class NeighborSearch {
 public:
  ///   labels  before erosion
  ///   eroded  true if faces may have receded up to kMaxErosionDepth voxels from their neighbors
  NeighborSearch(const Solid& solid, const Labels& labels, bool eroded)
      : frame_(solid.frame), reader_(*solid.blocks, labels), eroded_(eroded) {}

  /// Returns the fragment on the other side of a fragment's face, 0 if there is none.
  [[nodiscard]] std::uint16_t across(const std::array<glm::dvec3, 3>& corners,
                                     std::uint16_t fragment);

 private:
  GridFrame frame_;
  LabelReader reader_;
  bool eroded_;
};

/// Returns for each triangle of a fragment's mesh the fragment on its other side, 0 on the original
/// surface.
///   original  [triangles] true on the solid's surface
///   labels    before erosion
///   eroded    as of NeighborSearch
[[nodiscard]] std::vector<std::uint16_t> neighborsOf(const TriangleMesh& mesh,
                                                     const std::vector<bool>& original,
                                                     std::uint16_t fragment, const Solid& solid,
                                                     const Labels& labels, bool eroded);

/// The contacts of all fragments.  Fragments are in contact if their voxels share a face, or if the
/// surfaces do where they are joined by less than a voxel; area, normal and centroid come from the
/// faces of both meshes.
class ContactMeasure {
 public:
  ContactMeasure() = default;
  ContactMeasure(const ContactMeasure&) = delete;
  ContactMeasure& operator=(const ContactMeasure&) = delete;

  /// Adds the faces of a fragment's mesh.  Fragments must be added in the order of their ids,
  /// because floating-point sums depend on it.
  void add(const Fragment& fragment);

  /// Adds a face of a fragment; its neighbor is not 0.
  void add(std::uint16_t fragment, const SurfaceTriangle& face);

  /// Returns whether faces between two fragments have been added.
  [[nodiscard]] bool has(std::uint16_t a, std::uint16_t b) const {
    return sums_.contains({std::min(a, b), std::max(a, b)});
  }

  /// Returns the contacts of fragments 1..fragments, all of which must have been added.
  ///   voxels  see voxelContacts
  [[nodiscard]] std::vector<std::vector<Contact>> contacts(std::size_t fragments,
                                                           ContactSums voxels) const;

  /// The same of fragments that share voxel faces only where faces have been added.
  [[nodiscard]] std::vector<std::vector<Contact>> contacts(std::size_t fragments) const;

 private:
  ContactSums sums_;
  ContactSums::key_type last_{0, 0};
  ContactSum* lastSum_ = nullptr;  // of last_
};

}  // namespace sherd
