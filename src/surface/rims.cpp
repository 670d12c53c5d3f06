// Moving junctions one by one.
#include "surface/rims.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>

namespace sherd {
namespace {

constexpr double kLeastCosine = 0.7;  // between a triangle and its quad as it was
constexpr double kLeastArea = 0.01;   // square voxels
constexpr int kRounds = 2;
constexpr std::array kSteps{1.0, 0.75, 0.5, 0.25};

// The quads at junctions.
class Surroundings {
 public:
  Surroundings(std::span<const std::vector<InterfaceQuad>> quads,
               std::span<const Junction> junctions, std::span<const glm::dvec3> vertices)
      : quads_(junctions.size()) {
    constexpr std::uint32_t kNone = 0xffffffffu;
    std::vector<std::uint32_t> junctionOf(vertices.size(), kNone);
    for (std::uint32_t j = 0; j < junctions.size(); ++j) {
      for (const std::uint32_t v : junctions[j].vertices) junctionOf[v] = j;
    }
    for (const std::vector<InterfaceQuad>& ofLeaf : quads) {
      for (const InterfaceQuad& quad : ofLeaf) {
        for (const std::uint32_t v : quad.vertex) {
          if (junctionOf[v] == kNone) continue;
          quads_[junctionOf[v]].push_back({&quad, normalOf(quad, vertices)});
        }
      }
    }
  }

  // How bad the worst triangle at a junction is: a cosine, less where it is small; enough is
  // kLeastCosine.  Where one is below `enough` already, that one.
  double worst(std::size_t junction, std::span<const glm::dvec3> vertices,
               double enough = -2.0) const {
    double least = kLeastCosine;
    for (const Around& around : quads_[junction]) {
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
  struct Around {
    const InterfaceQuad* quad;
    glm::dvec3 normal;  // as it was
  };

  static glm::dvec3 normalOf(const InterfaceQuad& quad, std::span<const glm::dvec3> vertices) {
    const auto& v = quad.vertex;
    const glm::dvec3 n =
        glm::cross(vertices[v[2]] - vertices[v[0]], vertices[v[3]] - vertices[v[1]]);
    const double length = glm::length(n);
    return length > 0.0 ? n / length : glm::dvec3(0.0);
  }

  std::vector<std::vector<Around>> quads_;  // [junctions]
};

}  // namespace

std::array<std::array<std::uint32_t, 3>, 2> trianglesOf(const InterfaceQuad& quad,
                                                        std::span<const glm::dvec3> vertices) {
  const auto& v = quad.vertex;
  const glm::dvec3 a = vertices[v[0]] - vertices[v[2]], b = vertices[v[1]] - vertices[v[3]];
  if (glm::dot(a, a) <= glm::dot(b, b)) return {{{v[0], v[1], v[2]}, {v[0], v[2], v[3]}}};
  return {{{v[1], v[2], v[3]}, {v[1], v[3], v[0]}}};
}

void straightenRims(std::span<const std::vector<InterfaceQuad>> quads,
                    std::span<const Junction> junctions, std::vector<glm::dvec3>& vertices) {
  const Surroundings surroundings(quads, junctions, vertices);
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t j = 0; j < junctions.size(); ++j) {
      const auto place = [&](const glm::dvec3& at) {
        for (const std::uint32_t v : junctions[j].vertices) vertices[v] = at;
      };
      const glm::dvec3 from = vertices[junctions[j].vertices[0]];
      if (from + (junctions[j].wanted - from) == from) continue;  // it is there
      const double before = surroundings.worst(j, vertices);
      bool moved = false;
      for (std::size_t k = 0; k < kSteps.size() && !moved; ++k) {
        place(from + kSteps[k] * (junctions[j].wanted - from));
        moved = surroundings.worst(j, vertices, before) >= before;
      }
      if (!moved) place(from);
    }
  }
}

}  // namespace sherd
