// Transfers the surface attributes of a mesh to surfaces near it.
//
// Embree's BVH finds candidate triangles in single precision with a margin; their distances are
// computed in double precision.  The result is the least pair (distance, triangle), so it depends
// neither on the BVH nor on its traversal order.
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

#include "appearance/weights.h"
#include "mesh/search/embree_error.h"
#include "mesh/search/nearest_on_triangle.h"
#include "mesh/vertex_normals.h"

namespace sherd {
namespace {

constexpr double kMargin = 1e-6;  // above the error of single precision for a mesh of size 2

// Distance penalties for normals, in longest edges of the query face: for a triangle with the
// opposite orientation; and a small one for a tilted triangle, which decides between two that share
// an edge.
constexpr double kWrongSide = 2.0, kTilt = 0.01;

void check(RTCDevice device) { checkEmbree(device, ErrorCode::internal, "appearance"); }

}  // namespace

// A closest-point query in the space of mesh_.
struct AttributeSource::Query {
  glm::dvec3 point{0.0};
  glm::dvec3 normal{0.0};
  double size = 0.0;                  // longest edge of the query face
  std::uint32_t chart = kNoTriangle;  // restricts the query to a chart; kNoTriangle: all
  double tilt = 0.0;                  // kTilt, or 0 for the normal of a vertex
};

struct AttributeSource::Nearest {
  const AttributeSource* source = nullptr;
  const Query* query = nullptr;
  std::uint32_t triangle = kNoTriangle;
  glm::dvec3 point{0.0};
  double distance =
      std::numeric_limits<double>::infinity();  // including the penalties for the normal

