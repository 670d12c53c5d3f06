// Voxel solids for kernel tests.
#include "voxel_shapes.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>

namespace sherd::voxel_shapes {

using openvdb::Coord;

std::vector<Coord> neighbors(const Coord& v) {
  return {v.offsetBy(-1, 0, 0), v.offsetBy(1, 0, 0),  v.offsetBy(0, -1, 0),
          v.offsetBy(0, 1, 0),  v.offsetBy(0, 0, -1), v.offsetBy(0, 0, 1)};
}

VoxelSolid solidWhere(std::string name, int extent,
                      const std::function<bool(const Coord&)>& isInside) {
  VoxelSolid solid;
  solid.name = std::move(name);
  for (int x = -extent; x <= extent; ++x) {
    for (int y = -extent; y <= extent; ++y) {
      for (int z = -extent; z <= extent; ++z) {
        if (isInside({x, y, z})) solid.inside.insert({x, y, z});
      }
    }
  }
  std::set<Coord> layer = solid.inside;
  for (int step = 0; step < 3; ++step) {
    std::set<Coord> next;
    for (const Coord& v : layer) {
      for (const Coord& n : neighbors(v)) {
        if (!solid.inside.count(n) && solid.exteriorBand.insert(n).second) next.insert(n);
      }
    }
    layer = std::move(next);
  }
  return solid;
}

VoxelSolid ball(int radius) {
  return solidWhere("ball", radius, [=](const Coord& v) {
    return v.x() * v.x() + v.y() * v.y() + v.z() * v.z() <= radius * radius;
  });
}

VoxelSolid cup(int radius, int wall) {
  return solidWhere("cup", radius, [=](const Coord& v) {
    const int r2 = v.x() * v.x() + v.z() * v.z();
    const int inner = radius - wall;
    return r2 <= radius * radius && !(r2 < inner * inner && v.y() > -radius + wall);
  });
}

VoxelSolid sparseRandom(int extent, unsigned percent, unsigned seed) {
  std::minstd_rand random(seed + 1);
  return solidWhere("random " + std::to_string(percent) + " %", extent,
                    [&](const Coord&) { return random() % 100 < percent; });
}

VoxelSolid manyComponentsWithin(int extent) {
  return solidWhere("many components", extent, [](const Coord& v) {
    const auto cell = [](int c) { return (c + 100) / 5; };
    const auto within = [](int c) { return (c + 100) % 5; };
    // Cubes of 5 in every other cell of a checkerboard touch at edges; some of the other cells hold
    // separate cubes of 3.
    if ((cell(v.x()) + cell(v.y()) + cell(v.z())) % 2 == 0) return true;
    return cell(v.x()) % 3 == 0 && within(v.x()) > 0 && within(v.x()) < 4 && within(v.y()) > 0 &&
           within(v.y()) < 4 && within(v.z()) > 0 && within(v.z()) < 4;
  });
}

VoxelSolid checkerboard(int extent) {
  return solidWhere("checkerboard", extent,
                    [](const Coord& v) { return ((v.x() + v.y() + v.z()) & 1) == 0; });
}

bool small() {
  const char* value = std::getenv("SHERD_TEST_SMALL");
  return value && *value == '1';
}

std::vector<VoxelSolid> all() {
  if (small()) {
    return {ball(5), cup(6, 2), sparseRandom(4, 45, 2), manyComponentsWithin(5), checkerboard(3)};
  }
  return {ball(19),
          cup(20, 3),
          sparseRandom(12, 30, 1),
          sparseRandom(12, 45, 2),
          sparseRandom(10, 80, 3),
          manyComponentsWithin(20),
          checkerboard(9)};
}

std::shared_ptr<const LeafBlocks> blocksOf(const VoxelSolid& solid) {
  std::map<Coord, std::array<std::array<std::uint64_t, 8>, 2>> leaves;
  const auto set = [&](const Coord& v, std::size_t which) {
    leaves[v & ~7][which][static_cast<std::size_t>(v.x() & 7)] |=
        std::uint64_t{1} << (((v.y() & 7) << 3) | (v.z() & 7));
  };
  for (const Coord& v : solid.inside) set(v, 0);
  for (const Coord& v : solid.exteriorBand) set(v, 1);
  LeafBlocks blocks;
  std::map<Coord, std::uint32_t> number;
  for (const auto& [origin, masks] : leaves) {
    number[origin] = static_cast<std::uint32_t>(blocks.origins.size());
    blocks.origins.push_back(origin);
    blocks.inside.insert(blocks.inside.end(), masks[0].begin(), masks[0].end());
    blocks.exteriorBand.insert(blocks.exteriorBand.end(), masks[1].begin(), masks[1].end());
  }
  for (const Coord& origin : blocks.origins) {
    for (int k = 0; k < 6; ++k) {
      Coord beside = origin;
      beside[k / 2] += k % 2 ? 8 : -8;
      const auto found = number.find(beside);
      blocks.neighbors.push_back(found == number.end() ? LeafBlocks::kNone : found->second);
    }
  }
  return std::make_shared<const LeafBlocks>(std::move(blocks));
}

std::size_t voxelIndexOf(const LeafBlocks& blocks, const Coord& v) {
  const auto at = std::lower_bound(blocks.origins.begin(), blocks.origins.end(), v & ~7);
  return static_cast<std::size_t>(at - blocks.origins.begin()) * 512 +
         static_cast<std::size_t>(((v.x() & 7) << 6) | ((v.y() & 7) << 3) | (v.z() & 7));
}

bool leafOrder(const Coord& a, const Coord& b) {
  return std::pair(a & ~7, a) < std::pair(b & ~7, b);
}

}  // namespace sherd::voxel_shapes
