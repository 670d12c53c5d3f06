// A scene of triangles that Embree traces rays through.
#include "render/embree_scene.h"

#include <sherd/error.h>
#include <tbb/task_arena.h>

#include <limits>

#include "mesh/search/embree_error.h"

namespace sherd {
namespace {

void check(RTCDevice device) { checkEmbree(device, ErrorCode::output, "image"); }

void attach(const EmbreeScene& embree, const EmbreeMesh& mesh, unsigned id,
            RTCBuildQuality quality) {
  RTCGeometry geometry = rtcNewGeometry(embree.device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, quality);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             mesh.vertices.data(), 0, sizeof(glm::vec3), mesh.vertices.size() - 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                             mesh.triangles.data(), 0, sizeof(glm::uvec3), mesh.triangles.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(embree.scene.get(), geometry, id);
  rtcReleaseGeometry(geometry);
}

}  // namespace

EmbreeScene embreeScene(std::span<const EmbreeMesh> meshes, EmbreeTree tree) {
  EmbreeScene embree;
  // One thread builds the tree.  With more, the order within a leaf depends on their number, and so
  // does which of two triangles a ray through their common edge hits.  (Embree's own threads=1
  // throttles the whole process.)
  tbb::task_arena alone(1);
  alone.execute([&] {
    embree.device.reset(rtcNewDevice(nullptr));
    if (!embree.device) check(nullptr);
    embree.scene.reset(rtcNewScene(embree.device.get()));
    const bool isQuick = tree == EmbreeTree::quick;
    const RTCBuildQuality quality = isQuick ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
    rtcSetSceneBuildQuality(embree.scene.get(), quality);
    // Compact: two thirds of the memory, and faster to build.
    if (!isQuick)
      rtcSetSceneFlags(embree.scene.get(),
                       static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT));
    for (std::size_t i = 0; i < meshes.size(); ++i)
      attach(embree, meshes[i], static_cast<unsigned>(i), quality);
    rtcCommitScene(embree.scene.get());
    check(embree.device.get());
  });
  return embree;
}

RTCHit firstHit(RTCScene scene, glm::vec3 origin, glm::vec3 direction) {
  RTCRayHit ray;
  ray.ray.org_x = origin.x, ray.ray.org_y = origin.y, ray.ray.org_z = origin.z;
  ray.ray.dir_x = direction.x, ray.ray.dir_y = direction.y, ray.ray.dir_z = direction.z;
  ray.ray.tnear = 0.0f, ray.ray.tfar = std::numeric_limits<float>::infinity();
  ray.ray.mask = ~0u, ray.ray.flags = 0, ray.ray.time = 0.0f;
  ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
  return ray.hit;
}

}  // namespace sherd
