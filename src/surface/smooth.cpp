// Smoothing in two passes.
#include "surface/smooth.h"

#include <sherd/error.h>
#include <sherd/surface.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <set>
#include <string>

#include "base/cancel_flag.h"

namespace sherd {
namespace {

// Surfaces of fewer triangles than this, those of pores and crumbs of a voxel or three, would
// shrink to a point.
constexpr std::size_t kLeastTriangles = 100;

// What is smoothed: one mesh, or several whose vertices at one place stay together.
struct Smoothed {
  std::vector<glm::dvec3> vertices;
  std::vector<glm::uvec3> faces;
  std::vector<bool> boundary;         // [vertices]
  std::vector<std::uint32_t> places;  // [vertices] or empty
  std::vector<bool> stays{};          // [vertices] or empty
};

// Vertices that move and share a place all go to their mean.
void bringTogether(Smoothed& mesh, const std::vector<bool>& moves) {
  if (mesh.places.empty()) return;
  const std::uint32_t count = *std::max_element(mesh.places.begin(), mesh.places.end()) + 1;
  std::vector<glm::dvec3> sum(count, glm::dvec3(0.0));
  std::vector<int> members(count, 0);
  for (std::size_t v = 0; v < moves.size(); ++v) {
    if (!moves[v]) continue;
    sum[mesh.places[v]] += mesh.vertices[v];
    ++members[mesh.places[v]];
  }
  for (std::size_t v = 0; v < moves.size(); ++v) {
    const std::uint32_t place = mesh.places[v];
    if (moves[v]) mesh.vertices[v] = sum[place] / static_cast<double>(members[place]);
  }
}

// Moves some vertices of a mesh towards the mean over their faces, or away from it.
class Smoother {
 public:
  Smoother(Smoothed& mesh, const std::vector<bool>& moves)
      : mesh_(mesh), moves_(moves), neighbors_(mesh.vertices.size(), 0) {
    for (const glm::uvec3& face : mesh.faces) {
      for (int k = 0; k < 3; ++k) neighbors_[face[k]] += 2;
    }
  }

  // All at once, by `weight` of the way.
  void step(double weight) {
    std::vector<glm::dvec3>& vertices = mesh_.vertices;
    sum_.assign(vertices.size(), glm::dvec3(0.0));
    for (const glm::uvec3& face : mesh_.faces) {
      const glm::dvec3 a = vertices[face.x], b = vertices[face.y], c = vertices[face.z];
      sum_[face.x] += b + c;
      sum_[face.y] += c + a;
      sum_[face.z] += a + b;
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      if (!moves_[v] || neighbors_[v] == 0) continue;
      vertices[v] += weight * (sum_[v] / static_cast<double>(neighbors_[v]) - vertices[v]);
    }
    bringTogether(mesh_, moves_);
  }

