// Checks a mesh with CGAL.
#include "cli/evaluate/cgal_checks.h"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
#include <sherd/error.h>

#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "evaluate/convexity_rays.h"

namespace sherd {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Tree =
    CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Mesh>>>;

Point pointOf(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

struct Soup {
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> triangles;
};

Soup soupOf(const TriangleMesh& mesh) {
  Soup soup;
  for (const glm::dvec3& v : mesh.vertices) soup.points.push_back(pointOf(v));
  for (const glm::uvec3& t : mesh.triangles) soup.triangles.push_back({t.x, t.y, t.z});
  return soup;
}

/// Returns the distance along a ray from inside to the hull, in lengths of its direction.
double exitFrom(const Tree& hull, const Point& origin, const Kernel::Vector_3& direction) {
  const auto hit = hull.first_intersection(Kernel::Ray_3(origin, direction));
  if (!hit) return 0.0;  // rounding put the point outside
  if (const Point* at = boost::get<Point>(&hit->first)) {
    return std::sqrt(CGAL::squared_distance(origin, *at) / direction.squared_length());
  }
  return 0.0;  // the ray lies in a facet
}

std::optional<Convexity> convexityOf(const TriangleMesh& mesh, std::size_t samples,
                                     std::uint64_t seed) {
  const ConvexityRays sampled = convexityRays(mesh, samples, seed);
  const Soup soup = soupOf(sampled.mesh);
  Mesh body, hull;
  pmp::polygon_soup_to_polygon_mesh(soup.points, soup.triangles, body);
  CGAL::convex_hull_3(soup.points.begin(), soup.points.end(), hull);
  const CGAL::Side_of_triangle_mesh<Mesh, Kernel> side(body);
  const Tree tree(faces(hull).first, faces(hull).second, hull);
  std::vector<double> distances;
  for (const ConvexityRays::Ray& ray : sampled.rays) {
    const Point origin = pointOf(ray.origin);
    if (side(origin) != CGAL::ON_BOUNDED_SIDE) continue;
    distances.push_back(
        exitFrom(tree, origin, {ray.direction.x, ray.direction.y, ray.direction.z}));
  }
  if (distances.empty()) return {};  // flat, or inside out
  return convexityFrom(distances);
}

CgalVerdict check(const TriangleMesh& mesh, std::size_t samples, std::uint64_t seed) {
  CgalVerdict verdict;
  const Soup soup = soupOf(mesh);
  verdict.polygonMesh = pmp::is_polygon_soup_a_polygon_mesh(soup.triangles);
  if (!verdict.polygonMesh) return verdict;
  Mesh surface;
  pmp::polygon_soup_to_polygon_mesh(soup.points, soup.triangles, surface);
  verdict.valid = CGAL::is_valid_polygon_mesh(surface);
  verdict.closed = CGAL::is_closed(surface);
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> crossing;
  pmp::self_intersections(surface, std::back_inserter(crossing));
  verdict.selfIntersections = crossing.size();
  if (!verdict.closed) return verdict;
  // does_bound_a_volume requires a mesh without self-intersections, but does not check it.
  verdict.boundsVolume = crossing.empty() && pmp::does_bound_a_volume(surface);
  verdict.convexity = convexityOf(mesh, samples, seed);
  return verdict;
}

}  // namespace

bool hasCgalChecks() { return true; }

CgalVerdict checkWithCgal(const TriangleMesh& mesh, std::size_t samples, std::uint64_t seed) {
  try {
    return check(mesh, samples, seed);
  } catch (const CGAL::Failure_exception& e) {
    throw Error(ErrorCode::internal, std::string("CGAL failed: ") + e.what());
  }
}

}  // namespace sherd
