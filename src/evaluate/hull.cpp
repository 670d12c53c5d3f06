// The convex hull of points, as half spaces.
#include "evaluate/hull.h"

#include <libqhull_r/libqhull_r.h>
#include <sherd/error.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <limits>
#include <new>
#include <string>

namespace sherd {
namespace {

/// Qhull's state.  What it has to say goes into `said`, which is standard error otherwise.
class Quickhull {
 public:
  Quickhull() : log_(::open_memstream(&said_, &saidBytes_)) {
    if (!log_) throw std::bad_alloc();
    qh_zero(&state_, log_);
  }
  ~Quickhull() {
    int blocksLeft = 0, bytesLeft = 0;
    qh_freeqhull(&state_, !qh_ALL);  // its small blocks lie in large ones, freed at once
    qh_memfreeshort(&state_, &blocksLeft, &bytesLeft);
    std::fclose(log_);
    std::free(said_);
  }
  Quickhull(const Quickhull&) = delete;
  Quickhull& operator=(const Quickhull&) = delete;

  // Neither triangulated nor jogged, so the points stay as they are.
  int run(std::vector<glm::dvec3>& points) {
    char command[] = "qhull Pp";
    return qh_new_qhull(&state_, 3, static_cast<int>(points.size()), &points[0].x, False, command,
                        nullptr, log_);
  }

  std::vector<HalfSpace> halfSpaces() const {
    std::vector<HalfSpace> result;
    result.reserve(static_cast<std::size_t>(state_.num_facets));
    for (const facetT* facet = state_.facet_list; facet && facet->next; facet = facet->next) {
      const coordT* n = facet->normal;
      result.push_back({{n[0], n[1], n[2]}, facet->offset});
    }
    return result;
  }

  std::string firstLineSaid() {
    std::fflush(log_);
    const std::string text(said_, saidBytes_);
    return text.substr(0, text.find('\n'));
  }

 private:
  char* said_ = nullptr;
  std::size_t saidBytes_ = 0;
  std::FILE* log_;
  qhT state_;
};

}  // namespace

std::vector<HalfSpace> convexHull(std::vector<glm::dvec3> points) {
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(coordT), "Qhull reads the points as they lie");
  if (points.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw Error(ErrorCode::input, "convex hull: " + std::to_string(points.size()) +
                                      " points, at most 2147483647 are possible");
  }
  // Qhull asks for dimension + 1 points, and says so as an error of ours.
  if (points.size() < 4) throw Error(ErrorCode::input, "the mesh is flat; a body is needed");
  Quickhull quickhull;
  const int status = quickhull.run(points);
  if (status == qh_ERRsingular) {
    throw Error(ErrorCode::input, "the mesh is flat; a body is needed");
  }
  if (status == qh_ERRmem) throw std::bad_alloc();
  if (status != qh_ERRnone) {
    throw Error(ErrorCode::internal, "convex hull: " + quickhull.firstLineSaid());
  }
  return quickhull.halfSpaces();
}

double exitDistance(std::span<const HalfSpace> hull, const glm::dvec3& origin,
                    const glm::dvec3& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const HalfSpace& side : hull) {
    const double approach = glm::dot(side.normal, direction);
    const double height = glm::dot(side.normal, origin) + side.offset;
    if (approach > 0.0) nearest = std::min(nearest, -height / approach);
  }
  return std::max(nearest, 0.0);
}

}  // namespace sherd
