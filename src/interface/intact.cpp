// Meshes the intact solid leaf by leaf.
#include "interface/intact.h"

#include <sherd/error.h>
#include <sherd/fragments.h>
#include <tbb/parallel_for.h>

#include <glm/common.hpp>

#include "cut/intact_labels.h"
#include "interface/flat_input.h"
#include "mesh/triangle_area.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

// Sets the areas, masses and box of a leaf's triangles.
void measure(IntactSurface& surface, std::size_t leaf, const GridFrame& frame) {
  IntactLeaf& own = surface.leaves[leaf];
  if (own.quads.empty()) return;
  own.octants.assign(8, MassSums(surface.reference));
  own.areas.resize(own.quads.size());
  own.areaSums.reserve(own.triangles());
  double area = 0.0;
  for (std::size_t t = 0; t < own.triangles(); ++t) {
    const std::array<glm::dvec3, 3> at = surface.corners(leaf, t, frame);
    MassSums& octant = own.octants[octantOf(own.quads[t / 2].edge)];
    octant.add(at[0], at[1], at[2]);
    const double one = areaOf(at);
    own.areas[t / 2][t % 2] = one;
    own.areaSums.push_back(area += one);
    if (t == 0) own.box = {at[0], at[0]};
    for (const glm::dvec3& corner : at) {
      own.box.min = glm::min(own.box.min, corner);
      own.box.max = glm::max(own.box.max, corner);
    }
  }
  own.mass = sumOf(own.octants, surface.reference);
}

}  // namespace

void checkIntact(const IntactSurface* surface, const Solid& solid) {
  if (surface == nullptr || surface->distance == solid.distance) return;
  throw Error(ErrorCode::usage, "the intact surface is of another solid");
}

glm::dvec3 middleOf(const Solid& solid) {
  return 0.5 *
         (solid.frame.worldFromIndex(solid.box.min) + solid.frame.worldFromIndex(solid.box.max));
}

std::shared_ptr<const IntactSurface> intactSurface(const Solid& solid) {
  auto made = std::make_shared<IntactSurface>();
  const std::size_t count = solid.blocks->count();
  made->distance = solid.distance;
  made->neighborhoods = leafNeighbors(solid.blocks->origins);
  made->leaves.resize(count);
  made->creases = Creases(solid, made->neighborhoods, nullptr, KeepCrossings::yes);
  made->isPiecewiseFlat = isPiecewiseFlat(solid);
  const IntactLabels intact(solid.blocks);
  const Field field(solid, intact.labels, intact.cut, made->neighborhoods, &made->creases);
  tbb::parallel_for(std::size_t{0}, count,
                    [&](std::size_t leaf) { made->leaves[leaf].cells = cellsOf(field, leaf); });

  // Vertices are numbered by leaf, so that a vertex index identifies its leaf.
  AllCells all;
  std::uint32_t vertices = 0;
  for (const IntactLeaf& leaf : made->leaves) {
    all.leaves.push_back(&leaf.cells);
    all.firstVertex.push_back(vertices);
    vertices += static_cast<std::uint32_t>(leaf.cells.vertices.size());
  }
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t leaf) {
    IntactLeaf& own = made->leaves[leaf];
    std::array<std::uint32_t, 8> leafOfSlot{};
    own.isWhole = true;
    for (std::size_t slot = 0; slot < 8; ++slot) {
      leafOfSlot[slot] = made->neighborhoods[leaf][IntactLeaf::kSlots[slot]];
      const bool isPlain =
          leafOfSlot[slot] == LeafBlocks::kNone || made->leaves[leafOfSlot[slot]].cells.isPlain;
      own.isWhole &= isPlain;
    }
    if (!own.isWhole) return;
    // Positions of the corners, to split quads at the same diagonals as InterfaceMeshes.
    for (const InterfaceQuad& quad : quadsOf(field, all, leaf)) {
      std::array<IntactLeaf::Corner, 4> corner{};
      std::array<glm::dvec3, 4> at{};
      for (std::size_t k = 0; k < 4; ++k) {
        for (std::uint32_t slot = 0; slot < 8; ++slot) {
          if (leafOfSlot[slot] == LeafBlocks::kNone) continue;
          const std::uint32_t first = all.firstVertex[leafOfSlot[slot]];
          const LeafCells& cells = made->leaves[leafOfSlot[slot]].cells;
          if (quad.vertex[k] < first || quad.vertex[k] - first >= cells.vertices.size()) continue;
          corner[k] = slot << IntactLeaf::kSlotBits | (quad.vertex[k] - first);
          at[k] = solid.frame.worldFromIndex(cells.vertices[quad.vertex[k] - first]);
          break;
        }
      }
      own.quads.push_back(
          {corner, quad.edge, settledSplit({1, 0, {0, 1, 2, 3}, quad.edge, quad.split}, at)});
    }
    own.quads.shrink_to_fit();
  });
  made->reference = middleOf(solid);
  tbb::parallel_for(std::size_t{0}, count,
                    [&](std::size_t leaf) { measure(*made, leaf, solid.frame); });
  return made;
}

}  // namespace sherd
