// What is wrong with a mesh, and the mesh with its triangles turned the same way.
#include "mesh/repair.h"

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
#include "mesh/triangle_tree.h"

namespace sherd {
namespace {

void turn(glm::uvec3& triangle) { std::swap(triangle.y, triangle.z); }

// A triangle's corners in ascending order, and whether that is the way it turns.
std::pair<std::array<std::uint32_t, 3>, bool> sortedCorners(const glm::uvec3& t) {
  std::array<std::uint32_t, 3> corners{t.x, t.y, t.z};
  bool even = true;
  const auto order = [&](std::size_t a, std::size_t b) {
    if (corners[a] <= corners[b]) return;
    std::swap(corners[a], corners[b]);
    even = !even;
  };
  order(0, 1), order(1, 2), order(0, 1);
  return {corners, even};
}

// Of triangles with the same corners one is kept, or none where as many turn the one way as the
// other.
std::vector<glm::uvec3> withoutDuplicates(const std::vector<glm::uvec3>& triangles) {
  struct Entry {
    std::array<std::uint32_t, 3> corners;
    bool even;
    std::size_t at;
  };
  std::vector<Entry> entries;
  entries.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto [corners, even] = sortedCorners(triangles[i]);
    entries.push_back({corners, even, i});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.corners != b.corners ? a.corners < b.corners : a.at < b.at;
  });
  std::vector<bool> kept(triangles.size(), false);
  for (std::size_t i = 0; i < entries.size();) {
    std::size_t end = i;
    int net = 0;
    for (; end < entries.size() && entries[end].corners == entries[i].corners; ++end) {
      net += entries[end].even ? 1 : -1;
    }
    for (std::size_t k = i; k < end && net != 0; ++k) {
      if (entries[k].even != (net > 0)) continue;
      kept[entries[k].at] = true;
      break;
    }
    i = end;
  }
  std::vector<glm::uvec3> out;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (kept[i]) out.push_back(triangles[i]);
  }
  return out;
}

double areaOf(const TriangleMesh& mesh, const glm::uvec3& t) {
  const std::vector<glm::dvec3>& v = mesh.vertices;
  return 0.5 * glm::length(glm::cross(v[t.y] - v[t.x], v[t.z] - v[t.x]));
}

// Two triangles across an edge, and whether they are turned against each other.
struct Joint {
  std::uint32_t a, b;
  bool against;
};

// Where an edge has two triangles.
std::vector<Joint> joints(const TriangleMesh& mesh) {
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
  std::vector<Joint> out;
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

// Turn triangles to agree across joints, where `unbalanced` says of their part that they do not.
// Each group that hangs together by joints goes the way that most of its area went.  Returns how
// many were turned.
std::size_t turnAlike(TriangleMesh& mesh, const Components& parts,
                      const std::vector<bool>& unbalanced, const Progress* progress) {
  const std::size_t count = mesh.triangles.size();
  const std::vector<Joint> all = joints(mesh);
  throwIfCancelled(progress);
  std::vector<std::size_t> first(count + 1, 0);
  for (const Joint& joint : all) ++first[joint.a + 1], ++first[joint.b + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::pair<std::uint32_t, bool>> beside(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (const Joint& joint : all) {
    beside[next[joint.a]++] = {joint.b, joint.against};
    beside[next[joint.b]++] = {joint.a, joint.against};
  }

  std::size_t turned = 0;
  std::vector<bool> seen(count, false), against(count, false);
  std::vector<std::uint32_t> group;
  for (std::uint32_t start = 0; start < count; ++start) {
    if (seen[start] || !unbalanced[parts.ofTriangle[start]]) continue;
    group.assign(1, start);
    seen[start] = true;
    std::array<double, 2> areas{0.0, 0.0};  // of those that agree with the first, and of the others
    std::array<std::size_t, 2> sizes{0, 0};
    for (std::size_t i = 0; i < group.size(); ++i) {
      const std::uint32_t t = group[i];
      areas[against[t] ? 1 : 0] += areaOf(mesh, mesh.triangles[t]);
      ++sizes[against[t] ? 1 : 0];
      for (std::size_t k = first[t]; k < first[t + 1]; ++k) {
        const auto [other, isAgainst] = beside[k];
        if (seen[other]) continue;
        seen[other] = true;
        against[other] = against[t] != isAgainst;
        group.push_back(other);
      }
    }
    const bool wrong = areas[1] <= areas[0];  // those for which against[t] is this are turned
    turned += sizes[wrong ? 1 : 0];
    for (const std::uint32_t t : group) {
      if (against[t] == wrong) turn(mesh.triangles[t]);
    }
  }
  return turned;
}

// The volume of each part, its holes closed by cones to the middle of its box.
std::vector<double> volumesOf(const TriangleMesh& mesh, const Components& parts) {
  std::vector<Box> boxes(parts.count, Box{glm::dvec3(std::numeric_limits<double>::infinity()),
                                          glm::dvec3(-std::numeric_limits<double>::infinity())});
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Box& box = boxes[parts.ofTriangle[i]];
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3& v = mesh.vertices[mesh.triangles[i][k]];
      box.min = glm::min(box.min, v);
      box.max = glm::max(box.max, v);
    }
  }
  std::vector<double> volumes(parts.count, 0.0);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t part = parts.ofTriangle[i];
    const glm::dvec3 middle = 0.5 * (boxes[part].min + boxes[part].max);
    const glm::uvec3& t = mesh.triangles[i];
    volumes[part] +=
        glm::dot(mesh.vertices[t.x] - middle,
                 glm::cross(mesh.vertices[t.y] - middle, mesh.vertices[t.z] - middle)) /
        6.0;
  }
  return volumes;
}

