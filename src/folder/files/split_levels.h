// Levels of the tree of splits.
#pragma once

#include <sherd/fragments.h>

#include <cstddef>
#include <span>
#include <vector>

#include "folder/manifest/split_parents.h"
#include "formats/mesh/scene.h"

namespace sherd {

/// How deep splits lie below the intact object, which one of them may divide; at most
/// kDeepestLevel.
class SplitLevels {
 public:
  explicit SplitLevels(SplitParents parents);

  /// Returns the number of splits that a fragment comes from, without that of the intact object.
  [[nodiscard]] std::size_t ofFragment(int id) const { return depth_[splitOf(id)]; }

  /// Returns the level of a contact: 1 between what the intact object was divided into, one more
  /// for each split that both fragments come from.
  [[nodiscard]] std::size_t ofContact(int one, int other) const;

  /// Returns the last split that a fragment comes from, see SplitParents.
  [[nodiscard]] std::size_t splitOf(int id) const {
    return parents_.ofFragment[static_cast<std::size_t>(id - 1)];
  }

 private:
  SplitParents parents_;
  std::vector<std::size_t> depth_;  // [1 + splits] 0 of the intact object
};

/// A fragment in the hierarchy of clusters of Houdini Engine for Unreal.
struct UnrealCluster {
  int level = 1;     ///< unreal_gc_piece
  int cluster = -1;  ///< unreal_gc_cluster: the split that the fragment comes from; -1 at level 1
};

/// Returns [fragments] the clusters.  Level 1 are the fragments that come from no split but that of
/// the intact object; those of others follow without gaps, from 2.
[[nodiscard]] std::vector<UnrealCluster> unrealClusters(const SplitLevels& levels,
                                                        std::span<const Fragment> fragments);

}  // namespace sherd
