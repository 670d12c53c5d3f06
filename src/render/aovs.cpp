// AOVs at pixel centers, one ray each.
#include "render/aovs.h"

#include <tbb/parallel_for.h>

#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "render/embree_scene.h"

namespace sherd {
namespace {

struct Centers {
  std::span<const Fragment> fragments;
  const Scene& scene;
  RTCScene embree;
  const Camera& camera;
  char up;
  Aovs& aovs;

  void trace(int x, int y) const {
    const glm::vec3 d =
        camera.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    const RTCHit hit = firstHit(embree, camera.eye, d);
    if (hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
    store(static_cast<std::size_t>(y) * static_cast<std::size_t>(aovs.width) +
              static_cast<std::size_t>(x),
          hit, d);
  }

  void store(std::size_t pixel, const RTCHit& hit, const glm::vec3& ray) const {
    const Fragment& fragment = fragments[hit.geomID];
    const SceneFragment& traced = scene.fragments[hit.geomID];
    const float u = hit.u, v = hit.v, w = 1.0f - u - v;
    const glm::uvec3& t = traced.triangles[hit.primID];
    const std::vector<glm::dvec3>& vertices = fragment.mesh.vertices;
    aovs.position[pixel] = glm::vec3(double{w} * vertices[t.x] + double{u} * vertices[t.y] +
                                     double{v} * vertices[t.z] + scene.shifts[hit.geomID]);
    const glm::vec3 inScene =
        w * traced.vertices[t.x] + u * traced.vertices[t.y] + v * traced.vertices[t.z];
    aovs.depth[pixel] =
        static_cast<float>(scene.size * double{glm::dot(camera.eye - inScene, camera.back)});
    glm::vec3 normal = traced.normalAt(hit.primID, u, v);
    if (glm::dot(normal, ray) > 0.0f) normal = -normal;
    aovs.normal[pixel] = worldDirection(normal, up);
    aovs.fragment[pixel] = static_cast<std::uint32_t>(fragment.id);
    aovs.neighbor[pixel] = fragment.mesh.neighborOf(hit.primID);
  }
};

}  // namespace

void traceCenters(std::span<const Fragment> fragments, const Scene& scene, const Camera& camera,
                  char up, Aovs& aovs) {
  const std::size_t pixels =
      static_cast<std::size_t>(aovs.width) * static_cast<std::size_t>(aovs.height);
  aovs.depth.assign(pixels, std::numeric_limits<float>::infinity());
  aovs.normal.assign(pixels, glm::vec3(0.0f));
  aovs.position.assign(pixels, glm::vec3(0.0f));
  aovs.fragment.assign(pixels, 0);
  aovs.neighbor.assign(pixels, 0);
  std::vector<EmbreeMesh> meshes;
  for (const SceneFragment& fragment : scene.fragments)
    meshes.push_back({fragment.vertices, fragment.triangles});
  const EmbreeScene embree = embreeScene(meshes, EmbreeTree::exact);
  const Centers centers{fragments, scene, embree.scene.get(), camera, up, aovs};
  tbb::parallel_for(0, aovs.height, [&](int y) {
    for (int x = 0; x < aovs.width; ++x) centers.trace(x, y);
  });
}

}  // namespace sherd
