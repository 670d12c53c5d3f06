// Divides a mesh into planes: hierarchical clustering of its triangles.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <queue>
#include <tuple>

#include "base/cancel_flag.h"
#include "base/union_find.h"
#include "evaluate/cracks/crack_faces.h"
#include "mesh/plane_moments.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

constexpr std::size_t kCancelInterval = 1024;  // merges between checks for cancellation

// Costs are compared in steps of a part of the tolerance, and equal ones by area: in a flat region,
// where all costs are rounding errors, areas then grow evenly, and none has many neighbors.
constexpr double kCostSteps = 32.0;

// Meshes bend by some tenths of a voxel along the lines where cracks meet.  So a contact counts as
// one plane up to this multiple of the tolerance.
constexpr double kBentTolerance = 3.0;

/// A part of a plane, a number of triangles.
struct Cluster {
  PlaneMoments moments;
  glm::dvec3 normals{0.0};                 ///< sum of area normals
  std::vector<std::uint32_t> neighbors{};  ///< clusters, also merged ones
  double unevenness = 0.0;                 ///< mean square distance from its plane
  bool isContact = false;                  ///< began as a whole contact
  std::uint32_t version = 0;               ///< number of merges
};

/// A possible merge of two clusters.
struct Merge {
  int cost = 0;
  double area = 0.0;
  std::uint32_t a = 0, b = 0;
  std::uint32_t versionA = 0, versionB = 0;

  bool operator>(const Merge& other) const {
    return std::tie(cost, area, a, b, versionA, versionB) >
           std::tie(other.cost, other.area, other.a, other.b, other.versionA, other.versionB);
  }
};

/// Returns the moments of each triangle, about the middle of the mesh.
std::vector<PlaneMoments> momentsOf(const TriangleMesh& mesh) {
  const Box box = bounds(mesh);
  const glm::dvec3 center = 0.5 * (box.min + box.max);
  std::vector<PlaneMoments> moments(mesh.triangles.size());
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    moments[i].add(
        {mesh.vertices[t.x] - center, mesh.vertices[t.y] - center, mesh.vertices[t.z] - center});
  }
  return moments;
}

