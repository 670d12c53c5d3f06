// Surface::exact, from labels to the meshes of fragments.
#include "surface/exact/exact_meshes.h"

#include <sherd/mesh.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <iterator>
#include <memory>

#include "cut/cut.h"
#include "cut/label_reader.h"
#include "cut/nearest_label.h"
#include "intersect/arrange/unite.h"
#include "mesh/search/triangle_tree.h"
#include "mesh/triangle_area.h"
#include "remesh/bodies.h"
#include "remesh/decimate/simplified_cracks.h"
#include "remesh/parts/clean_meshes.h"
#include "remesh/parts/close_mesh.h"
#include "remesh/parts/loose_bodies.h"
#include "remesh/parts/part_edges.h"
#include "surface/exact/closed_solid.h"
#include "surface/exact/crack_surface.h"
#include "surface/exact/exact_by_cluster.h"
#include "surface/exact/kept_meshes.h"
#include "surface/exact/layer.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

// How often cracks in degenerate position are displaced anew.
constexpr int kMostTries = 4;

openvdb::Coord voxelAt(const glm::dvec3& index) {
  const glm::dvec3 rounded = glm::round(index);
  return {static_cast<int>(rounded.x), static_cast<int>(rounded.y), static_cast<int>(rounded.z)};
}

std::string obstacleOf(const Solid& solid) {
  if (solid.mesh == nullptr) return "the solid has no input mesh";
  const SolidReport& report = solid.report;
  if (report.fill != Fill::winding && !report.isThinnerThanVoxels && !isShell(solid)) {
    return "the mesh is not filled by winding numbers";
  }
  return {};
}

// The mesh that is cut, and the union of its bodies where they overlap or touch.
class Bodies {
 public:
  ///   source    the input's mesh, without holes
  ///   closed    what it was closed to, if that has a mesh
  ///   least     volume of a body that has some
  ///   progress  may be null
  Bodies(std::shared_ptr<const SolidMesh> source, const ClosedMesh& closed, double least,
         const Progress* progress)
      : whole_(std::move(source)),
        source_(*whole_),
        isInput_(closed.mesh == nullptr),
        least_(least),
        progress_(progress) {
    united_.closed.holes = closed.holes;
    if (closed.mesh) setMesh(whole_);
  }

  [[nodiscard]] const SolidMesh& mesh() const { return united_.mesh ? *united_.mesh : source_; }

  // Unites the bodies.  Returns a failure, as a clause, or nothing.
  std::string unite() {
    UnitedMesh all = sherd::unite(source_.mesh, progress_);
    isTried_ = true;
    if (!all.failure.empty() || !all.isChanged) return std::move(all.failure);
    united_.before = std::max(bodiesOf(source_.mesh, progress_).size(), std::size_t{1});
    united_.after = bodiesOf(all.mesh, progress_).size();
    SolidMesh united;
    for (const std::uint32_t triangle : all.mesh.source) {
      united.source.push_back(source_.source[triangle]);
      if (!source_.layer.empty()) united.layer.push_back(source_.layer[triangle]);
    }
    all.mesh.source.clear();
    united.mesh = std::move(all.mesh);
    setMesh(std::make_shared<const SolidMesh>(std::move(united)));
    return {};
  }

  [[nodiscard]] bool isTried() const { return isTried_; }
  // Whether the mesh has the holes of the input, and is no shell of it.
  [[nodiscard]] bool isInput() const { return isInput_; }
  [[nodiscard]] bool isUnited() const { return united_.before > 0; }
  [[nodiscard]] const UnitedBodies& united() const { return united_; }

 private:
  void setMesh(std::shared_ptr<const SolidMesh> mesh) {
    if (united_.closed.holes > 0) {
      mesh = std::make_shared<const SolidMesh>(withoutSmallClosed(*mesh, least_));
    }
    united_.mesh = std::move(mesh);
    united_.closed.faces = 0;
    united_.closed.area = 0.0;
    for (std::size_t t = 0; t < united_.mesh->source.size(); ++t) {
      if (united_.mesh->source[t] != TriangleMesh::kNoSource) continue;
      const std::vector<glm::dvec3>& v = united_.mesh->mesh.vertices;
      const glm::uvec3& c = united_.mesh->mesh.triangles[t];
      ++united_.closed.faces;
      united_.closed.area += areaOf({v[c.x], v[c.y], v[c.z]});
    }
  }

  const std::shared_ptr<const SolidMesh> whole_;
  const SolidMesh& source_;
  const bool isInput_;
  const double least_;
  const Progress* const progress_;
  bool isTried_ = false;
  UnitedBodies united_;
};

