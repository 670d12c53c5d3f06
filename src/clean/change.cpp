// A local change of the faces of all pieces.
#include "clean/change.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace sherd {
Change collapse(const Stars& stars, std::uint32_t gone, std::uint32_t at,
                const std::vector<glm::dvec3>& positions) {
  Change change{.at = at, .position = positions[at], .gone = gone};
  for (const std::uint32_t f : stars.around(gone)) {
    const CleanFace& face = stars.face(f);
    if (face.has(at)) {
      change.removed.push_back(f);
    } else {
      change.moved.push_back({f, replaced(face.corner, gone, at)});
    }
  }
  change.distance = glm::distance(positions[gone], positions[at]);
  return change;
}

Change attach(const Stars& stars, std::uint32_t a, std::uint32_t b, std::uint32_t at,
              const glm::dvec3& position, const std::vector<glm::dvec3>& positions) {
  Change change{.at = at, .position = position};
  for (const std::uint32_t f : stars.atEdge(a, b)) {
    const CleanFace& face = stars.face(f);
    if (face.has(at)) {
      change.removed.push_back(f);
    } else {
      change.moved.push_back({f, replaced(face.corner, b, at)});
      change.added.push_back({f, replaced(face.corner, a, at)});
    }
  }
  if (position != positions[at]) {
    for (const std::uint32_t f : stars.around(at)) {
      const bool isRemoved =
          std::find(change.removed.begin(), change.removed.end(), f) != change.removed.end();
      if (!isRemoved) change.moved.push_back({f, stars.face(f).corner});
    }
  }
  const glm::dvec3 along = positions[b] - positions[a], to = positions[at] - positions[a];
  change.distance = glm::length(glm::cross(along, to)) / glm::length(along);
  return change;
}

}  // namespace sherd