class Clustering {
 public:
  Clustering(const TriangleMesh& mesh, std::span<const SharedEdge> edges,
             std::span<const std::uint16_t> contact, const PlaneLimits& limits)
      : limits_(limits), clusters_(mesh.triangles.size()), sets_(mesh.triangles.size()) {
    std::vector<PlaneMoments> moments = momentsOf(mesh);
    if (limits.beginWithContacts) unitePlanarContacts(edges, contact, moments);
    for (std::uint32_t i = 0; i < clusters_.size(); ++i) {
      Cluster& cluster = clusters_[sets_.find(i)];
      cluster.moments.add(moments[i]);
      const glm::uvec3& t = mesh.triangles[i];
      cluster.normals += areaNormal({mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]});
    }
    for (const SharedEdge& e : edges) {
      if ((contact[e.a] == 0) != (contact[e.b] == 0)) continue;
      const std::uint32_t a = sets_.find(e.a), b = sets_.find(e.b);
      if (a == b) continue;
      clusters_[a].neighbors.push_back(b);
      clusters_[b].neighbors.push_back(a);
    }
    for (Cluster& cluster : clusters_) setUnevenness(cluster);
    for (std::uint32_t i = 0; i < clusters_.size(); ++i) propose(i, /*all=*/false);
  }

  void run(const Progress* progress) {
    for (std::size_t merges = 0; !queue_.empty();) {
      const Merge merge = queue_.top();
      queue_.pop();
      if (merge.versionA != clusters_[merge.a].version ||
          merge.versionB != clusters_[merge.b].version) {
        continue;
      }
      if (merges++ % kCancelInterval == 0) throwIfCancelled(progress);
      apply(merge);
    }
  }

  std::vector<std::uint32_t> sets() && { return std::move(sets_).all(); }

 private:
  /// Makes one cluster of each contact that lies in one plane.
  void unitePlanarContacts(std::span<const SharedEdge> edges,
                           std::span<const std::uint16_t> contact,
                           const std::vector<PlaneMoments>& moments) {
    UnionFind contacts(contact.size());
    for (const SharedEdge& e : edges) {
      if (contact[e.a] == contact[e.b] && contact[e.a] != 0) contacts.unite(e.a, e.b);
    }
    std::vector<PlaneMoments> sums(contact.size());
    for (std::uint32_t i = 0; i < contact.size(); ++i) sums[contacts.find(i)].add(moments[i]);
    const double most = std::pow(kBentTolerance * limits_.tolerance, 2.0);
    std::vector<char> planar(contact.size());
    for (std::uint32_t i = 0; i < contact.size(); ++i) {
      planar[i] =
          contact[i] != 0 && contacts.find(i) == i && sums[i].meanSquare(sums[i].plane()) <= most;
    }
    for (std::uint32_t i = 0; i < contact.size(); ++i) {
      clusters_[i].isContact = planar[i];
      if (planar[contacts.find(i)]) sets_.unite(contacts.find(i), i);
    }
  }

  /// Returns by how much two clusters are farther from their common plane than from their own ones,
  /// in steps: the larger root of the difference of mean squares.  So the unevenness of each does
  /// not count, up to its limit.  Returns, after all of these, the distance of the smaller one from
  /// the larger one's plane if it began as triangles; or -1 if they are not to be merged.
  int costOf(const Cluster& a, const Cluster& b) const {
    const auto& [small, large] = a.moments.area < b.moments.area ? std::tie(a, b) : std::tie(b, a);
    if (small.moments.area >= limits_.leastArea &&
        glm::dot(a.normals, b.normals) < 0.5 * glm::length(a.normals) * glm::length(b.normals)) {
      return -1;
    }
    PlaneMoments both = a.moments;
    both.add(b.moments);
    const FittedPlane plane = both.plane();
    const double fromA = a.moments.meanSquare(plane), fromB = b.moments.meanSquare(plane);
    const double limit = kBentTolerance * kBentTolerance * limits_.tolerance * limits_.tolerance;
    const double more = std::sqrt(std::max({0.0, fromA - a.unevenness, fromB - b.unevenness}));
    if (std::max(fromA, fromB) <= limit && more <= limits_.tolerance) {
      return static_cast<int>(more / limits_.tolerance * kCostSteps);
    }
    if (small.isContact) return -1;
    const double strip = small.moments.meanSquare(large.moments.plane());
    if (strip > limit) return -1;
    return static_cast<int>((1.0 + std::sqrt(strip) / limits_.tolerance) * kCostSteps);
  }

  static void setUnevenness(Cluster& cluster) {
    cluster.unevenness = cluster.moments.meanSquare(cluster.moments.plane());
  }

  void propose(std::uint32_t i, bool all) {
    Cluster& cluster = clusters_[i];
    for (std::uint32_t& other : cluster.neighbors) other = sets_.find(other);
    std::sort(cluster.neighbors.begin(), cluster.neighbors.end());
    cluster.neighbors.erase(std::unique(cluster.neighbors.begin(), cluster.neighbors.end()),
                            cluster.neighbors.end());
    std::erase(cluster.neighbors, i);
    for (const std::uint32_t j : cluster.neighbors) {
      if (!all && j < i) continue;  // at the start each pair is proposed once
      const Cluster& other = clusters_[j];
      const int cost = costOf(cluster, other);
      if (cost < 0) continue;
      queue_.push({cost, cluster.moments.area + other.moments.area, std::min(i, j), std::max(i, j),
                   clusters_[std::min(i, j)].version, clusters_[std::max(i, j)].version});
    }
  }

  void apply(const Merge& merge) {
    sets_.unite(merge.a, merge.b);
    Cluster& into = clusters_[merge.a];  // the lower number, as in UnionFind
    Cluster& from = clusters_[merge.b];
    into.moments.add(from.moments);
    setUnevenness(into);
    into.normals += from.normals;
    into.isContact |= from.isContact;
    into.neighbors.insert(into.neighbors.end(), from.neighbors.begin(), from.neighbors.end());
    from.neighbors = {};
    ++into.version;
    ++from.version;
    propose(merge.a, /*all=*/true);
  }

  PlaneLimits limits_;
  std::vector<Cluster> clusters_;
  UnionFind sets_;
  std::priority_queue<Merge, std::vector<Merge>, std::greater<>> queue_;
};

}  // namespace

Areas planarAreas(const TriangleMesh& mesh, std::span<const SharedEdge> edges,
                  std::span<const std::uint16_t> contact, const PlaneLimits& limits,
                  const Progress* progress) {
  Clustering clustering(mesh, edges, contact, limits);
  clustering.run(progress);
  std::vector<std::uint32_t> group;
  for (const std::uint16_t id : contact) group.push_back(id != 0);
  Areas areas = areasOf(mesh, std::move(clustering).sets(), group);
  std::vector<glm::dvec3> normals(areas.size.size(), glm::dvec3(0.0));
  for (std::size_t i = 0; i < contact.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    normals[areas.ofTriangle[i]] +=
        areaNormal({mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]});
  }
  for (std::size_t i = 0; i < normals.size(); ++i) areas.size[i] = 0.5 * glm::length(normals[i]);
  return areas;
}

}  // namespace sherd
