// Carries the look of a mesh over to surfaces that lie near it.
//
// Embree's tree finds the triangles that may be nearest, in single precision with a margin; how far
// each is, is told in double precision.  The least (distance, triangle) is taken as a pair, so the
// answer depends neither on the tree nor on the order in which it is walked.
#include "appearance/transfer.h"

#include <sherd/error.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>
#include <unordered_set>

#include "mesh/embree_error.h"
#include "mesh/nearest_on_triangle.h"
#include "mesh/vertex_normals.h"

namespace sherd {
namespace {

constexpr double kMargin = 1e-6;  // more than single precision can err where the mesh is 2 long

// How much farther away a triangle counts for its normal, in longest edges of the asking face:
// twice for one that looks the other way; and next to nothing for one that is tilted, to choose
// between two that meet in an edge.
constexpr double kWrongSide = 2.0, kTilt = 0.01;

void check(RTCDevice device) { checkEmbree(device, ErrorCode::internal, "appearance"); }

// Weights of a triangle's corners at a point of it; those of a triangle without area go to the
// corner that is nearest.
glm::dvec3 weightsAt(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                     const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
  const double bb = glm::dot(ab, ab), bc = glm::dot(ab, ac), cc = glm::dot(ac, ac);
  const double determinant = bb * cc - bc * bc;
  if (!(determinant > 1e-12 * bb * cc)) {
    const glm::dvec3 bp = p - b, cp = p - c;
    const double toA = glm::dot(ap, ap), toB = glm::dot(bp, bp), toC = glm::dot(cp, cp);
    if (toA <= toB && toA <= toC) return {1.0, 0.0, 0.0};
    return toB <= toC ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
  }
  const double pb = glm::dot(ap, ab), pc = glm::dot(ap, ac);
  const double v = std::clamp((cc * pb - bc * pc) / determinant, 0.0, 1.0);
  const double w = std::clamp((bb * pc - bc * pb) / determinant, 0.0, 1.0 - v);
  return {1.0 - v - w, v, w};
}

}  // namespace

// What is asked: in the space of mesh_.
struct LookSource::Query {
  glm::dvec3 point{0.0};
  glm::dvec3 normal{0.0};
  double size = 0.0;                  // the longest edge of the face that asks
  std::uint32_t chart = kNoTriangle;  // the only chart that counts; kNoTriangle: all
  double tilt = 0.0;                  // kTilt, or 0 where the normal is that of a vertex
};

struct LookSource::Nearest {
  const LookSource* source = nullptr;
  const Query* query = nullptr;
  std::uint32_t triangle = kNoTriangle;
  glm::dvec3 point{0.0};
  double distance = std::numeric_limits<double>::infinity();  // with what the normal adds

