// Moves junctions one by one.
#include "interface/cells/contact_boundaries.h"

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <numeric>

namespace sherd {
namespace {

constexpr double kLeastCosine = 0.7;  // between a triangle and its quad before any move
constexpr double kLeastOnCrease = 0.5;
constexpr double kLeastArea = 0.01;  // square voxels
constexpr int kBoundaryPasses = 2;
constexpr std::array kSteps{0.75, 0.5, 0.25};
constexpr std::array kStepsOnSurface{0.75, 0.5, 0.25, 0.0};

// The quads at junctions.
class JunctionQuads {
 public:
  JunctionQuads(std::span<const std::vector<InterfaceQuad>> quads,
                std::span<const Junction> junctions, std::span<const glm::dvec3> vertices,
                const std::function<bool(std::size_t)>& mayHave)
      : first_(junctions.size() + 1) {
    constexpr std::uint32_t kNone = 0xffffffffu;
    std::vector<std::uint32_t> junctionOf(vertices.size(), kNone);
    for (std::uint32_t j = 0; j < junctions.size(); ++j) {
      for (const std::uint32_t v : junctions[j].vertices()) junctionOf[v] = j;
    }
    struct Found {
      std::uint32_t junction;
      const InterfaceQuad* quad;
    };
    std::vector<Found> found;
    for (std::size_t leaf = 0; leaf < quads.size(); ++leaf) {
      if (quads[leaf].empty() || !mayHave(leaf)) continue;
      for (const InterfaceQuad& quad : quads[leaf]) {
        if (quad.isIntact) continue;
        for (const std::uint32_t v : quad.vertex) {
          if (junctionOf[v] != kNone) found.push_back({junctionOf[v], &quad});
        }
      }
    }
    for (const Found& at : found) ++first_[at.junction + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    quads_.resize(found.size());
    for (const Found& at : found) {
      quads_[next[at.junction]++] = {at.quad, normalOf(*at.quad, vertices)};
    }
  }

  // The quality of the worst triangle at a junction: the cosine to its quad's first normal, less if
  // it is small, at most kLeastCosine.  Stops at a quality below `enough`.
  double worstQuality(std::size_t junction, std::span<const glm::dvec3> vertices,
                      double enough = -2.0) const {
    double least = kLeastCosine;
    for (std::size_t i = first_[junction]; i < first_[junction + 1]; ++i) {
      const QuadAtJunction& around = quads_[i];
      if (least < enough) return least;
      for (const auto& t : trianglesOf(*around.quad, vertices)) {
        const glm::dvec3 n =
            0.5 * glm::cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]]);
        const double area = glm::length(n);
        if (area == 0.0) return -1.0;
        const double cosine = glm::dot(n, around.normal) / area;
        least = std::min(
            least, area < kLeastArea ? std::min(cosine, kLeastCosine * area / kLeastArea) : cosine);
      }
    }
    return least;
  }

 private:
  struct QuadAtJunction {
    const InterfaceQuad* quad;
    glm::dvec3 normal;  // before any move
  };

  static glm::dvec3 normalOf(const InterfaceQuad& quad, std::span<const glm::dvec3> vertices) {
    const auto& v = quad.vertex;
    const glm::dvec3 n =
        glm::cross(vertices[v[2]] - vertices[v[0]], vertices[v[3]] - vertices[v[1]]);
    const double length = glm::length(n);
    return length > 0.0 ? n / length : glm::dvec3(0.0);
  }

  std::vector<std::size_t> first_;     // [junctions + 1] into quads_
  std::vector<QuadAtJunction> quads_;  // by junction
};

bool isFirstDiagonal(const InterfaceQuad& quad, std::span<const glm::dvec3> vertices) {
  const int u = (quad.axis() + 1) % 3, v = (quad.axis() + 2) % 3;
  std::array<const glm::dvec3*, 4> at{};
  for (std::size_t k = 0; k < 4; ++k) at[k] = &vertices[quad.vertex[k]];
  // Twice the area of three corners, seen along the axis.
  const auto area = [&](std::size_t i, std::size_t j, std::size_t k) {
    const glm::dvec3 a = *at[j] - *at[i], b = *at[k] - *at[i];
    return a[u] * b[v] - a[v] * b[u];
  };
  // Three corners on one straight crease have no area.
  constexpr double kLeastShare = 0.01;
  const auto isIn = [&](double a, double b) {
    return a * b > kLeastShare * (1.0 - kLeastShare) * (a + b) * (a + b);
  };
  const bool isFirstIn = isIn(area(0, 1, 2), area(0, 2, 3)),
             isSecondIn = isIn(area(1, 2, 3), area(1, 3, 0));
  if (isFirstIn != isSecondIn) return isFirstIn;
  if (quad.split != QuadSplit::shorter) return quad.split == QuadSplit::first;
  const glm::dvec3 a = *at[0] - *at[2], b = *at[1] - *at[3];
  return glm::dot(a, a) <= glm::dot(b, b);
}

}  // namespace

QuadSplit settledSplit(const InterfaceQuad& quad, std::span<const glm::dvec3> vertices) {
  return isFirstDiagonal(quad, vertices) ? QuadSplit::first : QuadSplit::second;
}

void straightenBoundaries(std::span<const std::vector<InterfaceQuad>> quads,
                          std::span<const Junction> junctions, std::vector<glm::dvec3>& vertices,
                          const std::function<bool(std::size_t)>& mayHave) {
  if (junctions.empty()) return;
  const JunctionQuads junctionQuads(quads, junctions, vertices, mayHave);
  for (int pass = 0; pass < kBoundaryPasses; ++pass) {
    for (std::size_t j = 0; j < junctions.size(); ++j) {
      const auto moveTo = [&](const glm::dvec3& at) {
        for (const std::uint32_t v : junctions[j].vertices()) vertices[v] = at;
      };
      const glm::dvec3 from = vertices[junctions[j].vertices()[0]];
      if (from + (junctions[j].target - from) == from) continue;  // already there
      // A quality of kLeastCosine is the best there is, so the one before need not be known.
      moveTo(from + (junctions[j].target - from));
      if (junctionQuads.worstQuality(j, vertices, kLeastCosine) >= kLeastCosine) continue;
      moveTo(from);
      const double before = junctionQuads.worstQuality(j, vertices);
      const double enough = junctions[j].isOnCrease ? std::min(before, kLeastOnCrease) : before;
      const auto moves = [&](const glm::dvec3& to, double quality) {
        moveTo(to);
        return junctionQuads.worstQuality(j, vertices, quality) >= quality;
      };
      const glm::dvec3 &target = junctions[j].target, &normal = junctions[j].normal;
      const auto towards = [&](double step) { return from + step * (target - from); };
      const auto isMoved = [&](double step) { return moves(towards(step), enough); };
      const auto isMovedOnSurface = [&](double step) {
        const glm::dvec3 at = towards(step);
        return moves(at - glm::dot(at - target, normal) * normal, kLeastCosine);
      };
      const bool hasSurface = normal != glm::dvec3(0.0);
      if (!isMoved(1.0) &&
          !(hasSurface && std::ranges::any_of(kStepsOnSurface, isMovedOnSurface)) &&
          !std::ranges::any_of(kSteps, isMoved)) {
        moveTo(from);
      }
    }
  }
}

}  // namespace sherd
