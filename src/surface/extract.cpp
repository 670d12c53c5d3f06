// Fragments out of a labelled solid.
#include <sherd/error.h>
#include <sherd/fragments.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <string>

#include "surface/contacts.h"
#include "surface/cut.h"
#include "surface/decimate.h"
#include "surface/interface_mesh.h"
#include "surface/label_mesh.h"
#include "surface/level_set.h"
#include "surface/mesh.h"
#include "surface/smooth.h"
#include "surface/unbroken.h"
#include "uncancelled.h"

namespace sherd {
namespace {

// The leaves that concern each fragment: [fragments + 1], ascending.
std::vector<std::vector<std::uint32_t>> leavesOf(const Cut& cut, int fragments) {
  std::vector<std::vector<std::uint32_t>> leaves(static_cast<std::size_t>(fragments) + 1);
  for (std::uint32_t leaf = 0; leaf < cut.only.size(); ++leaf) {
    const auto add = [&](std::uint16_t fragment) {
      if (fragment != Labels::kWorn) leaves[fragment].push_back(leaf);
    };
    if (cut.index[leaf] == Cut::kWhole) {
      add(cut.only[leaf]);
    } else {
      for (const std::uint16_t fragment : cut.leaves[cut.index[leaf]].fragments) add(fragment);
    }
  }
  return leaves;
}

VoxelBox voxelBox(const Solid& solid, const Labels& labels, std::uint16_t fragment,
                  std::span<const std::uint32_t> leaves) {
  VoxelBox box{openvdb::Coord::max(), openvdb::Coord::min()};
  for (const std::uint32_t leaf : leaves) {
    for (std::size_t x = 0; x < 8; ++x) {
      for (std::uint64_t bits = solid.blocks.inside[leaf * 8 + x]; bits; bits &= bits - 1) {
        const auto v =
            static_cast<std::uint32_t>(x * 64) + static_cast<std::uint32_t>(std::countr_zero(bits));
        if (labels.fragment[std::size_t{leaf} * 512 + v] != fragment) continue;
        const openvdb::Coord voxel = solid.blocks.origins[leaf] + coordFromOffset(v);
        box.min.minComponent(voxel);
        box.max.maxComponent(voxel);
      }
    }
  }
  return box;
}

// The areas of the whole surface and of what faces others.
void measureAreas(Fragment& fragment) {
  double twice = 0.0, twiceFractured = 0.0;
  for (std::size_t t = 0; t < fragment.facing.size(); ++t) {
    const glm::uvec3& corner = fragment.mesh.triangles[t];
    const glm::dvec3& a = fragment.mesh.vertices[corner.x];
    const double own = glm::length(
        glm::cross(fragment.mesh.vertices[corner.y] - a, fragment.mesh.vertices[corner.z] - a));
    twice += own;
    if (fragment.facing[t] != 0) twiceFractured += own;
  }
  fragment.area = twice / 2.0;
  fragment.fractureArea = twiceFractured / 2.0;
}

// The meshes of all fragments, with what two share the same to the bit.
void meshTogether(std::span<Fragment> fragments, const Solid& solid, const Labels& labels,
                  const Cut& cut, std::span<const LeafRound> rounds, const Labels* unworn,
                  const SurfaceOptions& surface, const UnbrokenSurface* unbroken) {
  std::vector<LabelledMesh> meshes =
      interfaceMeshes(solid, labels, cut, rounds, static_cast<int>(fragments.size()), unbroken);
  std::vector<std::vector<std::uint16_t>> facing(meshes.size());
  tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t i) {
    facing[i] = meshes[i].other;
    if (!unworn) return;
    std::vector<bool> original;
    for (const std::uint16_t other : facing[i]) original.push_back(other == 0);
    facing[i] =
        facingOf(meshes[i].mesh, original, static_cast<std::uint16_t>(i + 1), solid, *unworn, true);
  });
  if (surface.adaptivity > 0.0) {
    std::vector<LabelledFaces> fewer =
        simplified(complexOf(meshes, facing), surface.adaptivity * solid.frame.voxelSize);
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      meshes[i] = std::move(fewer[i].mesh);
      facing[i] = std::move(fewer[i].facing);
    }
  }
  smoothTogether(meshes, facing, surface.smooth, solid.box.longestSide());
  std::vector<std::vector<CoarseMesh>> coarse;
  if (!surface.triangles.empty()) coarse = decimated(complexOf(meshes, facing), surface.triangles);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    fragments[i].mesh = std::move(meshes[i].mesh);
    fragments[i].facing = std::move(facing[i]);
    if (!coarse.empty()) fragments[i].coarse = std::move(coarse[i]);
  }
}

