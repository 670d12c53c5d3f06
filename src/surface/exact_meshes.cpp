// Surface::exact, from labels to the meshes of fragments.
#include "surface/exact_meshes.h"

#include <sherd/mesh.h>

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <memory>

#include "exact/unite.h"
#include "mesh/edges.h"
#include "mesh/positions.h"
#include "mesh/triangle_tree.h"
#include "surface/bodies.h"
#include "surface/clean_meshes.h"
#include "surface/crack_surface.h"
#include "surface/cut.h"
#include "surface/label_reader.h"
#include "surface/layer.h"
#include "surface/merge_facets.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

// How often cracks in degenerate position are displaced anew.
constexpr int kMostTries = 4;

openvdb::Coord voxelAt(const glm::dvec3& index) {
  const glm::dvec3 rounded = glm::round(index);
  return {static_cast<int>(rounded.x), static_cast<int>(rounded.y), static_cast<int>(rounded.z)};
}

// The label of the voxel that is nearest to a point.
std::uint16_t nearestLabel(const Labels& labels, const glm::dvec3& index) {
  double least = std::numeric_limits<double>::infinity();
  std::uint16_t nearest = 0;
  for (std::size_t leaf = 0; leaf < labels.blocks->count(); ++leaf) {
    const openvdb::Coord& origin = labels.blocks->origins[leaf];
    const glm::dvec3 low(origin.x(), origin.y(), origin.z());
    const glm::dvec3 apart = index - glm::clamp(index, low, low + 7.0);
    if (glm::dot(apart, apart) >= least) continue;
    for (std::size_t v = 0; v < 512; ++v) {
      const std::uint16_t label = labels.fragment[leaf * 512 + v];
      if (label == 0 || label == Labels::kEroded) continue;
      const openvdb::Coord at = labels.blocks->voxelAt(leaf * 512 + v);
      const glm::dvec3 to = glm::dvec3(at.x(), at.y(), at.z()) - index;
      if (glm::dot(to, to) >= least) continue;
      least = glm::dot(to, to);
      nearest = label;
    }
  }
  return nearest;
}

// Whether points are inside the mesh.  The solid has no region of its mesh where its voxels are
// those of a shell, or of a fragment.
std::function<bool(const glm::dvec3&)> insideOf(const Solid& solid) {
  if (solid.region != nullptr && !solid.report.isThinnerThanVoxels) {
    return
        [&](const glm::dvec3& p) { return solid.region->contains(solid.frame.indexFromWorld(p)); };
  }
  const auto tree = std::make_shared<const TriangleTree>(solid.mesh->mesh);
  return [tree](const glm::dvec3& p) { return tree->winding(p) >= 0.5; };
}

std::string obstacleOf(const Solid& solid) {
  if (solid.mesh == nullptr) return "the solid has no input mesh";
  if (solid.report.fill != Fill::winding && !solid.report.isThinnerThanVoxels) {
    return "the mesh is not filled by winding numbers";
  }
  const EdgeDefects edges = edgeDefects(solid.mesh->mesh);
  if (edges.unbalanced > 0) return "the mesh has " + textOf(edges);
  return {};
}

// The mesh that is cut, and the union of its bodies where they overlap or touch.
class Bodies {
 public:
  ///   progress  may be null
  Bodies(const SolidMesh& source, const Progress* progress)
      : source_(source), progress_(progress) {}

  [[nodiscard]] const SolidMesh& mesh() const { return united_.mesh ? *united_.mesh : source_; }

  // Unites the bodies.  Returns a failure, as a clause, or nothing.
  std::string unite() {
    UnitedMesh all = sherd::unite(source_.mesh, progress_);
    isTried_ = true;
    if (!all.failure.empty() || !all.isChanged) return std::move(all.failure);
    united_.before = bodiesOf(source_.mesh, progress_).size();
    united_.after = bodiesOf(all.mesh, progress_).size();
    SolidMesh united;
    for (const std::uint32_t triangle : all.mesh.source) {
      united.source.push_back(source_.source[triangle]);
      if (!source_.layer.empty()) united.layer.push_back(source_.layer[triangle]);
    }
    all.mesh.source.clear();
    united.mesh = std::move(all.mesh);
    united_.mesh = std::make_shared<const SolidMesh>(std::move(united));
    return {};
  }

  [[nodiscard]] bool isTried() const { return isTried_; }
  [[nodiscard]] const UnitedBodies& united() const { return united_; }

 private:
  const SolidMesh& source_;
  const Progress* const progress_;
  bool isTried_ = false;
  UnitedBodies united_;
};

