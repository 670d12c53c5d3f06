// Small components of fragments that are broken again.
#include "pipeline/refracture_islands.h"

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "voxelize/distance.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

// Of the voxels of all leaves, those that are dropped.
using VoxelMask = std::vector<std::uint64_t>;

bool has(const VoxelMask& mask, std::size_t voxel) { return (mask[voxel / 64] >> voxel % 64) & 1; }

// Marks the voxels of a fragment's small components.  Returns how many components there are.
std::size_t markIslands(const LeafBlocks& fragment, Device& device, VoxelMask& dropped) {
  const VoxelComponents components = findComponents(fragment, device);
  const std::vector<std::uint64_t>& voxels = components.voxels();
  const auto largest =
      static_cast<std::size_t>(std::max_element(voxels.begin(), voxels.end()) - voxels.begin());
  std::vector<bool> isSmall(voxels.size());
  for (std::size_t c = 0; c < voxels.size(); ++c)
    isSmall[c] = c != largest && voxels[c] < kSmallComponentVoxels;
  const auto count = static_cast<std::size_t>(std::count(isSmall.begin(), isSmall.end(), true));
  if (count == 0) return 0;
  fragment.forEachInside([&](std::size_t voxel) {
    if (isSmall[components.at(voxel)]) dropped[voxel / 64] |= std::uint64_t{1} << voxel % 64;
  });
  return count;
}

// Finds for points near a fragment whether its nearest voxel is dropped.
class NearestVoxels {
 public:
  NearestVoxels(const FinishedFracture& finished, int id, const VoxelMask& dropped)
      : finished_(finished), id_(id), dropped_(dropped) {}

  // Returns 1 or -1 for a voxel that is dropped or stays, 0 if there is none near.
  int vote(const glm::dvec3& point) const {
    constexpr int kReach = 2;
    const glm::dvec3 at = finished_.solid.frame.indexFromWorld(point), middle = glm::round(at);
    double least = 1e300;
    int found = 0;
    for (int x = -kReach; x <= kReach; ++x) {
      for (int y = -kReach; y <= kReach; ++y) {
        for (int z = -kReach; z <= kReach; ++z) {
          const glm::dvec3 to = middle + glm::dvec3(x, y, z) - at;
          const int own = glm::dot(to, to) < least ? voteOf(middle + glm::dvec3(x, y, z)) : 0;
          if (own == 0) continue;
          least = glm::dot(to, to);
          found = own;
        }
      }
    }
    return found;
  }

 private:
  int voteOf(const glm::dvec3& index) const {
    const openvdb::Coord voxel(static_cast<int>(index.x), static_cast<int>(index.y),
                               static_cast<int>(index.z));
    const std::uint32_t leaf = findLeaf(*finished_.solid.blocks, voxel);
    if (leaf == LeafBlocks::kNone) return 0;
    const std::size_t at = std::size_t{leaf} * 512 + offsetFromCoord(voxel);
    if (finished_.labels.fragment[at] != id_) return 0;
    return has(dropped_, at) ? 1 : -1;
  }

  const FinishedFracture& finished_;
  const int id_;
  const VoxelMask& dropped_;
};

// Returns [faces of the fragment] whether a face stays: those of bodies of dropped voxels do not.
std::vector<bool> facesThatStay(const FinishedFracture& finished, int id,
                                const VoxelMask& dropped) {
  const std::size_t begin = finished.firstFace[static_cast<std::size_t>(id) - 1],
                    end = finished.firstFace[static_cast<std::size_t>(id)];
  TriangleMesh own{finished.faces.vertices, {}};
  own.triangles.assign(finished.faces.triangles.begin() + static_cast<std::ptrdiff_t>(begin),
                       finished.faces.triangles.begin() + static_cast<std::ptrdiff_t>(end));
  const MeshComponents bodies = meshComponents(own);
  constexpr std::size_t kMostVotes = 64;
  std::vector<std::size_t> triangles(bodies.count, 0), visited(bodies.count, 0);
  for (const std::uint32_t body : bodies.ofTriangle) ++triangles[body];
  std::vector<int> votes(bodies.count, 0);
  const NearestVoxels nearest(finished, id, dropped);
  for (std::size_t t = 0; t < own.triangles.size(); ++t) {
    const std::uint32_t body = bodies.ofTriangle[t];
    if (visited[body]++ % (triangles[body] / kMostVotes + 1) != 0) continue;
    const glm::uvec3& c = own.triangles[t];
    votes[body] += nearest.vote((own.vertices[c.x] + own.vertices[c.y] + own.vertices[c.z]) / 3.0);
  }
  std::vector<bool> stays(own.triangles.size());
  for (std::size_t t = 0; t < stays.size(); ++t) stays[t] = votes[bodies.ofTriangle[t]] <= 0;
  return stays;
}

