// Densities at the middles of leaves.
#include "seed/leaf_densities.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "seed/draw/density.h"
#include "seed/draw/voxel_index.h"
#include "seed/impacts.h"

namespace sherd {
namespace {

// The impacts' part of the density at a point of index space.
double nearImpacts(const std::vector<AimedImpact>& impacts, const glm::dvec3& point) {
  constexpr double kFar = 0.05;
  double density = kFar;
  for (const AimedImpact& impact : impacts) {
    const double side = std::max({impact.side.x, impact.side.y, impact.side.z});
    const double deviation = side / std::sqrt(12.0 * std::max(impact.terms, 1));
    const glm::dvec3 apart = (point - impact.center) / std::max(deviation, 1e-9);
    const double falloff = 1.0 / (1.0 + glm::dot(apart, apart));
    density += falloff * falloff;
  }
  return density;
}

}  // namespace

std::vector<double> leafDensities(const Solid& solid, const VoxelComponents& components,
                                  const SeedOptions& options, std::size_t pieces) {
  const bool isHit = !options.impacts.empty() || options.randomImpacts > 0;
  const DensityField* const field = options.density.field.get();
  if (!isHit && field == nullptr) return {};
  std::vector<AimedImpact> impacts;
  if (isHit) {
    const std::vector<std::uint64_t> surface = surfaceMask(*solid.blocks);
    const VoxelIndex inside(*solid.blocks, solid.blocks->inside), onSurface(*solid.blocks, surface);
    impacts = aim(solid, components, options, pieces, inside, onSurface);
  }
  const DensityTest density(field, solid.frame, options.seed);
  std::vector<double> densities;
  for (const openvdb::Coord& origin : solid.blocks->origins) {
    const glm::dvec3 middle = glm::dvec3(origin.x(), origin.y(), origin.z()) + 3.5;
    // A piece is split where no density is, too, but late.
    constexpr double kLeast = 1e-3;
    densities.push_back((isHit ? nearImpacts(impacts, middle) : 1.0) *
                        std::max(density.at(middle), kLeast));
  }
  return densities;
}

}  // namespace sherd
