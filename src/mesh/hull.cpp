// The convex hull of points, as half spaces and as a mesh.
#include "mesh/hull.h"

#include <libqhull_r/libqhull_r.h>
#include <libqhull_r/poly_r.h>
#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <new>
#include <string>
#include <unordered_map>

namespace sherd {
namespace {

/// Qhull's state.  Its messages go into `text_` instead of standard error.
class Quickhull {
 public:
  Quickhull() : log_(::open_memstream(&text_, &textBytes_)) {
    if (!log_) throw std::bad_alloc();
    qh_zero(&state_, log_);
  }
  ~Quickhull() {
    int blocksLeft = 0, bytesLeft = 0;
    qh_freeqhull(
        &state_,
        !qh_ALL);  // frees no small blocks: the next call frees the large ones that contain them
    qh_memfreeshort(&state_, &blocksLeft, &bytesLeft);
    std::fclose(log_);
    std::free(text_);
  }
  Quickhull(const Quickhull&) = delete;
  Quickhull& operator=(const Quickhull&) = delete;

  // Without triangulation and joggling, so the points are not changed.
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

  // Returns the facets as fans, and the points that are their corners.
  //   points  those of run()
  TriangleMesh mesh(const std::vector<glm::dvec3>& points) {
    TriangleMesh result;
    std::unordered_map<int, std::uint32_t> vertexOfPoint;
    const auto vertexOf = [&](int point) {
      const auto [found, isNew] =
          vertexOfPoint.try_emplace(point, static_cast<std::uint32_t>(result.vertices.size()));
      if (isNew) result.vertices.push_back(points[static_cast<std::size_t>(point)]);
      return found->second;
    };
    for (facetT* facet = state_.facet_list; facet && facet->next; facet = facet->next) {
      setT* corners = qh_facet3vertex(&state_, facet);  // in cyclic order, either orientation
      std::vector<std::uint32_t> ring;
      for (int i = 0; i < qh_setsize(&state_, corners); ++i) {
        const auto* vertex = static_cast<const vertexT*>(corners->e[i].p);
        ring.push_back(vertexOf(qh_pointid(&state_, vertex->point)));
      }
      qh_settempfree(&state_, &corners);
      glm::dvec3 areaVector(0.0);
      for (std::size_t i = 0; i < ring.size(); ++i) {
        areaVector +=
            glm::cross(result.vertices[ring[i]], result.vertices[ring[(i + 1) % ring.size()]]);
      }
      const coordT* n = facet->normal;
      if (glm::dot(areaVector, glm::dvec3(n[0], n[1], n[2])) < 0.0)
        std::reverse(ring.begin(), ring.end());
      for (std::size_t i = 2; i < ring.size(); ++i) {
        result.triangles.emplace_back(ring[0], ring[i - 1], ring[i]);
      }
    }
    return result;
  }

  std::string firstLine() {
    std::fflush(log_);
    const std::string text(text_, textBytes_);
    return text.substr(0, text.find('\n'));
  }

 private:
  char* text_ = nullptr;
  std::size_t textBytes_ = 0;
  std::FILE* log_;
  qhT state_;
};

void hullOf(Quickhull& quickhull, std::vector<glm::dvec3>& points) {
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(coordT), "Qhull reads the points in place");
  if (points.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw Error(ErrorCode::input, "convex hull: " + std::to_string(points.size()) +
                                      " points; at most 2147483647 are possible");
  }
  // Qhull needs dimension + 1 points, and reports fewer as an error of the caller.
  const Error flat(ErrorCode::input, "the mesh is flat; its convex hull has no volume");
  if (points.size() < 4) throw flat;
  const int status = quickhull.run(points);
  if (status == qh_ERRsingular) throw flat;
  if (status == qh_ERRmem) throw std::bad_alloc();
  if (status != qh_ERRnone) {
    throw Error(ErrorCode::internal, "convex hull: " + quickhull.firstLine());
  }
}

// Returns the corners of the intersection of half spaces that contain the origin: the duals of the
// facets of the hull of the half spaces' duals.
std::vector<glm::dvec3> hullCorners(const std::vector<HalfSpace>& sides) {
  std::vector<glm::dvec3> duals;
  for (const HalfSpace& side : sides) duals.push_back(side.normal / -side.offset);
  std::vector<glm::dvec3> corners;
  for (const HalfSpace& facet : convexHull(std::move(duals))) {
    corners.push_back(facet.normal / -facet.offset);
  }
  return corners;
}

// Returns the power of two next to the points' greatest distance from a point along an axis: some
// of Qhull's bounds are absolute.
double hullUnit(const std::vector<glm::dvec3>& points, const glm::dvec3& from) {
  double farthest = 0.0;
  for (const glm::dvec3& p : points) {
    const glm::dvec3 apart = glm::abs(p - from);
    farthest = std::max({farthest, apart.x, apart.y, apart.z});
  }
  return farthest > 0.0 ? std::exp2(std::ilogb(farthest)) : 1.0;
}

}  // namespace

std::vector<HalfSpace> convexHull(std::vector<glm::dvec3> points) {
  Quickhull quickhull;
  hullOf(quickhull, points);
  return quickhull.halfSpaces();
}

TriangleMesh convexHullMesh(std::vector<glm::dvec3> points, double inset) {
  glm::dvec3 mean(0.0);
  for (const glm::dvec3& p : points) mean += p;
  mean /= static_cast<double>(std::max<std::size_t>(points.size(), 1));
  const double unit = hullUnit(points, mean);
  for (glm::dvec3& p : points) p = (p - mean) / unit;
  inset /= unit;
  if (inset > 0.0) {
    std::vector<HalfSpace> sides = convexHull(points);
    double room = std::numeric_limits<double>::infinity();
    for (const HalfSpace& side : sides) room = std::min(room, -side.offset);
    for (HalfSpace& side : sides) side.offset += std::min(inset, 0.5 * room);
    points = hullCorners(sides);
  }
  Quickhull quickhull;
  hullOf(quickhull, points);
  TriangleMesh mesh = quickhull.mesh(points);
  for (glm::dvec3& v : mesh.vertices) v = v * unit + mean;
  return mesh;
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