// Removes the bodies of dropped voxels from the meshes of fragments.
void dropFaces(const FinishedFracture& from, const std::set<int>& fragments,
               const VoxelMask& dropped, FinishedFracture& to) {
  if (from.firstFace.empty()) return;
  to.faces.triangles.clear();
  to.faces.neighbor.clear();
  to.sourceOf.clear();
  to.firstFace.assign(1, 0);
  for (int id = 1; id <= from.labels.fragmentCount; ++id) {
    const std::size_t begin = from.firstFace[static_cast<std::size_t>(id) - 1],
                      end = from.firstFace[static_cast<std::size_t>(id)];
    std::vector<bool> stays(end - begin, true);
    if (fragments.count(id)) stays = facesThatStay(from, id, dropped);
    for (std::size_t t = begin; t < end; ++t) {
      if (!stays[t - begin]) continue;
      to.faces.triangles.push_back(from.faces.triangles[t]);
      to.faces.neighbor.push_back(from.faces.neighbor[t]);
      if (!from.sourceOf.empty()) to.sourceOf.push_back(from.sourceOf[t]);
    }
    to.firstFace.push_back(to.faces.triangles.size());
  }
}

}  // namespace

LeafBlocks blocksOf(const FinishedFracture& finished, int id) {
  LeafBlocks blocks = *finished.solid.blocks;
  for (std::size_t voxelIndex = 0; voxelIndex < finished.labels.fragment.size(); ++voxelIndex) {
    if (finished.labels.fragment[voxelIndex] != id) {
      blocks.inside[voxelIndex >> 6] &= ~(std::uint64_t{1} << (voxelIndex & 63));
    }
  }
  blocks.exteriorBand.assign(blocks.exteriorBand.size(), 0);
  blocks.layers.clear();  // a fragment is of one body
  return blocks;
}

std::optional<FinishedFracture> withoutIslands(const FinishedFracture& finished,
                                               const std::set<int>& broken, Device& device) {
  const LeafBlocks& all = *finished.solid.blocks;
  VoxelMask dropped(all.inside.size(), 0);
  std::set<int> changed;
  std::size_t islands = 0;
  for (const int id : broken) {
    const std::size_t own = markIslands(blocksOf(finished, id), device, dropped);
    if (own > 0) changed.insert(id);
    islands += own;
  }
  if (islands == 0) return std::nullopt;
  FinishedFracture out = finished;
  Solid& solid = out.solid;
  solid.distance = withoutVoxels(*solid.distance, all,
                                 [&](std::size_t voxelIndex) { return has(dropped, voxelIndex); });
  solid.blocks = std::make_shared<const LeafBlocks>(leafBlocks(*solid.distance));
  solid.smallComponents += islands;
  solid.smallComponentVoxels += solid.voxels;
  measureVoxels(solid);
  solid.smallComponentVoxels -= solid.voxels;
  out.labels.blocks = solid.blocks;
  out.labels.fragment.assign(solid.blocks->count() * 512, 0);
  solid.blocks->forEachInside([&](std::size_t voxel) {
    const std::size_t before = findLeaf(all, solid.blocks->origins[voxel / 512]);
    out.labels.fragment[voxel] = finished.labels.fragment[before * 512 + voxel % 512];
  });
  dropFaces(finished, changed, dropped, out);
  return out;
}

}  // namespace sherd
