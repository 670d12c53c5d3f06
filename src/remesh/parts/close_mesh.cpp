// A closed mesh for Surface::exact, where the input has holes.
#include "remesh/parts/close_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "base/cancel_flag.h"
#include "base/text/formatted.h"
#include "base/union_find.h"
#include "intersect/self_crossings.h"
#include "mesh/edges.h"
#include "mesh/triangle_area.h"
#include "remesh/parts/fill_loops.h"
#include "voxelize/fill/caps.h"
#include "voxelize/fill/winding.h"
#include "voxelize/shell_mesh.h"

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
  return formatted(isShell(solid) ? "as a shell it would have %.2g %% other voxels"
                                  : "faces that close its holes would change %.2g %% of its voxels",
                   100.0 * other / std::max(all, 1.0));
}

// Whether faces that close holes cross others.
bool isCrossed(const TriangleMesh& mesh, std::size_t firstClosing, const Progress* progress) {
  std::vector<std::uint8_t> isClosing(mesh.triangles.size(), 0);
  std::fill(isClosing.begin() + static_cast<std::ptrdiff_t>(firstClosing), isClosing.end(), 1);
  return !selfCrossings(mesh.vertices, mesh.triangles, progress, {.of = isClosing}).empty();
}

// The mesh of some triangles, with their vertices alone.
TriangleMesh meshOfPart(std::span<const glm::dvec3> vertices, std::vector<glm::uvec3> triangles) {
  TriangleMesh mesh;
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (glm::uvec3& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const auto [found, isNew] =
          numbers.try_emplace(t[k], static_cast<std::uint32_t>(mesh.vertices.size()));
      if (isNew) mesh.vertices.push_back(vertices[t[k]]);
      t[k] = found->second;
    }
  }
  mesh.triangles = std::move(triangles);
  return mesh;
}

// Returns [triangles] the name of each one's part: those connected over edges of two triangles.
std::vector<std::uint32_t> partNumbers(const TriangleMesh& mesh) {
  std::vector<std::array<std::uint32_t, 3>> uses;  // ends of an edge, triangle
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]});
      uses.push_back({low, high, t});
    }
  }
  std::sort(uses.begin(), uses.end());
  UnionFind parts(mesh.triangles.size());
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    while (end < uses.size() && uses[end][0] == uses[i][0] && uses[end][1] == uses[i][1]) ++end;
    if (end == i + 2) parts.unite(uses[i][2], uses[i + 1][2]);
  }
  return std::move(parts).all();
}

ClosedMesh closedShell(const Solid& solid, const Progress* progress) {
  SolidMesh shell = shellMesh(*solid.mesh, solid.report.shellThickness);
  throwIfCancelled(progress);
  ClosedMesh closed;
  closed.failure = difference(solid, shell, 2 * solid.mesh->mesh.triangles.size(), progress);
  if (!closed.failure.empty()) return closed;
  if (!selfCrossings(shell.mesh.vertices, shell.mesh.triangles, progress).empty()) {
    closed.failure = "as a shell of its thickness it crosses itself";
    return closed;
  }
  closed.mesh = std::make_shared<const SolidMesh>(std::move(shell));
  return closed;
}

}  // namespace

bool isShell(const Solid& solid) {
  return solid.report.fill == Fill::shell && !solid.report.isThinnerThanVoxels;
}

SolidMesh withHolesFilled(const SolidMesh& open, const Progress* progress) {
  return withLoopsFilled(open, openLoops(open.mesh), progress);
}

SolidMesh withoutSmallClosed(const SolidMesh& closed, double least) {
  const std::vector<std::uint32_t> partOf = partNumbers(closed.mesh);
  std::map<std::uint32_t, std::vector<glm::uvec3>> parts;  // those with faces that close holes
  for (std::size_t t = 0; t < partOf.size(); ++t) {
    if (closed.source[t] == TriangleMesh::kNoSource) parts[partOf[t]];
  }
  for (std::size_t t = 0; t < partOf.size(); ++t) {
    const auto part = parts.find(partOf[t]);
    if (part != parts.end()) part->second.push_back(closed.mesh.triangles[t]);
  }
  std::erase_if(parts, [&](const auto& part) {
    const TriangleMesh own = meshOfPart(closed.mesh.vertices, part.second);
    return openEdges(own) > 0 || std::abs(volume(own)) >= least;
  });
  SolidMesh out;
  out.mesh.vertices = closed.mesh.vertices;
  for (std::size_t t = 0; t < partOf.size(); ++t) {
    if (parts.contains(partOf[t])) continue;
    out.mesh.triangles.push_back(closed.mesh.triangles[t]);
    out.source.push_back(closed.source[t]);
    if (!closed.layer.empty()) out.layer.push_back(closed.layer[t]);
  }
  return out.mesh.triangles.empty() ? closed : out;
}

ClosedMesh closedMesh(const Solid& solid, const Progress* progress) {
  const SolidMesh& open = *solid.mesh;
  if (isShell(solid)) return closedShell(solid, progress);
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
