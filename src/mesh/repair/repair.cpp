// Detection of mesh defects, and consistent orientation of triangles.
#include "mesh/repair/repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/cancel_flag.h"
#include "mesh/edges.h"
#include "mesh/repair/duplicates.h"
#include "mesh/repair/sheets.h"
#include "mesh/search/triangle_tree.h"

namespace sherd {
namespace {

void flip(glm::uvec3& triangle) { std::swap(triangle.y, triangle.z); }

double areaOf(const TriangleMesh& mesh, const glm::uvec3& t) {
  const std::vector<glm::dvec3>& v = mesh.vertices;
  return 0.5 * glm::length(glm::cross(v[t.y] - v[t.x], v[t.z] - v[t.x]));
}

// Two triangles that share an edge, and whether their orientations are opposite.
struct Adjacency {
  std::uint32_t a, b;
  bool isOpposite;
};

// Returns the pairs of triangles at edges with exactly two triangles.
std::vector<Adjacency> adjacencies(const TriangleMesh& mesh) {
  struct Half {
    std::uint64_t edge;
    std::uint32_t triangle;
    bool forward;
  };
  std::vector<Half> halves;
  halves.reserve(3 * mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      halves.push_back(
          {std::uint64_t{std::min(from, to)} << 32 | std::max(from, to), i, from < to});
    }
  }
  std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle;
  });
  std::vector<Adjacency> out;
  for (std::size_t i = 0; i < halves.size();) {
    std::size_t end = i;
    while (end < halves.size() && halves[end].edge == halves[i].edge) ++end;
    if (end - i == 2) {
      const Half &a = halves[i], &b = halves[i + 1];
      out.push_back({a.triangle, b.triangle, a.forward == b.forward});
    }
    i = end;
  }
  return out;
}

// Flips triangles of unbalanced components to agree across adjacencies.  Each connected group keeps
// the orientation of most of its area.  Returns the number of flipped triangles.
//   unbalanced  [components]
std::size_t orientConsistently(TriangleMesh& mesh, const MeshComponents& components,
                               const std::vector<bool>& unbalanced, const Progress* progress) {
  const std::size_t count = mesh.triangles.size();
  const std::vector<Adjacency> all = adjacencies(mesh);
  throwIfCancelled(progress);
  std::vector<std::size_t> first(count + 1, 0);
  for (const Adjacency& pair : all) ++first[pair.a + 1], ++first[pair.b + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::pair<std::uint32_t, bool>> beside(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (const Adjacency& pair : all) {
    beside[next[pair.a]++] = {pair.b, pair.isOpposite};
    beside[next[pair.b]++] = {pair.a, pair.isOpposite};
  }

  std::size_t flipped = 0;
  std::vector<bool> seen(count, false), opposite(count, false);
  std::vector<std::uint32_t> group;
  for (std::uint32_t start = 0; start < count; ++start) {
    if (seen[start] || !unbalanced[components.ofTriangle[start]]) continue;
    group.assign(1, start);
    seen[start] = true;
    std::array<double, 2> areas{0.0, 0.0};  // oriented like the first triangle, and opposite to it
    std::array<std::size_t, 2> sizes{0, 0};
    for (std::size_t i = 0; i < group.size(); ++i) {
      const std::uint32_t t = group[i];
      areas[opposite[t] ? 1 : 0] += areaOf(mesh, mesh.triangles[t]);
      ++sizes[opposite[t] ? 1 : 0];
      for (std::size_t k = first[t]; k < first[t + 1]; ++k) {
        const auto [other, isOpposite] = beside[k];
        if (seen[other]) continue;
        seen[other] = true;
        opposite[other] = opposite[t] != isOpposite;
        group.push_back(other);
      }
    }
    const bool wrong =
        areas[1] <= areas[0];  // triangles with this value of opposite[t] are flipped
    flipped += sizes[wrong ? 1 : 0];
    for (const std::uint32_t t : group) {
      if (opposite[t] == wrong) flip(mesh.triangles[t]);
    }
  }
  return flipped;
}

// Returns the volume of each component, its holes closed by cones to the center of its box.
std::vector<double> volumesOf(const TriangleMesh& mesh, const MeshComponents& components) {
  std::vector<Box> boxes(components.count,
                         Box{glm::dvec3(std::numeric_limits<double>::infinity()),
                             glm::dvec3(-std::numeric_limits<double>::infinity())});
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Box& box = boxes[components.ofTriangle[i]];
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3& v = mesh.vertices[mesh.triangles[i][k]];
      box.min = glm::min(box.min, v);
      box.max = glm::max(box.max, v);
    }
  }
  std::vector<double> volumes(components.count, 0.0);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t component = components.ofTriangle[i];
    const glm::dvec3 center = 0.5 * (boxes[component].min + boxes[component].max);
    const glm::uvec3& t = mesh.triangles[i];
    volumes[component] +=
        glm::dot(mesh.vertices[t.x] - center,
                 glm::cross(mesh.vertices[t.y] - center, mesh.vertices[t.z] - center)) /
        6.0;
  }
  return volumes;
}

