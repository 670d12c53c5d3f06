// The solid that a mesh bounds: its surface, and which voxel centers are inside.
#include "voxelize/fill/fill.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "mesh/edges.h"
#include "mesh/joined.h"
#include "voxelize/fill/caps.h"
#include "voxelize/fill/exposed.h"
#include "voxelize/fill/flood.h"
#include "voxelize/fill/generalized_winding.h"
#include "voxelize/fill/holes.h"
#include "voxelize/fill/walls.h"

namespace sherd {
namespace {

// A mesh with less enclosure() than this is a surface without thickness.  Scans with a hole at the
// bottom have 0.87 and more, open vases 0.7, bowls 0.8.
constexpr double kEncloses = 0.84;

constexpr double kBeside = 1e-3;  // voxels

// A mesh with as many open edges per triangle is a set of loose triangles or quads: each has three
// or two.  Open boxes have 0.4, blades of grass that are strips of triangles 1.
constexpr double kLooseEdges = 1.5;

// Steps of WorkLimit: some tens of seconds on one core, and 20 times what real open meshes need at
// the least automatic resolution.  Where the resolution is given, it grows with the area of a
// surface in voxels.
constexpr double kMostWork = 5e8;

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f %%", 100.0 * share);
  return text;
}

Filling shellOf(const TriangleMesh& mesh, const SolidOptions& options, double voxelSize,
                std::string reason) {
  Filling out{.fill = Fill::shell,
              .reason = std::move(reason),
              .surface = std::make_shared<TriangleTree>(mesh),
              .isInside = {},
              .contains = {}};
  out.halfThickness = 0.5 * shellVoxels(options, voxelSize);
  // A thickness in voxels is another one at each resolution; the points of this layer are not.
  const double reach =
      options.shellThickness > 0.0 ? out.halfThickness : kSurfaceLayer * longestSide(bounds(mesh));
  out.contains = [surface = out.surface, reach](const glm::dvec3& p) {
    return surface->nearest(p, reach).triangle != TriangleTree::kNone;
  };
  return out;
}

// Returns the winding number of a closed mesh around a point, by the triangles above it.
int windingBelow(const TriangleTree& tree, const glm::dvec3& p) {
  return tree.empty() ? 0 : tree.entries({p.x, p.y, tree.box().max.z + 1.0}, p);
}

// Returns the classification of points where each triangle separates inside from outside.
std::function<bool(const glm::dvec3&)> alternating(std::shared_ptr<const TriangleTree> tree) {
  return [tree = std::move(tree)](const glm::dvec3& p) { return windingBelow(*tree, p) % 2 != 0; };
}

// Returns the classification by the generalized winding number: a whole number for the mesh with
// its caps, minus that of the caps.
std::function<bool(const glm::dvec3&)> wound(const SearchedMesh& mesh) {
  const auto caps = std::make_shared<const TriangleTree>(mesh.caps);
  return [tree = mesh.tree, caps](const glm::dvec3& p) {
    return windingBelow(*tree, p) + windingBelow(*caps, p) - caps->winding(p) >= 0.5;
  };
}

std::uint64_t mostWork(const FillChoice& choice, const TriangleMesh& mesh,
                       const SolidOptions& options) {
  if (!choice.isLimited) return WorkLimit::kNone;
  const bool isGiven = options.resolution != kAutoResolution || options.voxelSize > 0.0;
  const double larger = longestSide(bounds(mesh)) / kLeastAutoResolution;
  return static_cast<std::uint64_t>(choice.workShare * kMostWork *
                                    (isGiven && larger > 1.0 ? larger * larger : 1.0));
}

Filling windingOf(const SearchedMesh& mesh, const FillChoice& choice, const SolidOptions& options,
                  const Progress* progress) {
  const auto winding = std::make_shared<GeneralizedWinding>(
      mesh.mesh, mesh.caps, mesh.tree, progress, mostWork(choice, mesh.mesh, options));
  Filling out{.fill = Fill::winding,
              .reason = choice.reason,
              .surface = mesh.tree,
              .isInside = [winding](const openvdb::Coord& c) { return winding->isInside(c); },
              .contains = wound(mesh)};
  if (winding->isSimple()) return out;
  TriangleMesh surface = exposedSurface(mesh.mesh, *winding, progress);
  if (!mesh.caps.triangles.empty()) {
    out.firstClosing = static_cast<std::uint32_t>(surface.triangles.size());
    surface = joined(std::move(surface), holeSurface(*winding, *mesh.tree, progress));
  }
  out.surface = std::make_shared<TriangleTree>(surface);
  return out;
}

}  // namespace

