// Pieces, and the shares of the fragments that come of them.
#include "grow/splits/split_fracture.h"

#include <algorithm>
#include <bit>
#include <set>
#include <utility>

#include "base/random.h"
#include "seed/fragment_ids.h"

namespace sherd {

std::vector<std::vector<std::uint64_t>> sidesOfComponents(const LeafBlocks& blocks,
                                                          const VoxelComponents& components,
                                                          const GuideSides& guides) {
  const std::size_t cracks = std::min<std::size_t>(guides.positive.size(), 64);
  std::vector<std::set<std::uint64_t>> found(components.count());
  std::vector<std::uint64_t> before(components.count(), 0);  // to search rarely
  blocks.forEachInside([&](std::size_t voxel) {
    std::uint64_t sides = 0;
    for (std::size_t i = 0; i < cracks; ++i) {
      sides |= (guides.positive[i][voxel / 64] >> (voxel % 64) & 1) << i;
    }
    const std::uint32_t component = components.at(voxel);
    if (sides == before[component] && !found[component].empty()) return;
    found[component].insert(before[component] = sides);
  });
  std::vector<std::vector<std::uint64_t>> all;
  for (const std::set<std::uint64_t>& each : found) all.emplace_back(each.begin(), each.end());
  return all;
}

namespace {

// Divides the sides of a piece that is split by a given crack, and returns how many of `count`
// shares the first part gets, near `first`: each part one for each of its sides, if there are
// enough, so that later cracks can split them.
std::size_t dividedSides(const SplitPiece& piece, std::int64_t crack, std::size_t first,
                         std::vector<std::uint64_t>& kept, std::vector<std::uint64_t>& added) {
  if (piece.sides.empty() || crack >= 64) return first;
  for (const std::uint64_t each : piece.sides) ((each >> crack & 1) ? added : kept).push_back(each);
  const std::size_t count = piece.last - piece.first;
  if (kept.size() + added.size() > count) return first;
  // Components that joined the other part are not among its sides: each part gets a share.
  return std::clamp(std::clamp(first, kept.size(), count - added.size()), std::size_t{1},
                    count - 1);
}

// The number of fragments that come of a piece's part that keeps its id, and the sides of given
// cracks that both parts have.
struct DividedPiece {
  std::size_t first = 1;
  std::vector<std::uint64_t> keptSides{}, addedSides{};
};

DividedPiece dividedPiece(const SplitFracture& fracture, const SplitPiece& piece,
                          const SplitPlane& plane) {
  DividedPiece divided;
  if (piece.isGiven) {
    divided.first = fracture.given.next(piece.label)->kept;
    return divided;
  }
  const std::size_t count = piece.last - piece.first;
  if (plane.impact) {
    divided.first =
        keptPieces(*plane.impact, count, static_cast<std::size_t>(fracture.sums[piece.label].count),
                   static_cast<std::size_t>(fracture.sums[plane.added].count));
    return divided;
  }
  const std::span<const double> shares(&fracture.shares[piece.first], count);
  const double keptMass = fracture.mass[piece.label], addedMass = fracture.mass[plane.added];
  divided.first = firstOf(shares, keptMass / (keptMass + addedMass));
  if (plane.normal == glm::ivec3(0)) {
    divided.first =
        dividedSides(piece, plane.offset, divided.first, divided.keptSides, divided.addedSides);
  }
  return divided;
}

// Decides anew the splits that are left of a piece.
void dropGiven(SplitFracture& fracture, std::uint16_t id) {
  for (const std::uint16_t dropped : fracture.given.dropped(id)) fracture.returnId(dropped);
}

// After a crack that has all voxels of a piece on one side.
void recordMiss(SplitFracture& fracture, SplitPiece& piece, const SplitPlane& plane) {
  if (piece.isGiven) {
    dropGiven(fracture, piece.label);
    piece.isGiven = false;
    return;
  }
  if (plane.impact) {
    afterMiss(*plane.impact, fracture.sums[piece.label].mean(), piece.nextImpact, piece.pattern);
  } else {
    piece.missed = plane.normal != glm::ivec3(0);
  }
  fracture.returnId(plane.added);
}

}  // namespace

void SplitFracture::returnId(std::uint16_t id) {
  std::swap(*std::find(ids.begin(), ids.end(), id), ids[--taken]);
}

void recordSplits(SplitFracture& fracture) {
  std::vector<SplitPiece> pieces;
  for (SplitPiece& piece : fracture.pieces) {
    const SplitPlane& plane = fracture.planes[piece.label];
    if (plane.added == 0) {
      pieces.push_back(piece);
      continue;
    }
    const auto kept = static_cast<std::size_t>(fracture.sums[piece.label].count),
               added = static_cast<std::size_t>(fracture.sums[plane.added].count);
    if (added == 0) {
      recordMiss(fracture, piece, plane);
      pieces.push_back(piece);
      continue;
    }
    const std::size_t count = piece.last - piece.first;
    DividedPiece divided = dividedPiece(fracture, piece, plane);
    std::size_t first = std::min(divided.first, kept);
    if (count - first > added) first = count - added;
    bool isGiven = piece.isGiven;
    if (isGiven) fracture.given.advance(piece.label);
    if (isGiven && first != divided.first) {  // too few voxels for the fragments of a part
      isGiven = false;
      dropGiven(fracture, piece.label);
      dropGiven(fracture, plane.added);
    }
    const int generation = piece.generation + 1;
    fracture.splits.push_back({piece.label, plane.added, piece.generation, plane.normal,
                               plane.offset, kept + added, plane.isSphere,
                               plane.ignoresWalls ? glm::ivec3(1) : plane.center});
    fracture.decided.push_back({fracture.splits.back(), first});
    pieces.push_back({piece.label, piece.first, piece.first + first, generation,
                      mixed(2 * piece.path + 1), false, std::move(divided.keptSides),
                      piece.component, isGiven, piece.nextImpact, piece.pattern});
    pieces.push_back({plane.added, piece.first + first, piece.last, generation,
                      mixed(2 * piece.path + 2), false, std::move(divided.addedSides),
                      piece.component, isGiven, piece.nextImpact, piece.pattern});
    if (plane.impact) {
      SplitPiece &keptPiece = pieces[pieces.size() - 2], &addedPiece = pieces.back();
      keptPiece.pattern = plane.impact->kept;
      addedPiece.pattern = plane.impact->added;
      keptPiece.nextImpact = addedPiece.nextImpact = plane.impact->nextImpact;
    }
  }
  fracture.pieces = std::move(pieces);
}

namespace {

// [components] voxels times the densities of their leaves: of a leaf with several components, all
// count for that of its first voxel.
std::vector<double> massOfComponents(const LeafBlocks& blocks, const VoxelComponents& components,
                                     std::span<const double> densities) {
  std::vector<double> mass(components.count(), 0.0);
  for (std::size_t leaf = 0; leaf < densities.size(); ++leaf) {
    std::size_t voxels = 0, first = 0;
    for (std::size_t word = leaf * 8; word < leaf * 8 + 8; ++word) {
      const std::uint64_t bits = blocks.inside[word];
      if (voxels == 0) first = word * 64 + static_cast<std::size_t>(std::countr_zero(bits));
      voxels += static_cast<std::size_t>(std::popcount(bits));
    }
    if (voxels > 0) mass[components.at(first)] += densities[leaf] * static_cast<double>(voxels);
  }
  return mass;
}

// Makes the pieces of components as their splits were decided.
void startGiven(SplitFracture& fracture, const GivenSplits& given) {
  fracture.given = GivenOrder(given);
  fracture.shares = given.shares;
  fracture.roots = given.roots;
  fracture.taken = fracture.ids.size();
  std::size_t first = 0;
  for (const GivenSplits::Root& root : given.roots) {
    const auto component = static_cast<std::uint32_t>(fracture.pieces.size());
    const std::uint64_t path = mixed(fracture.pieces.size() + 1);
    fracture.pieces.push_back(
        {root.id, first, first + root.fragments, 0, path, false, {}, component, true});
    first += root.fragments;
  }
}

}  // namespace

SplitFracture startedFracture(const SplitRun& run, const LeafBlocks& blocks,
                              const VoxelComponents& components, const openvdb::Coord& lowest) {
  SplitFracture fracture;
  fracture.seed = run.seed;
  fracture.lowest = lowest;
  fracture.impacts.assign(run.impacts.begin(), run.impacts.end());
  for (SplitImpact& impact : fracture.impacts) {
    impact.center -= glm::dvec3(lowest.x(), lowest.y(), lowest.z());
  }
  fracture.ids = permutedIds(run.shares.size(), run.seed);
  if (run.given != nullptr) {
    startGiven(fracture, *run.given);
    return fracture;
  }
  const std::vector<std::uint64_t>& voxels = components.voxels();
  std::vector<double> mass(voxels.begin(), voxels.end());
  if (!run.densities.empty()) mass = massOfComponents(blocks, components, run.densities);
  for (const std::vector<double>& shares : sharesOfComponents(run.shares, mass, voxels)) {
    const std::size_t first = fracture.shares.size();
    fracture.shares.insert(fracture.shares.end(), shares.begin(), shares.end());
    const std::uint64_t path = mixed(fracture.pieces.size() + 1);
    const auto component = static_cast<std::uint32_t>(fracture.pieces.size());
    const std::uint16_t id = fracture.nextId();
    fracture.roots.push_back({id, shares.size()});
    fracture.pieces.push_back({id, first, fracture.shares.size(), 0, path, false, {}, component});
  }
  return fracture;
}

}  // namespace sherd
