// Smooths meshes in two passes.
#include "remesh/smooth.h"

#include <sherd/error.h>
#include <sherd/fragments.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <set>
#include <string>

#include "base/cancel_flag.h"

namespace sherd {
namespace {

// Surfaces of fewer triangles (pores and islands of one to three voxels) would shrink to a point.
constexpr std::size_t kLeastTriangles = 100;

// One mesh, or several whose vertices with one positionId stay together.
struct Smoothed {
  std::vector<glm::dvec3> vertices;
  std::vector<glm::uvec3> faces;
  std::vector<bool> boundary;              // [vertices]
  std::vector<std::uint32_t> positionIds;  // [vertices] or empty
  std::vector<bool> isFixed{};             // [vertices] or empty
};

// Moves vertices that share a position to their mean.
void averageSharedPositions(Smoothed& mesh, const std::vector<bool>& moves) {
  if (mesh.positionIds.empty()) return;
  const std::uint32_t count =
      *std::max_element(mesh.positionIds.begin(), mesh.positionIds.end()) + 1;
  std::vector<glm::dvec3> sum(count, glm::dvec3(0.0));
  std::vector<int> members(count, 0);
  for (std::size_t v = 0; v < moves.size(); ++v) {
    if (!moves[v]) continue;
    sum[mesh.positionIds[v]] += mesh.vertices[v];
    ++members[mesh.positionIds[v]];
  }
  for (std::size_t v = 0; v < moves.size(); ++v) {
    const std::uint32_t id = mesh.positionIds[v];
    if (moves[v]) mesh.vertices[v] = sum[id] / static_cast<double>(members[id]);
  }
}

// Moves selected vertices towards the mean of their neighbors, or away from it.
class Smoother {
 public:
  Smoother(Smoothed& mesh, const std::vector<bool>& moves)
      : mesh_(mesh), moves_(moves), neighbors_(mesh.vertices.size(), 0) {
    for (const glm::uvec3& face : mesh.faces) {
      for (int k = 0; k < 3; ++k) neighbors_[face[k]] += 2;
    }
  }

  // Moves all by `weight` times the difference to the mean.
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
    averageSharedPositions(mesh_, moves_);
  }

 private:
  Smoothed& mesh_;
  const std::vector<bool>& moves_;
  std::vector<int> neighbors_;  // [vertices] counted once per face
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
  for (std::size_t v = 0; v < mesh.isFixed.size(); ++v) {
    if (mesh.isFixed[v]) boundary[v] = other[v] = false;
  }
  smooth(mesh, other, options.method, options.weight, options.iterations.over(longestSide),
         progress);
  smooth(mesh, boundary, options.method, options.boundaryWeight,
         options.boundaryIterations.over(longestSide), progress);
}

// [positionIds] True if the position is on a small surface.
std::vector<bool> smallSurfaces(std::span<const LabeledMesh> meshes,
                                std::span<const std::uint32_t> positionIds) {
  std::vector<bool> isSmall(*std::max_element(positionIds.begin(), positionIds.end()) +
                            std::size_t{1});
  for (const LabeledMesh& mesh : meshes) {
    const MeshComponents components = meshComponents(mesh.mesh);
    std::vector<std::size_t> triangles(components.count, 0);
    for (const std::uint32_t component : components.ofTriangle) ++triangles[component];
    for (std::size_t t = 0; t < components.ofTriangle.size(); ++t) {
      if (triangles[components.ofTriangle[t]] >= kLeastTriangles) continue;
      for (int k = 0; k < 3; ++k) isSmall[mesh.positionId[mesh.mesh.triangles[t][k]]] = true;
    }
  }
  return isSmall;
}

// Appends a mesh.
void add(Smoothed& to, const TriangleMesh& mesh) {
  const auto first = static_cast<unsigned>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  to.boundary.resize(to.vertices.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    to.faces.push_back(mesh.triangles[t] + first);
    for (int k = 0; mesh.neighborOf(t) != 0 && k < 3; ++k) to.boundary[to.faces.back()[k]] = true;
  }
}

bool areValid(const Iterations& iterations) {
  return iterations.count >= 0 && iterations.count <= 1000 && iterations.perVoxel >= 0.0 &&
         iterations.perVoxel <= 1.0;
}

bool isShare(double weight) { return weight >= 0.0 && weight <= 1.0; }

bool smooths(const Iterations& iterations) {
  return iterations.count > 0 || iterations.perVoxel > 0.0;
}

bool displaces(const NoiseOptions& noise) { return noise.rms > 0.0; }

bool isValid(const NoiseOptions& noise) {
  return noise.rms >= 0.0 && noise.rms <= 5.0 && noise.hurst >= 0.1 && noise.hurst <= 1.0 &&
         noise.wavelength >= 0.01 && noise.wavelength <= 100.0;
}

void checkNoise(const SurfaceOptions& options) {
  if (!isValid(options.mismatch) || !isValid(options.scanNoise) ||
      !isShare(options.mismatchCommon)) {
    throw Error(ErrorCode::usage,
                "noise on surfaces takes an rms of 0..5 % of the diagonal, a Hurst exponent of "
                "0.1..1, a wavelength of 0.01..100 %, and common shares of 0..1");
  }
  if (displaces(options.scanNoise) && options.surface == Surface::exact) {
    throw Error(ErrorCode::usage,
                "noise of a scan moves all vertices, and an exact surface has the input's; choose "
                "the smooth surface",
                OptionNames{"scan-noise", "surface"});
  }
  if (hasNoise(options) && options.adaptivity > 0.0) {
    throw Error(ErrorCode::usage,
                "noise needs vertices on every part of a surface, so faces can't be merged; omit "
                "the adaptivity, or decimate to a number of triangles",
                OptionNames{"adaptivity"});
  }
}

}  // namespace

