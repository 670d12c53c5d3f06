// Voxels that are taken away so that bodies of a mesh stay apart.
#include "voxelize/body_gaps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <map>
#include <optional>
#include <utility>

#include "base/cancel_flag.h"
#include "base/union_find.h"
#include "exact/self_crossings.h"
#include "mesh/boxes.h"
#include "voxelize/leaf_blocks.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu, kSeveral = 0xfffffffeu;
constexpr int kLeafSide = 8;

// Two voxels side by side lie on both sides of two surfaces: neither is farther from its own.
constexpr double kReach = 1.0;

// Where more of the voxels between two bodies have no others behind them, on either side, the
// bodies are too thin to lose voxels.
constexpr double kMostThin = 0.3;

using Pair = std::pair<std::uint32_t, std::uint32_t>;

// The component and the depth of a voxel near the surface.
struct Owned {
  std::uint32_t component = kNone;
  float depth = 0.0f;  // voxels
};

// Inside voxels of different components side by side.
struct Conflict {
  std::array<std::size_t, 2> voxel{};  // the second one's coordinate is higher
  std::array<std::uint32_t, 2> component{};
  std::array<float, 2> depth{};
  std::array<bool, 2> isThick{};  // whether the body goes on behind
};

// Returns [leaves] the component whose triangles come near a leaf, kNone or kSeveral.
std::vector<std::uint32_t> nearLeaves(const LeafBlocks& blocks, const TriangleTree& tree,
                                      const MeshComponents& components, CancelFlag& stop) {
  std::vector<std::uint32_t> near(blocks.count(), kNone);
  tbb::parallel_for(std::size_t{0}, near.size(), [&](std::size_t leaf) {
    if (stop.isSet()) return;
    const openvdb::Coord& origin = blocks.origins[leaf];
    const glm::dvec3 corner(origin.x(), origin.y(), origin.z());
    for (const std::uint32_t t :
         tree.meeting(widened({corner, corner + (kLeafSide - 1.0)}, 2.0 * kReach))) {
      const std::uint32_t own = components.ofTriangle[tree.source(t)];
      near[leaf] = near[leaf] == kNone || near[leaf] == own ? own : kSeveral;
    }
  });
  stop.throwIfSet();
  return near;
}

// The voxels of the leaves that several components come near.
class NearVoxels {
 public:
  NearVoxels(const LeafBlocks& blocks, const SearchedMesh& mesh, const MeshComponents& components,
             const Progress* progress)
      : blocks_(blocks), slot_(blocks.count(), kNone) {
    CancelFlag stop(progress);
    const std::vector<std::uint32_t> near = nearLeaves(blocks, *mesh.tree, components, stop);
    for (std::uint32_t leaf = 0; leaf < near.size(); ++leaf) {
      if (near[leaf] != kSeveral) continue;
      slot_[leaf] = static_cast<std::uint32_t>(leaves_.size());
      leaves_.push_back(leaf);
    }
    owned_.resize(leaves_.size() * 512);
    tbb::parallel_for(std::size_t{0}, leaves_.size(), [&](std::size_t slot) {
      if (!stop.isSet()) own(slot, *mesh.tree, components);
    });
    stop.throwIfSet();
  }

  [[nodiscard]] std::vector<Conflict> conflicts() const {
    std::vector<std::vector<Conflict>> found(leaves_.size());
    tbb::parallel_for(std::size_t{0}, leaves_.size(),
                      [&](std::size_t slot) { addConflicts(slot, found[slot]); });
    std::vector<Conflict> all;
    for (const std::vector<Conflict>& some : found) all.insert(all.end(), some.begin(), some.end());
    return all;
  }

