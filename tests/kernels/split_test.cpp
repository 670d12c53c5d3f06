// split.cl against sets of voxels, bit for bit: the labels that recorded splits give, the sums of
// nodes, contacts.
#include <sherd/labels.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <queue>
#include <random>
#include <set>

#include "device_fixture.h"
#include "grow/splits/sequential.h"
#include "grow/splits/split_nodes.h"
#include "grow_reference.h"
#include "random_ways.h"

namespace sherd {
namespace {

using openvdb::Coord;
using reference::LabelMap;
using voxel_shapes::VoxelSolid;

using Splits = DeviceTest;

// Voxels by their place in the arrays.
using Voxels = std::map<std::size_t, Coord>;

// The 6-connected components of voxels, ascending by their first voxel in leaf order.
std::vector<Voxels> componentsOf(const Voxels& voxels, const LeafBlocks& blocks) {
  std::set<Coord> left;
  for (const auto& [index, voxel] : voxels) left.insert(voxel);
  std::vector<Voxels> all;
  for (const auto& [index, first] : voxels) {
    if (!left.count(first)) continue;
    Voxels component;
    std::queue<Coord> next;
    next.push(first);
    left.erase(first);
    for (; !next.empty(); next.pop()) {
      component[voxel_shapes::voxelIndexOf(blocks, next.front())] = next.front();
      for (const Coord& n : voxel_shapes::neighbors(next.front())) {
        if (left.erase(n)) next.push(n);
      }
    }
    all.push_back(component);
  }
  return all;
}

bool touch(const Voxels& a, const Voxels& b) {
  std::set<Coord> other;
  for (const auto& [index, voxel] : b) other.insert(voxel);
  return std::any_of(a.begin(), a.end(), [&](const auto& each) {
    const std::vector<Coord> near = voxel_shapes::neighbors(each.second);
    return std::any_of(near.begin(), near.end(), [&](const Coord& n) { return other.count(n); });
  });
}

std::size_t largestOf(const std::vector<Voxels>& components) {
  return static_cast<std::size_t>(
      std::max_element(components.begin(), components.end(),
                       [](const Voxels& a, const Voxels& b) { return a.size() < b.size(); }) -
      components.begin());
}

// The voxels of a piece that a split gives away.
//   walls  null, or by whose ways voxels move
Voxels addedBy(const Split& split, const Voxels& piece, const LeafBlocks& blocks,
               const WallMiddles* walls) {
  Voxels kept, added;
  for (const auto& [index, v] : piece) {
    std::int64_t plane = 0, squared = 0;
    for (int i = 0; i < 3; ++i) {
      const bool ignoresWalls = !split.isSphere && split.center != glm::ivec3(0);
      const std::int64_t way = walls == nullptr || ignoresWalls
                                   ? 0
                                   : walls->ways()[3 * index + static_cast<std::size_t>(i)];
      const std::int64_t at = 64 * std::int64_t{v[i]} + way;
      plane += split.normal[i] * at;
      squared += (at - split.center[i]) * (at - split.center[i]);
    }
    ((split.isSphere ? squared : plane) > split.offset ? added : kept)[index] = v;
  }
  std::vector<Voxels> components = componentsOf(kept, blocks);
  const std::size_t keptFirst = largestOf(components);
  std::vector<Voxels> others = componentsOf(added, blocks);
  const std::size_t addedFirst = components.size() + largestOf(others);
  components.insert(components.end(), others.begin(), others.end());
  std::vector<std::size_t> ascending(components.size());
  for (std::size_t i = 0; i < ascending.size(); ++i) ascending[i] = i;
  std::sort(ascending.begin(), ascending.end(), [&](std::size_t a, std::size_t b) {
    return components[a].begin()->first < components[b].begin()->first;
  });
  std::map<std::size_t, bool> isAdded{{keptFirst, false}, {addedFirst, true}};
  std::queue<std::size_t> next;
  next.push(keptFirst);
  next.push(addedFirst);
  for (; !next.empty(); next.pop()) {
    for (const std::size_t other : ascending) {
      if (isAdded.count(other) || !touch(components[next.front()], components[other])) continue;
      isAdded[other] = isAdded[next.front()];
      next.push(other);
    }
  }
  Voxels out;
  for (const auto& [component, is] : isAdded) {
    if (is) out.insert(components[component].begin(), components[component].end());
  }
  return out;
}

// The labels that splits give, from a piece per component.
LabelMap labelsBy(const std::vector<Split>& splits, const VoxelSolid& solid, const Labels& result) {
  const WallMiddles* const walls = result.walls.get();
  const LeafBlocks& blocks = *result.blocks;
  Voxels all;
  for (const Coord& voxel : solid.inside) all[voxel_shapes::voxelIndexOf(blocks, voxel)] = voxel;
  std::map<std::uint16_t, std::uint16_t> parent;
  for (const Split& split : splits) parent[split.added] = split.fragment;
  std::map<std::uint16_t, Voxels> pieces;
  for (const Voxels& component : componentsOf(all, blocks)) {
    std::uint16_t first = result.fragment[component.begin()->first];
    while (parent.count(first)) first = parent[first];
    EXPECT_TRUE(pieces.emplace(first, component).second) << "a piece for each component";
  }
  for (const Split& split : splits) {
    Voxels& piece = pieces.at(split.fragment);
    EXPECT_EQ(piece.size(), split.voxels);
    const Voxels added = addedBy(split, piece, blocks, walls);
    for (const auto& [index, voxel] : added) piece.erase(index);
    EXPECT_TRUE(pieces.emplace(split.added, added).second);
  }
  LabelMap labels;
  for (const auto& [label, piece] : pieces) {
    for (const auto& [index, voxel] : piece) labels[voxel] = label;
  }
  return labels;
}

std::vector<SeededLabels> splitSolid(const std::shared_ptr<const LeafBlocks>& blocks,
                                     Device& device, const std::vector<std::size_t>& pieces,
                                     GrowOptions options = {}) {
  const VoxelComponents components = findComponents(*blocks, device);
  std::vector<SplitRun> runs;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    runs.push_back({sharesOfSplits(options.split, pieces[i], 7 + i), 7 + i});
  }
  options.growth = Growth::sequential;
  return growBySplits(blocks, components, runs, device, options);
}

TEST_F(Splits, LabelsAreThoseOfTheRecordedSplits) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    const std::size_t components = findComponents(*blocks, device()).count();
    const std::vector<std::size_t> more = voxel_shapes::small()
                                              ? std::vector<std::size_t>{0, 7}
                                              : std::vector<std::size_t>{0, 1, 2, 11, 60};
    for (const std::size_t further : more) {
      const std::size_t pieces = std::min(components + further, solid.inside.size());
      if (pieces > kMaxFragments) continue;
      const SeededLabels grown = splitSolid(blocks, device(), {pieces}).front();
      EXPECT_EQ(grown.labels.splits.size(), pieces - components) << solid.name;
      const LabelMap labels = labelsBy(grown.labels.splits, solid, grown.labels);
      EXPECT_TRUE(reference::mapOf(grown.labels) == labels) << solid.name << ", " << pieces;
      EXPECT_EQ(reference::countConnectedComponents(labels), pieces) << solid.name;
      ASSERT_EQ(grown.seeds.size(), pieces);
      for (std::size_t i = 0; i < pieces; ++i) {
        EXPECT_EQ(grown.seeds[i].fragment, i + 1);
        EXPECT_EQ(labels.at(grown.seeds[i].voxel), i + 1) << solid.name;
      }
    }
  }
}

