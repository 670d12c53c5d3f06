// Point-in-mesh test by ray casting.
#include "mesh/search/inside.h"

#include <sherd/error.h>
#include <tbb/task_arena.h>

#include <limits>
#include <string>

#include "mesh/search/embree_error.h"

namespace sherd {
namespace {

/// Three unit directions that are unlikely to be parallel to a face or edge of a model.
constexpr glm::vec3 kDirections[3] = {
    {0.6743f, 0.5291f, 0.5151f}, {-0.3709f, 0.8117f, -0.4512f}, {0.1933f, -0.4621f, -0.8655f}};

/// A ray's context, and the number of its exits from the mesh minus that of its entries.
struct Crossings {
  RTCIntersectContext context;  // first, because Embree passes its address to the filter
  int outwards = 0;
};

/// Counts a hit and rejects it, so that the ray continues.
void countHit(const RTCFilterFunctionNArguments* hit) {
  const unsigned n = hit->N;  // 1
  if (!hit->valid[0]) return;
  const float rate = RTCHitN_Ng_x(hit->hit, n, 0) * RTCRayN_dir_x(hit->ray, n, 0) +
                     RTCHitN_Ng_y(hit->hit, n, 0) * RTCRayN_dir_y(hit->ray, n, 0) +
                     RTCHitN_Ng_z(hit->hit, n, 0) * RTCRayN_dir_z(hit->ray, n, 0);
  reinterpret_cast<Crossings*>(hit->context)->outwards += rate > 0.0f ? 1 : -1;
  hit->valid[0] = 0;
}

void check(RTCDevice device) { checkEmbree(device, ErrorCode::internal, "inside test"); }

}  // namespace

InsideTest::InsideTest(const TriangleMesh& mesh)
    : vertices_(mesh.vertices.begin(), mesh.vertices.end()), triangles_(mesh.triangles) {
  vertices_.emplace_back(0.0f);
  device_.reset(rtcNewDevice(nullptr));
  if (!device_) check(nullptr);
  scene_.reset(rtcNewScene(device_.get()));
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             vertices_.data(), 0, sizeof(glm::vec3), mesh.vertices.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                             triangles_.data(), 0, sizeof(glm::uvec3), triangles_.size());
  rtcSetGeometryIntersectFilterFunction(geometry, &countHit);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_.get(), geometry);
  rtcReleaseGeometry(geometry);
  // Built by one thread, as in src/render/scene.cpp, so that the tree is the same on every machine.
  tbb::task_arena oneThread(1);
  oneThread.execute([&] { rtcCommitScene(scene_.get()); });
  check(device_.get());
}

bool InsideTest::windsAlong(const glm::vec3& origin, const glm::vec3& direction) const {
  Crossings crossings;
  rtcInitIntersectContext(&crossings.context);
  RTCRayHit hit{};
  hit.ray.org_x = origin.x, hit.ray.org_y = origin.y, hit.ray.org_z = origin.z;
  hit.ray.dir_x = direction.x, hit.ray.dir_y = direction.y, hit.ray.dir_z = direction.z;
  hit.ray.tfar = std::numeric_limits<float>::infinity();
  hit.ray.mask = ~0u;
  hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_.get(), &crossings.context, &hit);
  return crossings.outwards > 0;
}

// A ray through an edge counts both triangles; two of three rays seldom hit one.
bool InsideTest::contains(const glm::dvec3& point) const {
  const glm::vec3 origin(point);
  const bool first = windsAlong(origin, kDirections[0]);
  const bool second = windsAlong(origin, kDirections[1]);
  return first == second ? first : windsAlong(origin, kDirections[2]);
}

std::optional<bool> InsideTest::unanimous(const glm::dvec3& point) const {
  const glm::vec3 origin(point);
  const bool first = windsAlong(origin, kDirections[0]);
  for (int k = 1; k < 3; ++k) {
    if (windsAlong(origin, kDirections[k]) != first) return {};
  }
  return first;
}

}  // namespace sherd
