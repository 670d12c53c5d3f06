// Neighbors of fracture faces, and contacts.
#include "interface/contacts.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "cut/label_reader.h"
#include "cut/leaf_labels.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

// The most frequent label other than 0 and `own` of the eight voxels around an index position; the
// lowest of equals, 0 if there is none.
std::uint16_t majorityLabelAround(const glm::dvec3& p, std::uint16_t own, LabelReader& labels) {
  std::array<std::uint16_t, 8> found{};
  const openvdb::Coord base(static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)),
                            static_cast<int>(std::floor(p.z)));
  for (int k = 0; k < 8; ++k) {
    found[static_cast<std::size_t>(k)] =
        labels.at(base + openvdb::Coord(k >> 2, (k >> 1) & 1, k & 1));
  }
  std::sort(found.begin(), found.end());
  std::uint16_t best = 0;
  std::ptrdiff_t most = 0;
  for (const std::uint16_t label : found) {
    const std::ptrdiff_t count = std::count(found.begin(), found.end(), label);
    if (label == 0 || label == own || count <= most) continue;
    best = label;
    most = count;
  }
  return best;
}

}  // namespace

ContactSums voxelContacts(const Solid& solid, const Labels& labels, const Cut& cut,
                          std::span<const LeafNeighbors> neighborhoods) {
  const LeafBlocks& blocks = *solid.blocks;
  const double faceArea = solid.frame.voxelSize * solid.frame.voxelSize;
  ContactSums found;
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    // A leaf with one label and no eroded voxels had one label before erosion too.
    if (cut.only[leaf] != 0 && cut.only[leaf] != Labels::kEroded) continue;
    const LabelCube<9> cube =
        labelsAround<0, 1>(blocks, labels, neighborhoods[leaf], Voxels::inside);
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t stride =
          std::array<std::size_t, 3>{81, 9, 1}[static_cast<std::size_t>(axis)];
      for (std::size_t row = 0; row < 64; ++row) {
        const std::uint16_t* const own = &cube[row / 8 * 81 + row % 8 * 9];
        unsigned contactBits = 0;
        for (std::size_t z = 0; z < 8; ++z) {
          const std::uint16_t a = own[z], b = own[z + stride];
          contactBits |= static_cast<unsigned>((a != b) & (a != 0) & (b != 0)) << z;
        }
        for (; contactBits != 0; contactBits &= contactBits - 1) {
          const auto z = static_cast<std::size_t>(std::countr_zero(contactBits));
          const std::uint16_t a = own[z], b = own[z + stride];
          glm::dvec3 normal(0.0);
          normal[axis] = a < b ? 1.0 : -1.0;
          const openvdb::Coord voxel = blocks.voxelAt(leaf * 512 + row * 8 + z);
          glm::dvec3 at(voxel.x(), voxel.y(), voxel.z());
          at[axis] += 0.5;
          found[{std::min(a, b), std::max(a, b)}].add(faceArea, normal,
                                                      solid.frame.worldFromIndex(at));
        }
      }
    }
  }
  return found;
}

namespace {

std::vector<std::vector<Contact>> contactsOf(std::size_t fragments, const ContactSums& sums) {
  std::vector<std::vector<Contact>> all(fragments);
  for (const auto& [pair, sum] : sums) {
    if (!(sum.area > 0.0)) continue;  // of faces without area
    const double length = glm::length(sum.normal);
    Contact contact;
    contact.area = sum.area;
    contact.normal = length > 0 ? sum.normal / length : glm::dvec3(0.0);
    contact.centroid = sum.centroid / sum.area;
    contact.isThin = sum.isThin;
    contact.fragment = pair.second;
    all[pair.first - 1u].push_back(contact);
    contact.fragment = pair.first;
    contact.normal = -contact.normal;
    all[pair.second - 1u].push_back(contact);
  }
  for (std::vector<Contact>& own : all) {
    std::sort(own.begin(), own.end(),
              [](const Contact& a, const Contact& b) { return a.fragment < b.fragment; });
  }
  return all;
}

}  // namespace

