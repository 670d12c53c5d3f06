// What a mesh bounds: a surface, and the side of it that voxel centres are on.
#include "voxelize/fill.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "mesh/joined.h"
#include "voxelize/caps.h"
#include "voxelize/exposed.h"
#include "voxelize/flood.h"
#include "voxelize/generalised_winding.h"
#include "voxelize/holes.h"
#include "voxelize/triangle_tree.h"

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

// Middles of triangles, evenly by area.
std::vector<Sample> samplesOf(const TriangleMesh& mesh, std::size_t count) {
  std::vector<double> sums;
  sums.reserve(mesh.triangles.size());
  double sum = 0.0;
  const auto cross = [&](const glm::uvec3& t) {
    const std::vector<glm::dvec3>& v = mesh.vertices;
    return glm::cross(v[t.y] - v[t.x], v[t.z] - v[t.x]);
  };
  for (const glm::uvec3& t : mesh.triangles) sums.push_back(sum += glm::length(cross(t)));
  std::vector<Sample> out;
  for (std::size_t i = 0; i < count && sum > 0.0; ++i) {
    const double wanted = sum * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const auto at =
        static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), wanted) - sums.begin());
    const glm::uvec3& t = mesh.triangles[std::min(at, mesh.triangles.size() - 1)];
    out.push_back({(mesh.vertices[t.x] + mesh.vertices[t.y] + mesh.vertices[t.z]) / 3.0,
                   glm::normalize(cross(t))});
  }
  return out;
}

double enclosureBy(const TriangleTree& tree, const TriangleMesh& mesh) {
  constexpr std::size_t kSamples = 1000;
  double sum = 0.0;
  const std::vector<Sample> samples = samplesOf(mesh, kSamples);
  for (const Sample& s : samples) sum += tree.winding(s.point - kBeside * s.normal);
  return samples.empty() ? 0.0 : sum / static_cast<double>(samples.size());
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f %%", 100.0 * share);
  return text;
}

Filling shellOf(const TriangleMesh& mesh, const SolidOptions& options, double voxelSize,
                std::string reason) {
  Filling out{.fill = Fill::shell, .reason = std::move(reason), .surface = mesh, .insideRow = {}};
  const double thickness =
      options.shellThickness > 0.0 ? options.shellThickness / voxelSize : kShellVoxels;
  out.halfThickness = 0.5 * thickness;
  return out;
}

Filling windingOf(TriangleMesh mesh, const Progress* progress) {
  const auto winding = std::make_shared<GeneralisedWinding>(mesh);
  Filling out{.fill = Fill::winding, .reason = "", .surface = {}, .insideRow = {}};
  out.insideRow = [winding](int x, int y, int z0, std::uint8_t wanted) {
    return winding->insideRow(x, y, z0, wanted);
  };
  if (winding->isSimple()) {
    out.surface = std::move(mesh);
    return out;
  }
  out.surface = exposedSurface(mesh, *winding, progress);
  if (!winding->caps().triangles.empty()) {
    out.surface = joined(std::move(out.surface), holeSurface(*winding, TriangleTree(mesh)));
  }
  return out;
}

}  // namespace

double enclosure(const TriangleMesh& mesh) { return enclosureBy(TriangleTree(mesh), mesh); }

Filling fillingOf(TriangleMesh mesh, const TriangleMesh& original, const SolidOptions& options,
                  double voxelSize, const Progress* progress) {
  const bool closed = loopCaps(mesh).triangles.empty() && !mesh.triangles.empty();
  switch (options.fill) {
    case Fill::shell:
      return shellOf(original, options, voxelSize, "as asked for");
    case Fill::parity: {
      TriangleMesh whole = joined(mesh, coneCaps(mesh));
      const auto columns = std::make_shared<Winding>(whole, Winding::Rule::parity);
      return {.fill = Fill::parity,
              .reason = "as asked for",
              .surface = std::move(whole),
              .insideRow = [columns](int x, int y, int z0, std::uint8_t) {
                return columns->insideRow(x, y, z0);
              }};
    }
    case Fill::flood: {
      const auto flooded = std::make_shared<FloodedBox>(mesh);
      return {.fill = Fill::flood,
              .reason = "as asked for",
              .surface = std::move(mesh),
              .insideRow = [flooded](int x, int y, int z0, std::uint8_t) {
                return flooded->insideRow(x, y, z0);
              }};
    }
    case Fill::winding: {
      Filling out = windingOf(std::move(mesh), progress);
      out.reason = "as asked for";
      return out;
    }
    case Fill::automatic:
      break;
  }
  if (options.shellThickness > 0.0) {
    return shellOf(original, options, voxelSize, "a thickness of shell was asked for");
  }
  if (closed) {
    Filling out = windingOf(std::move(mesh), progress);
    out.reason = "the mesh is closed";
    return out;
  }
  const double encloses = enclosure(mesh);
  if (encloses < kEncloses) {
    return shellOf(original, options, voxelSize,
                   "the mesh is open and encloses nothing: " + percent(1.0 - encloses) +
                       " of what its inner side sees is outside");
  }
  Filling out = windingOf(std::move(mesh), progress);
  out.reason = "the mesh is open; its holes are closed where it winds half way round";
  return out;
}

WallThickness wallThickness(const TriangleMesh& mesh, double longestSideVoxels) {
  constexpr std::size_t kSamples = 2000;
  constexpr double kThinnestShare = 0.01;
  const TriangleTree tree(mesh);
  std::vector<double> thickness;
  for (const Sample& s : samplesOf(mesh, kSamples)) {
    thickness.push_back(tree.firstHit(s.point, -s.normal, kBeside));
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