  void consider(std::uint32_t t) {
    if (query->chart != kNoTriangle && source->charts_.of[t] != query->chart) return;
    const glm::uvec3& corners = source->mesh_.triangles[t];
    const std::vector<glm::dvec3>& v = source->mesh_.vertices;
    const glm::dvec3 at = nearestOnTriangle(query->point, v[corners.x], v[corners.y], v[corners.z]);
    const double agreement = glm::dot(source->normals_[t], query->normal);
    const double far =
        glm::length(at - query->point) +
        query->size * ((agreement > 0.0 ? 0.0 : kWrongSide) + query->tilt * (1.0 - agreement));
    if (far > distance || (far == distance && t >= triangle)) return;
    distance = far;
    triangle = t;
    point = at;
  }
};

LookSource::LookSource(const TriangleMesh& mesh, const SurfaceLook& look) : look_(look) {
  const Box box = bounds(mesh);
  middle_ = 0.5 * (box.min + box.max);
  scale_ = 0.5 * longestSide(box);
  if (!(scale_ > 0.0)) scale_ = 1.0;
  mesh_.triangles = mesh.triangles;
  mesh_.vertices.reserve(mesh.vertices.size());
  for (const glm::dvec3& v : mesh.vertices) mesh_.vertices.push_back((v - middle_) / scale_);
  vertices_.assign(mesh_.vertices.begin(), mesh_.vertices.end());
  vertices_.emplace_back(0.0f);
  const double sign = volume(mesh_) < 0.0 ? -1.0 : 1.0;
  normals_.reserve(mesh_.triangles.size());
  for (const glm::uvec3& t : mesh_.triangles) {
    const glm::dvec3& a = mesh_.vertices[t.x];
    normals_.push_back(sign *
                       unitOrZero(glm::cross(mesh_.vertices[t.y] - a, mesh_.vertices[t.z] - a)));
  }
  charts_ = charts(mesh, look);

  device_.reset(rtcNewDevice(nullptr));
  if (!device_) check(nullptr);
  const auto build = [&](const std::vector<glm::uvec3>& triangles) {
    RTCScene scene = rtcNewScene(device_.get());
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               vertices_.data(), 0, sizeof(glm::vec3), mesh_.vertices.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               triangles.data(), 0, sizeof(glm::uvec3), triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
  };
  scene_.reset(build(mesh_.triangles));
  for (const std::uint32_t t : charts_.ownSeam) seamTriangles_.push_back(mesh_.triangles[t]);
  if (!seamTriangles_.empty()) seams_.reset(build(seamTriangles_));
  check(device_.get());
}

bool LookSource::lookAt(RTCPointQueryFunctionArguments* found) {
  Nearest& nearest = *static_cast<Nearest*>(found->userPtr);
  const double before = nearest.distance;
  nearest.consider(found->primID);
  if (nearest.distance == before) return false;
  found->query->radius = static_cast<float>(nearest.distance * (1.0 + kMargin) + kMargin);
  return true;
}

// `start` is an answer already, or none; the search goes no farther than it.
LookSource::Nearest LookSource::nearest(const Query& query, const Nearest& start) const {
  Nearest nearest{this, &query};
  if (start.triangle != kNoTriangle) nearest.consider(start.triangle);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery asked{};
  const glm::vec3 at(query.point);
  asked.x = at.x, asked.y = at.y, asked.z = at.z;
  asked.radius = static_cast<float>(nearest.distance * (1.0 + kMargin) + kMargin);
  rtcPointQuery(scene_.get(), &asked, &context, &lookAt, &nearest);
  return nearest;
}

// Whether a triangle at a seam where a chart meets itself comes that near.
bool LookSource::isNearOwnSeam(const glm::dvec3& point, double reach) const {
  if (!seams_) return false;
  bool found = false;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery asked{};
  const glm::vec3 at(point);
  asked.x = at.x, asked.y = at.y, asked.z = at.z;
  asked.radius = static_cast<float>(reach * (1.0 + kMargin) + kMargin);
  const auto note = [](RTCPointQueryFunctionArguments* hit) {
    *static_cast<bool*>(hit->userPtr) = true;
    hit->query->radius = 0.0f;
    return true;
  };
  rtcPointQuery(seams_.get(), &asked, &context, note, &found);
  return found;
}

// The triangles that hang together with one of them within reach of a point, it first.
std::vector<std::uint32_t> LookSource::patch(std::uint32_t triangle, const glm::dvec3& point,
                                             double reach) const {
  std::vector<std::uint32_t> out{triangle};
  std::unordered_set<std::uint32_t> seen{triangle};
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (const std::uint32_t next : charts_.beyond[out[i]]) {
      if (next == kNoTriangle || !seen.insert(next).second) continue;
      const glm::uvec3& t = mesh_.triangles[next];
      const std::vector<glm::dvec3>& v = mesh_.vertices;
      const glm::dvec3 apart = nearestOnTriangle(point, v[t.x], v[t.y], v[t.z]) - point;
      if (glm::length(apart) <= reach) out.push_back(next);
    }
  }
  return out;
}

// A corner takes the look of the point that was found.
void LookSource::setCorner(SurfaceLook& out, std::size_t triangle, std::size_t corner,
                           const Nearest& found) const {
  const glm::uvec3& t = mesh_.triangles[found.triangle];
  const glm::dvec3 weights =
      weightsAt(found.point, mesh_.vertices[t.x], mesh_.vertices[t.y], mesh_.vertices[t.z]);
  glm::dvec2 texcoord(0.0);
  glm::dvec3 colour(0.5);  // rounds
  for (std::size_t k = 0; k < 3; ++k) {
    const double weight = weights[static_cast<int>(k)];
    if (!out.texcoords.empty()) {
      texcoord += weight * glm::dvec2(look_.texcoords[found.triangle][k]);
    }
    if (!out.colours.empty()) colour += weight * glm::dvec3(look_.colours[found.triangle][k]);
  }
  if (!out.texcoords.empty()) out.texcoords[triangle][corner] = glm::vec2(texcoord);
  if (!out.colours.empty()) out.colours[triangle][corner] = glm::u8vec3(colour);
}

