// Bodies of a mesh that stay bodies of their own where they touch, overlap or lie within others.
#include "voxelize/bodies/kept_bodies.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "mesh/search/boxes.h"
#include "mesh/search/near_boxes.h"
#include "voxelize/bodies/component_meshes.h"
#include "voxelize/bodies/disjoint_bodies.h"
#include "voxelize/fill/winding.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/leaves/spread.h"

namespace sherd {
namespace {

// Half of the distance, in voxels, from which on the exterior bands of two bodies are apart.
constexpr double kApart = 5.5;

// Few bodies have a layer each, so that the cells of one lose no voxels to seeds of another.
constexpr std::size_t kSpread = 16;

// A body has so many layers to choose from.
constexpr std::uint16_t kMostLayers = 256;

// The closed components of a mesh, each with its cavities.
struct KeptBodies {
  std::vector<std::uint32_t> ofTriangle;  // numbers, ascending by first triangles
  std::vector<TriangleMesh> meshes;
  std::vector<Box> boxes;
  std::vector<double> volumes;

  [[nodiscard]] std::size_t count() const { return meshes.size(); }
};

KeptBodies keptBodies(const TriangleMesh& mesh, const MeshComponents& components) {
  const ComponentMeshes parts(mesh.vertices, mesh, components);
  const std::vector<std::uint32_t> body = withCavities(parts);  // named by its first component
  std::vector<std::vector<std::uint32_t>> own;                  // components of each
  std::vector<std::uint32_t> number(body.size());
  for (std::uint32_t c = 0; c < body.size(); ++c) {
    if (body[c] == c) own.emplace_back();
    number[c] = body[c] == c ? static_cast<std::uint32_t>(own.size() - 1) : number[body[c]];
    own[number[c]].push_back(c);
  }
  KeptBodies bodies;
  for (const std::uint32_t c : components.ofTriangle) bodies.ofTriangle.push_back(number[c]);
  for (const std::vector<std::uint32_t>& some : own) {
    bodies.meshes.push_back(parts.joined(some));
    bodies.boxes.push_back(bounds(bodies.meshes.back()));
    bodies.volumes.push_back(volume(bodies.meshes.back()));
  }
  return bodies;
}

// Returns the pairs of bodies that must not share a layer, both ways round, ascending.
std::vector<std::pair<std::uint32_t, std::uint32_t>> meetingPairs(const KeptBodies& bodies) {
  std::vector<Box> reach;
  for (const Box& box : bodies.boxes) reach.push_back(widened(box, kApart));
  const BoxTree tree(reach);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t b = 0; b < bodies.count(); ++b) {
    for (const std::uint32_t other : tree.meeting(reach[b])) {
      if (other != b) pairs.emplace_back(b, other);
    }
  }
  return pairs;
}

// The layers of voxels: 1 + layer, 0 of voxels that are in no body or not inside.
using VoxelLayers = std::vector<std::uint16_t>;

// Gives a body the inside voxels whose centers lie in it.
void give(const LeafBlocks& blocks, const TriangleMesh& body, std::uint16_t layer,
          VoxelLayers& layers, const Progress* progress) {
  const Winding winding(body, Winding::Rule::signedCrossings, progress);
  winding.forEachRun([&](int x, int y, int z, int end, int number) {
    while (number > 0 && z < end) {
      const int stop = std::min(end, (z | 7) + 1);  // of the run in this leaf
      const std::uint32_t leaf = findLeaf(blocks, {x, y, z});
      for (; leaf != LeafBlocks::kNone && z < stop; ++z) {
        const std::size_t voxel = std::size_t{leaf} * 512 + offsetFromCoord({x, y, z});
        if (blocks.isInside(voxel)) layers[voxel] = static_cast<std::uint16_t>(layer + 1);
      }
      z = stop;
    }
  });
}

// Gives the inside voxels that are in no body, such as bridges, to what is beside them.
void giveRest(const LeafBlocks& blocks, VoxelLayers& layers, const Progress* progress) {
  std::vector<std::size_t> rest;
  blocks.forEachInside([&](std::size_t voxel) {
    if (layers[voxel] == 0) rest.push_back(voxel);
  });
  for (const std::size_t voxel : spread(blocks, std::move(rest), layers, progress)) {
    layers[voxel] = 1;
  }
}

VoxelLayers voxelLayers(const LeafBlocks& blocks, const KeptBodies& bodies,
                        const std::vector<std::uint16_t>& layer, const Progress* progress) {
  std::vector<std::uint32_t> order(bodies.count());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (bodies.volumes[a] != bodies.volumes[b]) return bodies.volumes[a] > bodies.volumes[b];
    return a > b;
  });
  VoxelLayers layers(blocks.count() * 512, 0);
  for (const std::uint32_t b : order) give(blocks, bodies.meshes[b], layer[b], layers, progress);
  giveRest(blocks, layers, progress);
  return layers;
}