// The same of two solids whose leaves have few nodes, for drivers that limit loops.
TEST_F(Splits, LabelsOfABallAndACupAreThoseOfTheRecordedSplits) {
  for (const VoxelSolid& solid : {voxel_shapes::ball(7), voxel_shapes::cup(8, 2)}) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    const SeededLabels grown = splitSolid(blocks, device(), {9}).front();
    EXPECT_TRUE(reference::mapOf(grown.labels) ==
                labelsBy(grown.labels.splits, solid, grown.labels))
        << solid.name;
  }
}

// An impact with three rings about the lowest voxel along x.
SplitImpact impactAt(const glm::dvec3& center, double radius, std::size_t pieces) {
  return {.center = center,
          .u = {0.0, 1.0, 0.0},
          .v = {0.0, 0.0, 1.0},
          .pattern = {.radials = 5, .rings = 3, .ratio = 1.5, .radius = radius},
          .component = 0,
          .pieces = pieces,
          .seed = 3};
}

TEST_F(Splits, OfImpactsAndInWallsAreThoseOfTheRecordedCracks) {
  std::vector<VoxelSolid> solids{
      voxel_shapes::solidWhere("plate", 12, [](const Coord& v) { return std::abs(v.z()) <= 1; })};
  std::vector<double> radii{6.0};
  if (!voxel_shapes::small()) {
    solids.push_back(voxel_shapes::ball(7));
    solids.push_back(voxel_shapes::cup(8, 2));
    radii = {3.0, 6.0, 30.0};
  }
  for (const VoxelSolid& solid : solids) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    const VoxelComponents components = findComponents(*blocks, device());
    const std::shared_ptr<const WallMiddles> ways = randomWays(blocks);
    for (const double radius : radii) {
      for (const bool isInWalls : {false, true}) {
        const std::vector<SplitImpact> impacts{impactAt({-5.3, 0.2, 1.1}, radius, 12),
                                               impactAt({4.0, 4.0, 0.0}, radius / 2.0, 7)};
        std::vector<SplitRun> runs;
        for (const std::size_t pieces : {std::size_t{17}, std::size_t{3}}) {
          SplitRun run{sharesOfSplits({}, pieces, 7), 7};
          // One of the two in walls: each fracture has its own positions.
          if (isInWalls && pieces == 17) run.middles = ways;
          run.impacts = impacts;
          runs.push_back(run);
        }
        const std::vector<SeededLabels> grown =
            growBySplits(blocks, components, runs, device(), {.growth = Growth::sequential});
        for (std::size_t i = 0; i < runs.size(); ++i) {
          const Labels& labels = grown[i].labels;
          EXPECT_EQ(labels.splits.size(), runs[i].shares.size() - 1) << solid.name;
          const LabelMap expected = labelsBy(labels.splits, solid, labels);
          EXPECT_TRUE(reference::mapOf(labels) == expected) << solid.name << ", " << radius;
          EXPECT_EQ(reference::countConnectedComponents(expected), runs[i].shares.size());
        }
        const auto isSphere = [](const Split& split) { return split.isSphere; };
        const std::vector<Split>& splits = grown[0].labels.splits;
        // Rings of 30 voxels are beyond the solids.
        if (radius < 10.0) {
          EXPECT_TRUE(std::any_of(splits.begin(), splits.end(), isSphere)) << solid.name;
        }
      }
    }
  }
}

