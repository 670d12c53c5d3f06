// The exploded fragments, centered and scaled.
#include "render/scene.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace sherd {
namespace {

constexpr float kCreaseCosine = 0.7f;  // 45 degrees; edges that meshing has rounded stay smooth

glm::dvec3 yUp(glm::dvec3 p, char up) {
  if (up == 'z') return {p.x, p.z, -p.y};
  if (up == 'x') return {p.z, p.x, p.y};
  return p;
}

glm::dvec3 centroidOfWhole(std::span<const Fragment> fragments) {
  glm::dvec3 sum(0.0);
  double volume = 0.0;
  for (const Fragment& fragment : fragments) {
    const double v = std::max(fragment.mass.volume, 0.0);
    sum += v * fragment.mass.centroid;
    volume += v;
  }
  if (volume > 0.0) return sum / volume;
  for (const Fragment& fragment : fragments) sum += fragment.mass.centroid;
  return sum / std::max(1.0, static_cast<double>(fragments.size()));
}

/// The triangles of each vertex: triangle[first[v]] to triangle[first[v + 1] - 1].
struct Fans {
  std::vector<std::uint32_t> first;     ///< [vertices + 2], the last one unused
  std::vector<std::uint32_t> triangle;  ///< [3 * triangles]
};

Fans fans(const TriangleMesh& mesh) {
  Fans result{std::vector<std::uint32_t>(mesh.vertices.size() + 2, 0),
              std::vector<std::uint32_t>(3 * mesh.triangles.size())};
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++result.first[t[k] + 2];
  for (std::size_t v = 2; v < result.first.size(); ++v) result.first[v] += result.first[v - 1];
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) result.triangle[result.first[mesh.triangles[i][k] + 1]++] = i;
  return result;  // first[v + 1] has advanced to the end of v's list, where the next one begins
}

/// Whether all faces around a vertex have one neighbor, and no two of them are more than 45 degrees
/// apart: none is more than half of that from the first.
bool isSmooth(const TriangleMesh& mesh, std::span<const std::uint32_t> around,
              const std::vector<glm::vec3>& areaNormal) {
  constexpr float kHalfCosine = 0.925f;
  if (around.empty()) return false;
  const glm::vec3& first = areaNormal[around.front()];
  const float least = kHalfCosine * kHalfCosine * glm::dot(first, first);
  return std::all_of(around.begin(), around.end(), [&](std::uint32_t i) {
    const float cosine = glm::dot(areaNormal[i], first);
    return mesh.neighborOf(i) == mesh.neighborOf(around.front()) && cosine > 0.0f &&
           cosine * cosine > least * glm::dot(areaNormal[i], areaNormal[i]);
  });
}

/// Computes corner normals: the area-weighted mean over the faces around the vertex with the same
/// neighbor as the corner's own face and at most 45 degrees from it.  Most vertices have one, with
/// their own index; those at creases have more, behind.
void setNormals(const Fragment& fragment, SceneFragment& target) {
  const TriangleMesh& mesh = fragment.mesh;
  std::vector<glm::vec3> areaNormal(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    const glm::vec3 a = target.vertices[t.x], b = target.vertices[t.y], c = target.vertices[t.z];
    areaNormal[i] = glm::cross(b - a, c - a);
  }
  const auto normal = [&](std::uint32_t i) {
    const float length = glm::length(areaNormal[i]);
    return length > 0.0f ? areaNormal[i] / length : glm::vec3(0.0f, 1.0f, 0.0f);
  };
  const Fans fan = fans(mesh);
  target.normalOf.assign(mesh.triangles.begin(), mesh.triangles.end());
  target.normals.resize(mesh.vertices.size());
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const std::span around =
        std::span(fan.triangle).subspan(fan.first[v], fan.first[v + 1] - fan.first[v]);
    if (isSmooth(mesh, around, areaNormal)) {
      glm::vec3 sum(0.0f);
      for (const std::uint32_t i : around) sum += areaNormal[i];
      target.normals[v] = sum / glm::length(sum);
      continue;
    }
    const auto first = static_cast<std::ptrdiff_t>(target.normals.size());
    for (const std::uint32_t i : around) {
      glm::vec3 sum(0.0f);
      for (const std::uint32_t other : around) {
        if (mesh.neighborOf(other) == mesh.neighborOf(i) &&
            glm::dot(normal(other), normal(i)) > kCreaseCosine)
          sum += areaNormal[other];
      }
      const float length = glm::length(sum);
      const glm::vec3 smooth = length > 0.0f ? sum / length : normal(i);
      auto at = std::find(target.normals.begin() + first, target.normals.end(), smooth);
      if (at == target.normals.end()) at = target.normals.insert(at, smooth);
      const auto index = static_cast<std::uint32_t>(at - target.normals.begin());
      for (int k = 0; k < 3; ++k)
        if (mesh.triangles[i][k] == v) target.normalOf[i][k] = index;
    }
  }
}

}  // namespace

glm::vec3 worldDirection(const glm::vec3& d, char up) {
  if (up == 'z') return {d.x, -d.z, d.y};
  if (up == 'x') return {d.y, d.z, d.x};
  return d;
}

Scene makeScene(std::span<const Fragment> fragments, const RenderOptions& options) {
  const glm::dvec3 whole = centroidOfWhole(fragments);
  std::vector<glm::dvec3> shift(fragments.size());
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    shift[i] = options.explode * (fragments[i].mass.centroid - whole);
    for (const glm::dvec3& v : fragments[i].mesh.vertices) {
      const glm::dvec3 p = yUp(v + shift[i], options.up);
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
  if (!(low.x <= high.x)) low = glm::dvec3(-1.0), high = glm::dvec3(1.0);
  const glm::dvec3 center = 0.5 * (low + high);
  const double size = high == low ? 1.0 : 0.5 * glm::length(high - low);

  Scene scene;
  scene.shifts = shift;
  scene.size = size;
  scene.groundY = static_cast<float>((low.y - center.y) / size);
  const glm::vec3 half = glm::vec3(0.5 * (high - low) / size);
  for (int k = 0; k < 8; ++k)
    scene.boxCorners.push_back(half * glm::vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
  scene.fragments.resize(fragments.size());
  tbb::parallel_for(std::size_t{0}, fragments.size(), [&](std::size_t i) {
    const TriangleMesh& mesh = fragments[i].mesh;
    SceneFragment& target = scene.fragments[i];
    target.vertices.reserve(mesh.vertices.size() + 1);
    for (const glm::dvec3& v : mesh.vertices)
      target.vertices.emplace_back((yUp(v + shift[i], options.up) - center) / size);
    target.vertices.emplace_back(0.0f);
    target.triangles = mesh.triangles;
    target.inner.resize(mesh.triangles.size(), 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      target.inner[t] = mesh.neighborOf(t) != 0;
    setNormals(fragments[i], target);
  });
  return scene;
}

}  // namespace sherd