// Flips components that are inside out and not within another.  Returns their number.
std::size_t flipComponents(TriangleMesh& mesh, const MeshComponents& components,
                           const Progress* progress) {
  std::vector<double> volumes = volumesOf(mesh, components);
  std::size_t flipped = 0;
  if (std::accumulate(volumes.begin(), volumes.end(), 0.0) < 0.0) {
    for (glm::uvec3& t : mesh.triangles) flip(t);
    for (double& v : volumes) v = -v;
    flipped += components.count;
  }
  if (std::none_of(volumes.begin(), volumes.end(), [](double v) { return v < 0.0; }))
    return flipped;

  TriangleMesh outward{mesh.vertices, {}};
  std::vector<std::vector<std::uint32_t>> corners(
      components.count);  // of the components that are inside out
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t component = components.ofTriangle[i];
    if (volumes[component] < 0.0) {
      corners[component].push_back(mesh.triangles[i].x);
    } else {
      outward.triangles.push_back(mesh.triangles[i]);
    }
  }
  throwIfCancelled(progress);
  const TriangleTree tree(outward);
  std::vector<bool> isFlipped(components.count, false);
  for (std::uint32_t component = 0; component < components.count; ++component) {
    if (corners[component].empty()) continue;
    throwIfCancelled(progress);
    constexpr std::size_t kSamples = 9;
    std::size_t within = 0;
    for (std::size_t k = 0; k < kSamples; ++k) {
      const std::size_t at = k * corners[component].size() / kSamples;
      within += tree.winding(mesh.vertices[corners[component][at]]) > 0.5 ? 1u : 0u;
    }
    if (2 * within >= kSamples) continue;
    isFlipped[component] = true;
    ++flipped;
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (isFlipped[components.ofTriangle[i]]) flip(mesh.triangles[i]);
  }
  return flipped;
}

// Keeps some triangles, given by their number in the mesh.
void keep(Repaired& out, const TriangleMesh& mesh, std::vector<std::uint32_t> kept) {
  out.source = std::move(kept);
  for (std::size_t i = 0; i < out.source.size(); ++i) {
    out.mesh.triangles[i] = mesh.triangles[out.source[i]];
  }
  out.mesh.triangles.resize(out.source.size());
}

// Moves flat sheets that have other triangles on each side from a mesh to its sheets.
//   among  triangles of the mesh as it is
void moveFlatSheets(Repaired& out, const TriangleMesh& mesh,
                    const std::vector<std::uint32_t>& among) {
  const FlatSheets flat = flatSheets(out.mesh, among);
  if (flat.triangles.empty()) return;
  for (SheetFace face : flat.faces) {
    face.front = out.source[face.front];
    face.back = out.source[face.back];
    face.other = out.source[face.other];
    out.sheets.push_back(face);
  }
  std::vector<std::uint32_t> kept;
  auto next = flat.triangles.begin();
  for (std::uint32_t t = 0; t < out.source.size(); ++t) {
    if (next != flat.triangles.end() && *next == t) {
      ++next;
    } else {
      kept.push_back(out.source[t]);
    }
  }
  keep(out, mesh, std::move(kept));
}