// The same for a fragment that was meshed by itself.
void shape(Fragment& fragment, const SurfaceOptions& surface, const Solid& solid) {
  if (surface.adaptivity > 0.0) {
    LabelledFaces fewer = std::move(simplified(complexOf(fragment.mesh, fragment.facing),
                                               surface.adaptivity * solid.frame.voxelSize)
                                        .front());
    fragment.mesh = std::move(fewer.mesh.mesh);
    fragment.facing = std::move(fewer.facing);
  }
  fragment.mesh =
      smoothed(std::move(fragment.mesh), fragment.facing, surface.smooth, solid.box.longestSide());
  fragment.coarse = decimated(fragment.mesh, fragment.facing, surface.triangles);
}

}  // namespace

std::vector<Fragment> extractFragments(const Solid& solid, const Labels& labels, int count,
                                       const Labels* unworn, const SurfaceOptions& surface,
                                       const Progress* progress, const UnbrokenSurface* unbroken) {
  checkSurfaceOptions(surface);
  step(progress, "extract", 0.0);
  const std::vector<std::uint64_t> voxels = countVoxels(solid.blocks, labels, count);
  if (voxels[0] != 0) {
    throw Error(ErrorCode::internal,
                std::to_string(voxels[0]) + " voxels of the solid have no fragment");
  }
  const bool isShared =
      surface.surface == Surface::smooth && surface.interface == Interface::shared;
  const bool hasLevelSets = surface.levelSets || !(isShared || surface.surface == Surface::labels);
  const std::vector<LeafRound> ownRounds =
      unbroken ? std::vector<LeafRound>() : leavesRound(solid.blocks.origins);
  const std::span<const LeafRound> rounds = unbroken ? unbroken->rounds : ownRounds;
  const Cut cut = findCut(solid.blocks, labels, rounds,
                          hasLevelSets ? CutExtent::everywhere : CutExtent::cells);
  const std::vector<std::vector<std::uint32_t>> leaves = leavesOf(cut, count);

  const Labels& before = unworn ? *unworn : labels;
  std::vector<Fragment> fragments(static_cast<std::size_t>(count));
  if (isShared) meshTogether(fragments, solid, labels, cut, rounds, unworn, surface, unbroken);
  const auto extract = [&](std::size_t i) {
    Fragment& fragment = fragments[i];
    fragment.id = static_cast<int>(i) + 1;
    const auto id = static_cast<std::uint16_t>(fragment.id);
    fragment.voxels = voxels[i + 1];
    fragment.voxelBox = voxelBox(solid, labels, id, leaves[i + 1]);
    if (hasLevelSets) {
      fragment.surface = fragmentLevelSet(solid, cut, id, leaves[i + 1]);
    }
    if (surface.surface == Surface::labels) {
      VoxelMesh meshed =
          meshOfFaces(facesOf(solid, labels, before, id, leaves[i + 1]), solid.frame);
      fragment.mesh = std::move(meshed.mesh);
      fragment.facing = std::move(meshed.facing);
    } else if (!isShared) {
      LevelSetMesh meshed =
          meshLevelSet(*fragment.surface, solid.frame, solidOver(solid, leaves[i + 1]).get());
      fragment.mesh = std::move(meshed.mesh);
      fragment.facing =
          facingOf(fragment.mesh, meshed.original, id, solid, before, unworn != nullptr);
    }
    if (!isShared) shape(fragment, surface, solid);
    fragment.mass = massProperties(fragment.mesh);
    measureAreas(fragment);
  };
  // In rounds, so that the caller's thread can report and be stopped between them.
  constexpr std::size_t kRound = 8;
  for (std::size_t first = 0; first < fragments.size(); first += kRound) {
    tbb::parallel_for(first, std::min(first + kRound, fragments.size()),
                      [&](std::size_t i) { uncancelled([&] { extract(i); }); });
    step(progress, "extract",
         static_cast<double>(std::min(first + kRound, fragments.size())) /
             static_cast<double>(fragments.size()));
  }
  addContacts(fragments, solid, before, cut, rounds);
  return fragments;
}

TriangleMesh solidMesh(const Solid& solid, const SurfaceOptions& options) {
  if (options.interface == Interface::shared) {
    Labels one;
    one.fragment.assign(solid.blocks.count() * 512, 1);
    Cut uncut;
    uncut.only.assign(solid.blocks.count(), 1);
    uncut.index.assign(solid.blocks.count(), Cut::kWhole);
    uncut.stairs.resize(2);
    const std::vector<LeafRound> rounds = leavesRound(solid.blocks.origins);
    return std::move(interfaceMeshes(solid, one, uncut, rounds, 1).front().mesh);
  }
  return meshLevelSet(*solid.distance, solid.frame, nullptr).mesh;
}

}  // namespace sherd
