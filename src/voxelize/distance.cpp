// Distance grids from meshes.
#include "voxelize/distance.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

#include "base/cancel_flag.h"
#include "voxelize/band.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using Leaf = FloatGrid::TreeType::LeafNodeType;

// Inside voxels are at least this deep, so that triangles do not shrink to points.
constexpr float kLeastDepthVoxels = 1e-3f;

float worldFromVoxels(float voxels, const GridFrame& frame) {
  return static_cast<float>(static_cast<double>(voxels) * frame.voxelSize);
}

// Three voxels, rounded up: readers divide by the voxel size and compare with 3.
float background(const GridFrame& frame) {
  return std::nextafter(worldFromVoxels(kHalfWidthVoxels, frame), INFINITY);
}

// Calls visit(box) for each tile of values that are below 0.
template <class Visit>
void forEachInsideTile(const FloatGrid& grid, const Visit& visit) {
  auto tiles = grid.tree().cbeginValueAll();
  tiles.setMaxDepth(FloatGrid::TreeType::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tiles; ++tiles) {
    if (*tiles >= 0) continue;
    openvdb::CoordBBox box;
    tiles.getBoundingBox(box);
    visit(box);
  }
}

// OpenVDB's constructors refuse voxels under 1.44e-5 units, whose volume is below their tolerance
// of 3e-15, but its maps read and apply any size.  So the transform is read as a file has it.  Its
// copies go through those constructors: grids share it instead.
openvdb::math::Transform::Ptr transformOf(const GridFrame& frame) {
  using openvdb::Vec3d;
  openvdb::initialize();  // registers the kinds of maps
  std::stringstream stored;
  openvdb::io::setCurrentVersion(stored);  // else it is taken for an old file
  openvdb::writeString(stored, openvdb::math::UniformScaleTranslateMap::mapType());
  const double inverse = 1.0 / frame.voxelSize;
  const Vec3d values[] = {{frame.origin.x, frame.origin.y, frame.origin.z},
                          Vec3d(frame.voxelSize),    // scale
                          Vec3d(frame.voxelSize),    // sides of a voxel
                          Vec3d(inverse),            // inverse of the scale,
                          Vec3d(inverse * inverse),  // its square
                          Vec3d(inverse / 2.0)};     // and its half
  for (const Vec3d& value : values) value.write(stored);
  auto transform = std::make_shared<openvdb::math::Transform>();
  transform->read(stored);
  return transform;
}

// A grid without values, to be filled by leaves and tiles.
FloatGrid::Ptr emptyLevelSet(const GridFrame& frame) {
  FloatGrid::Ptr grid = FloatGrid::create(background(frame));
  grid->setTransform(transformOf(frame));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName("surface");
  return grid;
}

// A voxel farther than this from the surface has all neighbors on its side.  More than 1, because a
// neighbor may lie on the surface.
constexpr float kBeyondNeighbors = 1.001f;  // voxels

// Returns which voxels of a leaf are inside, of those nearer to the surface than `reach`.  Only a
// few voxels are classified directly: no surface lies between two neighbors when either is far
// from it, so they have the same side.
std::array<bool, 512> sidesOf(const BandLeaf& leaf, double reach, const Filling& filling) {
  std::array<bool, 512> inside{}, known{};
  std::array<std::uint16_t, 512> front;
  const auto isNear = [&](unsigned i) { return leaf.distance[i] < static_cast<float>(reach); };
  for (unsigned start = 0; start < 512; ++start) {
    if (known[start] || !isNear(start)) continue;
    const bool side = filling.isInside(leaf.origin + coordFromOffset(start));
    std::size_t waiting = 0;
    const auto reachVoxel = [&](unsigned i) {
      known[i] = true;
      inside[i] = side;
      front[waiting++] = static_cast<std::uint16_t>(i);
    };
    reachVoxel(start);
    while (waiting > 0) {
      const unsigned i = front[--waiting];
      const bool isFar = leaf.distance[i] > kBeyondNeighbors;
      for (const unsigned shift : {0u, 3u, 6u}) {
        const unsigned along = i >> shift & 7u;
        const auto step = [&](unsigned next) {
          if (!known[next] && isNear(next) && (isFar || leaf.distance[next] > kBeyondNeighbors))
            reachVoxel(next);
        };
        if (along > 0) step(i - (1u << shift));
        if (along < 7) step(i + (1u << shift));
      }
    }
  }
  return inside;
}

}  // namespace