  void consider(std::uint32_t t) {
    if (query->chart != kNoTriangle && source->charts_.ids[t] != query->chart) return;
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

AttributeSource::AttributeSource(const TriangleMesh& mesh, bool findsTriangles)
    : attributes_(mesh.attributes), findsTriangles_(findsTriangles) {
  const Box box = bounds(mesh);
  center_ = 0.5 * (box.min + box.max);
  scale_ = 0.5 * longestSide(box);
  if (!(scale_ > 0.0)) scale_ = 1.0;
  mesh_.triangles = mesh.triangles;
  mesh_.vertices.reserve(mesh.vertices.size());
  for (const glm::dvec3& v : mesh.vertices) mesh_.vertices.push_back((v - center_) / scale_);
  vertices_.assign(mesh_.vertices.begin(), mesh_.vertices.end());
  vertices_.emplace_back(0.0f);
  const double sign = volume(mesh_) < 0.0 ? -1.0 : 1.0;
  normals_.reserve(mesh_.triangles.size());
  for (const glm::uvec3& t : mesh_.triangles) {
    const glm::dvec3& a = mesh_.vertices[t.x];
    normals_.push_back(sign *
                       unitOrZero(glm::cross(mesh_.vertices[t.y] - a, mesh_.vertices[t.z] - a)));
  }
  if (attributes_.hasOnlyNormals() && !findsTriangles) return;  // nothing is searched for
  if (!attributes_.hasOnlyNormals()) charts_ = charts(mesh);

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
  for (const std::uint32_t t : charts_.selfSeam) seamTriangles_.push_back(mesh_.triangles[t]);
  if (!seamTriangles_.empty()) seams_.reset(build(seamTriangles_));
  check(device_.get());
}

bool AttributeSource::visitTriangle(RTCPointQueryFunctionArguments* found) {
  Nearest& nearest = *static_cast<Nearest*>(found->userPtr);
  const double before = nearest.distance;
  nearest.consider(found->primID);
  if (nearest.distance == before) return false;
  found->query->radius = static_cast<float>(nearest.distance * (1.0 + kMargin) + kMargin);
  return true;
}

// `start` is a candidate that bounds the search, or has no triangle.
AttributeSource::Nearest AttributeSource::nearest(const Query& query, const Nearest& start) const {
  Nearest nearest{this, &query};
  if (start.triangle != kNoTriangle) nearest.consider(start.triangle);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery embreeQuery{};
  const glm::vec3 at(query.point);
  embreeQuery.x = at.x, embreeQuery.y = at.y, embreeQuery.z = at.z;
  embreeQuery.radius = static_cast<float>(nearest.distance * (1.0 + kMargin) + kMargin);
  rtcPointQuery(scene_.get(), &embreeQuery, &context, &visitTriangle, &nearest);
  return nearest;
}

// Returns the query for the triangle nearest to a face.
AttributeSource::Query AttributeSource::faceQuery(const TriangleMesh& mesh,
                                                  const glm::uvec3& t) const {
  const auto at = [&](std::uint32_t vertex) { return (mesh.vertices[vertex] - center_) / scale_; };
  const glm::dvec3 a = at(t.x), b = at(t.y), c = at(t.z);
  Query query;
  query.point = (a + b + c) / 3.0;
  query.normal = unitOrZero(glm::cross(b - a, c - a));
  query.size = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
  query.tilt = kTilt;
  return query;
}

//   guess  a triangle that is likely near, or kNoTriangle
AttributeSource::Nearest AttributeSource::nearestTo(const Query& face, std::uint32_t guess) const {
  return nearest(face, {this, nullptr, guess});
}

// Whether a triangle of charts_.selfSeam lies within reach.
bool AttributeSource::isNearSelfSeam(const glm::dvec3& point, double reach) const {
  if (!seams_) return false;
  bool found = false;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery embreeQuery{};
  const glm::vec3 at(point);
  embreeQuery.x = at.x, embreeQuery.y = at.y, embreeQuery.z = at.z;
  embreeQuery.radius = static_cast<float>(reach * (1.0 + kMargin) + kMargin);
  const auto markFound = [](RTCPointQueryFunctionArguments* hit) {
    *static_cast<bool*>(hit->userPtr) = true;
    hit->query->radius = 0.0f;
    return true;
  };
  rtcPointQuery(seams_.get(), &embreeQuery, &context, markFound, &found);
  return found;
}

// The triangles within reach of a point that are connected to the first one, which comes first.
std::vector<std::uint32_t> AttributeSource::patch(std::uint32_t triangle, const glm::dvec3& point,
                                                  double reach) const {
  std::vector<std::uint32_t> out{triangle};
  std::unordered_set<std::uint32_t> seen{triangle};
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (const std::uint32_t next : charts_.neighbors[out[i]]) {
      if (next == kNoTriangle || !seen.insert(next).second) continue;
      const glm::uvec3& t = mesh_.triangles[next];
      const std::vector<glm::dvec3>& v = mesh_.vertices;
      const glm::dvec3 offset = nearestOnTriangle(point, v[t.x], v[t.y], v[t.z]) - point;
      if (glm::length(offset) <= reach) out.push_back(next);
    }
  }
  return out;
}

// Interpolates the attributes at the point that was found.
void AttributeSource::setCorner(SurfaceAttributes& out, std::size_t triangle, std::size_t corner,
                                const Nearest& found) const {
  const glm::uvec3& t = mesh_.triangles[found.triangle];
  const glm::dvec3 weights =
      weightsAt(found.point, mesh_.vertices[t.x], mesh_.vertices[t.y], mesh_.vertices[t.z]);
  interpolate(out, triangle, corner, found.triangle, weights);
}

// Sets a corner from the corners of the source's triangle `from`.
void AttributeSource::interpolate(SurfaceAttributes& out, std::size_t triangle, std::size_t corner,
                                  std::uint32_t from, const glm::dvec3& weights) const {
  glm::dvec2 texcoord(0.0);
  glm::dvec3 color(0.5);  // so that truncation rounds
  for (std::size_t k = 0; k < 3; ++k) {
    const double weight = weights[static_cast<int>(k)];
    if (!out.texcoords.empty()) {
      texcoord += weight * glm::dvec2(attributes_.texcoords[from][k]);
    }
    if (!out.colors.empty()) color += weight * glm::dvec3(attributes_.colors[from][k]);
  }
  if (!out.texcoords.empty()) out.texcoords[triangle][corner] = glm::vec2(texcoord);
  if (!out.colors.empty()) out.colors[triangle][corner] = glm::u8vec3(color);
}

// One transfer.  Corners near a seam where a chart meets itself are found face by face; all others
// by one query for each vertex and chart.
class AttributeSource::Transfer {
 public:
  Transfer(const AttributeSource& source, const TriangleMesh& mesh, std::uint32_t inside)
      : source_(source), mesh_(mesh), normals_(mesh.vertices.size(), glm::dvec3(0.0)) {
    const std::size_t count = mesh.triangles.size();
    out_ = source.insideAttributes(count, inside);
    onlyMaterials_ = out_.texcoords.empty() && out_.colors.empty();
    for (std::uint32_t t = 0; t < count; ++t) {
      if (mesh.neighborOf(t) == 0) original_.push_back(t);
    }
    for (const std::uint32_t t : original_) {
      const Corners corners = cornersOf(mesh, mesh.triangles[t]);
      for (int k = 0; k < 3; ++k) {
        normals_[mesh.triangles[t][k]] +=
            corners.angle[static_cast<std::size_t>(k)] * corners.normal;
      }
    }
  }