TEST_F(Splits, EveryVoxelCanBeAPiece) {
  const VoxelSolid solid = voxel_shapes::solidWhere("bent", 3, [](const Coord& v) {
    return v.z() == 0 && (v.x() == -3 || v.y() == 2) && v.x() <= 0;
  });
  const auto blocks = voxel_shapes::blocksOf(solid);
  const SeededLabels grown = splitSolid(blocks, device(), {solid.inside.size()}).front();
  std::set<std::uint16_t> ids;
  for (const auto& [voxel, label] : reference::mapOf(grown.labels)) ids.insert(label);
  EXPECT_EQ(ids.size(), solid.inside.size());
}

TEST_F(Splits, FracturesGrownTogetherEqualSeparateOnes) {
  const auto blocks = voxel_shapes::blocksOf(voxel_shapes::cup(9, 2));
  const std::vector<std::size_t> pieces{9, 1, 30, 4};
  for (const int group : voxel_shapes::small() ? std::vector<int>{3} : std::vector<int>{0, 1, 3}) {
    GrowOptions options;
    options.tuning.workGroupSize = group;
    const std::vector<SeededLabels> together = splitSolid(blocks, device(), pieces, options);
    const VoxelComponents components = findComponents(*blocks, device());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const SplitRun run{sharesOfSplits({}, pieces[i], 7 + i), 7 + i};
      const Labels alone = growBySplits(blocks, components, std::span(&run, 1), device(),
                                        {.growth = Growth::sequential})
                               .front()
                               .labels;
      EXPECT_EQ(together[i].labels.fragment, alone.fragment);
    }
  }
}

