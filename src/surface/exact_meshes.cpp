// Surface::exact, from labels to the meshes of fragments.
#include "surface/exact_meshes.h"

#include <sherd/mesh.h>

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <memory>
#include <optional>

#include "base/cancel_flag.h"
#include "mesh/edges.h"
#include "mesh/triangle_tree.h"
#include "surface/bodies.h"
#include "surface/crack_surface.h"
#include "surface/cut.h"
#include "surface/label_reader.h"
#include "surface/merge_facets.h"
#include "surface/vertex_numbers.h"
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

// Adds the meshes of a body to those of the bodies before it.
//   body  with TriangleMesh::source
void append(std::vector<LabeledMesh> from, const TriangleMesh& body, std::uint32_t firstPosition,
            std::vector<LabeledMesh>& to) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    LabeledMesh &own = from[i], &all = to[i];
    const auto first = static_cast<std::uint32_t>(all.mesh.vertices.size());
    all.mesh.vertices.insert(all.mesh.vertices.end(), own.mesh.vertices.begin(),
                             own.mesh.vertices.end());
    for (const glm::uvec3& t : own.mesh.triangles) all.mesh.triangles.push_back(t + first);
    for (const std::uint32_t source : own.mesh.source) {
      all.mesh.source.push_back(source == TriangleMesh::kNoSource ? source : body.source[source]);
    }
    all.other.insert(all.other.end(), own.other.begin(), own.other.end());
    for (const std::uint32_t id : own.positionId) all.positionId.push_back(firstPosition + id);
  }
}

// Returns the faces that meet a box.
Complex within(const Complex& cracks, const TriangleTree& tree, const Box& box) {
  std::vector<std::uint32_t> faces = tree.meeting(box);
  for (std::uint32_t& face : faces) face = tree.source(face);
  std::sort(faces.begin(), faces.end());
  std::vector<std::uint32_t> used;
  for (const std::uint32_t face : faces) {
    const glm::uvec3& corner = cracks.faces[face].corner;
    used.insert(used.end(), {corner.x, corner.y, corner.z});
  }
  const VertexNumbers numbers(std::move(used), cracks.vertices.size());
  Complex out;
  for (const std::uint32_t v : numbers.vertices()) out.vertices.push_back(cracks.vertices[v]);
  for (const std::uint32_t face : faces) {
    ComplexFace own = cracks.faces[face];
    for (int k = 0; k < 3; ++k) own.corner[k] = numbers.of(own.corner[k]);
    out.faces.push_back(own);
  }
  return out;
}

// Cuts each body alone.  Where bodies overlap, so do the faces of their cracks.
ExactSurface cutBodies(std::span<const TriangleMesh> bodies, const Complex& cracks,
                       std::size_t fragments, SpaceLabels space, const Progress* progress) {
  if (bodies.empty()) return {.failure = "the mesh is not closed"};
  ExactSurface all{.meshes = std::vector<LabeledMesh>(fragments)};
  std::uint32_t positions = 0;
  const TriangleTree faces(TriangleMesh{cracks.vertices, trianglesOf(cracks)});
  for (const TriangleMesh& body : bodies) {
    throwIfCancelled(progress);
    std::optional<TriangleTree> tree;
    space.isInside = [&](const glm::dvec3& p) {
      if (!tree) tree.emplace(body);
      return tree->winding(p) >= 0.5;
    };
    ExactSurface own =
        exactSurface(body, within(cracks, faces, bounds(body)), fragments, space, progress);
    if (!own.failure.empty()) return own;
    std::uint32_t next = positions;
    for (const LabeledMesh& part : own.meshes) {
      for (const std::uint32_t id : part.positionId) next = std::max(next, positions + id + 1);
    }
    append(std::move(own.meshes), body, positions, all.meshes);
    positions = next;
  }
  return all;
}

}  // namespace

ExactSurface exactMeshes(const Solid& solid, const Labels& labels,
                         std::span<const LeafNeighbors> neighborhoods, const Progress* progress) {
  if (std::string obstacle = obstacleOf(solid); !obstacle.empty()) {
    return {.failure = std::move(obstacle)};
  }
  const Cut cut = findCut(labels, neighborhoods, CutExtent::exact, progress);
  const Labels beyond = labelsBeyond(solid, labels, cut, neighborhoods);
  const Complex cracks = crackSurface(solid, beyond, cut, neighborhoods, progress);
  const auto indexOf = [&](const glm::dvec3& p) { return solid.frame.indexFromWorld(p); };
  LabelReader reader(*beyond.blocks, beyond);
  const SpaceLabels space{[&](const glm::dvec3& p) { return reader.at(voxelAt(indexOf(p))); },
                          [&](const glm::dvec3& p) { return nearestLabel(beyond, indexOf(p)); },
                          insideOf(solid)};
  const auto fragments = static_cast<std::size_t>(labels.fragmentCount);
  const double tolerance = kCrackTolerance * solid.frame.voxelSize;
  ExactSurface surface;
  std::optional<std::vector<TriangleMesh>> bodies;
  for (int attempt = 0; attempt < kMostTries; ++attempt) {
    const MergeOptions merging{.facets = {.cracks = {.tolerance = tolerance}},
                               .displacementSeed = static_cast<std::uint64_t>(attempt)};
    const Complex simple = withMergedFacets(cracks, merging, progress).complex;
    surface = exactSurface(solid.mesh->mesh, simple, fragments, space, progress);
    if (!surface.failure.empty() && solid.report.defects.components > 1) {
      // Bodies that overlap or touch can be cut one by one.
      if (!bodies) bodies = bodiesOf(solid.mesh->mesh, progress);
      surface = cutBodies(*bodies, simple, fragments, space, progress);
    }
    if (!surface.isDegenerate) break;
  }
  for (LabeledMesh& mesh : surface.meshes) {
    for (std::uint32_t& source : mesh.mesh.source) {
      if (source != TriangleMesh::kNoSource) source = solid.mesh->source[source];
    }
  }
  return surface;
}

}  // namespace sherd