// Cuts the bodies of one layer, or of all.
//   solid, labels  of the layer
ExactSurface cutLayer(const Solid& solid, const Labels& labels, const TriangleMesh& mesh,
                      std::function<bool(const glm::dvec3&)> isInside,
                      std::span<const LeafNeighbors> neighborhoods, const Progress* progress) {
  const Cut cut = findCut(labels, neighborhoods, CutExtent::exact, progress);
  const Labels beyond = labelsBeyond(solid, labels, cut, neighborhoods);
  const Complex cracks = crackSurface(solid, beyond, cut, neighborhoods, progress);
  const auto indexOf = [&](const glm::dvec3& p) { return solid.frame.indexFromWorld(p); };
  LabelReader reader(*beyond.blocks, beyond);
  const SpaceLabels space{[&](const glm::dvec3& p) { return reader.at(voxelAt(indexOf(p))); },
                          [&](const glm::dvec3& p) { return nearestLabel(beyond, indexOf(p)); },
                          std::move(isInside)};
  const auto fragments = static_cast<std::size_t>(labels.fragmentCount);
  const double tolerance = kCrackTolerance * solid.frame.voxelSize;
  ExactSurface surface;
  for (int attempt = 0; attempt < kMostTries; ++attempt) {
    const MergeOptions merging{.facets = {.cracks = {.tolerance = tolerance}},
                               .displacementSeed = static_cast<std::uint64_t>(attempt)};
    const Complex simple = withMergedFacets(cracks, merging, progress).complex;
    surface = exactSurface(mesh, simple, fragments, space, progress);
    if (!surface.isDegenerate) break;
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
ExactSurface cutLayers(const Solid& solid, const Labels& labels, const SolidMesh& mesh,
                       std::span<const LeafNeighbors> neighborhoods, const Progress* progress) {
  if (mesh.layer.empty()) {
    ExactSurface surface =
        cutLayer(solid, labels, mesh.mesh, insideOf(solid), neighborhoods, progress);
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
        [&](const glm::dvec3& p) { return tree.winding(p) >= 0.5; }, neighborhoods, progress);
    if (!surface.failure.empty()) return surface;
    setSources(surface, own.source);
    for (std::size_t i = 0; i < all.meshes.size(); ++i) {
      if (surface.meshes[i].mesh.triangles.empty()) continue;
      all.meshes[i] = std::move(surface.meshes[i]);
    }
  }
  return all;
}

// Whether edges of a mesh, at equal positions, have more than two triangles.
bool touchesItself(const TriangleMesh& mesh) {
  TriangleMesh merged{mesh.vertices, mesh.triangles};
  const std::vector<std::uint32_t> first = firstAtPosition(mesh.vertices);
  for (glm::uvec3& t : merged.triangles) t = {first[t.x], first[t.y], first[t.z]};
  return edgeDefects(merged).nonManifold > 0;
}

// The cut of united bodies, or a failure: bodies that touch along edges may have fragments that do.
ExactSurface checkedUnion(ExactSurface surface, const UnitedBodies& united) {
  if (!surface.failure.empty()) return surface;
  for (std::size_t i = 0; united.mesh != nullptr && i < surface.meshes.size(); ++i) {
    if (!touchesItself(surface.meshes[i].mesh)) continue;
    return {.failure = "fragment " + std::to_string(i + 1) +
                       " of the united bodies touches itself along an edge"};
  }
  surface.united = united;
  return surface;
}

}  // namespace

ExactSurface exactMeshes(const Solid& solid, const Labels& labels,
                         std::span<const LeafNeighbors> neighborhoods, const Progress* progress) {
  if (std::string obstacle = obstacleOf(solid); !obstacle.empty()) {
    return {.failure = std::move(obstacle)};
  }
  Bodies bodies(*solid.mesh, progress);
  if (componentsMeet(solid.mesh->mesh, progress)) {
    if (std::string failure = bodies.unite(); !failure.empty()) return {.failure = failure};
  }
  ExactSurface surface = cutLayers(solid, labels, bodies.mesh(), neighborhoods, progress);
  // A body that crosses itself is cut as it is where no crack meets the crossings.
  if (!surface.failure.empty() && !bodies.isTried() && bodies.unite().empty() &&
      bodies.united().mesh != nullptr) {
    surface = cutLayers(solid, labels, bodies.mesh(), neighborhoods, progress);
  }
  return checkedUnion(std::move(surface), bodies.united());
}

}  // namespace sherd
