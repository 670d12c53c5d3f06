// Finds crossings and edges with too many faces.
#include "remesh/complex_faults.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

#include "remesh/face_edges.h"

namespace sherd {
namespace {

// Returns a point that two triangles have in common, or one of a corner.
glm::dvec3 commonPoint(const std::array<glm::dvec3, 3>& s, const std::array<glm::dvec3, 3>& t) {
  for (const auto& [edges, plane] : {std::pair(&s, &t), std::pair(&t, &s)}) {
    const auto& [a, b, c] = *plane;
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 &from = (*edges)[k], &to = (*edges)[(k + 1) % 3];
      const double atFrom = glm::dot(normal, from - a), atTo = glm::dot(normal, to - a);
      if (atFrom * atTo >= 0.0) continue;
      const glm::dvec3 p = from + atFrom / (atFrom - atTo) * (to - from);
      const auto isLeft = [&](const glm::dvec3& u, const glm::dvec3& v) {
        return glm::dot(glm::cross(v - u, p - u), normal) >= 0.0;
      };
      if (isLeft(a, b) && isLeft(b, c) && isLeft(c, a)) return p;
    }
  }
  return s[0];
}

// Whether a label other than 0 has more than two of the faces at an edge.
bool isCrowded(const LabeledComplex& complex, std::span<const FaceEdges::Use> uses) {
  if (uses.size() <= 3) return false;
  std::vector<std::uint16_t> labels;
  for (const FaceEdges::Use& use : uses) {
    labels.push_back(complex.faces[use.face].front);
    labels.push_back(complex.faces[use.face].back);
  }
  std::sort(labels.begin(), labels.end());
  for (std::size_t i = 2; i < labels.size(); ++i) {
    if (labels[i] != 0 && labels[i] == labels[i - 2]) return true;
  }
  return false;
}

}  // namespace

std::vector<ComplexFault> faultsOf(const LabeledComplex& complex, const CrossingPairs& tested,
                                   const Progress* progress) {
  const std::vector<glm::uvec3> triangles = trianglesOf(complex);
  const auto corners = [&](std::uint32_t f) {
    const glm::uvec3& t = triangles[f];
    const std::vector<glm::dvec3>& v = complex.vertices;
    return std::array<glm::dvec3, 3>{v[t.x], v[t.y], v[t.z]};
  };
  std::vector<ComplexFault> faults;
  for (const auto& [f, g] : selfCrossings(complex.vertices, triangles, progress, tested)) {
    faults.push_back({commonPoint(corners(f), corners(g)), {f, g}});
  }
  const FaceEdges edges(triangles, complex.vertices.size());
  for (std::size_t e = 0; e < edges.count(); ++e) {
    const auto uses = edges.uses(e);
    if (!isCrowded(complex, uses)) continue;
    faults.push_back({complex.vertices[edges.ends(e)[0]], {uses[0].face, uses[1].face}});
  }
  return faults;
}

}  // namespace sherd
