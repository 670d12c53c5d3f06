// All fragments in their assembled positions.
#include "evaluate/assembly.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sherd {
namespace {

double distanceTo(const Box& box, const glm::dvec3& point) {
  return glm::length(glm::max(glm::max(box.min - point, point - box.max), glm::dvec3(0.0)));
}

}  // namespace

Assembly::Assembly(std::span<const FragmentMesh> fragments)
    : fragments_(fragments), meshes_(fragments.size()), closed_(fragments.size()) {
  tbb::parallel_for(std::size_t{0}, fragments.size(), [&](std::size_t i) {
    meshes_[i] = std::make_unique<MeshDistance>(fragments[i].mesh);
    closed_[i] = openEdges(fragments[i].mesh) == 0;
  });
  for (std::size_t i = 0; i < meshes_.size(); ++i) {
    const Box& box = meshes_[i]->box();
    box_ = i == 0 ? box : Box{glm::min(box_.min, box.min), glm::max(box_.max, box.max)};
  }
}

Assembly::Location Assembly::locate(const glm::dvec3& point, std::size_t excluded,
                                    double rounding) const {
  Location location;
  location.distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < meshes_.size(); ++i) {
    if (i == excluded) continue;
    const double toBox = distanceTo(meshes_[i]->box(), point);
    if (toBox > 0.0 && toBox >= location.distance) continue;
    // A fragment whose box contains the point may contain it at any distance.
    const MeshDistance::Nearest found =
        toBox > 0.0 ? meshes_[i]->nearest(point, location.distance) : meshes_[i]->nearest(point);
    const double distance = found.distance;
    if (distance < location.distance) {
      location.distance = distance;
      location.nearest = i;
      location.closestPoint = found.point;
    }
    if (toBox == 0.0 && closed_[i] && distance > std::max(rounding, location.depth) &&
        meshes_[i]->contains(point, distance)) {
      location.depth = distance;
    }
  }
  return location;
}

bool Assembly::anyContains(const glm::dvec3& point, std::size_t excluded, double rounding) const {
  for (std::size_t i = 0; i < meshes_.size(); ++i) {
    if (i == excluded || !closed_[i] || distanceTo(meshes_[i]->box(), point) > 0.0) continue;
    if (!meshes_[i]->likelyContains(point)) continue;
    const double distance = meshes_[i]->distance(point);
    if (distance > rounding && meshes_[i]->contains(point, distance)) return true;
  }
  return false;
}

}  // namespace sherd
