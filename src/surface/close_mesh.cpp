// A closed mesh for Surface::exact, where the input has holes.
#include "surface/close_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "base/cancel_flag.h"
#include "base/formatted.h"
#include "exact/fill_loops.h"
#include "exact/self_crossings.h"
#include "mesh/edges.h"
#include "mesh/triangle_area.h"
#include "voxelize/caps.h"
#include "voxelize/winding.h"

namespace sherd {
namespace {

using Loops = std::vector<std::vector<std::uint32_t>>;

// The mesh's edges between vertices of its loops.
KnownEdges edgesBetween(const TriangleMesh& mesh, const Loops& loops) {
  std::vector<bool> isOnLoop(mesh.vertices.size(), false);
  for (const std::vector<std::uint32_t>& loop : loops) {
    for (const std::uint32_t v : loop) isOnLoop[v] = true;
  }
  KnownEdges edges;
  forEachEdge(mesh, [&](const EdgeUse& edge) {
    if (isOnLoop[edge.low] && isOnLoop[edge.high]) edges.emplace_back(edge.low, edge.high);
  });
  return edges;
}

SolidMesh withLoopsFilled(const SolidMesh& open, const Loops& loops, const Progress* progress) {
  const FilledLoops filled =
      filledLoops(open.mesh.vertices, loops, edgesBetween(open.mesh, loops), progress);
  SolidMesh closed = open;
  TriangleMesh& mesh = closed.mesh;
  mesh.vertices.insert(mesh.vertices.end(), filled.centers.begin(), filled.centers.end());
  mesh.triangles.insert(mesh.triangles.end(), filled.triangles.begin(), filled.triangles.end());
  closed.source.resize(mesh.triangles.size(), TriangleMesh::kNoSource);
  if (!closed.layer.empty()) closed.layer.resize(mesh.triangles.size(), 0);
  return closed;
}

// Voxels whose center a closed mesh has on the other side than the solid.
std::uint64_t otherVoxels(const Solid& solid, const TriangleMesh& mesh, const Progress* progress) {
  TriangleMesh inVoxels{mesh.vertices, mesh.triangles};
  for (glm::dvec3& v : inVoxels.vertices) v = solid.frame.indexFromWorld(v);
  const Winding winding(inVoxels, Winding::Rule::signedCrossings, progress);
  std::uint64_t inside = 0, inBoth = 0;
  winding.forEachRun([&](int, int, int z, int end, int number) {
    if (number > 0) inside += static_cast<std::uint64_t>(end - z);
  });
  solid.blocks->forEachInside([&](std::size_t voxel) {
    if (winding.isInside(solid.blocks->voxelAt(voxel))) ++inBoth;
  });
  return inside - inBoth + solid.voxels - inBoth;
}

// Why the closed mesh is not that of the solid, as a clause, or nothing.
std::string difference(const Solid& solid, const SolidMesh& closed, std::size_t firstClosing,
                       const Progress* progress) {
  const double size = solid.frame.voxelSize;
  double area = 0.0;  // of the faces that close holes, voxels
  for (std::size_t t = firstClosing; t < closed.mesh.triangles.size(); ++t) {
    const glm::uvec3& c = closed.mesh.triangles[t];
    const std::vector<glm::dvec3>& v = closed.mesh.vertices;
    area += areaOf({v[c.x] / size, v[c.y] / size, v[c.z] / size});
  }
  const SolidReport& report = solid.report;
  const double other = static_cast<double>(otherVoxels(solid, closed.mesh, progress)),
               all = static_cast<double>(solid.voxels),
               changed = static_cast<double>(report.bridges + solid.smallComponentVoxels);
  if (other <= kOtherVoxels * all + area + changed) return {};
  return formatted("faces that close its holes would change %.2g %% of its voxels",
                   100.0 * other / std::max(all, 1.0));
}

// Whether faces that close holes cross others.
bool isCrossed(const TriangleMesh& mesh, std::size_t firstClosing, const Progress* progress) {
  std::vector<std::uint8_t> isClosing(mesh.triangles.size(), 0);
  std::fill(isClosing.begin() + static_cast<std::ptrdiff_t>(firstClosing), isClosing.end(), 1);
  return !selfCrossings(mesh.vertices, mesh.triangles, progress, {.of = isClosing}).empty();
}

}  // namespace

ClosedMesh closedMesh(const Solid& solid, const Progress* progress) {
  const SolidMesh& open = *solid.mesh;
  const Loops loops = openLoops(open.mesh);
  if (loops.empty()) return {};
  ClosedMesh closed{.holes = loops.size()};
  SolidMesh filled = withLoopsFilled(open, loops, progress);
  throwIfCancelled(progress);
  const std::size_t first = open.mesh.triangles.size();
  closed.failure = difference(solid, filled, first, progress);
  if (!closed.failure.empty()) return closed;
  closed.isCrossed = isCrossed(filled.mesh, first, progress);
  closed.mesh = std::make_shared<const SolidMesh>(std::move(filled));
  return closed;
}

}  // namespace sherd
