// Moves objects to the origin, where single precision resolves them.
#include <sherd/options.h>

#include <memory>
#include <utility>
#include <variant>

#include "seed/draw/density.h"
#include "voxelize/distance.h"

namespace sherd {
namespace {

void move(Impact& impact, const glm::dvec3& by) {
  if (auto* point = std::get_if<WorldPoint>(&impact.target)) *point += by;
  if (auto* ray = std::get_if<Ray>(&impact.target)) ray->origin += by;
}

void move(Guide& guide, const glm::dvec3& by) {
  for (std::vector<glm::dvec3>& line : guide.polylines) {
    for (glm::dvec3& point : line) point += by;
  }
  for (glm::dvec3& vertex : guide.mesh.vertices) vertex += by;
}

}  // namespace

glm::dvec3 boxCenter(const TriangleMesh& mesh) {
  const Box box = bounds(mesh);
  return box.min + (box.max - box.min) / 2.0;  // whose sum could overflow
}

glm::dvec3 boxCenter(const Solid& solid) {
  const openvdb::Coord both = solid.box.min + solid.box.max;
  return solid.frame.worldFromIndex(glm::dvec3(both.x(), both.y(), both.z()) / 2.0);
}

TriangleMesh moved(TriangleMesh mesh, const glm::dvec3& by) {
  for (glm::dvec3& vertex : mesh.vertices) vertex += by;
  return mesh;
}

Solid moved(Solid solid, const glm::dvec3& by) {
  solid.frame.origin += by;
  const FloatGridPtr grid = copyOf(*solid.distance);
  setFrame(*grid, solid.frame);
  solid.distance = grid;
  return solid;
}

FractureOptions moved(FractureOptions options, const glm::dvec3& by) {
  SeedOptions& seeds = options.seeds;
  for (Impact& impact : seeds.impacts) move(impact, by);
  for (std::size_t i = 0; seeds.given && i < seeds.given->points.size(); ++i) {
    seeds.given->points[i].position += by;
  }
  for (Guide& guide : options.guides) move(guide, by);
  if (seeds.density.field) {
    seeds.density.field = std::make_shared<const DensityField>(
        [field = seeds.density.field, by](const glm::dvec3& at) { return field->at(at - by); },
        seeds.density.field->most());
  }
  return options;
}

RunOptions recentered(RunOptions options, const glm::dvec3& offset) {
  for (Impact& impact : options.fracture.seeds.impacts) impact.given = impact.target;
  options.fracture = moved(std::move(options.fracture), -offset);
  options.write.offset = offset;
  return options;
}

}  // namespace sherd
