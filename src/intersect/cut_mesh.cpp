// A closed mesh cut by open surfaces, exactly.
#include "intersect/cut_mesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "base/sort_unique.h"
#include "intersect/find_crossings.h"
#include "intersect/split_triangles.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

constexpr const char* kStage = "cut";

ExactPoint pointAt(const CrossingKey& key, const TriangleMesh& surface, const Cutters& cutters) {
  if (key.isCutterEdge) {
    return crossingPoint({cutters.vertices[key.low], cutters.vertices[key.high]},
                         positionsOf(surface.vertices, surface.triangles[key.triangle]));
  }
  return crossingPoint({surface.vertices[key.low], surface.vertices[key.high]},
                       positionsOf(cutters.vertices, cutters.triangles[key.triangle]));
}

// Numbers crossing points by their keys, which do not depend on the order of the work.
CrossingPoints crossingPoints(const std::vector<CrossedPair>& pairs, const TriangleMesh& surface,
                              const Cutters& cutters) {
  CrossingPoints crossings;
  crossings.first = static_cast<std::uint32_t>(surface.vertices.size() + cutters.vertices.size());
  crossings.keys.reserve(2 * pairs.size());
  for (const CrossedPair& pair : pairs) {
    crossings.keys.insert(crossings.keys.end(), {pair.from, pair.to});
  }
  sortUnique(crossings.keys);
  crossings.points.resize(crossings.keys.size());
  tbb::parallel_for(std::size_t{0}, crossings.keys.size(), [&](std::size_t i) {
    crossings.points[i] = pointAt(crossings.keys[i], surface, cutters);
  });
  return crossings;
}

std::vector<Seam> seamsOf(const std::vector<CrossedPair>& pairs, const CrossingPoints& crossings) {
  const auto vertex = [&](const CrossingKey& key) {
    const auto found = std::lower_bound(crossings.keys.begin(), crossings.keys.end(), key);
    return crossings.first + static_cast<std::uint32_t>(found - crossings.keys.begin());
  };
  std::vector<Seam> seams(pairs.size());
  tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
    seams[i].from = vertex(pairs[i].from);
    seams[i].to = vertex(pairs[i].to);
    seams[i].s = pairs[i].s;
    seams[i].c = pairs[i].c;
  });
  return seams;
}

// The triangles of the other mesh at pairs of seams that cross on a triangle.
std::vector<std::array<std::uint32_t, 2>> crossingTriangles(const SplitTriangles& split,
                                                            const std::vector<Seam>& seams,
                                                            std::uint32_t Seam::*triangle) {
  std::vector<std::array<std::uint32_t, 2>> found;
  for (const auto& [i, j] : split.crossingSeams) {
    const auto [low, high] = std::minmax({seams[i].*triangle, seams[j].*triangle});
    found.push_back({low, high});
  }
  sortUnique(found);
  return found;
}

}  // namespace

MeshCut cutMesh(const TriangleMesh& surface, const Cutters& cutters, const Progress* progress) {
  reportProgress(progress, kStage, 0.0);
  MeshCut cut;
  CrossedPairs crossed = findCrossings(surface, cutters, progress);
  cut.degenerate = std::move(crossed.degenerate);
  cut.flat = std::move(crossed.flat);
  if (!cut.isComplete()) return cut;

  reportProgress(progress, kStage, 0.4);
  const CrossingPoints crossings = crossingPoints(crossed.pairs, surface, cutters);
  cut.seams = seamsOf(crossed.pairs, crossings);
  cut.points.reserve(crossings.points.size());
  for (const ExactPoint& point : crossings.points) cut.points.push_back(point.rounded);

  reportProgress(progress, kStage, 0.6);
  SplitTriangles ofSurface = splitTriangles({surface.vertices, surface.triangles, false, 0},
                                            cutters.triangles, crossings, cut.seams, progress);
  reportProgress(progress, kStage, 0.8);
  const auto firstCutterVertex = static_cast<std::uint32_t>(surface.vertices.size());
  SplitTriangles ofCutters =
      splitTriangles({cutters.vertices, cutters.triangles, true, firstCutterVertex},
                     cutters.triangles, crossings, cut.seams, progress);
  cut.surface = std::move(ofSurface.parts);
  cut.cutters = std::move(ofCutters.parts);
  cut.surfaceCrossed = std::move(ofSurface.isCrossed);
  cut.cutterCrossed = std::move(ofCutters.isCrossed);
  cut.cutterCrossings = crossingTriangles(ofSurface, cut.seams, &Seam::c);
  cut.surfaceCrossings = crossingTriangles(ofCutters, cut.seams, &Seam::s);
  cut.flat = std::move(ofSurface.flat);
  cut.degenerate = std::move(ofSurface.degenerate);
  cut.degenerate.insert(cut.degenerate.end(), ofCutters.degenerate.begin(),
                        ofCutters.degenerate.end());
  sortUnique(cut.flat);
  sortUnique(cut.degenerate);
  reportProgress(progress, kStage, 1.0);
  return cut;
}

}  // namespace sherd
