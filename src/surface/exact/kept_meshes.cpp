// Surface::exact of bodies that are kept where they touch, overlap or lie within others.
#include "surface/exact/kept_meshes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "base/cancel_flag.h"
#include "base/infinity.h"
#include "interface/contacts.h"
#include "mesh/positions.h"
#include "mesh/search/boxes.h"
#include "mesh/search/near_boxes.h"
#include "remesh/vertex_numbers.h"
#include "surface/exact/closed_solid.h"
#include "surface/exact/layer.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/leaves/spread.h"

namespace sherd {
namespace {

// What is known of the bodies of a mesh.
struct KeptBodies {
  std::vector<Box> boxes;            // index space
  std::vector<std::uint16_t> layer;  // [bodies]
  std::vector<bool> hasVoxels;       // that have labels
};

KeptBodies bodiesIn(const Solid& solid) {
  const SolidMesh& mesh = *solid.mesh;
  const std::size_t count = std::size_t{*std::max_element(mesh.body.begin(), mesh.body.end())} + 1;
  KeptBodies bodies{std::vector<Box>(count, {glm::dvec3(kInfinity), glm::dvec3(-kInfinity)}),
                    std::vector<std::uint16_t>(count, 0), std::vector<bool>(count, false)};
  for (std::size_t t = 0; t < mesh.body.size(); ++t) {
    Box& box = bodies.boxes[mesh.body[t]];
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 at =
          solid.frame.indexFromWorld(mesh.mesh.vertices[mesh.mesh.triangles[t][k]]);
      box = {glm::min(box.min, at), glm::max(box.max, at)};
    }
    bodies.layer[mesh.body[t]] = mesh.layer[t];
  }
  return bodies;
}

// Finds the bodies with labeled voxels.  Boxes of bodies in one layer are apart by more than a
// leaf.
void findVoxels(const LeafBlocks& blocks, const Labels& labels, KeptBodies& bodies) {
  const BoxTree tree(bodies.boxes);
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    std::vector<std::uint16_t> layers;  // with labels in the leaf
    for (std::size_t voxel = leaf * 512; voxel < leaf * 512 + 512; ++voxel) {
      if (!blocks.isInside(voxel) || labels.fragment[voxel] == 0) continue;
      const auto layer = static_cast<std::uint16_t>(blocks.layerOf(voxel));
      if (layers.empty() || layers.back() != layer) layers.push_back(layer);
    }
    if (layers.empty()) continue;
    const openvdb::Coord& origin = blocks.origins[leaf];
    const glm::dvec3 corner(origin.x(), origin.y(), origin.z());
    for (const std::uint32_t b : tree.meeting(widened({corner, corner + 7.0}, 1.0))) {
      const auto at = std::find(layers.begin(), layers.end(), bodies.layer[b]);
      if (at != layers.end()) bodies.hasVoxels[b] = true;
    }
  }
}

// Returns the bodies of a layer that have voxels, with the vertices that they use, each position
// once.
std::shared_ptr<const SolidMesh> keptMesh(const SolidMesh& mesh, std::size_t layer,
                                          const KeptBodies& bodies) {
  std::vector<std::uint32_t> own, used;
  for (std::uint32_t t = 0; t < mesh.body.size(); ++t) {
    if (mesh.layer[t] != layer || !bodies.hasVoxels[mesh.body[t]]) continue;
    const glm::uvec3& c = mesh.mesh.triangles[t];
    own.push_back(t);
    used.insert(used.end(), {c.x, c.y, c.z});
  }
  const VertexNumbers numbers(std::move(used), mesh.mesh.vertices.size());
  SolidMesh out;
  for (const std::uint32_t v : numbers.vertices()) {
    out.mesh.vertices.push_back(mesh.mesh.vertices[v]);
  }
  const std::vector<std::uint32_t> first = firstAtPosition(out.mesh.vertices);
  for (const std::uint32_t t : own) {
    const glm::uvec3& c = mesh.mesh.triangles[t];
    out.mesh.triangles.emplace_back(first[numbers.of(c.x)], first[numbers.of(c.y)],
                                    first[numbers.of(c.z)]);
    out.source.push_back(mesh.source[t]);
  }
  return std::make_shared<const SolidMesh>(std::move(out));
}

