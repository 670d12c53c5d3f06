// Impacts whose pattern of cracks is made by splits.
#include "seed/split_impacts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "base/random.h"
#include "seed/draw/voxel_index.h"
#include "seed/impacts.h"

namespace sherd {

std::vector<SplitImpact> splitImpacts(const Solid& solid, const VoxelComponents& components,
                                      const SeedOptions& options, std::size_t pieces) {
  const bool isAny = std::any_of(options.impacts.begin(), options.impacts.end(),
                                 [](const Impact& impact) { return impact.energy > 0.0; });
  if (!isAny) return {};
  const std::vector<std::uint64_t> surface = surfaceMask(*solid.blocks);
  const VoxelIndex inside(*solid.blocks, solid.blocks->inside), onSurface(*solid.blocks, surface);
  const Walls walls(solid);
  const std::vector<AimedImpact> aimed = aim(solid, components, options, pieces, inside, onSurface);
  std::vector<SplitImpact> all;
  for (std::size_t i = 0; i < aimed.size(); ++i) {
    if (aimed[i].pattern.radials == 0) continue;
    SplitImpact impact{.center = aimed[i].center,
                       .pattern = aimed[i].pattern,
                       .component = aimed[i].component,
                       .pieces = aimed[i].count,
                       .seed = randomBits(options.seed, Stage::impactSeed, i)};
    const std::optional<Wall> wall = walls.at(impact.center, 0.5 * impact.pattern.radius);
    glm::dvec3 normal = wall ? wall->normal : walls.normalAt(impact.center);
    if (wall) impact.center = wall->middle;
    if (normal == glm::dvec3(0.0)) normal = {0.0, 0.0, 1.0};
    const glm::dvec3 axis = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    impact.u = glm::normalize(glm::cross(normal, axis));
    impact.v = glm::cross(normal, impact.u);
    all.push_back(impact);
  }
  return all;
}

}  // namespace sherd