// Whether points are inside the mesh.  The solid has no region of its mesh where its voxels are
// those of a shell, or of a fragment, and another one where holes were closed.
std::function<bool(const glm::dvec3&)> insideOf(const Solid& solid, const Bodies& bodies) {
  if (solid.region != nullptr && !solid.report.isThinnerThanVoxels && bodies.isInput()) {
    return
        [&](const glm::dvec3& p) { return solid.region->contains(solid.frame.indexFromWorld(p)); };
  }
  const auto tree = std::make_shared<const TriangleTree>(bodies.mesh().mesh);
  return [tree](const glm::dvec3& p) { return tree->winding(p) >= 0.5; };
}

// Cuts the bodies of one layer, or of all.
//   solid, labels  of the layer
ExactSurface cutLayer(const Solid& solid, const Labels& labels, const TriangleMesh& mesh,
                      std::function<bool(const glm::dvec3&)> isInside,
                      std::span<const LeafNeighbors> neighborhoods, double adaptivity,
                      const Progress* progress) {
  const Cut cut = findCut(labels, neighborhoods, CutExtent::exact, progress);
  const Labels beyond = labelsBeyond(solid, labels, cut, neighborhoods);
  LabeledComplex cracks = crackSurface(solid, beyond, cut, neighborhoods, progress);
  const auto indexOf = [&](const glm::dvec3& p) { return solid.frame.indexFromWorld(p); };
  LabelReader reader(*beyond.blocks, beyond);
  const SpaceLabels space{[&](const glm::dvec3& p) { return reader.at(voxelAt(indexOf(p))); },
                          [&](const glm::dvec3& p) { return nearestLabel(beyond, indexOf(p)); },
                          std::move(isInside)};
  const auto fragments = static_cast<std::size_t>(labels.fragmentCount);
  ExactSurface surface;
  for (int attempt = 0; attempt < kMostTries; ++attempt) {
    const LabeledComplex simple = simplifiedCracks(
        cracks, mesh, solid.frame,
        {.adaptivity = adaptivity, .displacementSeed = static_cast<std::uint64_t>(attempt)},
        progress);
    surface = exactSurface(mesh, simple, fragments, space, progress);
    if (!surface.isDegenerate) break;
    // What a displacement does not mend may be a crack that ends at the surface.
    if (attempt == 1) {
      cracks = crackSurface(solid, beyond, cut, neighborhoods, progress, CrackEnds::halfQuads);
    }
  }
  if (surface.failure.empty()) {
    surface.meshes = withoutSlivers(std::move(surface.meshes), mesh, cleanOptions(solid), progress);
  }
  return surface;
}

// Numbers triangles of the mesh that was cut by those of the input.
void setSources(ExactSurface& surface, std::span<const std::uint32_t> source) {
  for (LabeledMesh& mesh : surface.meshes) {
    for (std::uint32_t& triangle : mesh.mesh.source) {
      if (triangle != TriangleMesh::kNoSource) triangle = source[triangle];
    }
  }
}

// Cuts a mesh, one layer after the other.  A fragment is in one layer.
ExactSurface cutLayers(const Solid& solid, const Labels& labels, const Bodies& bodies,
                       std::span<const LeafNeighbors> neighborhoods, double adaptivity,
                       const Progress* progress) {
  const SolidMesh& mesh = bodies.mesh();
  if (mesh.layer.empty()) {
    ExactSurface surface = cutLayer(solid, labels, mesh.mesh, insideOf(solid, bodies),
                                    neighborhoods, adaptivity, progress);
    setSources(surface, mesh.source);
    return surface;
  }
  ExactSurface all;
  all.meshes.resize(static_cast<std::size_t>(labels.fragmentCount));
  for (std::size_t layer = 0; layer <= solid.blocks->layers.size(); ++layer) {
    const SolidMesh own = meshOfLayer(mesh, layer);
    const Solid part = solidOfLayer(solid, layer);
    const TriangleTree tree(own.mesh);
    ExactSurface surface = cutLayer(
        part, labelsOfLayer(labels, part), own.mesh,
        [&](const glm::dvec3& p) { return tree.winding(p) >= 0.5; }, neighborhoods, adaptivity,
        progress);
    if (!surface.failure.empty()) return surface;
    setSources(surface, own.source);
    std::move(surface.moved.begin(), surface.moved.end(), std::back_inserter(all.moved));
    addLayer(std::move(surface.meshes), all.meshes);
  }
  setPositions(all.meshes);
  return all;
}

// Cuts a mesh whose holes may have been closed.
ExactSurface cutBodies(const Solid& solid, const Labels& labels, const Bodies& bodies,
                       std::span<const LeafNeighbors> neighborhoods, double adaptivity,
                       const Progress* progress) {
  ExactSurface surface = cutLayers(solid, labels, bodies, neighborhoods, adaptivity, progress);
  if (surface.failure.empty() || bodies.isInput()) return surface;
  // Cracks may not reach the faces that close holes, or the corners of a shell.
  const ClosedSolid closed = closedSolid(solid, labels, bodies.mesh().mesh, progress);
  return cutLayers(closed.solid, closed.labels, bodies,
                   leafNeighbors(closed.labels.blocks->origins), adaptivity, progress);
}

