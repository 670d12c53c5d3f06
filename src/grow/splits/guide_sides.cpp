// On which side of a given crack the voxels of a solid lie.
#include "grow/splits/guide_sides.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sherd {
namespace {

// Sets the bits of a leaf's inside voxels on the positive side.
void setSides(const LeafBlocks& blocks, const GridFrame& frame, const SidedMesh& surface,
              std::size_t leaf, std::vector<std::uint64_t>& positive) {
  const openvdb::Coord& origin = blocks.origins[leaf];
  const glm::dvec3 middle =
      frame.worldFromIndex(glm::dvec3(origin.x(), origin.y(), origin.z()) + 3.5);
  const double reach = (3.5 * std::sqrt(3.0) + 1e-6) * frame.voxelSize;
  const SidedMesh::Side ofMiddle = surface.sideOf(middle);
  const bool isOneSided = surface.isOneSided(middle, ofMiddle, reach);
  std::uint32_t guess = ofMiddle.guess;
  for (std::size_t word = leaf * 8; word < leaf * 8 + 8; ++word) {
    if (isOneSided) {
      positive[word] = ofMiddle.distance > 0.0 ? blocks.inside[word] : 0;
      continue;
    }
    for (std::uint64_t bits = blocks.inside[word]; bits != 0; bits &= bits - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(bits));
      const SidedMesh::Side side =
          surface.sideOf(frame.worldFromIndex(blocks.voxelAt(word * 64 + bit)), guess);
      guess = side.guess;
      if (side.distance > 0.0) positive[word] |= std::uint64_t{1} << bit;
    }
  }
}

}  // namespace

std::vector<std::uint64_t> positiveSide(const LeafBlocks& blocks, const GridFrame& frame,
                                        const SidedMesh& surface, const Progress* progress) {
  std::vector<std::uint64_t> positive(blocks.inside.size(), 0);
  // In batches, so that the calling thread can report progress and be cancelled in between.
  constexpr std::size_t kBatch = 1024;
  for (std::size_t first = 0; first < blocks.count(); first += kBatch) {
    reportProgress(progress, "guides",
                   static_cast<double>(first) / static_cast<double>(blocks.count()));
    tbb::parallel_for(first, std::min(first + kBatch, blocks.count()),
                      [&](std::size_t leaf) { setSides(blocks, frame, surface, leaf, positive); });
  }
  return positive;
}

}  // namespace sherd