FloatGridPtr levelSetOf(const Filling& filling, const GridFrame& frame, const Progress* progress) {
  const double reach = kHalfWidthVoxels + filling.halfThickness;
  const std::vector<BandLeaf> band = bandOf(*filling.surface, reach, progress);
  reportProgress(progress, "voxelize", 0.8);

  const float outside = background(frame);
  const auto half = static_cast<float>(filling.halfThickness);
  FloatGrid::Ptr grid = emptyLevelSet(frame);
  std::vector<std::unique_ptr<Leaf>> leaves(band.size());
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, band.size(), [&](std::size_t i) {
    if (stop.isSet()) return;
    leaves[i] = std::make_unique<Leaf>(band[i].origin, outside, false);
    std::array<bool, 512> inside{};
    if (filling.isInside) inside = sidesOf(band[i], reach, filling);
    for (openvdb::Index k = 0; k < Leaf::SIZE; ++k) {
      const float distance = band[i].distance[k];
      if (!(distance < static_cast<float>(reach))) continue;
      float voxels = distance - half;
      if (filling.isInside) voxels = inside[k] ? -distance : distance;
      const bool isInside = filling.isInside ? inside[k] : voxels < 0.0f;
      if (isInside) voxels = std::min(voxels, -kLeastDepthVoxels);
      if (voxels <= -static_cast<float>(kHalfWidthVoxels)) {
        leaves[i]->setValueOff(k, -outside);
      } else if (voxels < static_cast<float>(kHalfWidthVoxels)) {
        leaves[i]->setValueOn(k, worldFromVoxels(voxels, frame));
      }
    }
  });
  stop.throwIfSet();
  for (std::unique_ptr<Leaf>& leaf : leaves) {
    if (!leaf->isEmpty()) grid->tree().addLeaf(leaf.release());
  }
  openvdb::tools::signedFloodFillWithValues(grid->tree(), outside, -outside);
  return grid;
}

std::function<float(const openvdb::Coord&)> valuesOf(ConstFloatGridPtr grid) {
  return [grid, values = grid->getConstAccessor()](const openvdb::Coord& voxel) {
    return values.getValue(voxel);
  };
}

void addVoxels(FloatGrid& grid, LeafBlocks& blocks, std::span<const std::size_t> voxelIndices) {
  const float depth = -worldFromVoxels(kLeastDepthVoxels, frameOf(grid));
  FloatGrid::Accessor accessor = grid.getAccessor();
  for (const std::size_t voxelIndex : voxelIndices) {
    const std::uint64_t bit = std::uint64_t{1} << (voxelIndex % 64);
    accessor.setValueOn(blocks.voxelAt(voxelIndex), depth);
    blocks.inside[voxelIndex / 64] |= bit;
    blocks.exteriorBand[voxelIndex / 64] &= ~bit;
  }
}

std::function<float(const glm::dvec3&)> samplesOf(ConstFloatGridPtr grid) {
  return [grid = std::move(grid)](const glm::dvec3& at) {
    return openvdb::tools::BoxSampler::sample(grid->getConstAccessor(),
                                              openvdb::Vec3d(at.x, at.y, at.z));
  };
}

FloatGridPtr uniformGrid(float value) { return FloatGrid::create(value); }

void setFrame(FloatGrid& grid, const GridFrame& frame) { grid.setTransform(transformOf(frame)); }

FloatGridPtr emptyLike(const FloatGrid& grid) {
  // Of the ways to copy a grid, only this one shares the transform.
  const FloatGridPtr empty = openvdb::ConstPtrCast<FloatGrid>(grid.copyReplacingMetadata(grid));
  empty->newTree();
  return empty;
}

FloatGridPtr copyOf(const FloatGrid& grid) {
  const FloatGridPtr copy = emptyLike(grid);
  copy->setTree(grid.tree().copy());
  return copy;
}

void multiplyValues(FloatGrid& grid, double factor) {
  const auto times = [factor](float value) {
    return static_cast<float>(static_cast<double>(value) * factor);
  };
  for (auto leaf = grid.tree().beginLeaf(); leaf; ++leaf) {
    float* const values = leaf->buffer().data();
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) values[i] = times(values[i]);
  }
  auto tiles = grid.tree().beginValueAll();
  tiles.setMaxDepth(FloatGrid::TreeType::ValueAllIter::LEAF_DEPTH - 1);
  for (; tiles; ++tiles) tiles.setValue(times(*tiles));
  auto& root = grid.tree().root();
  root.setBackground(times(root.background()), /*updateChildNodes=*/false);
}

// OpenVDB takes values less than 1e-8 apart for equal, and so mistakes -background for background.
void unite(FloatGrid& grid, FloatGrid& other) {
  const double voxelSize = frameOf(grid).voxelSize;
  const double unit = voxelSize < 1e-6 ? std::exp2(std::ilogb(voxelSize)) : 1.0;
  if (unit != 1.0) {
    multiplyValues(grid, 1.0 / unit);
    multiplyValues(other, 1.0 / unit);
  }
  openvdb::tools::csgUnion(grid, other);
  if (unit != 1.0) multiplyValues(grid, unit);
}

