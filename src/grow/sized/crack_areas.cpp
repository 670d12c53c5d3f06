// Cracks between fragments, and weights that change the fragments' sizes.
#include "grow/sized/crack_areas.h"

#include <algorithm>
#include <cstddef>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

std::vector<CrackArea> crackAreas(const Labels& labels) {
  const LeafBlocks& blocks = *labels.blocks;
  std::vector<std::uint32_t> pairs;  // of each face
  blocks.forEachInside([&](std::size_t voxel) {
    const std::uint16_t own = labels.fragment[voxel];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t behind = voxelBehind(blocks, voxel, axis);
      if (behind == kNoVoxel || !blocks.isInside(behind)) continue;
      const std::uint16_t other = labels.fragment[behind];
      if (other == own || other == 0 || own == 0) continue;
      if (!blocks.layers.empty() && blocks.layerOf(voxel) != blocks.layerOf(behind)) continue;
      pairs.push_back(std::uint32_t{std::min(own, other)} << 16 | std::max(own, other));
    }
  });
  std::sort(pairs.begin(), pairs.end());
  std::vector<CrackArea> areas;
  for (const std::uint32_t pair : pairs) {
    const CrackArea area{static_cast<std::uint16_t>(pair >> 16),
                         static_cast<std::uint16_t>(pair & 0xffff), 1};
    if (!areas.empty() && areas.back().a == area.a && areas.back().b == area.b) {
      ++areas.back().faces;
    } else {
      areas.push_back(area);
    }
  }
  return areas;
}

std::vector<double> weightsFor(const std::vector<WeightSpring>& springs,
                               const std::vector<double>& change) {
  const std::size_t n = change.size();
  std::vector<double> diagonal(n, 0.0);
  for (const WeightSpring& s : springs) {
    diagonal[s.a] += s.stiffness;
    diagonal[s.b] += s.stiffness;
  }
  const auto dot = [&](const std::vector<double>& u, const std::vector<double>& v) {
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) sum += u[i] * v[i];
    return sum;
  };
  const auto scaled = [&](const std::vector<double>& v) {
    std::vector<double> out(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) out[i] = diagonal[i] > 0.0 ? v[i] / diagonal[i] : 0.0;
    return out;
  };
  // Conjugate gradients, preconditioned by the diagonal.
  std::vector<double> weights(n, 0.0), rest = change, direction = scaled(rest), step(n);
  double energy = dot(rest, direction);
  const double enough = 1e-10 * energy;
  constexpr int kMostSteps = 500;
  for (int i = 0; i < kMostSteps && energy > enough; ++i) {
    std::fill(step.begin(), step.end(), 0.0);
    for (const WeightSpring& s : springs) {
      const double moved = s.stiffness * (direction[s.a] - direction[s.b]);
      step[s.a] += moved;
      step[s.b] -= moved;
    }
    const double curvature = dot(direction, step);
    if (!(curvature > 0.0)) break;
    const double length = energy / curvature;
    for (std::size_t k = 0; k < n; ++k) {
      weights[k] += length * direction[k];
      rest[k] -= length * step[k];
    }
    const std::vector<double> next = scaled(rest);
    const double nextEnergy = dot(rest, next);
    for (std::size_t k = 0; k < n; ++k) direction[k] = next[k] + nextEnergy / energy * direction[k];
    energy = nextEnergy;
  }
  return weights;
}

}  // namespace sherd
