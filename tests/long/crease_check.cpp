// How well fragments keep the creases of meshes.
//
// usage: sherd_crease_check RESOLUTION PIECES [MESH...]    (built-in shapes, by default)
//
// Prints a line for each mesh: the distances in voxels from points on the input's edges of more
// than 40 degrees to the fragments' original surface, the mean distance of that surface's vertices
// to the input, the pairs of triangles that cross, faults of meshes, triangles, volume and seconds.
#include <openvdb/openvdb.h>
#include <sherd/sherd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "intersect/self_crossings.h"
#include "mesh/search/triangle_tree.h"
#include "mesh_checks.h"
#include "shapes.h"
#include "voxelize/region.h"

namespace {

using namespace sherd;

constexpr std::size_t kPoints = 4000;
constexpr double kLeastCosine = 0.766;  // of normals beside an edge: 40 degrees
constexpr double kWall = 2.0;           // voxels
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A point on an edge, in index space.
struct EdgePoint {
  glm::dvec3 at{0.0};
  bool isThick = false;  // the solid, and the space before it, is thicker than kWall
};

struct SharpEdge {
  glm::dvec3 from{0.0}, to{0.0}, outward{0.0};
  bool isConvex = true;
};

std::vector<SharpEdge> sharpEdges(const TriangleMesh& mesh, const GridFrame& frame) {
  struct Side {
    glm::dvec3 normal, opposite;
  };
  using Key = std::array<std::array<double, 3>, 2>;  // by position: STL files share no vertices
  std::map<Key, std::vector<Side>> sides;
  const auto key = [](const glm::dvec3& p) { return std::array{p.x, p.y, p.z}; };
  for (const glm::uvec3& t : mesh.triangles) {
    std::array<glm::dvec3, 3> at;
    for (int k = 0; k < 3; ++k)
      at[static_cast<std::size_t>(k)] = frame.indexFromWorld(mesh.vertices[t[k]]);
    const glm::dvec3 cross = glm::cross(at[1] - at[0], at[2] - at[0]);
    if (glm::length(cross) == 0.0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = key(at[k]), b = key(at[(k + 1) % 3]);
      sides[{std::min(a, b), std::max(a, b)}].push_back({glm::normalize(cross), at[(k + 2) % 3]});
    }
  }
  std::vector<SharpEdge> edges;
  for (const auto& [ends, both] : sides) {
    if (both.size() != 2 || glm::dot(both[0].normal, both[1].normal) > kLeastCosine) continue;
    const glm::dvec3 from(ends[0][0], ends[0][1], ends[0][2]),
        to(ends[1][0], ends[1][1], ends[1][2]);
    const glm::dvec3 sum = both[0].normal + both[1].normal;
    if (glm::length(sum) < 0.1) continue;  // folded
    edges.push_back(
        {from, to, glm::normalize(sum), glm::dot(both[0].normal, both[1].opposite - from) < 0.0});
  }
  return edges;
}

// Points at equal distances along the edges, without those that the solid covers.
std::vector<EdgePoint> pointsOn(const std::vector<SharpEdge>& edges, const Solid& solid,
                                const TriangleTree& tree) {
  double total = 0.0;
  for (const SharpEdge& edge : edges) total += glm::distance(edge.from, edge.to);
  std::vector<EdgePoint> points;
  const double step = total / static_cast<double>(kPoints);
  double next = 0.5 * step, passed = 0.0;
  for (const SharpEdge& edge : edges) {
    const double length = glm::distance(edge.from, edge.to);
    for (; next < passed + length; next += step) {
      const glm::dvec3 at = edge.from + (next - passed) / length * (edge.to - edge.from);
      if (!solid.region->isWithin(at, 0.01)) continue;
      const double wall =
          std::min(tree.firstHit(at, -edge.outward, 0.1), tree.firstHit(at, edge.outward, 0.1));
      points.push_back({at, wall > kWall});
    }
    passed += length;
  }
  return points;
}

struct Distances {
  std::size_t count = 0;
  double mean = 0.0, median = 0.0, p95 = 0.0, most = 0.0;
};

Distances described(std::vector<double> all) {
  if (all.empty()) return {};
  std::sort(all.begin(), all.end());
  double sum = 0.0;
  for (const double d : all) sum += d;
  const std::size_t n = all.size();
  return {n, sum / static_cast<double>(n), all[n / 2], all[n * 95 / 100], all.back()};
}

// The faces of all fragments that have no neighbor, in index space.
TriangleMesh originalSurface(const std::vector<Fragment>& fragments, const GridFrame& frame) {
  TriangleMesh all;
  for (const Fragment& fragment : fragments) {
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    for (const glm::dvec3& v : fragment.mesh.vertices)
      all.vertices.push_back(frame.indexFromWorld(v));
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      if (fragment.mesh.neighbor[t] == 0)
        all.triangles.push_back(fragment.mesh.triangles[t] + first);
    }
  }
  return all;
}

