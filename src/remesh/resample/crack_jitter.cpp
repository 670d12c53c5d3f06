// Moves vertices of cracks.
#include "remesh/resample/crack_jitter.h"

#include <vector>

#include "base/random.h"
#include "intersect/self_crossings.h"

namespace sherd {
namespace {

// What is left of the move of a vertex whose triangles cross others, and how often.
constexpr double kLess = 1.0 / 8.0;
constexpr int kJitterRounds = 2;

}  // namespace

void jitterCracks(TriangleMesh& mesh, const GridFrame& frame, const FragmentKey& key) {
  const std::vector<glm::dvec3> before = mesh.vertices;
  std::vector<double> reach(before.size(), 0.0);  // voxels; 0: stays
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; mesh.neighborOf(t) != 0 && k < 3; ++k) {
      reach[mesh.triangles[t][k]] = kCrackJitter;
    }
  }
  const auto move = [&](std::size_t v) {
    glm::dvec3 at = inVoxels(frame, before[v]);
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint64_t item = (std::uint64_t{key.fragment} << 34 | v) * 3 + k;
      at[static_cast<int>(k)] +=
          reach[v] * (2.0 * randomUnit(key.seed, Stage::crackJitter, item) - 1.0);
    }
    mesh.vertices[v] = frame.worldFromIndex(at);
  };
  for (std::size_t v = 0; v < reach.size(); ++v) {
    if (reach[v] > 0.0) move(v);
  }
  for (int round = 0; round < kJitterRounds; ++round) {
    const auto pairs = selfCrossings(mesh.vertices, mesh.triangles);
    if (pairs.empty()) break;
    std::vector<bool> isCrossed(reach.size(), false);
    for (const auto& pair : pairs) {
      for (const std::uint32_t t : pair) {
        for (int k = 0; k < 3; ++k) isCrossed[mesh.triangles[t][k]] = true;
      }
    }
    for (std::size_t v = 0; v < reach.size(); ++v) {
      if (!isCrossed[v] || reach[v] == 0.0) continue;
      reach[v] *= kLess;
      move(v);
    }
  }
}

}  // namespace sherd