double enclosure(const SearchedMesh& mesh) {
  constexpr std::size_t kSamples = 1000;
  double sum = 0.0;
  const std::vector<SurfaceSample> samples = surfaceSamples(mesh.mesh, kSamples, false);
  for (const SurfaceSample& s : samples)
    sum += std::clamp(mesh.tree->winding(s.point - kBeside * s.normal), 0.0, 1.0);
  return samples.empty() ? 0.0 : sum / static_cast<double>(samples.size());
}

FillChoice chosenFill(const SearchedMesh& mesh, const SolidOptions& options) {
  if (options.fill != Fill::automatic) return {options.fill, "as selected"};
  if (options.shellThickness > 0.0) return {Fill::shell, "a shell thickness is given"};
  if (mesh.mesh.triangles.empty()) {
    return {Fill::winding, "all of its triangles are on both sides of sheets"};
  }
  if (mesh.caps.triangles.empty()) return {Fill::winding, "the mesh is closed"};
  // Each open edge is one of a cap, and each vertex of a cap the first of one.
  const std::size_t triangles = mesh.mesh.triangles.size(), open = mesh.caps.vertices.size();
  if (static_cast<double>(open) >= kLooseEdges * static_cast<double>(triangles)) {
    return {Fill::shell, "the mesh is open and encloses no volume: its triangles are loose, and " +
                             std::to_string(open) + " of their edges have no neighbor"};
  }
  const EdgeDefects edges = edgeDefects(mesh.mesh);
  const std::string found =
      edges.boundary > 0 ? "the mesh is open" : "the mesh has " + textOf(edges);
  const double encloses = enclosure(mesh);
  if (encloses < kEncloses) {
    return {Fill::shell, found + " and encloses no volume: " + percent(1.0 - encloses) +
                             " of the directions behind its surface lead outside"};
  }
  return {Fill::winding,
          found + (edges.boundary > 0 ? "; its holes are closed where" : "; it is filled where") +
              " the winding number is 0.5",
          true};
}

double shellVoxels(const SolidOptions& options, double voxelSize) {
  // A shell of this thickness is 6-connected in every orientation.
  constexpr double kShellVoxels = 2.5;
  return options.shellThickness > 0.0 ? options.shellThickness / voxelSize : kShellVoxels;
}

namespace {

// As fillingOf, without points near sheets.
Filling wholeFilling(const FillChoice& choice, const SearchedMesh& mesh,
                     const TriangleMesh& original, const SolidOptions& options, double voxelSize,
                     const Progress* progress) {
  switch (choice.fill) {
    case Fill::shell:
      return shellOf(original, options, voxelSize, choice.reason);
    case Fill::parity: {
      const TriangleMesh whole = joined(mesh.mesh, coneCaps(mesh.mesh));
      const auto columns = std::make_shared<Winding>(whole, Winding::Rule::parity, progress);
      const auto tree = std::make_shared<const TriangleTree>(whole);
      return {.fill = Fill::parity,
              .reason = choice.reason,
              .surface = tree,
              .firstClosing = static_cast<std::uint32_t>(mesh.mesh.triangles.size()),
              .isInside = [columns](const openvdb::Coord& c) { return columns->isInside(c); },
              .contains = alternating(tree)};
    }
    case Fill::flood: {
      const auto flooded = std::make_shared<FloodedBox>(mesh.mesh, progress);
      return {.fill = Fill::flood,
              .reason = choice.reason,
              .surface = mesh.tree,
              .isInside = [flooded](const openvdb::Coord& c) { return flooded->isInside(c); },
              .contains = alternating(mesh.tree)};
    }
    case Fill::winding:
    case Fill::automatic:  // not a choice
      break;
  }
  return windingOf(mesh, choice, options, progress);
}

}  // namespace

Filling fillingOf(const FillChoice& choice, const SearchedMesh& mesh, const TriangleMesh& original,
                  const SolidOptions& options, double voxelSize, const Progress* progress,
                  const SheetsApart* apart) {
  Filling out = wholeFilling(choice, mesh, original, options, voxelSize, progress);
  if (apart == nullptr || out.fill == Fill::shell || options.shellThickness > 0.0) return out;
  out.contains = [of = out.fill == Fill::winding ? wound(apart->rest)
                                                 : alternating(apart->rest.tree),
                  sheets = std::make_shared<const TriangleTree>(apart->sheets),
                  reach = kSurfaceLayer * longestSide(bounds(mesh.mesh))](const glm::dvec3& p) {
    return of(p) || sheets->nearest(p, reach).triangle != TriangleTree::kNone;
  };
  return out;
}

}  // namespace sherd