// Returns the splits of a run on a solid.
GivenSplits decidedOn(const LeafBlocks& blocks, const SplitRun& run, Device& device) {
  return decideSplits(blocks, findComponents(blocks, device), std::span(&run, 1), device,
                      {.growth = Growth::sequential})
      .front();
}

// Returns the labels of splits that were decided before.
Labels labelsOf(const std::shared_ptr<const LeafBlocks>& blocks, const GivenSplits& given,
                Device& device) {
  SplitRun run{given.shares, 7};
  run.given = &given;
  return growBySplits(blocks, findComponents(*blocks, device), std::span(&run, 1), device,
                      {.growth = Growth::sequential})
      .front()
      .labels;
}

std::vector<std::uint32_t> sameComponents(std::size_t count) {
  std::vector<std::uint32_t> same(count);
  for (std::size_t i = 0; i < count; ++i) same[i] = static_cast<std::uint32_t>(i);
  return same;
}

TEST_F(Splits, ThatWereDecidedGiveTheSameLabels) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    const std::size_t components = findComponents(*blocks, device()).count();
    const std::size_t pieces = std::min(components + 9, solid.inside.size());
    if (pieces > kMaxFragments) continue;
    SplitRun run{sharesOfSplits({}, pieces, 7), 7};
    const std::vector<SplitImpact> impacts{impactAt({-2.3, 0.2, 1.1}, 3.0, 6)};
    if (components == 1) run.impacts = impacts;
    const Labels direct = growBySplits(blocks, findComponents(*blocks, device()),
                                       std::span(&run, 1), device(), {.growth = Growth::sequential})
                              .front()
                              .labels;
    const GivenSplits given =
        givenFor(decidedOn(*blocks, run, device()), {1.0}, sameComponents(components));
    EXPECT_EQ(labelsOf(blocks, given, device()).fragment, direct.fragment) << solid.name;
    std::uint64_t least = solid.inside.size();
    const std::vector<std::uint64_t> voxels = countVoxels(direct);
    for (std::size_t id = 1; id < voxels.size(); ++id) least = std::min(least, voxels[id]);
    EXPECT_EQ(given.leastVoxels, least) << solid.name;
  }
}

// A ball about the same point of space, whose voxels are `ratio` times as wide as those of a ball
// of radius 9.
VoxelSolid ballOf(double ratio) {
  const double center = 0.5 * (1.0 / ratio - 1.0);
  return voxel_shapes::solidWhere("ball", static_cast<int>(9.0 / ratio) + 3, [&](const Coord& v) {
    const double x = v.x() - center, y = v.y() - center, z = v.z() - center;
    return ratio * ratio * (x * x + y * y + z * z) < 81.0;
  });
}

TEST_F(Splits, ThatWereDecidedOnOtherVoxelsAreTheSamePlanes) {
  const auto decidedOnBlocks = voxel_shapes::blocksOf(ballOf(1.0));
  SplitRun run{sharesOfSplits({}, 12, 7), 7};
  const std::vector<SplitImpact> impacts{impactAt({-8.0, 0.2, 1.1}, 4.0, 5)};
  run.impacts = impacts;
  const GivenSplits decided = decidedOn(*decidedOnBlocks, run, device());
  for (const double ratio : {0.4, 0.75, 1.5}) {
    const VoxelSolid solid = ballOf(ratio);
    const auto blocks = voxel_shapes::blocksOf(solid);
    const Labels labels =
        labelsOf(blocks, givenFor(decided, {1.0 / ratio}, sameComponents(1)), device());
    const LabelMap expected = labelsBy(labels.splits, solid, labels);
    EXPECT_TRUE(reference::mapOf(labels) == expected) << ratio;
    EXPECT_EQ(reference::countConnectedComponents(expected), 12u) << ratio;
    ASSERT_EQ(labels.splits.size(), decided.splits.size());
    for (const GivenSplit& each : decided.splits) {
      const Split& from = each.split;
      const auto to = std::find_if(labels.splits.begin(), labels.splits.end(),
                                   [&](const Split& split) { return split.added == from.added; });
      ASSERT_NE(to, labels.splits.end());
      EXPECT_EQ(to->fragment, from.fragment);
      EXPECT_EQ(to->normal, from.normal);
      EXPECT_EQ(to->isSphere, from.isSphere);
      // Of the ball's center, 1/64 of its own voxels, rounded to steps of 1/64 of both.
      const auto beyond = [](const Split& split, double center) {
        const glm::dvec3 p(64.0 * center);
        const auto offset = static_cast<double>(split.offset);
        if (split.isSphere) return glm::length(p - glm::dvec3(split.center)) - std::sqrt(offset);
        const glm::dvec3 normal(split.normal);
        return (glm::dot(normal, p) - offset) / glm::length(normal);
      };
      EXPECT_NEAR(beyond(*to, 0.5 * (1.0 / ratio - 1.0)) * ratio, beyond(from, 0.0), 2.0 + ratio)
          << ratio;
    }
  }
}