 private:
  void own(std::size_t slot, const TriangleTree& tree, const MeshComponents& components) {
    std::uint32_t guess = TriangleTree::kNone;
    for (std::size_t v = 0; v < 512; ++v) {
      const std::size_t voxel = std::size_t{leaves_[slot]} * 512 + v;
      if (!blocks_.isInside(voxel)) continue;
      const openvdb::Coord at = blocks_.voxelAt(voxel);
      const TriangleTree::Nearest nearest =
          tree.nearest(glm::dvec3(at.x(), at.y(), at.z()), kReach, guess);
      if (nearest.triangle == TriangleTree::kNone) continue;
      guess = nearest.triangle;
      owned_[slot * 512 + v] = {components.ofTriangle[tree.source(nearest.triangle)],
                                static_cast<float>(nearest.distance)};
    }
  }

  // Returns the neighbor of a voxel along an axis, kNone if it has no leaf.
  [[nodiscard]] std::optional<std::size_t> beside(std::size_t voxel, int axis, int step) const {
    const int shift = 6 - 3 * axis;
    const auto local = static_cast<int>(voxel % 512);
    const int at = (local >> shift & 7) + step;
    if (at >= 0 && at < kLeafSide) {
      return voxel + static_cast<std::size_t>(step * (1 << shift));
    }
    const std::uint32_t leaf =
        blocks_
            .neighbors[voxel / 512 * 6 + static_cast<std::size_t>(2 * axis + (step > 0 ? 1 : 0))];
    if (leaf == LeafBlocks::kNone) return std::nullopt;
    const int moved = (local & ~(7 << shift)) | (at & 7) << shift;
    return std::size_t{leaf} * 512 + static_cast<std::size_t>(moved);
  }

  [[nodiscard]] const Owned* ownedAt(std::size_t voxel) const {
    const std::uint32_t slot = slot_[voxel / 512];
    if (slot == kNone) return nullptr;
    const Owned& owned = owned_[std::size_t{slot} * 512 + voxel % 512];
    return owned.component == kNone ? nullptr : &owned;
  }

  // Whether a voxel has one of another component beside it, along an axis.
  [[nodiscard]] bool isInConflict(std::size_t voxel, int axis, std::uint32_t own) const {
    for (const int step : {-1, 1}) {
      const std::optional<std::size_t> next = beside(voxel, axis, step);
      const Owned* const other = next ? ownedAt(*next) : nullptr;
      if (other != nullptr && other->component != own) return true;
    }
    return false;
  }

  // Whether the two voxels behind one are of the same component, and in no conflict along
  // the axis.
  [[nodiscard]] bool isThick(std::size_t voxel, int axis, int step, std::uint32_t own) const {
    for (int depth = 1; depth <= 2; ++depth) {
      const std::optional<std::size_t> behind = beside(voxel, axis, step);
      if (!behind || !blocks_.isInside(*behind)) return false;
      const Owned* const owned = ownedAt(*behind);
      if (owned != nullptr && (owned->component != own || isInConflict(*behind, axis, own)))
        return false;
      voxel = *behind;
    }
    return true;
  }

  void addConflicts(std::size_t slot, std::vector<Conflict>& found) const {
    for (std::size_t v = 0; v < 512; ++v) {
      const std::size_t voxel = std::size_t{leaves_[slot]} * 512 + v;
      const Owned* const own = ownedAt(voxel);
      if (own == nullptr) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const std::optional<std::size_t> next = beside(voxel, axis, 1);
        const Owned* const other = next ? ownedAt(*next) : nullptr;
        if (other == nullptr || other->component == own->component) continue;
        found.push_back({{voxel, *next},
                         {own->component, other->component},
                         {own->depth, other->depth},
                         {isThick(voxel, axis, -1, own->component),
                          isThick(*next, axis, 1, other->component)}});
      }
    }
  }

  const LeafBlocks& blocks_;
  std::vector<std::uint32_t> leaves_;  // that several components come near
  std::vector<std::uint32_t> slot_;    // [leaves of the solid] index into leaves_, or kNone
  std::vector<Owned> owned_;           // [leaves_ * 512]
};