SurfaceLook LookSource::on(const TriangleMesh& mesh, std::span<const std::uint16_t> facing,
                           std::uint32_t inside) const {
  const std::size_t count = mesh.triangles.size();
  SurfaceLook out;
  if (!look_.texcoords.empty()) out.texcoords.resize(count);
  if (!look_.colours.empty()) {
    out.colours.assign(count, {kInsideColour, kInsideColour, kInsideColour});
  }
  if (!look_.material.empty()) out.material.assign(count, inside);

  std::vector<std::uint32_t> original;
  for (std::uint32_t t = 0; t < count; ++t) {
    if (facing[t] == 0) original.push_back(t);
  }
  const auto own = [&](std::uint32_t vertex) { return (mesh.vertices[vertex] - middle_) / scale_; };

  // The normals of vertices, as the original surface alone has them.
  std::vector<glm::dvec3> normals(mesh.vertices.size(), glm::dvec3(0.0));
  for (const std::uint32_t t : original) {
    const Corners corners = cornersOf(mesh, mesh.triangles[t]);
    for (int k = 0; k < 3; ++k) {
      normals[mesh.triangles[t][k]] += corners.angle[static_cast<std::size_t>(k)] * corners.normal;
    }
  }

  struct Face {
    std::uint32_t nearest = kNoTriangle;
    double size = 0.0;
    bool done = false;  // its corners were asked for one by one
  };
  const bool onlyMaterials = out.texcoords.empty() && out.colours.empty();
  std::vector<Face> faces(original.size());
  const auto lookUp = [&](std::size_t i, std::uint32_t guess) {
    const glm::uvec3& t = mesh.triangles[original[i]];
    const glm::dvec3 a = own(t.x), b = own(t.y), c = own(t.z);
    Query query;
    query.point = (a + b + c) / 3.0;
    query.normal = unitOrZero(glm::cross(b - a, c - a));
    query.size = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
    query.tilt = kTilt;
    const Nearest found = nearest(query, {this, nullptr, guess});
    if (!out.material.empty()) out.material[original[i]] = look_.material[found.triangle];
    // A corner is within two thirds of the longest edge, and what is nearest to it about as far
    // from it as the centroid's is from the centroid.
    const double reach = 0.7 * query.size + 2.0 * glm::length(found.point - query.point);
    faces[i] = {found.triangle, query.size, onlyMaterials || isNearOwnSeam(query.point, reach)};
    if (!faces[i].done || onlyMaterials) return found.triangle;
    const std::vector<std::uint32_t> near = patch(found.triangle, query.point, reach);
    for (int k = 0; k < 3; ++k) {
      const Query corner{own(t[k]), unitOrZero(normals[t[k]]), query.size, kNoTriangle, 0.0};
      Nearest best{this, &corner};
      for (const std::uint32_t candidate : near) best.consider(candidate);
      setCorner(out, original[i], static_cast<std::size_t>(k), best);
    }
    return found.triangle;
  };
  // A face lies beside the one before it, mostly, and so does what is nearest to it.
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, original.size(), 256),
                    [&](const auto& range) {
                      std::uint32_t guess = kNoTriangle;
                      for (std::size_t i = range.begin(); i != range.end(); ++i)
                        guess = lookUp(i, guess);
                    });
  if (onlyMaterials) return out;

  // Corners of one vertex in one chart are the same: asked for once.
  struct Corner {
    std::uint32_t vertex, chart, face;
    std::uint8_t corner;
    auto key() const { return std::tie(vertex, chart, face, corner); }
    bool sameAs(const Corner& other) const {
      return vertex == other.vertex && chart == other.chart;
    }
  };
  std::vector<Corner> corners;
  corners.reserve(3 * original.size());
  for (std::uint32_t i = 0; i < original.size(); ++i) {
    for (std::uint8_t k = 0; k < 3 && !faces[i].done; ++k) {
      corners.push_back({mesh.triangles[original[i]][k], charts_.of[faces[i].nearest], i, k});
    }
  }
  std::sort(corners.begin(), corners.end(),
            [](const Corner& a, const Corner& b) { return a.key() < b.key(); });
  std::vector<std::uint32_t> firsts;
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    if (i == 0 || !corners[i].sameAs(corners[i - 1])) firsts.push_back(i);
  }
  tbb::parallel_for(std::size_t{0}, firsts.size(), [&](std::size_t group) {
    const std::size_t first = firsts[group];
    const std::size_t end = group + 1 < firsts.size() ? firsts[group + 1] : corners.size();
    const Corner& corner = corners[first];
    Query query;
    query.point = own(corner.vertex);
    query.normal = unitOrZero(normals[corner.vertex]);
    for (std::size_t i = first; i < end; ++i) {
      query.size = std::max(query.size, faces[corners[i].face].size);
    }
    query.chart = corner.chart;
    const Nearest found = nearest(query, {this, nullptr, faces[corner.face].nearest});
    for (std::size_t i = first; i < end; ++i) {
      setCorner(out, original[corners[i].face], corners[i].corner, found);
    }
  });
  return out;
}

}  // namespace sherd
