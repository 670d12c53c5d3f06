// Runs the stages one by one, with seeds and impacts of one's own, and writes a mesh per fragment.
//
//     own_seeds bowl.obj
#include <sherd/sherd.h>

#include <iostream>
#include <vector>

namespace {

// One seed for each octant of the mesh's box, each the center of a fragment.  Seeds outside the
// solid move to the nearest voxel within two voxels, so these may be refused: then only the impact
// is used.
std::vector<sherd::SeedPoint> octantSeeds(const sherd::TriangleMesh& mesh) {
  const sherd::Box box = sherd::bounds(mesh);
  std::vector<sherd::SeedPoint> seeds;
  for (int octant = 0; octant < 8; ++octant) {
    glm::dvec3 at = box.min;
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] += (box.max[axis] - box.min[axis]) * ((octant >> axis & 1) != 0 ? 0.75 : 0.25);
    }
    seeds.push_back({.position = at, .fragment = octant + 1});
  }
  return seeds;
}

// Twelve fragments, five of them from an impact on the middle of the upper side.
std::vector<sherd::Seed> impactSeeds(const sherd::TriangleMesh& mesh, const sherd::Solid& solid,
                                     const sherd::VoxelComponents& components) {
  const sherd::Box box = sherd::bounds(mesh);
  const glm::dvec3 above{0.5 * (box.min.x + box.max.x), box.max.y, 0.5 * (box.min.z + box.max.z)};
  sherd::SeedOptions options{.pieces = 12, .seed = 3};
  options.impacts.push_back({.target = above, .count = 5, .sigma = 0.1 * sherd::longestSide(box)});
  return sherd::placeSeeds(solid, components, options);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: own_seeds MESH\n";
    return 2;
  }
  try {
    sherd::provideKernelCache();
    sherd::Device device;
    const sherd::SourceMesh source = sherd::readMesh(argv[1]);
    const sherd::PreparedSolid ready =
        sherd::prepared(sherd::voxelize(source.mesh, {.resolution = 64}), device);
    std::vector<std::vector<sherd::Seed>> seedSets{
        impactSeeds(source.mesh, ready.solid, ready.components)};
    try {
      seedSets.push_back(
          sherd::seedsFromPoints(octantSeeds(source.mesh), ready.solid, ready.components));
    } catch (const sherd::Error& error) {
      std::cout << "no seeds by octants: " << error.what() << '\n';
    }
    // Several fractures of one solid grow together.
    const std::vector<sherd::Labels> grown =
        sherd::grow(ready.solid.blocks, seedSets, device, {.roughness = 1.0});
    for (std::size_t set = 0; set < grown.size(); ++set) {
      const sherd::Labels& labels = grown[set];
      const std::string first = std::to_string(set) + "_";
      for (const sherd::Fragment& fragment : sherd::extractFragments(ready.solid, labels)) {
        sherd::writePly(first + std::to_string(fragment.id) + ".ply", fragment.mesh);
      }
      std::cout << labels.fragmentCount << " fragments\n";
    }
    return 0;
  } catch (const sherd::Error& error) {
    std::cerr << error.what() << '\n';
    return static_cast<int>(error.code());
  }
}