  SurfaceAttributes run() && {
    faces_.resize(original_.size());
    // Consecutive faces are mostly adjacent, so the previous result is a good first candidate.
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, original_.size(), 256),
                      [&](const auto& range) {
                        std::uint32_t guess = kNoTriangle;
                        for (std::size_t i = range.begin(); i != range.end(); ++i)
                          guess = transferFace(i, guess);
                      });
    if (!onlyMaterials_) transferCorners();
    return std::move(out_);
  }

 private:
  struct Face {
    std::uint32_t nearest = kNoTriangle;
    double size = 0.0;
    bool done = false;  // its corners have their attributes already
  };

  struct Corner {
    std::uint32_t vertex, chart, face;
    std::uint8_t corner;
    auto key() const { return std::tie(vertex, chart, face, corner); }
    bool sameAs(const Corner& other) const {
      return vertex == other.vertex && chart == other.chart;
    }
  };

  glm::dvec3 sourcePosition(std::uint32_t vertex) const {
    return (mesh_.vertices[vertex] - source_.center_) / source_.scale_;
  }

  // Finds the triangle nearest to a face; returns it.
  std::uint32_t transferFace(std::size_t i, std::uint32_t guess) {
    const Query query = source_.faceQuery(mesh_, mesh_.triangles[original_[i]]);
    const Nearest found = source_.nearestTo(query, guess);
    if (!out_.material.empty()) {
      out_.material[original_[i]] = source_.attributes_.material[found.triangle];
    }
    // A corner lies within 2/3 of the longest edge of the centroid, and its closest point is about
    // as far from it as the centroid's is from the centroid.
    const double reach = 0.7 * query.size + 2.0 * glm::length(found.point - query.point);
    faces_[i] = {found.triangle, query.size,
                 onlyMaterials_ || source_.isNearSelfSeam(query.point, reach)};
    if (faces_[i].done && !onlyMaterials_) {
      setCornersOf(i, query.size, source_.patch(found.triangle, query.point, reach));
    }
    return found.triangle;
  }

  // Sets a face's corners from the nearest of some triangles.
  void setCornersOf(std::size_t i, double size, const std::vector<std::uint32_t>& near) {
    const glm::uvec3& t = mesh_.triangles[original_[i]];
    for (int k = 0; k < 3; ++k) {
      const Query corner{sourcePosition(t[k]), unitOrZero(normals_[t[k]]), size, kNoTriangle, 0.0};
      Nearest best{&source_, &corner};
      for (const std::uint32_t candidate : near) best.consider(candidate);
      source_.setCorner(out_, original_[i], static_cast<std::size_t>(k), best);
    }
  }

