// Pieces, and the shares of the fragments that come of them.
#include "grow/split_fracture.h"

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

}  // namespace

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
      if (plane.impact) {
        afterMiss(*plane.impact, fracture.sums[piece.label].mean(), piece.nextImpact,
                  piece.pattern);
      } else {
        piece.missed = plane.normal != glm::ivec3(0);
      }
      std::swap(*std::find(fracture.ids.begin(), fracture.ids.end(), plane.added),
                fracture.ids[--fracture.taken]);
      pieces.push_back(piece);
      continue;
    }
    const std::size_t count = piece.last - piece.first;
    const std::span<const double> shares(&fracture.shares[piece.first], count);
    const double keptMass = fracture.mass[piece.label], addedMass = fracture.mass[plane.added];
    std::size_t first = firstOf(shares, keptMass / (keptMass + addedMass));
    std::vector<std::uint64_t> keptSides, addedSides;
    if (plane.impact) {
      first = keptPieces(*plane.impact, count, kept, added);
    } else if (plane.normal == glm::ivec3(0)) {
      first = dividedSides(piece, plane.offset, first, keptSides, addedSides);
    }
    first = std::min(first, kept);
    if (count - first > added) first = count - added;
    const int generation = piece.generation + 1;
    fracture.splits.push_back({piece.label, plane.added, piece.generation, plane.normal,
                               plane.offset, kept + added, plane.isSphere,
                               plane.ignoresWalls ? glm::ivec3(1) : plane.center});
    pieces.push_back({piece.label, piece.first, piece.first + first, generation,
                      mixed(2 * piece.path + 1), false, std::move(keptSides), piece.component,
                      piece.nextImpact, piece.pattern});
    pieces.push_back({plane.added, piece.first + first, piece.last, generation,
                      mixed(2 * piece.path + 2), false, std::move(addedSides), piece.component,
                      piece.nextImpact, piece.pattern});
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

}  // namespace

SplitFracture startedFracture(const SplitRun& run, const LeafBlocks& blocks,
                              const VoxelComponents& components, const openvdb::Coord& lowest) {
  SplitFracture fracture;
  fracture.seed = run.seed;
  fracture.impacts.assign(run.impacts.begin(), run.impacts.end());
  for (SplitImpact& impact : fracture.impacts) {
    impact.center -= glm::dvec3(lowest.x(), lowest.y(), lowest.z());
  }
  fracture.ids = permutedIds(run.shares.size(), run.seed);
  const std::vector<std::uint64_t>& voxels = components.voxels();
  std::vector<double> mass(voxels.begin(), voxels.end());
  if (!run.densities.empty()) mass = massOfComponents(blocks, components, run.densities);
  for (const std::vector<double>& shares : sharesOfComponents(run.shares, mass, voxels)) {
    const std::size_t first = fracture.shares.size();
    fracture.shares.insert(fracture.shares.end(), shares.begin(), shares.end());
    const std::uint64_t path = mixed(fracture.pieces.size() + 1);
    const auto component = static_cast<std::uint32_t>(fracture.pieces.size());
    fracture.pieces.push_back(
        {fracture.nextId(), first, fracture.shares.size(), 0, path, false, {}, component});
  }
  return fracture;
}

}  // namespace sherd