// Turn parts that are inside out, and do not lie in another.  Returns how many.
std::size_t turnParts(TriangleMesh& mesh, const Components& parts, const Progress* progress) {
  std::vector<double> volumes = volumesOf(mesh, parts);
  std::size_t turned = 0;
  if (std::accumulate(volumes.begin(), volumes.end(), 0.0) < 0.0) {
    for (glm::uvec3& t : mesh.triangles) turn(t);
    for (double& v : volumes) v = -v;
    turned += parts.count;
  }
  if (std::none_of(volumes.begin(), volumes.end(), [](double v) { return v < 0.0; })) return turned;

  TriangleMesh outward{mesh.vertices, {}};
  std::vector<std::vector<std::uint32_t>> corners(parts.count);  // of the parts that are inside out
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t part = parts.ofTriangle[i];
    if (volumes[part] < 0.0) {
      corners[part].push_back(mesh.triangles[i].x);
    } else {
      outward.triangles.push_back(mesh.triangles[i]);
    }
  }
  throwIfCancelled(progress);
  const TriangleTree tree(outward);
  std::vector<bool> turns(parts.count, false);
  for (std::uint32_t part = 0; part < parts.count; ++part) {
    if (corners[part].empty()) continue;
    throwIfCancelled(progress);
    constexpr std::size_t kLooks = 9;
    std::size_t within = 0;
    for (std::size_t k = 0; k < kLooks; ++k) {
      const std::size_t at = k * corners[part].size() / kLooks;
      within += tree.winding(mesh.vertices[corners[part][at]]) > 0.5 ? 1u : 0u;
    }
    if (2 * within >= kLooks) continue;
    turns[part] = true;
    ++turned;
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (turns[parts.ofTriangle[i]]) turn(mesh.triangles[i]);
  }
  return turned;
}

}  // namespace

Repaired repaired(const TriangleMesh& mesh, const Progress* progress) {
  Repaired out{mesh, {}};
  MeshDefects& defects = out.defects;
  const auto countEdges = [&] {
    throwIfCancelled(progress);
    std::size_t unbalanced = 0;
    defects.boundaryEdges = defects.nonManifoldEdges = defects.misorientedEdges = 0;
    forEachEdge(out.mesh, [&](const EdgeUse& edge) {
      const std::size_t uses = edge.forward + edge.backward;
      defects.boundaryEdges += uses == 1 ? 1u : 0u;
      defects.nonManifoldEdges += uses > 2 ? 1u : 0u;
      defects.misorientedEdges += uses == 2 && edge.forward != 1 ? 1u : 0u;
      unbalanced += edge.forward != edge.backward ? 1u : 0u;
    });
    return unbalanced;
  };
  for (const glm::uvec3& t : mesh.triangles) defects.zeroAreaTriangles += areaOf(mesh, t) == 0.0;
  std::size_t unbalanced = countEdges();
  if (unbalanced > 0 || defects.nonManifoldEdges > 0) {
    out.mesh.triangles = withoutDuplicates(mesh.triangles);
    defects.duplicateTriangles = mesh.triangles.size() - out.mesh.triangles.size();
  }
  const MeshDefects asRead = defects;
  if (defects.duplicateTriangles > 0) unbalanced = countEdges();
  throwIfCancelled(progress);
  const Components parts = components(out.mesh);
  if (unbalanced > 0) {
    std::vector<bool> unbalancedPart(parts.count, false);
    std::vector<std::uint32_t> partOf(out.mesh.vertices.size(), 0);
    for (std::size_t i = 0; i < out.mesh.triangles.size(); ++i) {
      partOf[out.mesh.triangles[i].x] = partOf[out.mesh.triangles[i].y] =
          partOf[out.mesh.triangles[i].z] = parts.ofTriangle[i];
    }
    forEachEdge(out.mesh, [&](const EdgeUse& edge) {
      if (edge.forward != edge.backward) unbalancedPart[partOf[edge.low]] = true;
    });
    defects.turnedTriangles = turnAlike(out.mesh, parts, unbalancedPart, progress);
  }
  defects.boundaryEdges = asRead.boundaryEdges;  // of the mesh as it came
  defects.nonManifoldEdges = asRead.nonManifoldEdges;
  defects.misorientedEdges = asRead.misorientedEdges;
  defects.parts = parts.count;
  defects.turnedParts = turnParts(out.mesh, parts, progress);
  return out;
}

}  // namespace sherd