  // Returns the corners without attributes, those of one vertex and chart together.
  std::vector<Corner> remainingCorners() const {
    std::vector<Corner> corners;
    corners.reserve(3 * original_.size());
    for (std::uint32_t i = 0; i < original_.size(); ++i) {
      for (std::uint8_t k = 0; k < 3 && !faces_[i].done; ++k) {
        corners.push_back(
            {mesh_.triangles[original_[i]][k], source_.charts_.ids[faces_[i].nearest], i, k});
      }
    }
    std::sort(corners.begin(), corners.end(),
              [](const Corner& a, const Corner& b) { return a.key() < b.key(); });
    return corners;
  }

  void transferCorners() {
    const std::vector<Corner> corners = remainingCorners();
    std::vector<std::uint32_t> firsts;
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
      if (i == 0 || !corners[i].sameAs(corners[i - 1])) firsts.push_back(i);
    }
    tbb::parallel_for(std::size_t{0}, firsts.size(), [&](std::size_t group) {
      const std::size_t first = firsts[group];
      const std::size_t end = group + 1 < firsts.size() ? firsts[group + 1] : corners.size();
      setCorners(std::span(corners).subspan(first, end - first));
    });
  }

  // Sets corners of one vertex and chart by one query.
  void setCorners(std::span<const Corner> same) {
    const Corner& corner = same.front();
    Query query;
    query.point = sourcePosition(corner.vertex);
    query.normal = unitOrZero(normals_[corner.vertex]);
    for (const Corner& other : same) query.size = std::max(query.size, faces_[other.face].size);
    query.chart = corner.chart;
    const Nearest found = source_.nearest(query, {&source_, nullptr, faces_[corner.face].nearest});
    for (const Corner& other : same) {
      source_.setCorner(out_, original_[other.face], other.corner, found);
    }
  }

  const AttributeSource& source_;
  const TriangleMesh& mesh_;
  SurfaceAttributes out_;
  bool onlyMaterials_ = false;
  std::vector<std::uint32_t> original_;  // faces of the original surface
  std::vector<glm::dvec3> normals_;      // [vertices] of the original surface, weighted by angle
  std::vector<Face> faces_;              // [original_]
};

std::vector<std::uint32_t> AttributeSource::trianglesOf(const TriangleMesh& mesh) const {
  if (!mesh.source.empty()) return mesh.source;
  std::vector<std::uint32_t> out(mesh.triangles.size(), TriangleMesh::kNoSource);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, out.size(), 256), [&](const auto& range) {
    std::uint32_t guess = kNoTriangle;
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      if (mesh.neighborOf(t) != 0) continue;
      guess = nearestTo(faceQuery(mesh, mesh.triangles[t]), guess).triangle;
      out[t] = guess;
    }
  });
  return out;
}

SurfaceAttributes AttributeSource::insideAttributes(std::size_t triangles,
                                                    std::uint32_t inside) const {
  SurfaceAttributes out;
  if (!attributes_.texcoords.empty()) out.texcoords.resize(triangles);
  if (!attributes_.colors.empty()) {
    out.colors.assign(triangles, {kInsideColor, kInsideColor, kInsideColor});
  }
  if (!attributes_.material.empty()) out.material.assign(triangles, inside);
  return out;
}

SurfaceAttributes AttributeSource::transferTo(const TriangleMesh& mesh,
                                              std::uint32_t inside) const {
  if (!mesh.source.empty()) return fromSources(mesh, inside);
  if (attributes_.hasOnlyNormals()) return {};
  return Transfer(*this, mesh, inside).run();
}

}  // namespace sherd