GridFrame frameOf(const FloatGrid& grid) {
  const openvdb::Vec3d origin = grid.transform().indexToWorld(openvdb::Vec3d(0.0));
  return {{origin.x(), origin.y(), origin.z()}, grid.voxelSize()[0]};
}

double smallestVoxel(const FloatGrid& grid) {
  const openvdb::Vec3d size = grid.voxelSize();
  return std::min({size.x(), size.y(), size.z()});
}

bool isSolidLevelSet(const FloatGrid& grid) {
  if (grid.getGridClass() != openvdb::GRID_LEVEL_SET || !grid.transform().isLinear()) return false;
  // Not by the map's matrix, which OpenVDB refuses for small voxels.
  const openvdb::math::MapBase& map = *grid.transform().baseMap();
  const openvdb::Vec3d origin = map.applyMap(openvdb::Vec3d(0.0));
  const double size = map.applyJacobian(openvdb::Vec3d(1.0, 0.0, 0.0))[0];
  if (!(size >= kSmallestVoxel && size <= kLargestVoxel)) return false;
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(origin[axis])) return false;
    openvdb::Vec3d along(0.0);
    along[axis] = 1.0;
    const openvdb::Vec3d step = map.applyJacobian(along);
    for (int k = 0; k < 3; ++k) {
      const double expected = k == axis ? size : 0.0;
      if (!(std::abs(step[k] - expected) <= 1e-9 * size)) return false;
    }
  }
  constexpr double kHalfFloats = 0.01;  // grids may be saved with 11 bits
  return static_cast<double>(grid.background()) >= (kHalfWidthVoxels - kHalfFloats) * size;
}

bool hasFiniteValues(const FloatGrid& grid) {
  constexpr std::uint32_t kExponent = 0x7f800000;
  if (!std::isfinite(grid.background())) return false;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const float* const values = leaf->buffer().data();
    unsigned others = 0;
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i)
      others += (std::bit_cast<std::uint32_t>(values[i]) & kExponent) == kExponent ? 1u : 0u;
    if (others > 0) return false;
  }
  auto tiles = grid.tree().cbeginValueAll();
  tiles.setMaxDepth(FloatGrid::TreeType::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tiles; ++tiles) {
    if (!std::isfinite(*tiles)) return false;
  }
  return true;
}

VoxelCounts voxelsOf(const FloatGrid& grid, double isovalue, bool above) {
  const auto isSolid = [&](double value) { return above ? value > isovalue : value < isovalue; };
  VoxelCounts counts;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    unsigned inside = 0;
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) inside += isSolid(leaf->getValue(i)) ? 1u : 0u;
    counts.inside += inside;
    if (inside > 0 && inside < Leaf::SIZE) counts.surface += 64.0;  // one sheet through the leaf
  }
  auto tiles = grid.tree().cbeginValueAll();
  tiles.setMaxDepth(FloatGrid::TreeType::ValueAllCIter::LEAF_DEPTH - 1);
  const bool isInverted = isSolid(grid.background());
  for (; tiles; ++tiles) {
    // Where the background is solid, so are the neighbors of the root's tiles that are not.
    if (!isSolid(*tiles) && !(isInverted && tiles.getLevel() == FloatGrid::TreeType::DEPTH - 1)) {
      continue;
    }
    const auto voxels = static_cast<double>(tiles.getVoxelCount());
    counts.inside += voxels;
    counts.surface += 6.0 * std::cbrt(voxels * voxels);  // of a cube
  }
  return counts;
}

Solid solidOf(const FloatGrid& levelSet) {
  Solid solid;
  solid.frame = frameOf(levelSet);
  const float outside = background(solid.frame);
  const float leastDepth = worldFromVoxels(kLeastDepthVoxels, solid.frame);
  const FloatGrid::Ptr grid = emptyLevelSet(solid.frame);
  for (auto leaf = levelSet.tree().cbeginLeaf(); leaf; ++leaf) {
    auto copy = std::make_unique<Leaf>(leaf->origin(), outside, false);
    bool isEmpty = true;
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
      const float value = leaf->getValue(i);
      if (value <= -outside) {
        copy->setValueOff(i, -outside);
      } else if (value < outside) {
        copy->setValueOn(i, value < 0.0f ? std::min(value, -leastDepth) : value);
      } else {  // outside or NaN
        continue;
      }
      isEmpty = false;
    }
    if (!isEmpty) grid->tree().addLeaf(copy.release());
  }
  forEachInsideTile(levelSet, [&](const openvdb::CoordBBox& box) {
    grid->tree().sparseFill(box, -outside, /*active=*/false);
  });
  solid.distance = grid;
  solid.blocks = std::make_shared<const LeafBlocks>(leafBlocks(*grid));
  measureVoxels(solid);
  return solid;
}