// The components of a mesh as meshes of their own.
class Components {
 public:
  Components(std::span<const glm::dvec3> vertices, const TriangleMesh& mesh,
             const MeshComponents& components)
      : vertices_(vertices), triangles_(components.count) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      triangles_[components.ofTriangle[t]].push_back(mesh.triangles[t]);
    }
  }

  [[nodiscard]] std::size_t count() const { return triangles_.size(); }

  [[nodiscard]] TriangleMesh joined(std::span<const std::uint32_t> some) const {
    TriangleMesh out;
    std::vector<std::uint32_t> used;
    for (const std::uint32_t c : some) {
      for (const glm::uvec3& t : triangles_[c]) used.insert(used.end(), {t.x, t.y, t.z});
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const auto numberOf = [&](std::uint32_t v) {
      return static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) -
                                        used.begin());
    };
    for (const std::uint32_t v : used) out.vertices.push_back(vertices_[v]);
    for (const std::uint32_t c : some) {
      for (const glm::uvec3& t : triangles_[c]) {
        out.triangles.emplace_back(numberOf(t.x), numberOf(t.y), numberOf(t.z));
      }
    }
    return out;
  }

  [[nodiscard]] TriangleMesh mesh(std::uint32_t component) const {
    return joined(std::span(&component, 1));
  }

  [[nodiscard]] glm::dvec3 point(std::uint32_t component) const {
    return vertices_[triangles_[component].front().x];
  }

 private:
  std::span<const glm::dvec3> vertices_;
  std::vector<std::vector<glm::uvec3>> triangles_;
};

// Joins each cavity to the smallest body around it.
void joinCavities(const Components& components, UnionFind& bodies) {
  struct Outside {
    std::uint32_t component;
    double volume;
    Box box;
  };
  std::vector<Outside> outsides;
  std::vector<std::uint32_t> cavities;
  for (std::uint32_t c = 0; c < components.count(); ++c) {
    const TriangleMesh mesh = components.mesh(c);
    const double own = volume(mesh);
    if (own < 0.0) {
      cavities.push_back(c);
    } else {
      outsides.push_back({c, own, bounds(mesh)});
    }
  }
  if (cavities.empty()) return;
  std::stable_sort(outsides.begin(), outsides.end(),
                   [](const Outside& a, const Outside& b) { return a.volume < b.volume; });
  std::vector<std::optional<TriangleTree>> trees(outsides.size());
  for (const std::uint32_t cavity : cavities) {
    const glm::dvec3 p = components.point(cavity);
    for (std::size_t i = 0; i < outsides.size(); ++i) {
      const Box& box = outsides[i].box;
      if (glm::clamp(p, box.min, box.max) != p) continue;
      if (!trees[i]) trees[i].emplace(components.mesh(outsides[i].component));
      if (trees[i]->winding(p) < 0.5) continue;
      bodies.unite(cavity, outsides[i].component);
      break;
    }
  }
}

// Returns the triangles near voxels in conflict, 0 or 1.
std::vector<std::uint8_t> nearConflicts(const LeafBlocks& blocks, const SearchedMesh& mesh,
                                        const std::vector<Conflict>& conflicts) {
  std::vector<std::uint8_t> near(mesh.mesh.triangles.size(), 0);
  for (const Conflict& conflict : conflicts) {
    const openvdb::Coord a = blocks.voxelAt(conflict.voxel[0]),
                         b = blocks.voxelAt(conflict.voxel[1]);
    const Box box{{a.x(), a.y(), a.z()}, {b.x(), b.y(), b.z()}};
    for (const std::uint32_t t : mesh.tree->meeting(widened(box, kReach))) {
      near[mesh.tree->source(t)] = 1;
    }
  }
  return near;
}

// Whether one of two bodies that do not cross lies within the other's solid.
class Nesting {
 public:
  Nesting(const Components& components, const std::vector<std::uint32_t>& body)
      : parts_(components.count()), components_(components), trees_(components.count()) {
    for (std::uint32_t c = 0; c < body.size(); ++c) parts_[body[c]].push_back(c);
  }

  bool areNested(std::uint32_t a, std::uint32_t b) { return isWithin(a, b) || isWithin(b, a); }

