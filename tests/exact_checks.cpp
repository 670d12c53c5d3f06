// What must hold of exact surfaces.
#include "exact_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <sstream>
#include <tuple>
#include <vector>

#include "intersect/self_crossings.h"

namespace sherd {
namespace {

using Position = std::array<double, 3>;

Position positionOf(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

double areaOf(const TriangleMesh& mesh, std::size_t t) {
  const glm::uvec3& c = mesh.triangles[t];
  const std::vector<glm::dvec3>& v = mesh.vertices;
  return glm::length(glm::cross(v[c.y] - v[c.x], v[c.z] - v[c.x])) / 2.0;
}

// The corners in their order, the least first.
std::array<Position, 3> cornersOf(const TriangleMesh& mesh, std::size_t t, bool isReversed) {
  const glm::uvec3& c = mesh.triangles[t];
  std::array<Position, 3> corners{positionOf(mesh.vertices[c.x]), positionOf(mesh.vertices[c.y]),
                                  positionOf(mesh.vertices[c.z])};
  if (isReversed) std::swap(corners[1], corners[2]);
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

std::size_t unmatchedCracks(std::span<const Fragment> fragments) {
  using Key = std::tuple<int, int, std::array<Position, 3>>;  // owner, neighbor, corners
  std::map<Key, int> faces;
  for (const Fragment& fragment : fragments) {
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      const int other = fragment.mesh.neighbor[t];
      if (other == 0) continue;
      ++faces[{fragment.id, other, cornersOf(fragment.mesh, t, false)}];
      --faces[{other, fragment.id, cornersOf(fragment.mesh, t, true)}];
    }
  }
  return static_cast<std::size_t>(
      std::count_if(faces.begin(), faces.end(), [](const auto& f) { return f.second != 0; }));
}

// Input triangles that are not there as they were.
//   isWorn  parts may be missing
std::size_t unlikeInput(const TriangleMesh& input, std::span<const Fragment> fragments,
                        bool isWorn) {
  std::vector<double> areas(input.triangles.size(), 0.0);
  std::vector<std::size_t> faces(input.triangles.size(), 0);
  std::vector<bool> isWhole(input.triangles.size(), false);
  for (const Fragment& fragment : fragments) {
    const TriangleMesh& mesh = fragment.mesh;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const std::uint32_t source = mesh.source[t];
      if (source == TriangleMesh::kNoSource) continue;
      areas[source] += areaOf(mesh, t);
      ++faces[source];
      isWhole[source] = cornersOf(mesh, t, false) == cornersOf(input, source, false) ||
                        cornersOf(mesh, t, false) == cornersOf(input, source, true);
    }
  }
  const double tolerance = 1e-12 * area(input);
  std::size_t count = 0;
  for (std::size_t s = 0; s < areas.size(); ++s) {
    const double own = areaOf(input, s);
    const bool isUnlike = std::abs(areas[s] - own) > tolerance || (faces[s] == 1 && !isWhole[s]);
    count += isUnlike && !(isWorn && areas[s] < own + tolerance) ? 1u : 0u;
  }
  return count;
}

std::size_t newCrossings(const TriangleMesh& mesh) {
  const auto isInput = [&](std::uint32_t t) { return mesh.neighbor[t] == 0; };
  // Sheets may touch: vertices at one position count as one.
  std::map<Position, std::uint32_t> first;
  std::vector<glm::uvec3> triangles = mesh.triangles;
  for (glm::uvec3& t : triangles) {
    for (int k = 0; k < 3; ++k)
      t[k] = first.emplace(positionOf(mesh.vertices[t[k]]), t[k]).first->second;
  }
  const auto pairs = selfCrossings(mesh.vertices, triangles);
  return static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(), [&](const auto& pair) {
    return !isInput(pair[0]) || !isInput(pair[1]);
  }));
}

}  // namespace

bool ExactFaults::any() const {
  return openEdges + nonManifoldEdges + selfCrossings + unlikeInput + unmatchedCracks > 0 ||
         std::abs(outerArea) > 1e-9 || std::abs(volume) > 1e-9;
}

std::string ExactFaults::text() const {
  std::ostringstream out;
  out << openEdges << " open edges, " << nonManifoldEdges << " non-manifold edges, "
      << selfCrossings << " self-crossings, " << unlikeInput << " triangles unlike the input's, "
      << unmatchedCracks << " unmatched fracture faces, area " << outerArea << ", volume "
      << volume;
  return out.str();
}

ExactFaults exactFaults(const TriangleMesh& input, std::span<const Fragment> fragments,
                        bool isWorn) {
  ExactFaults faults;
  double outer = 0.0, inside = 0.0;
  for (const Fragment& fragment : fragments) {
    const TriangleMesh& mesh = fragment.mesh;
    faults.openEdges += openEdges(mesh);
    faults.nonManifoldEdges += nonManifoldEdges(mesh);
    faults.selfCrossings += newCrossings(mesh);
    inside += volume(mesh);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.source[t] != TriangleMesh::kNoSource) outer += areaOf(mesh, t);
    }
  }
  faults.unlikeInput = unlikeInput(input, fragments, isWorn);
  if (isWorn) return faults;
  faults.unmatchedCracks = unmatchedCracks(fragments);
  faults.outerArea = outer / area(input) - 1.0;
  faults.volume = inside / std::abs(volume(input)) - 1.0;
  return faults;
}

}  // namespace sherd
