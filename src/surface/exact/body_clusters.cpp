// Clusters of bodies: components of a mesh and fragments, united where they have something in
// common.
#include "surface/exact/body_clusters.h"

#include <algorithm>
#include <bit>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "base/cancel_flag.h"
#include "base/union_find.h"
#include "cut/label_reader.h"
#include "cut/nearest_label.h"
#include "intersect/self_crossings.h"
#include "mesh/search/triangle_tree.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/leaves/leaf_masks.h"

namespace sherd {
namespace {

using openvdb::Coord;

// Of a component's triangles, about so many are looked up among the voxels.
constexpr std::size_t kMostSamples = 4096;

std::size_t layerOfTriangle(const SolidMesh& mesh, std::size_t t) {
  return mesh.layer.empty() ? 0 : mesh.layer[t];
}

glm::dvec3 centroidOf(const TriangleMesh& mesh, const glm::uvec3& t) {
  return (mesh.vertices[t.x] + mesh.vertices[t.y] + mesh.vertices[t.z]) / 3.0;
}

// Calls visit(voxel) for the inside voxels of a leaf that lie at the surface, ascending.
template <class Visit>
void forEachAtSurface(const LeafBlocks& blocks, const VoxelMask& outside, std::size_t leaf,
                      const Visit& visit) {
  for (std::size_t x = 0; x < 8; ++x) {
    std::uint64_t open = withBeside(&outside[leaf * 8], x);
    for (std::size_t side = 0; side < 6; ++side) {
      const std::uint32_t beside = blocks.neighbors[leaf * 6 + side];
      if (beside != LeafBlocks::kNone) open |= besideFace(outside, beside, side, x);
    }
    for (std::uint64_t bits = blocks.inside[leaf * 8 + x] & open; bits; bits &= bits - 1) {
      visit(leaf * 512 + x * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
    }
  }
}

// Whether a label is that of a fragment: eroded voxels are of none.
bool isOfFragment(const Labels& labels, std::uint16_t label) {
  return label != 0 && label <= labels.fragmentCount;
}

// Unites labels, which are numbered from `first`, where their voxels share a face in one layer.
void uniteTouching(const Labels& labels, std::uint32_t first, UnionFind& sets) {
  const LeafBlocks& blocks = *labels.blocks;
  std::pair<std::uint16_t, std::uint16_t> last{0, 0};
  blocks.forEachInside([&](std::size_t voxel) {
    const std::uint16_t own = labels.fragment[voxel];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t next = voxelBehind(blocks, voxel, axis);
      if (next == kNoVoxel || !blocks.isInside(next)) continue;
      const std::uint16_t other = labels.fragment[next];
      if (other == own || std::pair{own, other} == last) continue;
      if (!isOfFragment(labels, own) || !isOfFragment(labels, other)) continue;
      if (blocks.layerOf(voxel) != blocks.layerOf(next)) continue;
      last = {own, other};
      sets.unite(first + own, first + other);
    }
  });
}

class Clusters {
 public:
  Clusters(const Solid& solid, const SolidMesh& mesh, const Labels& labels)
      : solid_(solid),
        mesh_(mesh),
        labels_(labels),
        components_(meshComponents(mesh.mesh)),
        sets_(components_.count + static_cast<std::size_t>(labels.fragmentCount) + 1) {}

  std::vector<BodyCluster> find(const Progress* progress) {
    uniteTouching(labels_, components_.count, sets_);
    for (const auto& [s, t] : selfCrossings(mesh_.mesh.vertices, mesh_.mesh.triangles, progress,
                                            {.source = components_.ofTriangle})) {
      sets_.unite(components_.ofTriangle[s], components_.ofTriangle[t]);
    }
    uniteWithVoxels(progress);
    uniteWithSurfaces(progress);
    return clusters();
  }

 private:
  void unite(std::uint32_t component, std::uint16_t label) {
    sets_.unite(component, components_.count + label);
  }

  // The label of the inside voxel of a layer that is nearest to a point, of those around it; or 0.
  std::uint16_t labelNear(const glm::dvec3& index, std::size_t layer, LabelReader& reader) const {
    const glm::dvec3 middle = glm::round(index);
    double least = std::numeric_limits<double>::infinity();
    std::uint16_t nearest = 0;
    for (int k = 0; k < 27; ++k) {
      const glm::dvec3 at = middle + glm::dvec3(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1);
      const double squared = glm::dot(at - index, at - index);
      if (squared >= least) continue;
      const Coord voxel(static_cast<int>(at.x), static_cast<int>(at.y), static_cast<int>(at.z));
      if (!reader.isInside(voxel) || !isOfFragment(labels_, reader.at(voxel))) continue;
      const std::uint32_t leaf = findLeaf(*solid_.blocks, voxel);
      if (solid_.blocks->layerOf(std::size_t{leaf} * 512 + offsetFromCoord(voxel)) != layer) {
        continue;
      }
      least = squared;
      nearest = reader.at(voxel);
    }
    return nearest;
  }