// Voxels so few that most planes miss: splits are decided anew, and there are as many pieces.
TEST_F(Splits, ThatVoxelsDoNotResolveAreDecidedAnew) {
  const auto fine = voxel_shapes::blocksOf(voxel_shapes::ball(7));
  const VoxelSolid few = voxel_shapes::ball(2);
  const auto blocks = voxel_shapes::blocksOf(few);
  for (const std::size_t pieces : {std::size_t{5}, few.inside.size() - 1, few.inside.size()}) {
    const SplitRun run{sharesOfSplits({}, pieces, 7), 7};
    const GivenSplits given = givenFor(decidedOn(*fine, run, device()), {0.3}, sameComponents(1));
    const Labels labels = labelsOf(blocks, given, device());
    const LabelMap expected = labelsBy(labels.splits, few, labels);
    EXPECT_TRUE(reference::mapOf(labels) == expected) << pieces;
    EXPECT_EQ(reference::countConnectedComponents(expected), pieces);
    const std::vector<std::uint64_t> voxels = countVoxels(labels);
    EXPECT_EQ(std::count(voxels.begin() + 1, voxels.end(), 0u), 0) << pieces;
  }
}

TEST_F(Splits, RoughCracksKeepTheNumberOfPieces) {
  const auto blocks = voxel_shapes::blocksOf(voxel_shapes::ball(12));
  GrowOptions options{.roughness = 1.5, .noiseSeeds = {5}};
  const Labels rough = splitSolid(blocks, device(), {12}, options).front().labels;
  const LabelMap labels = reference::mapOf(rough);
  EXPECT_EQ(reference::countConnectedComponents(labels), 12u);
  EXPECT_EQ(labels.size(), blocks->insideVoxels());
  options.roughness = 0.0;
  EXPECT_NE(splitSolid(blocks, device(), {12}, options).front().labels.fragment, rough.fragment);
}

TEST_F(Splits, MorePiecesThanVoxelsAreRefused) {
  const auto blocks = voxel_shapes::blocksOf(voxel_shapes::ball(1));
  EXPECT_THROW((void)splitSolid(blocks, device(), {blocks->insideVoxels() + 1}), Error);
}

// Random labels on a solid, and its nodes.
struct RandomNodes {
  RandomNodes(const VoxelSolid& solid, Device& device, unsigned seed, unsigned count)
      : blocks(voxel_shapes::blocksOf(solid)), state(*blocks, 1, implOf(device)) {
    std::mt19937 random(seed);
    label.assign(blocks->count() * 512, 0);
    for (const Coord& voxel : solid.inside) {
      const std::size_t at = voxel_shapes::voxelIndexOf(*blocks, voxel);
      label[at] = static_cast<std::uint16_t>(1 + random() % count);
      all[at] = voxel;
    }
    labels = labelsPerVoxel(state, uploadBuffer<std::uint16_t>(state.device, label));
  }

  // The components of equal label, ascending by their first voxel.
  std::vector<Voxels> components() const {
    std::map<std::uint16_t, Voxels> byLabel;
    for (const auto& [at, voxel] : all) byLabel[label[at]][at] = voxel;
    std::vector<Voxels> found;
    for (const auto& [id, voxels] : byLabel) {
      for (const Voxels& component : componentsOf(voxels, *blocks)) found.push_back(component);
    }
    std::sort(found.begin(), found.end(),
              [](const Voxels& a, const Voxels& b) { return a.begin()->first < b.begin()->first; });
    return found;
  }

