// The generations of splits: planes are decided on the host, from sums that kernels make.
#include "grow/split.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <queue>
#include <set>
#include <utility>

#include "base/cancel_flag.h"
#include "base/random.h"
#include "grow/split_nodes.h"
#include "grow/split_plan.h"
#include "grow/split_wall.h"
#include "seed/fragment_ids.h"
#include "seed/irwin_hall.h"
#include "voxelize/leaf_blocks.h"

namespace sherd {
namespace {

// A piece, and the shares of the fragments that come of it: [first, last) of its fracture's.
struct Piece {
  std::uint16_t label = 0;
  std::size_t first = 0, last = 0;
  int generation = 0;
  std::uint64_t path = 0;              // hash of the sides of all splits before, for random numbers
  bool missed = false;                 // the last plane had all voxels on one side
  std::vector<std::uint64_t> sides{};  // of given cracks, that its voxels are on, ascending: a bit
                                       // for each of the first 64

  bool isSplit() const { return last - first > 1; }
};

// The plane through a piece, and the label of the positive side.
struct Plane {
  glm::ivec3 normal{0};
  std::int64_t offset = 0;
  std::uint16_t added = 0;
};

// One fracture on the host.
struct Fracture {
  std::uint64_t seed = 0;
  std::vector<double> shares{};
  std::vector<std::uint16_t> ids{};  // in the order in which pieces take them
  std::size_t taken = 0;
  std::vector<Piece> pieces{};
  std::vector<Split> splits{};
  std::vector<VoxelSums> sums{};  // [labels + 1]
  std::vector<double> mass{};     // [labels + 1] voxels times densities
  std::vector<Plane> planes{};    // [labels + 1] of this generation