  // Unites components with the labels of the voxels beside their triangles.
  void uniteWithVoxels(const Progress* progress) {
    std::vector<std::vector<std::uint32_t>> own(components_.count);
    for (std::uint32_t t = 0; t < mesh_.mesh.triangles.size(); ++t) {
      own[components_.ofTriangle[t]].push_back(t);
    }
    LabelReader reader(*solid_.blocks, labels_);
    for (std::uint32_t c = 0; c < components_.count; ++c) {
      throwIfCancelled(progress);
      bool isFound = false;
      const auto indexOf = [&](std::uint32_t t) {
        return solid_.frame.indexFromWorld(centroidOf(mesh_.mesh, mesh_.mesh.triangles[t]));
      };
      const std::size_t step = own[c].size() / kMostSamples + 1;
      for (std::size_t i = 0; i < own[c].size(); i += step) {
        const std::uint32_t t = own[c][i];
        const std::uint16_t label = labelNear(indexOf(t), layerOfTriangle(mesh_, t), reader);
        if (label != 0) unite(c, label);
        isFound |= label != 0;
      }
      if (!isFound) unite(c, nearestLabel(labels_, indexOf(own[c].front())));
    }
  }

  // Unites labels with the components of the surfaces nearest to their voxels: a component may have
  // voxels that are connected only through walls thinner than these, and large triangles.
  void uniteWithSurfaces(const Progress* progress) {
    const LeafBlocks& blocks = *solid_.blocks;
    VoxelMask outside;
    for (const std::uint64_t word : blocks.inside) outside.push_back(~word);
    std::map<std::size_t, LayerTree> trees;
    std::vector<std::uint16_t> known;
    for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
      if (leaf % 1024 == 0) throwIfCancelled(progress);
      known.clear();
      forEachAtSurface(blocks, outside, leaf, [&](std::size_t voxel) {
        const std::uint16_t label = labels_.fragment[voxel];
        if (!isOfFragment(labels_, label)) return;
        if (std::find(known.begin(), known.end(), label) != known.end()) return;
        known.push_back(label);
        const LayerTree& of = treeOf(blocks.layerOf(voxel), trees);
        const Coord at = blocks.voxelAt(voxel);
        const glm::dvec3 p = solid_.frame.worldFromIndex(glm::dvec3(at.x(), at.y(), at.z()));
        const TriangleTree::Nearest nearest =
            of.tree.nearest(p, std::numeric_limits<double>::infinity());
        if (nearest.triangle == TriangleTree::kNone) return;
        unite(components_.ofTriangle[of.triangle[of.tree.source(nearest.triangle)]], label);
      });
    }
  }

  // The triangles of one layer.
  struct LayerTree {
    TriangleTree tree;
    std::vector<std::uint32_t> triangle;  // of the mesh
  };

  const LayerTree& treeOf(std::size_t layer, std::map<std::size_t, LayerTree>& trees) const {
    const auto found = trees.find(layer);
    if (found != trees.end()) return found->second;
    TriangleMesh own{mesh_.mesh.vertices, {}};
    std::vector<std::uint32_t> triangle;
    for (std::uint32_t t = 0; t < mesh_.mesh.triangles.size(); ++t) {
      if (layerOfTriangle(mesh_, t) != layer) continue;
      own.triangles.push_back(mesh_.mesh.triangles[t]);
      triangle.push_back(t);
    }
    return trees.emplace(layer, LayerTree{TriangleTree(own), std::move(triangle)}).first->second;
  }

  std::vector<BodyCluster> clusters() {
    std::vector<BodyCluster> all;
    std::map<std::uint32_t, std::size_t> number;  // by names of sets
    for (int id = 1; id <= labels_.fragmentCount; ++id) {
      const auto label = static_cast<std::uint16_t>(id);
      const auto [found, isNew] =
          number.try_emplace(sets_.find(components_.count + label), all.size());
      if (isNew) all.emplace_back();
      all[found->second].fragments.push_back(label);
    }
    for (std::uint32_t t = 0; t < mesh_.mesh.triangles.size(); ++t) {
      const auto found = number.find(sets_.find(components_.ofTriangle[t]));
      if (found != number.end()) all[found->second].triangles.push_back(t);
    }
    return all;
  }

  const Solid& solid_;
  const SolidMesh& mesh_;
  const Labels& labels_;
  const MeshComponents components_;
  UnionFind sets_;  // of components, and after them of labels
};

}  // namespace

std::vector<BodyCluster> bodyClusters(const Solid& solid, const SolidMesh& mesh,
                                      const Labels& labels, const Progress* progress) {
  return Clusters(solid, mesh, labels).find(progress);
}

std::vector<std::uint32_t> connectedFragments(const Labels& labels) {
  UnionFind sets(static_cast<std::size_t>(labels.fragmentCount) + 1);
  uniteTouching(labels, 0, sets);
  std::vector<std::uint32_t> all = std::move(sets).all();
  all.erase(all.begin());
  return all;
}

}  // namespace sherd
