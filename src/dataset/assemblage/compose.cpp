// Puts fractures of several objects together as one.
#include "dataset/assemblage/compose.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

#include "base/random.h"
#include "dataset/assemblage/compose_grid.h"
#include "mesh/joined.h"
#include "seed/fragment_ids.h"

namespace sherd {
namespace {

/// Voxels along x from the first solid's.
int shiftOf(const Solid& solid, const Solid& first) {
  return static_cast<int>(
      std::lround((solid.frame.origin.x - first.frame.origin.x) / first.frame.voxelSize));
}

// Appends the leaf blocks of a solid.
void append(LeafBlocks& all, const LeafBlocks& own, int shift) {
  const auto before = static_cast<std::uint32_t>(all.count());
  const std::size_t words = all.inside.size();
  for (const openvdb::Coord& origin : own.origins) {
    all.origins.push_back(origin + openvdb::Coord(shift, 0, 0));
  }
  all.inside.insert(all.inside.end(), own.inside.begin(), own.inside.end());
  all.exteriorBand.insert(all.exteriorBand.end(), own.exteriorBand.begin(), own.exteriorBand.end());
  for (const std::uint32_t neighbor : own.neighbors) {
    all.neighbors.push_back(neighbor == LeafBlocks::kNone ? neighbor : neighbor + before);
  }
  if (all.layers.size() < own.layers.size()) {
    all.layers.resize(own.layers.size(), std::vector<std::uint64_t>(words, 0));
  }
  for (std::size_t i = 0; i < all.layers.size(); ++i) {
    if (i < own.layers.size()) {
      all.layers[i].insert(all.layers[i].end(), own.layers[i].begin(), own.layers[i].end());
    }
    all.layers[i].resize(all.inside.size(), 0);
  }
}

Solid composedSolid(const std::vector<const Solid*>& parts) {
  const Solid& first = *parts.front();
  Solid all;
  all.frame = first.frame;
  all.box = first.box;
  std::vector<PlacedGrid> grids;
  LeafBlocks blocks;
  for (const Solid* part : parts) {
    const int shift = shiftOf(*part, first);
    const openvdb::Coord by(shift, 0, 0);
    const bool isBeyond = blocks.origins.empty() || part->blocks->origins.empty() ||
                          (part->blocks->origins.front() + by).x() > blocks.origins.back().x();
    if (shift % 8 != 0 || !isBeyond) {
      throw Error(ErrorCode::internal, "the objects of an assemblage are not beside one another");
    }
    append(blocks, *part->blocks, shift);
    grids.push_back({part->distance, shift});
    all.box.min.minComponent(part->box.min + by);
    all.box.max.maxComponent(part->box.max + by);
    all.voxels += part->voxels;
    all.smallComponents += part->smallComponents;
    all.smallComponentVoxels += part->smallComponentVoxels;
  }
  all.distance = composedGrid(grids, first.distance);
  all.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  return all;
}

// Returns [parts][id] the ids in the whole: those that are kept first, each kind in a random order.
std::vector<std::vector<std::uint16_t>> composedIds(const std::vector<FracturePart>& parts,
                                                    std::uint64_t seed, std::size_t& kept) {
  std::size_t all = 0;
  kept = 0;
  for (const FracturePart& part : parts) {
    all += part.result.fragments.size();
    kept += part.only == kAllKept ? part.result.kept() : 1;
  }
  if (all > static_cast<std::size_t>(kMaxFragments)) {
    throw Error(ErrorCode::input, "an assemblage has " + std::to_string(all) +
                                      " fragments, more than " + std::to_string(kMaxFragments));
  }
  const auto order = permutedIds(kept, randomBits(seed, Stage::fragmentId, std::uint64_t{2} << 32));
  const auto rest =
      permutedIds(all - kept, randomBits(seed, Stage::fragmentId, std::uint64_t{3} << 32));
  std::size_t nextKept = 0, nextRest = 0;
  std::vector<std::vector<std::uint16_t>> ids;
  for (const FracturePart& part : parts) {
    std::vector<std::uint16_t> own{0};
    for (std::size_t i = 0; i < part.result.fragments.size(); ++i) {
      const bool isKept = part.only == kAllKept ? i < part.result.kept() : i == part.only;
      own.push_back(isKept ? order[nextKept++]
                           : static_cast<std::uint16_t>(rest[nextRest++] + kept));
    }
    ids.push_back(std::move(own));
  }
  return ids;
}

void renumber(TriangleMesh& mesh, const std::vector<std::uint16_t>& ids) {
  for (std::uint16_t& neighbor : mesh.neighbor) neighbor = ids[neighbor];
}

void renumber(Fragment& fragment, const std::vector<std::uint16_t>& ids, int shift) {
  fragment.id = ids[static_cast<std::size_t>(fragment.id)];
  fragment.voxelBox.min += openvdb::Coord(shift, 0, 0);
  fragment.voxelBox.max += openvdb::Coord(shift, 0, 0);
  renumber(fragment.mesh, ids);
  for (TriangleMesh& coarse : fragment.coarse) renumber(coarse, ids);
  for (Contact& contact : fragment.contacts) {
    contact.fragment = ids[static_cast<std::size_t>(contact.fragment)];
  }
  std::ranges::sort(fragment.contacts, {}, &Contact::fragment);
}

void appendLabels(Labels& all, const Labels& own, const std::vector<std::uint16_t>& ids) {
  for (const std::uint16_t label : own.fragment) {
    all.fragment.push_back(label == Labels::kEroded ? label : ids[label]);
  }
  all.cost.insert(all.cost.end(), own.cost.begin(), own.cost.end());
}

// Adds a part without its voxels.
void addPart(FractureResult& all, FractureResult part, const std::vector<std::uint16_t>& ids,
             const Solid& first, int object) {
  const int shift = shiftOf(part.solid, first);
  all.components += part.components;
  for (Seed seed : part.seeds) {
    seed.voxel += openvdb::Coord(shift, 0, 0);
    seed.fragment = ids[seed.fragment];
    all.seeds.push_back(seed);
  }
  all.seedsOn = part.seedsOn;
  all.eroded[0] += part.eroded[0];
  for (std::size_t id = 1; id < ids.size(); ++id) {
    all.eroded[ids[id]] = part.eroded[id];
    all.objectOf[ids[id] - 1u] = object;
    Fragment& fragment = all.fragments[ids[id] - 1u];
    fragment = std::move(part.fragments[id - 1]);
    renumber(fragment, ids, shift);
    if (fragment.surface != nullptr && shift != 0) {
      const PlacedGrid placed{fragment.surface, shift};
      fragment.surface = composedGrid(std::span(&placed, 1), first.distance);
    }
  }
  if (all.exactFailure.empty()) all.exactFailure = std::move(part.exactFailure);
  all.alone += part.alone;
  all.sizeError = std::max(all.sizeError, part.sizeError);
}

}  // namespace

ComposedFracture composed(std::vector<FracturePart> parts, std::uint64_t seed) {
  std::size_t kept = 0;
  ComposedFracture all{.result = {}, .newIds = composedIds(parts, seed, kept)};
  std::size_t count = 0;
  std::vector<const Solid*> solids;
  for (const FracturePart& part : parts) {
    solids.push_back(&part.result.solid);
    count += part.result.fragments.size();
  }
  FractureResult& result = all.result;
  result.solid = composedSolid(solids);
  result.labels.blocks = result.solid.blocks;
  result.labels.fragmentCount = static_cast<int>(count);
  result.fragments.resize(count);
  result.objectOf.resize(count);
  result.eroded.assign(count + 1, 0);
  result.withheld = count - kept;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    appendLabels(result.labels, parts[k].result.labels, all.newIds[k]);
  }
  const Solid first = parts.front().result.solid;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    addPart(result, std::move(parts[k].result), all.newIds[k], first, static_cast<int>(k));
  }
  return all;
}