 private:
  Smoothed& mesh_;
  const std::vector<bool>& moves_;
  std::vector<int> neighbors_;  // [vertices] once for each face
  std::vector<glm::dvec3> sum_;
};

void smooth(Smoothed& mesh, const std::vector<bool>& moves, Smoothing method, double weight,
            int iterations, const Progress* progress) {
  if (weight == 0.0 || iterations == 0) return;
  Smoother smoother(mesh, moves);
  for (int i = 0; i < iterations; ++i) {
    throwIfCancelled(progress);
    smoother.step(weight);
    if (method == Smoothing::taubin) smoother.step(1.0 / (kPassBand - 1.0 / weight));
  }
}

void smooth(Smoothed& mesh, const SmoothOptions& options, int longestSide,
            const Progress* progress) {
  std::vector<bool> boundary = mesh.boundary, other = mesh.boundary;
  other.flip();
  for (std::size_t v = 0; v < mesh.stays.size(); ++v) {
    if (mesh.stays[v]) boundary[v] = other[v] = false;
  }
  smooth(mesh, other, options.method, options.weight, options.iterations.over(longestSide),
         progress);
  smooth(mesh, boundary, options.method, options.boundaryWeight,
         options.boundaryIterations.over(longestSide), progress);
}

// [places] Does a small surface pass there?
std::vector<bool> smallSurfaces(std::span<const LabelledMesh> meshes,
                                std::span<const std::uint32_t> places) {
  std::vector<bool> isSmall(*std::max_element(places.begin(), places.end()) + std::size_t{1});
  for (const LabelledMesh& mesh : meshes) {
    const Components parts = components(mesh.mesh);
    std::vector<std::size_t> triangles(parts.count, 0);
    for (const std::uint32_t part : parts.ofTriangle) ++triangles[part];
    for (std::size_t t = 0; t < parts.ofTriangle.size(); ++t) {
      if (triangles[parts.ofTriangle[t]] >= kLeastTriangles) continue;
      for (int k = 0; k < 3; ++k) isSmall[mesh.place[mesh.mesh.triangles[t][k]]] = true;
    }
  }
  return isSmall;
}

// Add a mesh behind what is there.
void add(Smoothed& to, const TriangleMesh& mesh, std::span<const std::uint16_t> facing) {
  assert(facing.size() == mesh.triangles.size());
  const auto first = static_cast<unsigned>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  to.boundary.resize(to.vertices.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    to.faces.push_back(mesh.triangles[t] + first);
    for (int k = 0; facing[t] != 0 && k < 3; ++k) to.boundary[to.faces.back()[k]] = true;
  }
}

bool areGood(const Iterations& iterations) {
  return iterations.count >= 0 && iterations.count <= 1000 && iterations.perVoxel >= 0.0 &&
         iterations.perVoxel <= 1.0;
}

bool isShare(double weight) { return weight >= 0.0 && weight <= 1.0; }

bool isAny(const Iterations& iterations) {
  return iterations.count > 0 || iterations.perVoxel > 0.0;
}

}  // namespace

bool movesAnything(const SmoothOptions& options, int longestSide) {
  return options.iterations.over(longestSide) > 0 ||
         options.boundaryIterations.over(longestSide) > 0;
}

void checkSurfaceOptions(const SurfaceOptions& options) {
  const SmoothOptions& smooth = options.smooth;
  if (!areGood(smooth.iterations) || !areGood(smooth.boundaryIterations) ||
      !isShare(smooth.weight) || !isShare(smooth.boundaryWeight)) {
    throw Error(ErrorCode::usage,
                "smoothing takes weights of 0..1, and 0..1000 iterations or 0..1 a voxel");
  }
  const double largest = std::max(isAny(smooth.iterations) ? smooth.weight : 0.0,
                                  isAny(smooth.boundaryIterations) ? smooth.boundaryWeight : 0.0);
  if (smooth.method == Smoothing::taubin && largest > kMostTaubinWeight) {
    throw Error(ErrorCode::usage,
                "Taubin's smoothing takes weights of 0..2/3, or short waves grow; more needs "
                "--smoothing laplacian");
  }
  if (!(options.adaptivity >= 0.0 && options.adaptivity <= 1.0)) {
    throw Error(ErrorCode::usage, "the adaptivity lies in 0..1");
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
                      const SmoothOptions& options, int longestSide, const Progress* progress) {
  if (!movesAnything(options, longestSide)) return mesh;
  Smoothed all;
  add(all, mesh, facing);
  smooth(all, options, longestSide, progress);
  mesh.vertices = std::move(all.vertices);
  return mesh;
}

void smoothTogether(std::span<LabelledMesh> meshes,
                    std::span<const std::vector<std::uint16_t>> facing,
                    const SmoothOptions& options, int longestSide, const Progress* progress) {
  if (!movesAnything(options, longestSide)) return;
  Smoothed all;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    add(all, meshes[i].mesh, facing[i]);
    all.places.insert(all.places.end(), meshes[i].place.begin(), meshes[i].place.end());
  }
  const std::vector<bool> isSmall = smallSurfaces(meshes, all.places);
  for (const std::uint32_t place : all.places) all.stays.push_back(isSmall[place]);
  smooth(all, options, longestSide, progress);
  auto from = all.vertices.begin();
  for (LabelledMesh& mesh : meshes) {
    const auto to = from + static_cast<std::ptrdiff_t>(mesh.mesh.vertices.size());
    mesh.mesh.vertices.assign(from, to);
    from = to;
  }
}

}  // namespace sherd