void check(const std::string& name, const TriangleMesh& mesh, int resolution, int pieces,
           Device& device) {
  FractureOptions options;
  options.pieces = pieces;
  options.seed = 7;
  options.solid.resolution = resolution;
  options.solid.keepMesh = true;
  options.surface.levelSets = false;
  if (const char* a = std::getenv("SHERD_ADAPTIVITY")) options.surface.adaptivity = std::atof(a);
  const FractureResult result = fracture(mesh, options, device);
  double extraction = 0.0;
  for (const StageTime& time : result.times) {
    if (time.stage == "extract") extraction += time.seconds;
  }
  const Solid& solid = result.solid;
  const TriangleMesh clean = solid.mesh->mesh;
  TriangleMesh inIndexSpace = clean;
  for (glm::dvec3& v : inIndexSpace.vertices) v = solid.frame.indexFromWorld(v);
  const TriangleTree input(inIndexSpace);
  const TriangleMesh surface = originalSurface(result.fragments, solid.frame);
  const TriangleTree tree(surface);
  std::vector<double> all, thick, error;
  for (const EdgePoint& p : pointsOn(sharpEdges(clean, solid.frame), solid, input)) {
    all.push_back(tree.nearest(p.at, kInfinity).distance);
    if (p.isThick) thick.push_back(all.back());
  }
  std::vector<bool> isUsed(surface.vertices.size());
  for (const glm::uvec3& t : surface.triangles) isUsed[t.x] = isUsed[t.y] = isUsed[t.z] = true;
  for (std::size_t v = 0; v < isUsed.size(); ++v) {
    if (isUsed[v]) error.push_back(input.nearest(surface.vertices[v], kInfinity).distance);
  }
  std::size_t crossings = 0, faults = 0, triangles = 0;
  double volumeSum = 0.0;
  for (const Fragment& fragment : result.fragments) {
    crossings += selfCrossings(fragment.mesh.vertices, fragment.mesh.triangles).size();
    faults += openEdges(fragment.mesh) + nonManifoldEdges(fragment.mesh) +
              nonManifoldVertices(fragment.mesh);
    triangles += fragment.mesh.triangles.size();
    volumeSum += volume(fragment.mesh);
  }
  const Distances edges = described(std::move(all)), thickEdges = described(std::move(thick)),
                  errors = described(std::move(error));
  std::printf(
      "%-28s %4zu median %.3f p95 %.3f max %.3f | thick %4zu p95 %.3f max %.3f | error %.4f p95 "
      "%.3f max %.2f | cross %zu faults %zu | tri %zu out/in %.2f | vol %.5f | extract %.3f s\n",
      name.c_str(), edges.count, edges.median, edges.p95, edges.most, thickEdges.count,
      thickEdges.p95, thickEdges.most, errors.mean, errors.p95, errors.most, crossings, faults,
      triangles, static_cast<double>(triangles) / static_cast<double>(mesh.triangles.size()),
      volumeSum / solid.report.meshVolume, extraction);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  openvdb::initialize();
  const int resolution = argc > 1 ? std::atoi(argv[1]) : 128;
  const int pieces = argc > 2 ? std::atoi(argv[2]) : 8;
  Device device("builtin");
  if (argc <= 3) {
    check("ball", shapes::ball(1.0, 6), resolution, pieces, device);
    check("torus", shapes::torus(2.0, 0.8, 400, 160), resolution, pieces, device);
    check("cup", shapes::cup(1.0, 0.25, 1.5, 0.25, 400), resolution, pieces, device);
    check("cube", shapes::cube(1.0), resolution, pieces, device);
  }
  for (int i = 3; i < argc; ++i) {
    const std::filesystem::path path(argv[i]);
    try {
      check(path.filename().string(), readMesh(path).mesh, resolution, pieces, device);
    } catch (const Error& e) {
      std::printf("%s: %s\n", path.filename().c_str(), e.what());
    }
  }
}
