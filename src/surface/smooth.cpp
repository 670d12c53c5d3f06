// Laplacian smoothing in two passes.
#include <sherd/error.h>
#include <sherd/surface.h>

#include <cassert>
#include <cstddef>
#include <set>
#include <string>

namespace sherd {
namespace {

// One pass: vertices with moves[v] go towards the mean over `faces`, all at once.
void smooth(std::vector<glm::dvec3>& vertices, const std::vector<glm::uvec3>& faces,
            const std::vector<bool>& moves, double weight, int iterations) {
  if (weight == 0.0 || iterations == 0) return;
  std::vector<int> neighbours(vertices.size(), 0);
  for (const glm::uvec3& face : faces) {
    for (int k = 0; k < 3; ++k) neighbours[face[k]] += 2;
  }
  std::vector<glm::dvec3> sum(vertices.size());
  for (int i = 0; i < iterations; ++i) {
    sum.assign(vertices.size(), glm::dvec3(0.0));
    for (const glm::uvec3& face : faces) {
      const glm::dvec3 a = vertices[face.x], b = vertices[face.y], c = vertices[face.z];
      sum[face.x] += b + c;
      sum[face.y] += c + a;
      sum[face.z] += a + b;
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      if (!moves[v] || neighbours[v] == 0) continue;
      vertices[v] += weight * (sum[v] / static_cast<double>(neighbours[v]) - vertices[v]);
    }
  }
}

bool areGood(const Iterations& iterations) {
  return iterations.count >= 0 && iterations.count <= 1000 && iterations.perVoxel >= 0.0 &&
         iterations.perVoxel <= 1.0;
}

bool isShare(double weight) { return weight >= 0.0 && weight <= 1.0; }

}  // namespace

void checkSurfaceOptions(const SurfaceOptions& options) {
  const SmoothOptions& smooth = options.smooth;
  if (!areGood(smooth.iterations) || !areGood(smooth.boundaryIterations) ||
      !isShare(smooth.weight) || !isShare(smooth.boundaryWeight)) {
    throw Error(ErrorCode::usage,
                "smoothing takes weights of 0..1, and 0..1000 iterations or 0..1 a voxel");
  }
  std::set<std::size_t> seen;
  for (const std::size_t triangles : options.triangles) {
    if (triangles < 4 || !seen.insert(triangles).second) {
      throw Error(ErrorCode::usage, "a mesh cannot be decimated to " + std::to_string(triangles) +
                                        " triangles" + (triangles < 4 ? "" : " twice"));
    }
  }
}

TriangleMesh smoothed(TriangleMesh mesh, std::span<const std::uint16_t> facing,
                      const SmoothOptions& options, int longestSide) {
  assert(facing.size() == mesh.triangles.size());
  std::vector<bool> boundary(mesh.vertices.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; facing[t] != 0 && k < 3; ++k) boundary[mesh.triangles[t][k]] = true;
  }
  std::vector<bool> other = boundary;
  other.flip();
  smooth(mesh.vertices, mesh.triangles, other, options.weight,
         options.iterations.over(longestSide));
  smooth(mesh.vertices, mesh.triangles, boundary, options.boundaryWeight,
         options.boundaryIterations.over(longestSide));
  return mesh;
}

}  // namespace sherd