// Counts the bodies that have voxels, and those with voxels beside those of others.
void count(const LeafBlocks& blocks, const KeptBodies& bodies,
           const std::vector<std::uint16_t>& layer, const VoxelLayers& layers, BodyLayers& out) {
  const BoxTree tree(bodies.boxes);
  std::vector<bool> isSeen(bodies.count(), false), isNear(bodies.count(), false);
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    std::vector<std::uint16_t> own, near;  // layers with voxels in the leaf
    for (std::size_t voxel = leaf * 512; voxel < leaf * 512 + 512; ++voxel) {
      const std::uint16_t at = layers[voxel];
      if (at == 0) continue;
      if (own.empty() || own.back() != at) own.push_back(at);
      for (std::size_t side = 0; side < 6; ++side) {
        const std::size_t beside = voxelBeside(blocks, voxel, side);
        if (beside == kNoVoxel || layers[beside] == 0 || layers[beside] == at) continue;
        if (near.empty() || near.back() != at) near.push_back(at);
      }
    }
    if (own.empty()) continue;
    const openvdb::Coord& origin = blocks.origins[leaf];
    const glm::dvec3 corner(origin.x(), origin.y(), origin.z());
    for (const std::uint32_t b : tree.meeting(widened({corner, corner + 7.0}, 1.0))) {
      const auto has = [&](const std::vector<std::uint16_t>& some) {
        return std::find(some.begin(), some.end(), layer[b] + 1) != some.end();
      };
      if (has(own)) isSeen[b] = true;
      if (has(near)) isNear[b] = true;
    }
  }
  out.kept = bodies.count();
  out.hidden = static_cast<std::size_t>(std::count(isSeen.begin(), isSeen.end(), false));
  out.bodies = static_cast<std::size_t>(std::count(isNear.begin(), isNear.end(), true));
}

}  // namespace

BodyLayers keptLayers(const LeafBlocks& blocks, const SearchedMesh& mesh,
                      const Progress* progress) {
  const MeshComponents components = meshComponents(mesh.mesh);
  if (components.count < 2) return {};
  KeptBodies bodies = keptBodies(mesh.mesh, components);
  if (bodies.count() < 2) return {};
  const auto spread = static_cast<std::uint32_t>(std::min(bodies.count(), kSpread));
  const std::vector<std::uint16_t> layer =
      layersApart(meetingPairs(bodies), bodies.count(), spread);
  const std::uint16_t highest = *std::max_element(layer.begin(), layer.end());
  if (highest >= kMostLayers) return {.areJoined = true};
  const VoxelLayers layers = voxelLayers(blocks, bodies, layer, progress);
  BodyLayers out;
  count(blocks, bodies, layer, layers, out);
  for (const std::uint32_t b : bodies.ofTriangle) out.ofTriangle.push_back(layer[b]);
  out.bodyOfTriangle = std::move(bodies.ofTriangle);
  out.voxels.assign(highest, std::vector<std::uint64_t>(blocks.inside.size(), 0));
  for (std::size_t voxel = 0; voxel < layers.size(); ++voxel) {
    if (layers[voxel] < 2) continue;
    out.voxels[layers[voxel] - 2u][voxel / 64] |= std::uint64_t{1} << (voxel % 64);
  }
  return out;
}

}  // namespace sherd
