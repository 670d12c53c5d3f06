// One layer of a solid.
#include "surface/exact/layer.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/leaves/leaf_masks.h"

namespace sherd {
Solid solidOfLayer(const Solid& solid, std::size_t layer) {
  const LeafBlocks& all = *solid.blocks;
  LeafBlocks own{.origins = all.origins, .neighbors = all.neighbors};
  VoxelMask active;
  for (std::size_t word = 0; word < all.inside.size(); ++word) {
    own.inside.push_back(insideOfLayer(all, layer, word));
    active.push_back(all.inside[word] | all.exteriorBand[word]);
  }
  own.exteriorBand = grownBySteps(all, own.inside, active, kBandSteps);
  for (std::size_t word = 0; word < own.inside.size(); ++word) {
    own.exteriorBand[word] &= ~own.inside[word];
  }
  Solid out = solid;
  out.blocks = std::make_shared<const LeafBlocks>(std::move(own));
  return out;
}

Labels labelsOfLayer(const Labels& labels, const Solid& solid) {
  Labels own = labels;
  own.blocks = solid.blocks;
  own.cost.clear();
  for (std::size_t voxel = 0; voxel < own.fragment.size(); ++voxel) {
    if (!solid.blocks->isInside(voxel)) own.fragment[voxel] = 0;
  }
  return own;
}

SolidMesh meshOfLayer(const SolidMesh& mesh, std::size_t layer) {
  SolidMesh own;
  own.mesh.vertices = mesh.mesh.vertices;
  for (std::size_t t = 0; t < mesh.mesh.triangles.size(); ++t) {
    if (mesh.layer[t] != layer) continue;
    own.mesh.triangles.push_back(mesh.mesh.triangles[t]);
    own.source.push_back(mesh.source[t]);
  }
  return own;
}

void addLayer(std::vector<LabeledMesh> layer, std::vector<LabeledMesh>& all) {
  std::uint32_t positions = 0;  // of other layers
  for (const LabeledMesh& mesh : all) {
    for (const std::uint32_t id : mesh.positionId) positions = std::max(positions, id + 1);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (layer[i].mesh.triangles.empty()) continue;
    all[i] = std::move(layer[i]);
    for (std::uint32_t& id : all[i].positionId) id += positions;
  }
}

}  // namespace sherd
