// What the centres of a picture's pixels see.
#include "render/layers.h"

#include <tbb/parallel_for.h>

#include <glm/geometric.hpp>
#include <limits>

namespace sherd {
namespace {

struct Centres {
  std::span<const Fragment> fragments;
  const Scene& scene;
  const Camera& camera;
  char up;
  Layers& layers;

  void trace(int x, int y) const {
    const glm::vec3 d =
        camera.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    RTCRayHit ray;
    ray.ray.org_x = camera.eye.x, ray.ray.org_y = camera.eye.y, ray.ray.org_z = camera.eye.z;
    ray.ray.dir_x = d.x, ray.ray.dir_y = d.y, ray.ray.dir_z = d.z;
    ray.ray.tnear = 0.0f, ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0u, ray.ray.flags = 0, ray.ray.time = 0.0f;
    ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene.embree.get(), &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
    see(static_cast<std::size_t>(y) * static_cast<std::size_t>(layers.width) +
            static_cast<std::size_t>(x),
        ray.hit, d);
  }

  void see(std::size_t at, const RTCHit& hit, const glm::vec3& ray) const {
    const Fragment& fragment = fragments[hit.geomID];
    const Piece& piece = scene.pieces[hit.geomID];
    const float u = hit.u, v = hit.v, w = 1.0f - u - v;
    const glm::uvec3& t = piece.triangles[hit.primID];
    const std::vector<glm::dvec3>& vertices = fragment.mesh.vertices;
    layers.position[at] = glm::vec3(double{w} * vertices[t.x] + double{u} * vertices[t.y] +
                                    double{v} * vertices[t.z] + scene.shifts[hit.geomID]);
    const glm::vec3 inScene =
        w * piece.vertices[t.x] + u * piece.vertices[t.y] + v * piece.vertices[t.z];
    layers.depth[at] =
        static_cast<float>(scene.size * double{glm::dot(camera.eye - inScene, camera.back)});
    glm::vec3 normal = piece.normalAt(hit.primID, u, v);
    if (glm::dot(normal, ray) > 0.0f) normal = -normal;
    layers.normal[at] = worldDirection(normal, up);
    layers.fragment[at] = static_cast<std::uint32_t>(fragment.id);
    layers.facing[at] = fragment.facing.empty() ? 0u : fragment.facing[hit.primID];
  }
};

}  // namespace

void traceCentres(std::span<const Fragment> fragments, const Scene& scene, const Camera& camera,
                  char up, Layers& layers) {
  const std::size_t pixels =
      static_cast<std::size_t>(layers.width) * static_cast<std::size_t>(layers.height);
  layers.depth.assign(pixels, std::numeric_limits<float>::infinity());
  layers.normal.assign(pixels, glm::vec3(0.0f));
  layers.position.assign(pixels, glm::vec3(0.0f));
  layers.fragment.assign(pixels, 0);
  layers.facing.assign(pixels, 0);
  const Centres centres{fragments, scene, camera, up, layers};
  tbb::parallel_for(0, layers.height, [&](int y) {
    for (int x = 0; x < layers.width; ++x) centres.trace(x, y);
  });
}

}  // namespace sherd