namespace {

struct Masks {
  std::array<std::uint64_t, 8> inside{}, exteriorBand{};

  // Whether an inside voxel touches the neighboring leaf in this direction (-1, 0 or 1 per axis).
  [[nodiscard]] bool touches(const Coord& direction) const {
    constexpr std::uint64_t kLowZ = 0x0101010101010101;
    std::uint64_t side = ~std::uint64_t{0};
    if (direction.y() != 0) side &= std::uint64_t{0xff} << (direction.y() > 0 ? 56 : 0);
    if (direction.z() != 0) side &= kLowZ << (direction.z() > 0 ? 7 : 0);
    const std::size_t first = direction.x() > 0 ? 7 : 0, last = direction.x() < 0 ? 0 : 7;
    for (std::size_t x = first; x <= last; ++x) {
      if ((inside[x] & side) != 0) return true;
    }
    return false;
  }
};

using FoundLeaves = std::vector<std::pair<Coord, Masks>>;

// Adds leaves without voxels beside inside voxels.  Where distances jump from inside to outside (in
// grids of other programs, or where a hole is far from any triangle) there is no band, but the
// surface still passes through such leaves.
void addEmptyLeaves(FoundLeaves& found) {
  std::vector<Coord> origins;
  origins.reserve(found.size());
  for (const auto& [origin, masks] : found) origins.push_back(origin);
  const std::vector<LeafNeighbors> neighbors = leafNeighbors(origins);
  std::vector<Coord> missing;
  for (std::size_t leaf = 0; leaf < neighbors.size(); ++leaf) {
    for (int k = 0; k < 27; ++k) {
      if (neighbors[leaf][static_cast<std::size_t>(k)] != LeafBlocks::kNone) continue;
      const Coord direction(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1);
      if (found[leaf].second.touches(direction)) {
        missing.push_back(origins[leaf] +
                          Coord(8 * direction.x(), 8 * direction.y(), 8 * direction.z()));
      }
    }
  }
  if (missing.empty()) return;
  std::sort(missing.begin(), missing.end());
  missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
  for (const Coord& origin : missing) found.emplace_back(origin, Masks{});
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
}

}  // namespace

LeafBlocks leafBlocks(const FloatGrid& grid) {
  // Leaves of the grid, and leaves of its interior tiles (inactive, negative).
  FoundLeaves found;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    Masks masks;
    bool any = false;
    for (unsigned offset = 0; offset < 512; ++offset) {
      const std::uint64_t bit = std::uint64_t{1} << (offset & 63);
      if (leaf->getValue(offset) < 0) {
        masks.inside[offset >> 6] |= bit;
      } else if (leaf->isValueOn(offset)) {
        masks.exteriorBand[offset >> 6] |= bit;
      } else {
        continue;
      }
      any = true;
    }
    if (any) found.emplace_back(leaf->origin(), masks);
  }
  Masks full;
  full.inside.fill(~std::uint64_t{0});
  forEachInsideTile(grid, [&](const openvdb::CoordBBox& box) {
    for (int x = box.min().x(); x <= box.max().x(); x += 8) {
      for (int y = box.min().y(); y <= box.max().y(); y += 8) {
        for (int z = box.min().z(); z <= box.max().z(); z += 8) {
          found.emplace_back(Coord(x, y, z), full);
        }
      }
    }
  });
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  addEmptyLeaves(found);

  LeafBlocks blocks;
  for (const auto& [origin, masks] : found) {
    blocks.origins.push_back(origin);
    blocks.inside.insert(blocks.inside.end(), masks.inside.begin(), masks.inside.end());
    blocks.exteriorBand.insert(blocks.exteriorBand.end(), masks.exteriorBand.begin(),
                               masks.exteriorBand.end());
  }
  blocks.neighbors = leafNeighborTable(blocks.origins);
  return blocks;
}

ConstFloatGridPtr withoutVoxels(const FloatGrid& grid, const LeafBlocks& blocks,
                                const std::function<bool(std::size_t)>& isSmallComponent) {
  const FloatGridPtr copy = copyOf(grid);
  FloatGrid::Accessor accessor = copy->getAccessor();
  blocks.forEachInside([&](std::size_t voxelIndex) {
    if (!isSmallComponent(voxelIndex)) return;
    const Coord voxel = blocks.voxelAt(voxelIndex);
    accessor.setValueOnly(voxel, -accessor.getValue(voxel));
  });
  return copy;
}

void measureVoxels(Solid& solid) {
  solid.voxels = solid.blocks->insideVoxels();
  solid.box = insideBox(*solid.blocks);
}

}  // namespace sherd