FractureResult composedWhole(std::vector<FractureResult> wholes) {
  FractureResult all;
  std::vector<const Solid*> solids;
  for (const FractureResult& whole : wholes) solids.push_back(&whole.solid);
  all.solid = composedSolid(solids);
  all.labels.blocks = all.solid.blocks;
  all.labels.fragmentCount = 1;
  all.eroded = {0, 0};
  all.fragments.resize(1);
  Fragment& fragment = all.fragments.front();
  fragment.id = 1;
  fragment.voxels = all.solid.voxels;
  fragment.voxelBox = all.solid.box;
  fragment.surface = all.solid.distance;
  fragment.coarse.resize(wholes.front().fragments.front().coarse.size());
  for (FractureResult& whole : wholes) {
    appendLabels(all.labels, whole.labels, {0, 1});
    all.components += whole.components;
    Fragment& own = whole.fragments.front();
    fragment.meshedAs = own.meshedAs;
    fragment.area += own.area;
    own.mesh.source.clear();
    fragment.mesh = joined(std::move(fragment.mesh), own.mesh);
    for (std::size_t i = 0; i < fragment.coarse.size(); ++i) {
      fragment.coarse[i] = joined(std::move(fragment.coarse[i]), own.coarse[i]);
    }
  }
  fragment.mass = massProperties(fragment.mesh);
  return all;
}

}  // namespace sherd