// The cut of united bodies: bodies that touch along edges may have fragments that do.
ExactSurface checkedUnion(ExactSurface surface, const UnitedBodies& united,
                          const Progress* progress) {
  if (!surface.failure.empty()) return surface;
  if (united.before > 0) {
    if (std::string failure = partSheets(surface.meshes, progress); !failure.empty()) {
      return {.failure = std::move(failure)};
    }
  }
  surface.united = united;
  return surface;
}

// Whether voxels of a fragment are within a body.
bool hasVoxels(const Solid& solid, const Labels& labels, const TriangleMesh& body, const Box& box,
               std::uint16_t id) {
  const TriangleTree tree(body);
  const openvdb::Coord low = voxelAt(solid.frame.indexFromWorld(box.min)),
                       high = voxelAt(solid.frame.indexFromWorld(box.max));
  LabelReader reader(*solid.blocks, labels);
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) {
        const openvdb::Coord at(x, y, z);
        if (!reader.isInside(at) || reader.at(at) != id) continue;
        if (tree.winding(solid.frame.worldFromIndex(glm::dvec3(x, y, z))) >= 0.5) return true;
      }
    }
  }
  return false;
}

// Cuts all bodies at once.
ExactSurface cutTogether(const Solid& solid, const Labels& labels,
                         std::span<const LeafNeighbors> neighborhoods, double adaptivity,
                         const Progress* progress) {
  const ClosedMesh closed = closedMesh(solid, progress);
  if (!closed.failure.empty()) return {.failure = closed.failure};
  const double least =
      std::pow(solid.frame.voxelSize, 3) * static_cast<double>(leastComponentVoxels(solid));
  Bodies bodies(closed.mesh ? closed.mesh : solid.mesh, closed, least, progress);
  if (closed.isCrossed || componentsMeet(bodies.mesh().mesh, progress)) {
    if (std::string failure = bodies.unite(); !failure.empty()) return {.failure = failure};
  }
  ExactSurface surface = cutBodies(solid, labels, bodies, neighborhoods, adaptivity, progress);
  // A body that crosses itself is cut as it is where no crack meets the crossings.
  if (!surface.failure.empty() && !bodies.isTried() && bodies.unite().empty() &&
      bodies.isUnited()) {
    surface = cutBodies(solid, labels, bodies, neighborhoods, adaptivity, progress);
  }
  surface = checkedUnion(std::move(surface), bodies.united(), progress);
  surface.united.loose = removeLooseBodies(
      surface.meshes, least, [&](const TriangleMesh& body, const Box& box, std::uint16_t id) {
        return hasVoxels(solid, labels, body, box, id);
      });
  // Voxels connect parts of an open mesh that are near each other.
  for (std::size_t i = 0; i < surface.meshes.size() && !bodies.isInput(); ++i) {
    if (bodyCount(surface.meshes[i].mesh) < 2) continue;
    return {.failure =
                "fragment " + std::to_string(i + 1) +
                " would be several bodies, since parts of the open mesh are near each other"};
  }
  const std::vector<std::uint64_t> voxels = countVoxels(labels);
  for (std::size_t i = 0; i < surface.meshes.size(); ++i) {
    if (voxels[i + 1] == 0 || !surface.meshes[i].mesh.triangles.empty()) continue;
    return {.failure = "fragment " + std::to_string(i + 1) +
                       " would be empty: no part of the mesh lies within its cracks"};
  }
  if (isShell(solid)) surface.united.before = surface.united.after = 0;  // its folds, no bodies
  return surface;
}

}  // namespace

ExactSurface exactMeshes(const Solid& solid, const Labels& labels, const Labels* uneroded,
                         std::span<const LeafNeighbors> neighborhoods, double adaptivity,
                         const Progress* progress) {
  if (std::string obstacle = obstacleOf(solid); !obstacle.empty()) {
    return {.failure = std::move(obstacle)};
  }
  if (!solid.mesh->body.empty()) {
    const auto cut = [&](const ClosedSolid& layer) {
      return exactMeshes(layer.solid, layer.labels, nullptr,
                         leafNeighbors(layer.labels.blocks->origins), adaptivity, progress);
    };
    return keptMeshes(solid, labels, cut, progress);
  }
  ExactSurface surface = cutTogether(solid, labels, neighborhoods, adaptivity, progress);
  if (!surface.failure.empty()) {
    const auto cut = [&](const ClusterSolid& part) {
      return cutTogether(part.solid, part.labels, leafNeighbors(part.solid.blocks->origins),
                         adaptivity, progress);
    };
    surface = cutByCluster(solid, labels, uneroded ? *uneroded : labels, std::move(surface), cut,
                           progress);
  }
  const auto known = static_cast<std::size_t>(solid.smallComponents);  // which a warning counts
  surface.united.loose -= std::min(surface.united.loose, known);
  return surface;
}

}  // namespace sherd
