// The components of a mesh that inside voxels belong to.
#pragma once

#include <sherd/progress.h>
#include <sherd/solid.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// Which component's surface inside voxels are nearest to, where several come near.  An inside
/// voxel belongs to that component: the way from it to another would leave its body first.  Of
/// surfaces that are equally near, as those of bodies whose gap is lost in rounding, it is the one
/// behind which the voxel lies.
class VoxelOwners {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  ///   blocks  of the solid, in the index space of the tree's mesh; kept by reference
  ///   throws  Error(cancelled)
  VoxelOwners(const LeafBlocks& blocks, const TriangleTree& tree, const MeshComponents& components,
              const Progress* progress);

  /// Returns the pairs of components that inside voxels side by side belong to.
  [[nodiscard]] std::vector<std::array<std::uint32_t, 2>> neighbors() const;

  /// Calls visit(voxel, component) for the inside voxels nearest to a surface, in leaves that
  /// several components come near.
  template <class Visit>
  void forEach(const Visit& visit) const {
    for (std::size_t slot = 0; slot < leaves_.size(); ++slot) {
      for (std::size_t v = 0; v < 512; ++v) {
        const std::uint32_t component = owner_[slot * 512 + v];
        if (component != kNone) visit(std::size_t{leaves_[slot]} * 512 + v, component);
      }
    }
  }

  /// Whether so many components come near one leaf that no owners were found.
  [[nodiscard]] bool areTooMany() const { return areTooMany_; }

  /// Returns the pairs of components, lower first, that come near one leaf: all that are nearer to
  /// each other than cracks reach beyond a solid, and some more.
  [[nodiscard]] const std::vector<std::array<std::uint32_t, 2>>& nearPairs() const {
    return nearPairs_;
  }

  /// Returns [leaves] the component that comes near a leaf, kNone, or kSeveral.
  [[nodiscard]] const std::vector<std::uint32_t>& nearLeaves() const { return near_; }
  static constexpr std::uint32_t kSeveral = 0xfffffffeu;

  /// Returns the component that an inside voxel is nearest to, or kNone if none is near.
  [[nodiscard]] std::uint32_t ownerOf(std::size_t voxel) const;

 private:
  void findNear(const Progress* progress);
  void findOwners(std::size_t slot);
  [[nodiscard]] std::uint32_t ownerAt(const glm::dvec3& p,
                                      const TriangleTree::Nearest& nearest) const;
  void addNeighbors(std::size_t slot, std::vector<std::array<std::uint32_t, 2>>& found) const;

  const LeafBlocks& blocks_;
  const TriangleTree& tree_;
  const MeshComponents& components_;
  bool areTooMany_ = false;
  std::vector<std::array<std::uint32_t, 2>> nearPairs_;
  std::vector<std::uint32_t> near_;    // [leaves of the solid]
  std::vector<std::uint32_t> leaves_;  // that several components come near
  std::vector<std::uint32_t> slot_;    // [leaves of the solid] index into leaves_, or kNone
  std::vector<std::uint32_t> owner_;   // [leaves_ * 512]
};

}  // namespace sherd
