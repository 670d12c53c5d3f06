// How much memory a solid takes, and the box of its surface.
#include <openvdb/openvdb.h>

#include "interface/intact.h"
#include "seed/draw/wall.h"
#include "solid.h"
#include "voxelize/wall_middles.h"

namespace pysherd {
namespace {

template <class Value>
std::uint64_t bytesOf(const std::vector<Value>& values) {
  return values.capacity() * sizeof(Value);
}

std::uint64_t bytesOf(const sherd::LeafBlocks& blocks) {
  std::uint64_t bytes = bytesOf(blocks.origins) + bytesOf(blocks.inside) +
                        bytesOf(blocks.exteriorBand) + bytesOf(blocks.neighbors);
  for (const std::vector<std::uint64_t>& layer : blocks.layers) bytes += bytesOf(layer);
  return bytes;
}

std::uint64_t bytesOf(const sherd::TriangleMesh& mesh) {
  const sherd::SurfaceAttributes& own = mesh.attributes;
  return bytesOf(mesh.vertices) + bytesOf(mesh.triangles) + bytesOf(mesh.neighbor) +
         bytesOf(mesh.source) + bytesOf(own.texcoords) + bytesOf(own.colors) +
         bytesOf(own.material) + bytesOf(own.normals);
}

std::uint64_t bytesOf(const sherd::SourceMesh& source) {
  std::uint64_t bytes =
      bytesOf(source.mesh) + bytesOf(source.objectOfTriangle) + bytesOf(source.polygons);
  for (const sherd::Texture& texture : source.appearance.textures) bytes += texture.bytes.size();
  return bytes;
}

std::uint64_t bytesOf(const sherd::IntactLeaf& leaf) {
  const sherd::LeafCells& cells = leaf.cells;
  return sizeof leaf + bytesOf(cells.cells) + bytesOf(cells.vertices) + bytesOf(cells.labels) +
         bytesOf(cells.ranks) + bytesOf(cells.positionIds) + bytesOf(cells.nonManifold) +
         bytesOf(cells.junctions) + bytesOf(leaf.quads) + bytesOf(leaf.areas) +
         bytesOf(leaf.areaSums);
}

std::uint64_t bytesOf(const sherd::IntactSurface& surface, const sherd::LeafBlocks& blocks) {
  std::uint64_t bytes = bytesOf(surface.neighborhoods);
  for (const sherd::IntactLeaf& leaf : surface.leaves) bytes += bytesOf(leaf);
  for (const openvdb::Coord& origin : blocks.origins)
    bytes +=
        surface.creases.of(origin).size_bytes() + surface.creases.crossings(origin).size_bytes();
  return bytes;
}

}  // namespace

sherd::Box Solid::surfaceBox() const {
  sherd::Box box;
  bool isFirst = true;
  const auto add = [&](const glm::dvec3& low, const glm::dvec3& high) {
    box.min = isFirst ? low : glm::min(box.min, low);
    box.max = isFirst ? high : glm::max(box.max, high);
    isFirst = false;
  };
  if (const auto intact = surface()) {
    for (const sherd::IntactLeaf& leaf : intact->leaves) {
      for (const glm::dvec3& vertex : leaf.cells.vertices) {
        const glm::dvec3 at = solid().frame.worldFromIndex(vertex);
        add(at, at);
      }
    }
  }
  if (isFirst) {  // voxels reach half their size around their centers
    const glm::dvec3 half(0.5 * solid().frame.voxelSize);
    add(solid().frame.worldFromIndex(solid().box.min) - half,
        solid().frame.worldFromIndex(solid().box.max) + half);
  }
  return box;
}

std::uint64_t Solid::bytes() const {
  constexpr std::uint64_t kTreesPerTriangle = 174;  // of Solid::region, which copies the mesh
  std::uint64_t bytes = solid().distance->memUsage() + bytesOf(*solid().blocks) + bytesOf(source_);
  if (solid().region) bytes += kTreesPerTriangle * source_.mesh.triangles.size();
  if (solid().mesh) bytes += bytesOf(solid().mesh->mesh) + bytesOf(solid().mesh->source);
  if (const auto intact = surface()) bytes += bytesOf(*intact, *solid().blocks);
  const bool keepsWalls =
      isSmall() && resolved(sherd::SeedsOn::automatic, solid(), 2) == sherd::SeedsOn::wall;
  if (keepsWalls) bytes += solid().blocks->count() * sherd::SolidWalls::kBytesOfALeaf;
  return bytes;
}

}  // namespace pysherd
