// Distance grids from meshes.
#include "voxelize/distance.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tree/LeafManager.h>
#include <sherd/error.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace sherd {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using Leaf = FloatGrid::TreeType::LeafNodeType;

// No inside voxel is nearer to the surface than this share of a voxel: it keeps triangles from
// shrinking to points.
constexpr float kLeastDepthVoxels = 1e-3f;

// The mesh as meshToVolume wants it, in double: float would lose a large grid's last thousandths.
struct IndexMesh {
  const TriangleMesh& mesh;
  std::size_t polygonCount() const { return mesh.triangles.size(); }
  std::size_t pointCount() const { return mesh.vertices.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t n, std::size_t v, openvdb::Vec3d& p) const {
    const glm::dvec3& q = mesh.vertices[mesh.triangles[n][static_cast<int>(v)]];
    p = {q.x, q.y, q.z};
  }
};

// Lets the caller stop OpenVDB's long loops; they ask from many threads, so only a flag is read
// there.
struct Interrupter {
  const Progress* progress;
  void start(const char* = nullptr) {}
  void end() {}
  bool wasInterrupted(int = -1) const {
    return progress && progress->cancelled && progress->cancelled();
  }
};

float worldFromVoxels(float voxels, const GridFrame& frame) {
  return static_cast<float>(static_cast<double>(voxels) * frame.voxelSize);
}

// Three voxels, and not a hair less: readers divide by the voxel size and compare with 3.
float background(const GridFrame& frame) {
  return std::nextafter(worldFromVoxels(kHalfWidthVoxels, frame), INFINITY);
}

}  // namespace

FloatGridPtr levelSetFromMesh(const TriangleMesh& mesh, const Winding& winding,
                              const GridFrame& frame, const Progress* progress) {
  Interrupter interrupter{progress};
  FloatGrid::Ptr grid = openvdb::tools::meshToVolume<FloatGrid>(
      interrupter, IndexMesh{mesh}, *openvdb::math::Transform::createLinearTransform(1.0),
      static_cast<float>(kHalfWidthVoxels), 0.0f, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  step(progress, "voxelize", 0.5);

  const float outside = background(frame);
  openvdb::tools::changeBackground(grid->tree(), outside);
  openvdb::tree::LeafManager<FloatGrid::TreeType> leaves(grid->tree());
  leaves.foreach ([&](Leaf& leaf, std::size_t) {
    for (int x = 0; x < 8; ++x) {
      for (int y = 0; y < 8; ++y) {
        const unsigned inside =
            winding.insideRow(leaf.origin().x() + x, leaf.origin().y() + y, leaf.origin().z());
        for (int z = 0; z < 8; ++z) {
          const auto offset = static_cast<openvdb::Index>((x << 6) | (y << 3) | z);
          const bool isInside = (inside >> z) & 1;
          const float distance = leaf.getValue(offset);  // voxels, >= 0
          if (!leaf.isValueOn(offset) || !(distance < static_cast<float>(kHalfWidthVoxels))) {
            leaf.setValueOff(offset, isInside ? -outside : outside);
          } else {
            const float voxels = isInside ? -std::max(distance, kLeastDepthVoxels) : distance;
            leaf.setValueOnly(offset, worldFromVoxels(voxels, frame));
          }
        }
      }
    }
  });
  openvdb::tools::signedFloodFillWithValues(grid->tree(), outside, -outside);

  openvdb::math::Transform::Ptr transform =
      openvdb::math::Transform::createLinearTransform(frame.voxelSize);
  transform->postTranslate({frame.origin.v.x, frame.origin.v.y, frame.origin.v.z});
  grid->setTransform(transform);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName("surface");
  return grid;
}

void unite(FloatGrid& grid, FloatGrid& other) { openvdb::tools::csgUnion(grid, other); }

GridFrame frameOf(const FloatGrid& grid) {
  const openvdb::Vec3d origin = grid.transform().indexToWorld(openvdb::Vec3d(0.0));
  return {{{origin.x(), origin.y(), origin.z()}}, grid.voxelSize()[0]};
}

LeafBlocks leafBlocks(const FloatGrid& grid) {
  struct Masks {
    std::array<std::uint64_t, 8> inside{}, outerBand{};
  };
  // Leaves of the grid, and leaves cut from its interior tiles (inactive, negative).
  std::vector<std::pair<Coord, Masks>> found;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    Masks masks;
    bool any = false;
    for (unsigned offset = 0; offset < 512; ++offset) {
      const std::uint64_t bit = std::uint64_t{1} << (offset & 63);
      if (leaf->getValue(offset) < 0) {
        masks.inside[offset >> 6] |= bit;
      } else if (leaf->isValueOn(offset)) {
        masks.outerBand[offset >> 6] |= bit;
      } else {
        continue;
      }
      any = true;
    }
    if (any) found.emplace_back(leaf->origin(), masks);
  }
  Masks full;
  full.inside.fill(~std::uint64_t{0});
  auto tiles = grid.tree().cbeginValueAll();
  tiles.setMaxDepth(FloatGrid::TreeType::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tiles; ++tiles) {
    if (*tiles >= 0) continue;
    openvdb::CoordBBox box;
    tiles.getBoundingBox(box);
    for (int x = box.min().x(); x <= box.max().x(); x += 8) {
      for (int y = box.min().y(); y <= box.max().y(); y += 8) {
        for (int z = box.min().z(); z <= box.max().z(); z += 8)
          found.emplace_back(Coord(x, y, z), full);
      }
    }
  }
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });

  LeafBlocks blocks;
  for (const auto& [origin, masks] : found) {
    blocks.origins.push_back(origin);
    blocks.inside.insert(blocks.inside.end(), masks.inside.begin(), masks.inside.end());
    blocks.outerBand.insert(blocks.outerBand.end(), masks.outerBand.begin(), masks.outerBand.end());
  }
  blocks.neighbours = leafNeighbours(blocks.origins);
  return blocks;
}

ConstFloatGridPtr withoutVoxels(const FloatGrid& grid, const LeafBlocks& blocks,
                                const std::function<bool(std::size_t)>& isSpeck) {
  FloatGrid::Ptr copy = grid.deepCopy();
  FloatGrid::Accessor accessor = copy->getAccessor();
  blocks.forEachInside([&](std::size_t place) {
    if (!isSpeck(place)) return;
    const Coord voxel = blocks.voxelAt(place);
    accessor.setValueOnly(voxel, -accessor.getValue(voxel));
  });
  return copy;
}

}  // namespace sherd