// Returns the solid and labels of one layer, of the leaves near its voxels.
ClosedSolid closedLayer(const Solid& solid, const Labels& labels, std::size_t layer) {
  ClosedSolid out{solidOfLayer(solid, layer), {}};
  out.labels = labelsOfLayer(labels, out.solid);
  const LeafBlocks& all = *out.solid.blocks;
  LeafBlocks own;
  std::vector<std::uint16_t> fragment;
  for (std::size_t leaf = 0; leaf < all.count(); ++leaf) {
    const auto inside = all.inside.begin() + static_cast<std::ptrdiff_t>(leaf * 8);
    const auto band = all.exteriorBand.begin() + static_cast<std::ptrdiff_t>(leaf * 8);
    const auto isAny = [](std::uint64_t word) { return word != 0; };
    if (std::none_of(inside, inside + 8, isAny) && std::none_of(band, band + 8, isAny)) continue;
    own.origins.push_back(all.origins[leaf]);
    own.inside.insert(own.inside.end(), inside, inside + 8);
    own.exteriorBand.insert(own.exteriorBand.end(), band, band + 8);
    const auto from = out.labels.fragment.begin() + static_cast<std::ptrdiff_t>(leaf * 512);
    fragment.insert(fragment.end(), from, from + 512);
  }
  own.neighbors = leafNeighborTable(own.origins);
  out.solid.blocks = std::make_shared<const LeafBlocks>(std::move(own));
  out.solid.region = nullptr;
  out.solid.smallComponents = 0;
  out.labels.blocks = out.solid.blocks;
  out.labels.fragment = std::move(fragment);
  return out;
}

// Labels without eroded voxels: what is beside these goes on.
Labels healed(Labels labels, const Progress* progress) {
  std::vector<std::size_t> eroded;
  for (std::size_t voxel = 0; voxel < labels.fragment.size(); ++voxel) {
    if (labels.fragment[voxel] != Labels::kEroded) continue;
    eroded.push_back(voxel);
    labels.fragment[voxel] = 0;
  }
  for (const std::size_t voxel :
       spread(*labels.blocks, std::move(eroded), labels.fragment, progress)) {
    labels.fragment[voxel] = Labels::kEroded;
  }
  return labels;
}

// Sets the neighbors of faces that eroded voxels part from them: fragments of the same body.
void setNeighbors(const ClosedSolid& part, std::vector<LabeledMesh>& meshes,
                  const Progress* progress) {
  const std::vector<std::uint16_t>& all = part.labels.fragment;
  if (std::find(all.begin(), all.end(), Labels::kEroded) == all.end()) return;
  const Labels labels = healed(part.labels, progress);
  tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t i) {
    TriangleMesh& mesh = meshes[i].mesh;
    std::vector<bool> isKnown;
    for (const std::uint16_t other : meshes[i].other) isKnown.push_back(other != Labels::kEroded);
    mesh.neighbor =
        neighborsOf(mesh, isKnown, static_cast<std::uint16_t>(i + 1), part.solid, labels, true);
    for (std::size_t t = 0; t < isKnown.size(); ++t) {
      if (isKnown[t]) mesh.neighbor[t] = meshes[i].other[t];
    }
  });
}

// Adds the meshes of a layer, and what was cut.
void appendLayer(ExactSurface layer, const SolidMesh& own, ExactSurface& all, SolidMesh& whole) {
  addLayer(std::move(layer.meshes), all.meshes);
  std::move(layer.moved.begin(), layer.moved.end(), std::back_inserter(all.moved));
  const SolidMesh& cut = layer.united.mesh ? *layer.united.mesh : own;
  const auto first = static_cast<std::uint32_t>(whole.mesh.vertices.size());
  whole.mesh.vertices.insert(whole.mesh.vertices.end(), cut.mesh.vertices.begin(),
                             cut.mesh.vertices.end());
  for (const glm::uvec3& t : cut.mesh.triangles) whole.mesh.triangles.push_back(t + first);
  whole.source.insert(whole.source.end(), cut.source.begin(), cut.source.end());
  all.united.before += layer.united.before;
  all.united.after += layer.united.after;
  all.united.loose += layer.united.loose;
}

}  // namespace

ExactSurface keptMeshes(const Solid& solid, const Labels& labels,
                        const std::function<ExactSurface(const ClosedSolid&)>& cut,
                        const Progress* progress) {
  KeptBodies bodies = bodiesIn(solid);
  findVoxels(*solid.blocks, labels, bodies);
  ExactSurface all;
  all.meshes.resize(static_cast<std::size_t>(labels.fragmentCount));
  SolidMesh whole;
  for (std::size_t layer = 0; layer <= solid.blocks->layers.size(); ++layer) {
    throwIfCancelled(progress);
    const std::shared_ptr<const SolidMesh> own = keptMesh(*solid.mesh, layer, bodies);
    if (own->mesh.triangles.empty()) continue;
    ClosedSolid part = closedLayer(solid, labels, layer);
    part = closedSolid(part.solid, part.labels, own->mesh, progress, Extension::cells);
    part.solid.mesh = own;
    ExactSurface surface = cut(part);
    if (!surface.failure.empty()) return surface;
    // Smooth surfaces are those of all voxels, which bodies share.
    if (!surface.smooth.empty()) return {.failure = std::move(surface.smooth.front().reason)};
    setNeighbors(part, surface.meshes, progress);
    appendLayer(std::move(surface), *own, all, whole);
  }
  if (whole.source.size() != solid.mesh->source.size() || all.united.before > 0) {
    all.united.mesh = std::make_shared<const SolidMesh>(std::move(whole));
  }
  return all;
}

}  // namespace sherd