// Drops duplicates.  Returns the components of what is left.
//   hasRepeated  whether any triangle may be there twice
MeshComponents dropDuplicates(Repaired& out, const TriangleMesh& mesh, bool hasRepeated) {
  MeshComponents components;
  std::vector<std::uint32_t> among;
  if (hasRepeated) {
    OnceTriangles once = withoutDuplicates(mesh.triangles);
    out.sheets = std::move(once.sheets);
    keep(out, mesh, std::move(once.kept));
    among.resize(out.source.size());
    std::iota(among.begin(), among.end(), 0u);
  } else {
    components = meshComponents(mesh);
    among = ofSmallComponents(components);
  }
  moveFlatSheets(out, mesh, among);
  out.defects.duplicateTriangles = mesh.triangles.size() - out.mesh.triangles.size();
  return !hasRepeated && out.defects.duplicateTriangles == 0 ? components
                                                             : meshComponents(out.mesh);
}

// Orients sheets like their neighbors, and leaves out those that are inside the rest, or few.
void settleSheets(Repaired& out, const Progress* progress) {
  if (out.sheets.empty()) return;
  keepOutside(out.sheets, out.mesh, progress);
  out.defects.sheetTriangles = 2 * out.sheets.size();
  if (areFew(out.sheets, out.mesh)) out.sheets.clear();
  TriangleMesh fronts{out.mesh.vertices, {}};
  for (const SheetFace& face : out.sheets) fronts.triangles.push_back(face.corners);
  const MeshComponents components = meshComponents(fronts);
  orientConsistently(fronts, components, std::vector<bool>(components.count, true), progress);
  for (std::size_t i = 0; i < out.sheets.size(); ++i) {
    SheetFace& face = out.sheets[i];
    if (face.corners == fronts.triangles[i]) continue;
    face.corners = fronts.triangles[i];
    std::swap(face.front, face.back);
  }
}

}  // namespace

Repaired repaired(const TriangleMesh& mesh, const Progress* progress) {
  Repaired out{mesh, std::vector<std::uint32_t>(mesh.triangles.size()), {}, {}};
  std::iota(out.source.begin(), out.source.end(), 0u);
  MeshDefects& defects = out.defects;
  const auto countEdges = [&] {
    throwIfCancelled(progress);
    const EdgeDefects edges = edgeDefects(out.mesh);
    defects.boundaryEdges = edges.boundary;
    defects.nonManifoldEdges = edges.nonManifold;
    defects.misorientedEdges = edges.misoriented;
    return edges.unbalanced;
  };
  for (const glm::uvec3& t : mesh.triangles) defects.zeroAreaTriangles += areaOf(mesh, t) == 0.0;
  std::size_t unbalanced = countEdges();
  const MeshComponents components =
      dropDuplicates(out, mesh, unbalanced > 0 || defects.nonManifoldEdges > 0);
  const MeshDefects asRead = defects;
  if (defects.duplicateTriangles > 0) unbalanced = countEdges();
  throwIfCancelled(progress);
  if (unbalanced > 0) {
    std::vector<bool> unbalancedComponent(components.count, false);
    std::vector<std::uint32_t> componentOf(out.mesh.vertices.size(), 0);
    for (std::size_t i = 0; i < out.mesh.triangles.size(); ++i) {
      componentOf[out.mesh.triangles[i].x] = componentOf[out.mesh.triangles[i].y] =
          componentOf[out.mesh.triangles[i].z] = components.ofTriangle[i];
    }
    forEachEdge(out.mesh, [&](const EdgeUse& edge) {
      if (edge.forward != edge.backward) unbalancedComponent[componentOf[edge.low]] = true;
    });
    defects.flippedTriangles =
        orientConsistently(out.mesh, components, unbalancedComponent, progress);
  }
  defects.boundaryEdges = asRead.boundaryEdges;  // of the mesh before repair
  defects.nonManifoldEdges = asRead.nonManifoldEdges;
  defects.misorientedEdges = asRead.misorientedEdges;
  defects.components = components.count;
  defects.flippedComponents = flipComponents(out.mesh, components, progress);
  settleSheets(out, progress);
  return out;
}

}  // namespace sherd
