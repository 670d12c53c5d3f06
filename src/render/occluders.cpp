// The fragments as obstacles of light.
#include "render/occluders.h"

#include <tbb/parallel_for.h>

#include <array>
#include <bit>
#include <glm/common.hpp>
#include <limits>
#include <utility>

namespace sherd {
namespace {

/// Numbers of the cubes of a grid, in the order in which they are first met.
class Cubes {
 public:
  explicit Cubes(std::size_t atMost)
      : mask_(std::bit_ceil(2 * atMost + 1) - 1), slots_(mask_ + 1, Slot{kFree, 0}) {}

  /// Returns the number of a cube, and `next` if it is new.
  std::uint32_t number(std::uint64_t cube, std::uint32_t next) {
    for (std::size_t at = cube * 0x9e3779b97f4a7c15u >> 20 & mask_;; at = (at + 1) & mask_) {
      if (slots_[at].cube == cube) return slots_[at].number;
      if (slots_[at].cube == kFree) {
        slots_[at] = {cube, next};
        return next;
      }
    }
  }

 private:
  static constexpr std::uint64_t kFree = ~std::uint64_t{0};
  struct Slot {
    std::uint64_t cube;
    std::uint32_t number;
  };
  std::size_t mask_;
  std::vector<Slot> slots_;
};

/// A part of the mesh, its vertices numbered from 0.
struct Merged {
  std::vector<glm::vec3> vertices;
  std::vector<glm::uvec3> triangles;
};

Merged merged(const SceneFragment& fragment, float cell) {
  const std::size_t count = fragment.vertices.size() - 1;
  glm::vec3 low(std::numeric_limits<float>::infinity());
  for (std::size_t v = 0; v < count; ++v) low = glm::min(low, fragment.vertices[v]);
  Merged result;
  Cubes cubes(count);
  std::vector<float> members;  // of each cube
  std::vector<std::uint32_t> number(count);
  const float scale = 1.0f / cell;
  for (std::size_t v = 0; v < count; ++v) {
    const glm::vec3 at = scale * (fragment.vertices[v] - low);
    const std::uint64_t cube = static_cast<std::uint64_t>(at.x) |
                               static_cast<std::uint64_t>(at.y) << 20 |
                               static_cast<std::uint64_t>(at.z) << 40;
    const std::uint32_t n = cubes.number(cube, static_cast<std::uint32_t>(members.size()));
    if (n == members.size()) {
      members.push_back(0.0f);
      result.vertices.emplace_back(0.0f);
    }
    members[n] += 1.0f;
    result.vertices[n] += fragment.vertices[v];
    number[v] = n;
  }
  for (std::size_t n = 0; n < members.size(); ++n) result.vertices[n] /= members[n];
  for (const glm::uvec3& t : fragment.triangles) {
    const glm::uvec3 corner(number[t.x], number[t.y], number[t.z]);
    if (corner.x != corner.y && corner.y != corner.z && corner.z != corner.x)
      result.triangles.push_back(corner);
  }
  return result;
}

}  // namespace

Occluders::Occluders(const Scene& scene, float cell) : cell_(cell) {
  std::vector<Merged> parts(scene.fragments.size());
  tbb::parallel_for(std::size_t{0}, parts.size(),
                    [&](std::size_t i) { parts[i] = merged(scene.fragments[i], cell); });
  for (Merged& part : parts) {
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    vertices_.insert(vertices_.end(), part.vertices.begin(), part.vertices.end());
    for (const glm::uvec3& t : part.triangles) triangles_.push_back(t + first);
    part = {};
  }
  vertices_.emplace_back(0.0f);
  embree_ = embreeScene(std::array{EmbreeMesh{vertices_, triangles_}}, EmbreeTree::quick);
}

float Occluders::free(glm::vec3 origin, glm::vec3 direction, float start) const {
  RTCRay ray;
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tnear = start, ray.tfar = std::numeric_limits<float>::infinity();
  ray.mask = ~0u, ray.flags = 0, ray.time = 0.0f;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(embree_.scene.get(), &context, &ray);
  return ray.tfar > 0.0f ? 1.0f : 0.0f;
}

}  // namespace sherd
