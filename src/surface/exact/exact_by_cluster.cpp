// Cuts clusters of bodies one by one.
#include "surface/exact/exact_by_cluster.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/cancel_flag.h"
#include "mesh/positions.h"
#include "remesh/bodies.h"
#include "remesh/parts/close_mesh.h"

namespace sherd {
namespace {

// What is cut of all clusters, one after the other.
class Assembled {
 public:
  Assembled(const Solid& solid, const SolidMesh& closed, std::size_t fragments)
      : solid_(solid), closed_(closed) {
    all_.meshes.resize(fragments);
  }

  // Takes the meshes of a cluster, unless one of its fragments has none.
  void add(const BodyCluster& cluster, const Solid& part, ExactSurface surface,
           const Progress* progress) {
    for (const std::uint16_t label : cluster.fragments) {
      if (!surface.failure.empty()) break;
      if (!surface.meshes[label - 1u].mesh.triangles.empty()) continue;
      surface.failure = "the cracks leave nothing of fragment " + std::to_string(label);
    }
    UnitedBodies& united = all_.united;
    const bool isCut = surface.failure.empty();
    if (isCut && surface.united.before > 0) {
      united.before += surface.united.before;
      united.after += surface.united.after;
    } else {
      const std::size_t bodies = bodiesIn(*part.mesh, progress);
      united.before += bodies;
      united.after += bodies;
    }
    if (!isCut) {
      isChanged_ |= addFailed(cluster, std::move(surface.failure));
      return;
    }
    isUnited_ |= surface.united.before > 0;
    isChanged_ |= surface.united.mesh != nullptr;
    addMesh(surface.united.mesh ? *surface.united.mesh : *part.mesh);
    united.closed.holes += surface.united.closed.holes;
    united.closed.faces += surface.united.closed.faces;
    united.closed.area += surface.united.closed.area;
    united.loose += surface.united.loose;
    std::move(surface.moved.begin(), surface.moved.end(), std::back_inserter(all_.moved));
    for (const std::uint16_t label : cluster.fragments) {
      all_.meshes[label - 1u] = std::move(surface.meshes[label - 1u]);
    }
  }

  ExactSurface finished() && {
    if (!isUnited_) all_.united.before = all_.united.after = 0;
    if (isChanged_ && !isShell(solid_)) {
      all_.united.mesh = std::make_shared<const SolidMesh>(std::move(mesh_));
    }
    setPositions(all_.meshes);
    return std::move(all_);
  }

 private:
  static std::size_t bodiesIn(const SolidMesh& mesh, const Progress* progress) {
    return std::max(bodiesOf(mesh.mesh, progress).size(), std::size_t{1});
  }

  void addMesh(const SolidMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(mesh_.mesh.vertices.size());
    mesh_.mesh.vertices.insert(mesh_.mesh.vertices.end(), mesh.mesh.vertices.begin(),
                               mesh.mesh.vertices.end());
    for (const glm::uvec3& t : mesh.mesh.triangles) mesh_.mesh.triangles.push_back(t + first);
    mesh_.source.insert(mesh_.source.end(), mesh.source.begin(), mesh.source.end());
  }

  // Returns whether faces close holes of the cluster.
  bool addFailed(const BodyCluster& cluster, std::string reason) {
    SmoothBodies failed{.reason = std::move(reason)};
    failed.fragments.assign(cluster.fragments.begin(), cluster.fragments.end());
    SolidMesh own{.mesh = {closed_.mesh.vertices, {}}, .source = {}};
    for (const std::uint32_t t : cluster.triangles) {
      own.mesh.triangles.push_back(closed_.mesh.triangles[t]);
      own.source.push_back(closed_.source[t]);
      if (own.source.back() != TriangleMesh::kNoSource)
        failed.triangles.push_back(own.source.back());
    }
    const bool isClosed = failed.triangles.size() < own.source.size();
    addMesh(own);
    std::sort(failed.triangles.begin(), failed.triangles.end());
    all_.smooth.push_back(std::move(failed));
    return isClosed;
  }

  const Solid& solid_;
  const SolidMesh& closed_;
  ExactSurface all_;
  SolidMesh mesh_;  // of all clusters
  bool isUnited_ = false, isChanged_ = false;
};

// Leaves out the faces that close holes.
std::vector<BodyCluster> ofInput(std::vector<BodyCluster> clusters, std::size_t triangles) {
  for (BodyCluster& cluster : clusters) {
    const auto end =
        std::lower_bound(cluster.triangles.begin(), cluster.triangles.end(), triangles);
    cluster.triangles.erase(end, cluster.triangles.end());
  }
  return clusters;
}

}  // namespace

void setPositions(std::vector<LabeledMesh>& meshes) {
  std::vector<glm::dvec3> all;
  for (const LabeledMesh& mesh : meshes) {
    all.insert(all.end(), mesh.mesh.vertices.begin(), mesh.mesh.vertices.end());
  }
  const std::vector<std::uint32_t> first = firstAtPosition(all);
  auto next = first.begin();
  for (LabeledMesh& mesh : meshes) {
    const auto end = next + static_cast<std::ptrdiff_t>(mesh.mesh.vertices.size());
    mesh.positionId.assign(next, end);
    next = end;
  }
}

ExactSurface cutByCluster(const Solid& solid, const Labels& labels, const Labels& before,
                          ExactSurface failed,
                          const std::function<ExactSurface(const ClusterSolid&)>& cut,
                          const Progress* progress) {
  const SolidMesh closed = isShell(solid) ? *solid.mesh : withHolesFilled(*solid.mesh, progress);
  const std::vector<BodyCluster> clusters = bodyClusters(solid, closed, before, progress);
  if (clusters.size() < 2) return failed;
  const std::vector<BodyCluster> own = ofInput(clusters, solid.mesh->mesh.triangles.size());
  const ClusterSolids parts(solid, labels, before, own);
  Assembled all(solid, closed, static_cast<std::size_t>(labels.fragmentCount));
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    throwIfCancelled(progress);
    const ClusterSolid part = parts.of(c);
    all.add(clusters[c], part.solid, cut(part), progress);
  }
  ExactSurface surface = std::move(all).finished();
  return surface.smooth.size() < clusters.size() ? std::move(surface) : std::move(failed);
}

}  // namespace sherd