bool movesAnything(const SmoothOptions& options, int longestSide) {
  return options.iterations.over(longestSide) > 0 ||
         options.boundaryIterations.over(longestSide) > 0;
}

Surface surfaceOf(const SurfaceOptions& options) {
  if (options.surface != Surface::automatic) return options.surface;
  const bool isSmooth = !options.meshes || options.interface == Interface::independent ||
                        options.scanNoise.rms > 0.0 || smooths(options.smooth.iterations) ||
                        smooths(options.smooth.boundaryIterations);
  return isSmooth ? Surface::smooth : Surface::exact;
}

bool hasNoise(const SurfaceOptions& options) {
  return displaces(options.mismatch) || displaces(options.scanNoise);
}

double crackAdaptivity(const SurfaceOptions& options) {
  return hasNoise(options) ? 0.0 : options.adaptivity;
}

bool samplesLabelSurfaces(const SurfaceOptions& options) {
  return options.surface == Surface::smooth && options.adaptivity <= 0.0 &&
         !smooths(options.smooth.iterations) && !smooths(options.smooth.boundaryIterations);
}

bool canLackMeshes(const SurfaceOptions& options) {
  return samplesLabelSurfaces(options) && !options.levelSets &&
         options.interface == Interface::shared && options.triangles.empty() && !hasNoise(options);
}

void checkSurfaceOptions(const SurfaceOptions& options) {
  const SmoothOptions& smooth = options.smooth;
  if (!areValid(smooth.iterations) || !areValid(smooth.boundaryIterations) ||
      !isShare(smooth.weight) || !isShare(smooth.boundaryWeight)) {
    throw Error(ErrorCode::usage,
                "smoothing takes weights of 0..1, and 0..1000 iterations or 0..1 a voxel");
  }
  const double largest = std::max(smooths(smooth.iterations) ? smooth.weight : 0.0,
                                  smooths(smooth.boundaryIterations) ? smooth.boundaryWeight : 0.0);
  if (smooth.method == Smoothing::taubin && largest > kMostTaubinWeight) {
    throw Error(ErrorCode::usage,
                "Taubin's smoothing takes weights of 0..2/3, or short waves grow; more needs "
                "Laplacian smoothing",
                OptionNames{"smoothing"});
  }
  if (options.adaptivity != kAutoAdaptivity &&
      !(options.adaptivity >= 0.0 && options.adaptivity <= 1.0)) {
    throw Error(ErrorCode::usage, "the adaptivity is automatic or lies in 0..1");
  }
  checkNoise(options);
  if (options.surface == Surface::exact &&
      (smooths(smooth.iterations) || smooths(smooth.boundaryIterations))) {
    throw Error(ErrorCode::usage, "exact surfaces take no smoothing", OptionNames{"surface"});
  }
  if (!options.meshes && !canLackMeshes(options)) {
    throw Error(ErrorCode::usage,
                "fragments without meshes have smooth, shared surfaces, no level sets, and are "
                "neither smoothed nor simplified nor decimated");
  }
  std::set<std::size_t> seen;
  for (const std::size_t triangles : options.triangles) {
    if (triangles < 4 || !seen.insert(triangles).second) {
      throw Error(ErrorCode::usage, "a mesh cannot be decimated to " + std::to_string(triangles) +
                                        " triangles" + (triangles < 4 ? "" : " twice"));
    }
  }
}

TriangleMesh smoothed(TriangleMesh mesh, const SmoothOptions& options, int longestSide,
                      const Progress* progress) {
  if (!movesAnything(options, longestSide)) return mesh;
  Smoothed all;
  add(all, mesh);
  smooth(all, options, longestSide, progress);
  mesh.vertices = std::move(all.vertices);
  return mesh;
}

void smoothTogether(std::span<LabeledMesh> meshes, const SmoothOptions& options, int longestSide,
                    const Progress* progress) {
  if (!movesAnything(options, longestSide)) return;
  Smoothed all;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    add(all, meshes[i].mesh);
    all.positionIds.insert(all.positionIds.end(), meshes[i].positionId.begin(),
                           meshes[i].positionId.end());
  }
  const std::vector<bool> isSmall = smallSurfaces(meshes, all.positionIds);
  for (const std::uint32_t id : all.positionIds) all.isFixed.push_back(isSmall[id]);
  smooth(all, options, longestSide, progress);
  auto from = all.vertices.begin();
  for (LabeledMesh& mesh : meshes) {
    const auto to = from + static_cast<std::ptrdiff_t>(mesh.mesh.vertices.size());
    mesh.mesh.vertices.assign(from, to);
    from = to;
  }
}

}  // namespace sherd