std::uint16_t NeighborSearch::across(const std::array<glm::dvec3, 3>& corners,
                                     std::uint16_t fragment) {
  const auto& [a, b, c] = corners;
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double length = glm::length(normal);
  const glm::dvec3 center = frame_.indexFromWorld((a + b + c) / 3.0);
  const glm::dvec3 outwards = length > 0 ? normal / length : glm::dvec3(0.0);
  // Voxels off the face belong to the neighbor.  At a boundary or in a narrow wedge there may be
  // none at that distance, so others are tried.
  for (const double away : {0.75, 0.25, 1.5}) {
    const std::uint16_t found = majorityLabelAround(center + away * outwards, fragment, reader_);
    if (found != 0) return found;
  }
  for (double away = 2.5; eroded_ && away < kMaxErosionDepth; away += 1.0) {
    const glm::dvec3 at = center + away * outwards;
    if (reader_.at(nearestVoxel(at)) == 0) break;  // outside the solid: original surface
    const std::uint16_t found = majorityLabelAround(at, fragment, reader_);
    if (found != 0) return found;
  }
  return 0;
}

std::vector<std::uint16_t> neighborsOf(const TriangleMesh& mesh, const std::vector<bool>& original,
                                       std::uint16_t fragment, const Solid& solid,
                                       const Labels& labels, bool eroded) {
  std::vector<std::uint16_t> neighbor(mesh.triangles.size(), 0);
  NeighborSearch search(solid, labels, eroded);
  for (std::size_t t = 0; t < neighbor.size(); ++t) {
    if (original[t]) continue;
    const glm::uvec3& corner = mesh.triangles[t];
    neighbor[t] = search.across(
        {mesh.vertices[corner.x], mesh.vertices[corner.y], mesh.vertices[corner.z]}, fragment);
  }
  return neighbor;
}

void ContactMeasure::add(const Fragment& fragment) {
  const TriangleMesh& mesh = fragment.mesh;
  for (std::size_t t = 0; t < mesh.neighbor.size(); ++t) {
    if (mesh.neighbor[t] == 0) continue;
    const glm::uvec3& corner = mesh.triangles[t];
    add(static_cast<std::uint16_t>(fragment.id),
        {{mesh.vertices[corner.x], mesh.vertices[corner.y], mesh.vertices[corner.z]},
         mesh.neighbor[t]});
  }
}

void ContactMeasure::add(std::uint16_t fragment, const SurfaceTriangle& face) {
  const ContactSums::key_type pair{std::min(fragment, face.neighbor),
                                   std::max(fragment, face.neighbor)};
  if (lastSum_ == nullptr || pair != last_) {
    last_ = pair;
    lastSum_ = &sums_[pair];
  }
  const auto& [a, b, c] = face.corner;
  const glm::dvec3 doubled = glm::cross(b - a, c - a) * (fragment < face.neighbor ? 1.0 : -1.0);
  const double doubledArea = glm::length(doubled);
  if (doubledArea == 0.0) return;
  // Half, because the faces of both sides are added.
  lastSum_->add(doubledArea / 4, doubled / doubledArea, (a + b + c) / 3.0);
}

std::vector<std::vector<Contact>> ContactMeasure::contacts(std::size_t fragments,
                                                           ContactSums voxels) const {
  // A contact of a few voxels may have no face in the meshes; its voxel faces are used then.  And
  // fragments whose voxels share no face may have faces towards each other: where erosion has left
  // nothing else near, and where exact surfaces are thinner than voxels.
  for (const auto& [pair, sum] : sums_) {
    if (!(sum.area > 0.0)) continue;
    const bool isThin = !voxels.contains(pair);
    ContactSum& own = voxels[pair];
    own = sum;
    own.isThin = isThin;
  }
  return contactsOf(fragments, voxels);
}

std::vector<std::vector<Contact>> ContactMeasure::contacts(std::size_t fragments) const {
  return contactsOf(fragments, sums_);
}

}  // namespace sherd
