// The planes of the next splits: decided on the host, from sums that kernels make.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>

#include "base/random.h"
#include "grow/splits/split_fracture.h"
#include "grow/splits/split_wall.h"
#include "seed/draw/irwin_hall.h"

namespace sherd {
namespace {

// The nodes of each split piece: [piece] leaf and node.
using NodesOfPieces = std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>;

NodesOfPieces nodesOfPieces(const GrowthState& state, const SplitNodes& nodes, std::size_t fracture,
                            const SplitFracture& of) {
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> pieceOf(of.ids.size() + 1, kNone);
  for (std::uint32_t i = 0; i < of.pieces.size(); ++i) {
    if (of.pieces[i].isSplit()) pieceOf[of.pieces[i].label] = i;
  }
  NodesOfPieces all(of.pieces.size());
  for (std::uint32_t leaf = 0; leaf < state.leafCount; ++leaf) {
    const auto [first, last] = nodes.of(fracture * state.leafCount + leaf);
    for (std::uint32_t node = first; node < last; ++node) {
      const std::uint32_t piece = pieceOf[nodes.label(node)];
      if (piece != kNone) all[piece].emplace_back(leaf, node);
    }
  }
  return all;
}

// A plane that surely has voxels on both sides: across the axis along which the piece is longest.
SplitPlane acrossAxis(const VoxelSums& sums) {
  const glm::dmat3 covariance = sums.covariance();
  int axis = 0;
  for (int i = 1; i < 3; ++i) axis = covariance[i][i] > covariance[axis][axis] ? i : axis;
  SplitPlane plane;
  // All voxels of a piece may have the same middle of the wall.
  plane.ignoresWalls = true;
  plane.normal[axis] = 1;
  plane.offset = static_cast<std::int64_t>(std::floor(64.0 * sums.mean()[axis]));
  return plane;
}

// Returns the share of a piece's voxels that its crack is meant to cut off.
double fractionOf(const SplitFracture& fracture, const SplitPiece& piece,
                  const SplitOptions& options) {
  const std::span<const double> shares(&fracture.shares[piece.first], piece.last - piece.first);
  const double normal =
      kNormalTerms * meanOfUniforms(kNormalTerms, fracture.seed, Stage::splitPart, piece.path);
  const std::size_t n = firstOf(shares, std::clamp(0.5 + options.offset * normal, 0.05, 0.95));
  double first = 0.0, all = 0.0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    all += shares[i];
    first += i < n ? shares[i] : 0.0;
  }
  return first / all;
}

// The crack of an impact's pattern, in integers.
SplitPlane planeOf(const ImpactSplit& split) {
  SplitPlane plane;
  plane.impact = split;
  if (split.radius > 0.0) {
    // A radius beyond any solid, whose square an integer still holds.
    constexpr double kMostRadius = 1 << 30;
    const double radius = std::min(64.0 * split.radius, kMostRadius);
    plane.isSphere = true;
    plane.center = glm::ivec3(glm::floor(64.0 * split.center + 0.5));
    plane.offset = static_cast<std::int64_t>(std::floor(radius * radius));
    return plane;
  }
  plane.normal = inSteps(split.normal);
  plane.offset = static_cast<std::int64_t>(
      std::floor(64.0 * glm::dot(glm::dvec3(plane.normal), split.center)));
  return plane;
}

// Voxels of a piece that are connected in a leaf.
struct VoxelCluster {
  std::uint32_t leaf = 0;
  double voxels = 0.0;  // times the density there
  double count = 0.0;   // of voxels
  glm::dvec3 mean{0.0};
  glm::dmat3 covariance{0.0};
};

// Returns where along a normal a fraction of the voxels lies below.
double positionOf(std::span<const VoxelCluster> clusters, const glm::dvec3& mean,
                  const glm::dmat3& covariance, const glm::dvec3& normal, double fraction) {
  ProjectedVoxels projected(glm::dot(normal, mean),
                            std::sqrt(glm::dot(normal, covariance * normal)));
  for (const VoxelCluster& cluster : clusters) {
    projected.add(glm::dot(normal, cluster.mean),
                  std::sqrt(glm::dot(normal, cluster.covariance * normal)), cluster.voxels);
  }
  return projected.quantile(fraction);
}

// Returns what a plane passes through or near, each leaf by how near it is: within half the
// deviation of the piece along the normal, so that leaves, which are coarse at low resolutions,
// matter little.
CrackedLeaves crackedLeaves(std::span<const VoxelCluster> clusters,
                            std::span<const glm::dmat3> walls, const glm::dmat3& covariance,
                            const glm::dvec3& normal, double position) {
  CrackedLeaves cracked;
  const double near = glm::dot(normal, covariance * normal) / 4.0;  // squared
  for (const VoxelCluster& cluster : clusters) {
    const double away = glm::dot(normal, cluster.mean) - position;
    const double reach = near + 6.0 * glm::dot(normal, cluster.covariance * normal);
    if (away * away >= reach) continue;
    const double weight = 1.0 - away * away / reach;
    cracked.voxels += weight * cluster.voxels;
    cracked.normals += weight * walls[cluster.leaf];
  }
  return cracked;
}

// Returns the crack by which the pattern of an impact divides a piece next, if one does.
std::optional<SplitPlane> crackOfImpact(SplitPiece& piece, std::span<const VoxelCluster> clusters,
                                        std::span<const SplitImpact> impacts) {
  const std::size_t count = piece.last - piece.first;
  while (!piece.pattern && piece.nextImpact < impacts.size()) {
    const SplitImpact& impact = impacts[piece.nextImpact++];
    if (impact.component != piece.component) continue;
    double all = 0.0, near = 0.0;
    for (const VoxelCluster& cluster : clusters) {
      all += cluster.count;
      const double away = glm::length(cluster.mean - impact.center);
      near += away < impact.outerRadius() ? cluster.count : 0.0;
    }
    // Where the pattern is most of a piece, its radial cracks run on to the piece's border.
    constexpr double kMost = 0.3;
    const ImpactPart whole = wholePattern(impacts, piece.nextImpact - 1, count, piece.path);
    if (near > kMost * all) {
      piece.pattern = whole;
    } else {
      return planeOf(outerRing(impacts, whole, count, piece.nextImpact));
    }
  }
  if (!piece.pattern) return {};
  const std::optional<ImpactSplit> split =
      nextSplit(impacts, *piece.pattern, piece.nextImpact, piece.path);
  if (!split) piece.pattern.reset();
  return split ? std::optional(planeOf(*split)) : std::nullopt;
}

SplitPlane planeThrough(const SplitFracture& fracture, SplitPiece& piece, const SplitNodes& nodes,
                        std::span<const std::pair<std::uint32_t, std::uint32_t>> own,
                        std::span<const glm::ivec3> low, const SplitRun& run,
                        const GrowOptions& options) {
  const VoxelSums& sums = fracture.sums[piece.label];
  if (piece.missed) return acrossAxis(sums);
  const glm::dmat3 covariance = sums.covariance();
  const double fraction = fractionOf(fracture, piece, options.split);
  std::vector<VoxelCluster> clusters;
  clusters.reserve(own.size());
  for (const auto& [leaf, node] : own) {
    const VoxelSums ofNode = nodes.sums(node);
    const double density = run.densities.empty() ? 1.0 : run.densities[leaf];
    const auto count = static_cast<double>(ofNode.count);
    clusters.push_back(
        {leaf, density * count, count, ofNode.mean() + glm::dvec3(low[leaf]), ofNode.covariance()});
  }
  if (std::optional<SplitPlane> crack = crackOfImpact(piece, clusters, fracture.impacts))
    return *crack;
  glm::dvec3 normal =
      crackNormal(covariance, options.split, options.anisotropy, fracture.seed, piece.path);
  if (!run.walls.empty()) {
    const double position = positionOf(clusters, sums.mean(), covariance, normal, fraction);
    normal = acrossWalls(crackedLeaves(clusters, run.walls, covariance, normal, position),
                         covariance, normal);
  }
  SplitPlane plane;
  plane.normal = inSteps(normal);
  plane.offset = static_cast<std::int64_t>(std::floor(
      64.0 * positionOf(clusters, sums.mean(), covariance, glm::dvec3(plane.normal), fraction)));
  return plane;
}

// The crack of a split that was decided before, from the lowest voxel.
SplitPlane planeOf(const Split& split, const openvdb::Coord& lowest) {
  SplitPlane plane;
  plane.normal = split.normal;
  plane.offset = split.offset;
  plane.added = split.added;
  plane.isSphere = split.isSphere;
  plane.ignoresWalls = !split.isSphere && split.center != glm::ivec3(0);
  if (split.isSphere) plane.center = split.center;
  for (int i = 0; i < 3; ++i) {
    plane.offset -= 64 * std::int64_t{split.normal[i]} * lowest[i];
    if (split.isSphere) plane.center[i] -= 64 * lowest[i];
  }
  return plane;
}

}  // namespace

void decidePlanes(const GrowthState& state, const SplitNodes& nodes, std::size_t index,
                  SplitFracture& fracture, std::span<const glm::ivec3> low, const SplitRun& run,
                  const GrowOptions& options) {
  fracture.planes.assign(fracture.ids.size() + 1, SplitPlane{});
  const NodesOfPieces own = nodesOfPieces(state, nodes, index, fracture);
  for (std::size_t i = 0; i < fracture.pieces.size(); ++i) {
    SplitPiece& piece = fracture.pieces[i];
    if (!piece.isSplit()) continue;
    if (const GivenSplit* const given =
            piece.isGiven ? fracture.given.next(piece.label) : nullptr) {
      fracture.planes[piece.label] = planeOf(given->split, fracture.lowest);
      continue;
    }
    SplitPlane plane = planeThrough(fracture, piece, nodes, own[i], low, run, options);
    plane.added = fracture.nextId();
    fracture.planes[piece.label] = plane;
  }
}

}  // namespace sherd
