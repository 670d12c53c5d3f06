// What a mesh bounds: a surface, and the side of it that voxel centres are on.
#include "voxelize/fill.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "mesh/joined.h"
#include "mesh/surface_by_area.h"
#include "voxelize/caps.h"
#include "voxelize/exposed.h"
#include "voxelize/flood.h"
#include "voxelize/generalised_winding.h"
#include "voxelize/holes.h"

namespace sherd {
namespace {

// A mesh that encloses less than this is a surface without thickness.  Scans with a hole at their
// foot have 0.87 and more, open vases 0.7, bowls 0.8.
constexpr double kEncloses = 0.84;

// A shell's thickness where none is told: whatever way it runs, steps from voxel to voxel stay in.
constexpr double kShellVoxels = 2.5;

constexpr double kBeside = 1e-3;  // voxels

struct Sample {
  glm::dvec3 point, normal;
};

// Middles of triangles, evenly by area; none where there is no area.
std::vector<Sample> samplesOf(const TriangleMesh& mesh, std::size_t count) {
  std::vector<Sample> out;
  if (!(area(mesh) > 0.0)) return out;
  const SurfaceByArea surface(mesh);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t t =
        surface.triangleAt((static_cast<double>(i) + 0.5) / static_cast<double>(count));
    out.push_back({surface.pointIn(t, 4.0 / 9.0, 0.5), surface.normalOf(t)});
  }
  return out;
}

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
              .isInside = {}};
  const double thickness =
      options.shellThickness > 0.0 ? options.shellThickness / voxelSize : kShellVoxels;
  out.halfThickness = 0.5 * thickness;
  return out;
}

Filling windingOf(const SearchedMesh& mesh, std::string reason, const Progress* progress) {
  const auto winding =
      std::make_shared<GeneralisedWinding>(mesh.mesh, mesh.caps, mesh.tree, progress);
  Filling out{.fill = Fill::winding,
              .reason = std::move(reason),
              .surface = mesh.tree,
              .isInside = [winding](const openvdb::Coord& c) { return winding->isInside(c); }};
  if (winding->isSimple()) return out;
  TriangleMesh surface = exposedSurface(mesh.mesh, *winding, progress);
  if (!mesh.caps.triangles.empty()) {
    surface = joined(std::move(surface), holeSurface(*winding, *mesh.tree, progress));
  }
  out.surface = std::make_shared<TriangleTree>(surface);
  return out;
}

}  // namespace

SearchedMesh searched(TriangleMesh mesh) {
  SearchedMesh out{std::move(mesh), {}, nullptr};
  out.caps = loopCaps(out.mesh);
  out.tree = std::make_shared<TriangleTree>(out.mesh);
  return out;
}

double enclosure(const SearchedMesh& mesh) {
  constexpr std::size_t kSamples = 1000;
  double sum = 0.0;
  const std::vector<Sample> samples = samplesOf(mesh.mesh, kSamples);
  for (const Sample& s : samples) sum += mesh.tree->winding(s.point - kBeside * s.normal);
  return samples.empty() ? 0.0 : sum / static_cast<double>(samples.size());
}

Filling fillingOf(const SearchedMesh& mesh, const TriangleMesh& original,
                  const SolidOptions& options, double voxelSize, const Progress* progress) {
  const std::string asked = "as asked for";
  switch (options.fill) {
    case Fill::shell:
      return shellOf(original, options, voxelSize, asked);
    case Fill::parity: {
      const TriangleMesh whole = joined(mesh.mesh, coneCaps(mesh.mesh));
      const auto columns = std::make_shared<Winding>(whole, Winding::Rule::parity, progress);
      return {.fill = Fill::parity,
              .reason = asked,
              .surface = std::make_shared<TriangleTree>(whole),
              .isInside = [columns](const openvdb::Coord& c) { return columns->isInside(c); }};
    }
    case Fill::flood: {
      const auto flooded = std::make_shared<FloodedBox>(mesh.mesh, progress);
      return {.fill = Fill::flood,
              .reason = asked,
              .surface = mesh.tree,
              .isInside = [flooded](const openvdb::Coord& c) { return flooded->isInside(c); }};
    }
    case Fill::winding:
      return windingOf(mesh, asked, progress);
    case Fill::automatic:
      break;
  }
  if (options.shellThickness > 0.0) {
    return shellOf(original, options, voxelSize, "a thickness of shell was asked for");
  }
  if (mesh.caps.triangles.empty() && !mesh.mesh.triangles.empty()) {
    return windingOf(mesh, "the mesh is closed", progress);
  }
  const double encloses = enclosure(mesh);
  if (encloses < kEncloses) {
    return shellOf(original, options, voxelSize,
                   "the mesh is open and encloses nothing: " + percent(1.0 - encloses) +
                       " of what its inner side sees is outside");
  }
  return windingOf(mesh, "the mesh is open; its holes are closed where it winds half way round",
                   progress);
}

WallThickness wallThickness(const SearchedMesh& mesh, double longestSideVoxels) {
  constexpr std::size_t kSamples = 2000;
  constexpr double kThinnestShare = 0.01;
  std::vector<double> thickness;
  for (const Sample& s : samplesOf(mesh.mesh, kSamples)) {
    thickness.push_back(mesh.tree->firstHit(s.point, -s.normal, kBeside));
  }
  WallThickness out;
  if (thickness.empty()) return out;
  std::sort(thickness.begin(), thickness.end());
  const auto thin = std::lower_bound(thickness.begin(), thickness.end(), 1.0) - thickness.begin();
  out.thinShare = static_cast<double>(thin) / static_cast<double>(thickness.size());
  out.thinnest =
      thickness[static_cast<std::size_t>(kThinnestShare * static_cast<double>(thickness.size()))];
  if (out.thinnest < 1.0 && out.thinnest > 0.0) {
    out.resolution = static_cast<int>(
        std::min(std::ceil(kHeldWallVoxels * longestSideVoxels / out.thinnest), 1e9));
  }
  return out;
}

}  // namespace sherd