 private:
  bool isWithin(std::uint32_t inner, std::uint32_t outer) {
    std::optional<TriangleTree>& tree = trees_[outer];
    if (!tree) tree.emplace(components_.joined(parts_[outer]));
    const glm::dvec3 p = components_.point(inner);
    const Box box = tree->box();
    return glm::clamp(p, box.min, box.max) == p && tree->winding(p) >= 0.5;
  }

  std::vector<std::vector<std::uint32_t>> parts_;  // of bodies, by their name
  const Components& components_;
  std::vector<std::optional<TriangleTree>> trees_;  // [bodies] made when needed
};

// Returns [components] the body of each, where bodies that cross, touch or are nested near voxels
// in conflict are one.
std::vector<std::uint32_t> bodiesOf(const LeafBlocks& blocks, const SearchedMesh& mesh,
                                    std::span<const glm::dvec3> vertices,
                                    const MeshComponents& components,
                                    const std::vector<Conflict>& conflicts,
                                    const Progress* progress) {
  const Components parts(vertices, mesh.mesh, components);
  UnionFind joined(components.count);
  joinCavities(parts, joined);
  const std::vector<std::uint32_t> alone = UnionFind(joined).all();
  std::vector<std::uint32_t> bodyOfTriangle;
  for (const std::uint32_t c : components.ofTriangle) bodyOfTriangle.push_back(alone[c]);
  for (const auto& [s, t] :
       selfCrossings(vertices, mesh.mesh.triangles, progress,
                     {.of = nearConflicts(blocks, mesh, conflicts), .source = bodyOfTriangle})) {
    joined.unite(bodyOfTriangle[s], bodyOfTriangle[t]);
  }
  std::vector<Pair> pairs;
  for (const Conflict& conflict : conflicts) {
    pairs.push_back(std::minmax(alone[conflict.component[0]], alone[conflict.component[1]]));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  Nesting nesting(parts, alone);
  for (const auto& [a, b] : pairs) {
    throwIfCancelled(progress);
    if (joined.find(a) != joined.find(b) && nesting.areNested(a, b)) joined.unite(a, b);
  }
  return std::move(joined).all();
}

std::size_t takenOf(const Conflict& conflict) {
  const auto& [thin, other] = conflict.isThick;
  if (thin != other) return conflict.voxel[thin ? 0 : 1];
  return conflict.voxel[conflict.depth[0] <= conflict.depth[1] ? 0 : 1];
}

}  // namespace

BodyGaps bodyGapsOf(const LeafBlocks& blocks, const SearchedMesh& mesh,
                    std::span<const glm::dvec3> vertices, const Progress* progress) {
  const MeshComponents components = meshComponents(mesh.mesh);
  if (components.count < 2) return {};
  const std::vector<Conflict> conflicts =
      NearVoxels(blocks, mesh, components, progress).conflicts();
  if (conflicts.empty()) return {};
  const std::vector<std::uint32_t> body =
      bodiesOf(blocks, mesh, vertices, components, conflicts, progress);
  std::map<Pair, std::vector<const Conflict*>> between;
  for (const Conflict& conflict : conflicts) {
    const Pair pair = std::minmax(body[conflict.component[0]], body[conflict.component[1]]);
    if (pair.first != pair.second) between[pair].push_back(&conflict);
  }
  BodyGaps gaps;
  for (const auto& [pair, own] : between) {
    const auto thin = std::count_if(own.begin(), own.end(), [](const Conflict* conflict) {
      return !conflict->isThick[0] && !conflict->isThick[1];
    });
    if (static_cast<double>(thin) > kMostThin * static_cast<double>(own.size())) {
      ++gaps.joined;
      continue;
    }
    for (const Conflict* conflict : own) gaps.voxels.push_back(takenOf(*conflict));
  }
  std::sort(gaps.voxels.begin(), gaps.voxels.end());
  gaps.voxels.erase(std::unique(gaps.voxels.begin(), gaps.voxels.end()), gaps.voxels.end());
  return gaps;
}

}  // namespace sherd