  std::shared_ptr<const LeafBlocks> blocks;
  GrowthState state;
  std::vector<std::uint16_t> label;
  Voxels all;
  DeviceLabels labels;
};

TEST_F(Splits, SumsAreThoseOfTheVoxels) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    RandomNodes random(solid, device(), 3, 3);
    const SplitNodes nodes(random.state, random.labels);
    std::map<std::uint32_t, VoxelSums> ofRoot;
    std::map<std::uint32_t, std::uint16_t> labelOfRoot;
    for (std::size_t leaf = 0; leaf < random.blocks->count(); ++leaf) {
      const auto [first, last] = nodes.of(leaf);
      const Coord& low = random.blocks->origins[leaf];
      for (std::uint32_t node = first; node < last; ++node) {
        ofRoot[nodes.root(node)].add(nodes.sums(node), {low.x(), low.y(), low.z()});
        labelOfRoot[nodes.root(node)] = nodes.label(node);
      }
    }
    const std::vector<Voxels> components = random.components();
    ASSERT_EQ(ofRoot.size(), components.size()) << solid.name;
    auto found = ofRoot.begin();
    for (const Voxels& component : components) {
      VoxelSums sums;
      for (const auto& [at, v] : component) {
        ++sums.count;
        const std::int64_t x = v.x(), y = v.y(), z = v.z();
        const std::array<std::int64_t, 3> first{x, y, z};
        const std::array<std::int64_t, 6> second{x * x, y * y, z * z, x * y, x * z, y * z};
        for (std::size_t i = 0; i < 3; ++i) sums.sum[i] += first[i];
        for (std::size_t i = 0; i < 6; ++i) sums.squares[i] += second[i];
      }
      EXPECT_EQ(found->second.count, sums.count) << solid.name;
      EXPECT_EQ(found->second.sum, sums.sum) << solid.name;
      EXPECT_EQ(found->second.squares, sums.squares) << solid.name;
      EXPECT_EQ(labelOfRoot[found->first], random.label[component.begin()->first]) << solid.name;
      ++found;
    }
  }
}

TEST_F(Splits, ContactsAreThoseOfTheVoxels) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    if (solid.inside.size() > 3000) continue;  // the reference compares all pairs
    RandomNodes random(solid, device(), 5, 2);
    const SplitNodes nodes(random.state, random.labels);
    std::vector<std::uint32_t> piece(nodes.count());
    std::map<std::uint32_t, std::size_t> numberOfRoot;
    for (std::uint32_t node = 0; node < nodes.count(); ++node) {
      numberOfRoot.emplace(nodes.root(node), 0);
    }
    std::size_t number = 0;
    for (auto& [root, own] : numberOfRoot) own = number++;
    for (std::uint32_t node = 0; node < nodes.count(); ++node) {
      piece[node] = static_cast<std::uint32_t>(numberOfRoot[nodes.root(node)] % 5);
    }
    std::set<std::pair<std::size_t, std::size_t>> found;
    for (const auto& [a, b] : nodes.contacts(random.state, piece)) {
      EXPECT_LT(a, b);
      EXPECT_TRUE(found.emplace(numberOfRoot.at(a), numberOfRoot.at(b)).second) << "each once";
    }
    const std::vector<Voxels> components = random.components();
    std::map<Coord, std::size_t> componentOf;
    for (std::size_t i = 0; i < components.size(); ++i) {
      for (const auto& [at, voxel] : components[i]) componentOf[voxel] = i;
    }
    std::set<std::pair<std::size_t, std::size_t>> expected;
    for (const auto& [voxel, i] : componentOf) {
      for (const Coord& n : voxel_shapes::neighbors(voxel)) {
        const auto other = componentOf.find(n);
        if (other == componentOf.end() || other->second <= i) continue;
        if (i % 5 != 0 && i % 5 == other->second % 5) expected.emplace(i, other->second);
      }
    }
    EXPECT_EQ(found, expected) << solid.name;
  }
}

}  // namespace
}  // namespace sherd