  std::uint16_t nextId() { return ids[taken++]; }
};

// The sums of nodes by label.
std::vector<VoxelSums> sumsOfLabels(const GrowthState& state, const SplitNodes& nodes,
                                    std::size_t fracture, std::size_t labels,
                                    std::span<const glm::ivec3> low) {
  std::vector<VoxelSums> sums(labels + 1);
  for (std::size_t leaf = 0; leaf < state.leafCount; ++leaf) {
    const auto [first, last] = nodes.of(fracture * state.leafCount + leaf);
    for (std::size_t node = first; node < last; ++node) {
      sums[nodes.label(node)].add(nodes.sums(node), low[leaf]);
    }
  }
  return sums;
}

// The voxels of nodes times the densities of their leaves, by label.
std::vector<double> massOfLabels(const GrowthState& state, const SplitNodes& nodes,
                                 std::size_t fracture, std::span<const VoxelSums> sums,
                                 std::span<const double> densities) {
  std::vector<double> mass(sums.size(), 0.0);
  if (densities.empty()) {
    for (std::size_t i = 0; i < mass.size(); ++i) mass[i] = static_cast<double>(sums[i].count);
    return mass;
  }
  for (std::size_t leaf = 0; leaf < state.leafCount; ++leaf) {
    const auto [first, last] = nodes.of(fracture * state.leafCount + leaf);
    for (std::size_t node = first; node < last; ++node) {
      mass[nodes.label(node)] += nodes.voxels(node) * densities[leaf];
    }
  }
  return mass;
}

// The nodes of each split piece: [piece] leaf and node.
using NodesOfPieces = std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>;

NodesOfPieces nodesOfPieces(const GrowthState& state, const SplitNodes& nodes, std::size_t fracture,
                            const Fracture& of) {
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
Plane acrossAxis(const VoxelSums& sums) {
  const glm::dmat3 covariance = sums.covariance();
  int axis = 0;
  for (int i = 1; i < 3; ++i) axis = covariance[i][i] > covariance[axis][axis] ? i : axis;
  Plane plane;
  plane.normal[axis] = 1;
  plane.offset = static_cast<std::int64_t>(std::floor(64.0 * sums.mean()[axis]));
  return plane;
}

// Returns the share of a piece's voxels that its crack is meant to cut off.
double fractionOf(const Fracture& fracture, const Piece& piece, const SplitOptions& options) {
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

// Voxels of a piece that are connected in a leaf.
struct VoxelCluster {
  std::uint32_t leaf = 0;
  double voxels = 0.0;  // times the density there
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

Plane planeThrough(const Fracture& fracture, const Piece& piece, const SplitNodes& nodes,
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
    clusters.push_back({leaf, density * static_cast<double>(ofNode.count),
                        ofNode.mean() + glm::dvec3(low[leaf]), ofNode.covariance()});
  }
  glm::dvec3 normal =
      crackNormal(covariance, options.split, options.anisotropy, fracture.seed, piece.path);
  if (!run.walls.empty()) {
    const double position = positionOf(clusters, sums.mean(), covariance, normal, fraction);
    normal = acrossWalls(crackedLeaves(clusters, run.walls, covariance, normal, position),
                         covariance, normal);
  }
  Plane plane;
  plane.normal = inSteps(normal);
  plane.offset = static_cast<std::int64_t>(std::floor(
      64.0 * positionOf(clusters, sums.mean(), covariance, glm::dvec3(plane.normal), fraction)));
  return plane;
}

// Decides the planes of all pieces that are split next.
void decidePlanes(const GrowthState& state, const SplitNodes& nodes, std::size_t index,
                  Fracture& fracture, std::span<const glm::ivec3> low, const SplitRun& run,
                  const GrowOptions& options) {
  fracture.planes.assign(fracture.ids.size() + 1, Plane{});
  const NodesOfPieces own = nodesOfPieces(state, nodes, index, fracture);
  for (std::size_t i = 0; i < fracture.pieces.size(); ++i) {
    const Piece& piece = fracture.pieces[i];
    if (!piece.isSplit()) continue;
    Plane plane = planeThrough(fracture, piece, nodes, own[i], low, run, options);
    plane.added = fracture.nextId();
    fracture.planes[piece.label] = plane;
  }
}

// Splits the voxels of all fractures by their planes, on the device.
void splitByPlanes(GrowthState& state, const DeviceLabels& labels, const DeviceBuffer& origins,
                   std::span<const Fracture> fractures) {
  std::vector<Int4> plane;
  std::vector<std::int64_t> offset;
  std::vector<std::uint32_t> first;
  for (const Fracture& fracture : fractures) {
    first.push_back(static_cast<std::uint32_t>(plane.size()));
    for (const Plane& each : fracture.planes) {
      plane.push_back({each.normal.x, each.normal.y, each.normal.z, each.added});
      offset.push_back(each.offset);
    }
  }
  state.run(
      "split_labels", state.items, state.inside, origins, state.leafCount, state.items,
      uploadBuffer<std::uint32_t>(state.device, first), uploadBuffer<Int4>(state.device, plane),
      uploadBuffer<std::int64_t>(state.device, offset), labels.owner, labels.tag, labels.second);
}

// Gives every piece that can be split a second label; those without voxels on one side of a given
// crack stay whole.
void splitAll(Fracture& fracture, std::size_t crack) {
  fracture.planes.assign(fracture.ids.size() + 1, Plane{});
  for (const Piece& piece : fracture.pieces) {
    if (!piece.isSplit()) continue;
    fracture.planes[piece.label] = {glm::ivec3(0), static_cast<std::int64_t>(crack),
                                    fracture.nextId()};
  }
}

// Splits the voxels of all fractures by the sides of a given crack, on the device.
void splitBySides(GrowthState& state, const DeviceLabels& labels,
                  std::span<const std::uint64_t> positive, std::span<const Fracture> fractures) {
  std::vector<std::uint32_t> first, added;
  for (const Fracture& fracture : fractures) {
    first.push_back(static_cast<std::uint32_t>(added.size()));
    for (const Plane& each : fracture.planes) added.push_back(each.added);
  }
  state.run("split_by_sides", state.items, state.inside,
            uploadBuffer<std::uint64_t>(state.device, positive), state.leafCount, state.items,
            uploadBuffer<std::uint32_t>(state.device, first),
            uploadBuffer<std::uint32_t>(state.device, added), labels.owner, labels.tag,
            labels.second);
}

// The components of the two sides of a piece, by their roots.
struct Sides {
  struct Component {
    std::uint32_t root;
    std::uint64_t voxels;
  };
  std::vector<Component> kept{}, added{};

  bool isEach() const { return kept.size() == 1 && added.size() == 1; }
};

const Sides::Component& largest(const std::vector<Sides::Component>& components) {
  return *std::max_element(components.begin(), components.end(), [](const auto& a, const auto& b) {
    return a.voxels != b.voxels ? a.voxels < b.voxels : a.root > b.root;
  });
}

// [labels + 1] the sides of pieces that are split in this generation.
std::vector<Sides> sidesOf(const GrowthState& state, const SplitNodes& nodes, std::size_t index,
                           const Fracture& fracture, std::span<const std::uint64_t> ofRoot) {
  std::vector<std::uint16_t> parent(fracture.ids.size() + 1, 0);
  for (std::size_t label = 1; label < fracture.planes.size(); ++label) {
    const std::uint16_t added = fracture.planes[label].added;
    if (added == 0) continue;
    parent[label] = static_cast<std::uint16_t>(label);
    parent[added] = static_cast<std::uint16_t>(label);
  }
  std::vector<Sides> sides(fracture.ids.size() + 1);
  const std::size_t begin = index * state.leafCount;
  for (std::size_t item = begin; item < begin + state.leafCount; ++item) {
    const auto [first, last] = nodes.of(item);
    for (std::uint32_t node = first; node < last; ++node) {
      const std::uint16_t label = nodes.label(node);
      if (nodes.root(node) != node || parent[label] == 0) continue;
      Sides& of = sides[parent[label]];
      (label == parent[label] ? of.kept : of.added).push_back({node, ofRoot[node]});
    }
  }
  return sides;
}

// Assigns each component of a piece to one of two connected parts, those of the largest component
// of each side: the others join what they touch first.  Returns the roots of the added part.
//   contacts  of the piece's components, ascending
std::vector<std::uint32_t> addedPart(
    const Sides& sides, std::span<const std::pair<std::uint32_t, std::uint32_t>> contacts) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> touching;
  for (const auto& [a, b] : contacts) {
    touching[a].push_back(b);
    touching[b].push_back(a);
  }
  std::map<std::uint32_t, bool> isAdded{{largest(sides.kept).root, false},
                                        {largest(sides.added).root, true}};
  std::queue<std::uint32_t> next;
  next.push(largest(sides.kept).root);
  next.push(largest(sides.added).root);
  for (; !next.empty(); next.pop()) {
    for (const std::uint32_t other : touching[next.front()]) {
      if (isAdded.emplace(other, isAdded[next.front()]).second) next.push(other);
    }
  }
  std::vector<std::uint32_t> added;
  for (const auto& [root, is] : isAdded) {
    if (is) added.push_back(root);
  }
  return added;
}

// Labels components anew, so that both sides of every piece are connected.
void connectSides(GrowthState& state, const DeviceLabels& labels, SplitNodes& nodes,
                  std::span<const Fracture> fractures) {
  std::vector<std::uint64_t> ofRoot(nodes.count(), 0);
  for (std::size_t node = 0; node < nodes.count(); ++node) {
    ofRoot[nodes.root(node)] += nodes.voxels(node);
  }
  std::vector<std::uint16_t> newLabel(nodes.count());  // of roots, then of all nodes
  for (std::size_t node = 0; node < newLabel.size(); ++node) newLabel[node] = nodes.label(node);
  std::vector<std::vector<Sides>> all;
  std::vector<std::uint32_t> piece(nodes.count(), 0);
  bool isAny = false, touch = false;
  for (std::size_t f = 0; f < fractures.size(); ++f) {
    all.push_back(sidesOf(state, nodes, f, fractures[f], ofRoot));
    for (std::size_t label = 1; label < all[f].size(); ++label) {
      Sides& sides = all[f][label];
      if (fractures[f].planes[label].added == 0 || sides.isEach()) continue;
      isAny = true;
      if (sides.kept.empty()) {  // the plane missed the piece
        for (const auto& each : sides.added)
          newLabel[each.root] = static_cast<std::uint16_t>(label);
      } else if (!sides.added.empty()) {
        touch = true;
        for (const auto& each : sides.kept) piece[each.root] = static_cast<std::uint32_t>(label);
        for (const auto& each : sides.added) piece[each.root] = static_cast<std::uint32_t>(label);
      }
    }
  }
  if (!isAny) return;
  for (std::size_t node = 0; node < piece.size(); ++node) piece[node] = piece[nodes.root(node)];
  const auto contacts =
      touch ? nodes.contacts(state, piece) : std::vector<std::pair<std::uint32_t, std::uint32_t>>{};
  std::map<std::pair<std::size_t, std::uint32_t>,
           std::vector<std::pair<std::uint32_t, std::uint32_t>>>
      ofPiece;
  std::size_t fracture = 0;
  for (const auto& contact : contacts) {  // ascending, as the nodes of fractures are
    while (fracture + 1 < fractures.size() &&
           contact.first >= nodes.of((fracture + 1) * state.leafCount).first) {
      ++fracture;
    }
    ofPiece[{fracture, piece[contact.first]}].push_back(contact);
  }
  for (const auto& [key, own] : ofPiece) {
    const Sides& sides = all[key.first][key.second];
    const std::uint16_t added = fractures[key.first].planes[key.second].added;
    for (const auto* components : {&sides.kept, &sides.added}) {
      for (const auto& each : *components) {
        newLabel[each.root] = static_cast<std::uint16_t>(key.second);
      }
    }
    for (const std::uint32_t root : addedPart(sides, own)) newLabel[root] = added;
  }
  for (std::size_t node = 0; node < newLabel.size(); ++node) {
    newLabel[node] = newLabel[nodes.root(node)];
  }
  nodes.relabel(state, labels, newLabel);
}

// Returns [components] on which sides of given cracks their voxels are.
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

// Divides the sides of a piece that is split by a given crack, and returns how many of `count`
// shares the first part gets, near `first`: each part one for each of its sides, if there are
// enough, so that later cracks can split them.
std::size_t dividedSides(const Piece& piece, std::int64_t crack, std::size_t first,
                         std::vector<std::uint64_t>& kept, std::vector<std::uint64_t>& added) {
  if (piece.sides.empty() || crack >= 64) return first;
  for (const std::uint64_t each : piece.sides) ((each >> crack & 1) ? added : kept).push_back(each);
  const std::size_t count = piece.last - piece.first;
  if (kept.size() + added.size() > count) return first;
  return std::clamp(first, kept.size(), count - added.size());
}

// Replaces split pieces by their two parts, and records the splits.
void recordSplits(Fracture& fracture) {
  std::vector<Piece> pieces;
  for (Piece& piece : fracture.pieces) {
    const Plane& plane = fracture.planes[piece.label];
    if (plane.added == 0) {
      pieces.push_back(piece);
      continue;
    }
    const auto kept = static_cast<std::size_t>(fracture.sums[piece.label].count),
               added = static_cast<std::size_t>(fracture.sums[plane.added].count);
    if (added == 0) {
      piece.missed = plane.normal != glm::ivec3(0);
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
    if (plane.normal == glm::ivec3(0)) {
      first = dividedSides(piece, plane.offset, first, keptSides, addedSides);
    }
    first = std::min(first, kept);
    if (count - first > added) first = count - added;
    const int generation = piece.generation + 1;
    fracture.splits.push_back(
        {piece.label, plane.added, piece.generation, plane.normal, plane.offset, kept + added});
    pieces.push_back({piece.label, piece.first, piece.first + first, generation,
                      mixed(2 * piece.path + 1), false, std::move(keptSides)});
    pieces.push_back({plane.added, piece.first + first, piece.last, generation,
                      mixed(2 * piece.path + 2), false, std::move(addedSides)});
  }
  fracture.pieces = std::move(pieces);
}

// Makes one piece of each component.
Fracture started(const SplitRun& run, const VoxelComponents& components) {
  Fracture fracture;
  fracture.seed = run.seed;
  fracture.ids = permutedIds(run.shares.size(), run.seed);
  for (const std::vector<double>& shares : sharesOfComponents(run.shares, components.voxels())) {
    const std::size_t first = fracture.shares.size();
    fracture.shares.insert(fracture.shares.end(), shares.begin(), shares.end());
    const std::uint64_t path = mixed(fracture.pieces.size() + 1);
    fracture.pieces.push_back({fracture.nextId(), first, fracture.shares.size(), 0, path});
  }
  return fracture;
}

// Returns labels of the components, each by the piece of its number.
DeviceLabels componentLabels(GrowthState& state, const VoxelComponents& components,
                             std::span<const Fracture> fractures) {
  const LeafBlocks& blocks = state.blocks;
  std::vector<std::uint32_t> ofLeaf(state.leafCount, 0);  // component + 1, or mixed
  std::vector<std::uint32_t> mixedLeaves;
  for (std::uint32_t leaf = 0; leaf < state.leafCount; ++leaf) {
    for (std::size_t v = std::size_t{leaf} * 512; v < std::size_t{leaf + 1} * 512; ++v) {
      if (!blocks.isInside(v)) continue;
      const std::uint32_t own = components.at(v) + 1;
      if (ofLeaf[leaf] != 0 && ofLeaf[leaf] != own) {
        ofLeaf[leaf] = SHERD_TAG_MIXED;
        break;
      }
      ofLeaf[leaf] = own;
      if (components.count() == 1) break;
    }
  }
  std::vector<std::uint32_t> tags;
  for (const Fracture& fracture : fractures) {
    for (const std::uint32_t own : ofLeaf) {
      const bool isOne = own != 0 && own != SHERD_TAG_MIXED;
      tags.push_back(isOne ? fracture.pieces[own - 1].label : own);
    }
  }
  DeviceLabels labels = makeLabels(state);
  if (std::find(ofLeaf.begin(), ofLeaf.end(), SHERD_TAG_MIXED) != ofLeaf.end()) {
    std::vector<std::uint16_t> owner(state.voxels(), 0);
    for (std::size_t f = 0; f < fractures.size(); ++f) {
      blocks.forEachInside([&](std::size_t v) {
        owner[f * state.leafCount * 512 + v] = fractures[f].pieces[components.at(v)].label;
      });
    }
    labels.owner = uploadBuffer<std::uint16_t>(state.device, owner);
  }
  labels.tag = uploadBuffer<std::uint32_t>(state.device, tags);
  return labels;
}

// Returns an inner voxel of each fragment: of the node nearest to its center.
std::vector<Seed> innerVoxels(GrowthState& state, const SplitNodes& nodes, std::size_t index,
                              const Fracture& fracture, std::span<const glm::ivec3> low) {
  struct Nearest {
    double distance = -1.0;
    SplitNodes::Target target{};
  };
  std::vector<Nearest> nearest(fracture.ids.size() + 1);
  std::vector<glm::dvec3> mean;
  for (const VoxelSums& sums : fracture.sums) mean.push_back(sums.mean());
  for (std::size_t leaf = 0; leaf < state.leafCount; ++leaf) {
    const std::size_t item = index * state.leafCount + leaf;
    const auto [first, last] = nodes.of(item);
    for (std::uint32_t node = first; node < last; ++node) {
      const std::uint16_t label = nodes.label(node);
      const glm::dvec3 apart = nodes.sums(node).mean() + glm::dvec3(low[leaf]) - mean[label];
      const double distance = glm::dot(apart, apart);
      Nearest& best = nearest[label];
      if (best.distance >= 0.0 && distance >= best.distance) continue;
      best = {distance,
              {static_cast<std::uint32_t>(item), node - first,
               glm::ivec3(glm::floor(mean[label] + 0.5)) - low[leaf]}};
    }
  }
  std::vector<SplitNodes::Target> targets;
  for (std::size_t label = 1; label < nearest.size(); ++label) {
    targets.push_back(nearest[label].target);
  }
  const std::vector<std::uint16_t> offsets = nodes.nearestVoxels(state, targets);
  std::vector<Seed> seeds;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const openvdb::Coord voxel =
        state.blocks.origins[targets[i].item % state.leafCount] + coordFromOffset(offsets[i]);
    seeds.push_back({voxel, static_cast<std::uint16_t>(i + 1)});
  }
  return seeds;
}

// Returns the greatest difference of a fragment's share from the one that it was meant to have,
// divided by that.
double sizeErrorOf(const Fracture& fracture) {
  double voxels = 0.0, error = 0.0;
  for (const VoxelSums& sums : fracture.sums) voxels += static_cast<double>(sums.count);
  for (const Piece& piece : fracture.pieces) {
    const double share = static_cast<double>(fracture.sums[piece.label].count) / voxels;
    error = std::max(error, std::abs(share / fracture.shares[piece.first] - 1.0));
  }
  return error;
}

// Orders splits by the size of what they split, and converts planes to voxels of the grid.
std::vector<Split> ordered(std::vector<Split> splits, const openvdb::Coord& lowest) {
  std::stable_sort(splits.begin(), splits.end(),
                   [](const Split& a, const Split& b) { return a.voxels > b.voxels; });
  for (Split& split : splits) {
    for (int i = 0; i < 3; ++i) {
      split.offset += 64 * std::int64_t{split.normal[i]} * lowest[i];
    }
  }
  return splits;
}

}  // namespace

SplitGrowth splitPieces(GrowthState& state, const VoxelComponents& components,
                        std::span<const SplitRun> runs, const GrowOptions& options,
                        const Progress* progress) {
  std::vector<Fracture> fractures;
  for (const SplitRun& run : runs) fractures.push_back(started(run, components));
  const openvdb::Coord lowest = state.lowest();
  const DeviceBuffer origins = state.uploadOrigins(lowest);
  std::vector<glm::ivec3> low;
  for (const openvdb::Coord& origin : state.blocks.origins) {
    const openvdb::Coord at = origin - lowest;
    low.emplace_back(at.x(), at.y(), at.z());
  }
  const auto isDone = [](const Fracture& fracture) {
    return std::none_of(fracture.pieces.begin(), fracture.pieces.end(),
                        [](const Piece& piece) { return piece.isSplit(); });
  };
  SplitGrowth grown{componentLabels(state, components, fractures), {}};
  SplitNodes nodes = SplitNodes::withoutRoots(state, grown.labels);
  const auto measure = [&] {
    for (std::size_t f = 0; f < fractures.size(); ++f) {
      Fracture& each = fractures[f];
      each.sums = sumsOfLabels(state, nodes, f, each.ids.size(), low);
      each.mass = massOfLabels(state, nodes, f, each.sums, runs[f].densities);
    }
  };
  measure();
  const auto finishGeneration = [&] {
    nodes = SplitNodes(state, grown.labels);
    connectSides(state, grown.labels, nodes, fractures);
    measure();
    for (Fracture& fracture : fractures) recordSplits(fracture);
  };
  const auto isAllDone = [&] { return std::all_of(fractures.begin(), fractures.end(), isDone); };
  const GuideSides* const guides = runs.front().guides;
  if (guides && !guides->positive.empty()) {
    const auto sides = sidesOfComponents(state.blocks, components, *guides);
    for (Fracture& fracture : fractures) {
      for (std::size_t i = 0; i < sides.size(); ++i) fracture.pieces[i].sides = sides[i];
    }
  }
  for (std::size_t i = 0; guides && i < guides->positive.size() && !isAllDone(); ++i) {
    reportProgress(progress, "grow", 0.0);
    for (Fracture& fracture : fractures) splitAll(fracture, i);
    splitBySides(state, grown.labels, guides->positive[i], fractures);
    finishGeneration();
  }
  while (!isAllDone()) {
    reportProgress(progress, "grow", 0.0);
    throwIfCancelled(progress);
    for (std::size_t f = 0; f < fractures.size(); ++f) {
      decidePlanes(state, nodes, f, fractures[f], low, runs[f], options);
    }
    splitByPlanes(state, grown.labels, origins, fractures);
    finishGeneration();
  }
  for (std::size_t f = 0; f < fractures.size(); ++f) {
    grown.fractures.push_back({ordered(std::move(fractures[f].splits), lowest),
                               innerVoxels(state, nodes, f, fractures[f], low),
                               sizeErrorOf(fractures[f])});
  }
  return grown;
}

}  // namespace sherd
