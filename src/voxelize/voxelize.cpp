// From a mesh to a solid.
#include <sherd/error.h>
#include <sherd/solid.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

#include "mesh/repair.h"
#include "voxelize/bridges.h"
#include "voxelize/distance.h"
#include "voxelize/fill.h"
#include "voxelize/specks.h"

namespace sherd {
namespace {

constexpr int kLargestResolution = 4096;

TriangleMesh inIndexSpace(TriangleMesh mesh, const GridFrame& frame) {
  for (glm::dvec3& v : mesh.vertices) v = frame.indexFromWorld({v}).v;
  return mesh;
}

}  // namespace

double voxelSizeFor(const TriangleMesh& mesh, const SolidOptions& options) {
  const double longest = longestSide(bounds(mesh));
  if (!(longest > 0.0) || !std::isfinite(longest)) {
    throw Error(ErrorCode::input, "the mesh's box has no size that can be divided into voxels");
  }
  if (options.voxelSize == 0.0) {
    if (options.resolution < 8 || options.resolution > kLargestResolution) {
      throw Error(ErrorCode::usage, "a resolution of " + std::to_string(options.resolution) +
                                        " was asked for, 8 to " +
                                        std::to_string(kLargestResolution) + " are possible");
    }
    return longest / options.resolution;
  }
  if (!(options.voxelSize > 0.0) || !(longest / options.voxelSize <= kLargestResolution)) {
    std::ostringstream text;
    text << "a voxel size of " << options.voxelSize << " was asked for; the mesh is " << longest
         << " long, so it has to be " << longest / kLargestResolution << " or more";
    throw Error(ErrorCode::usage, text.str());
  }
  return options.voxelSize;
}

int resolutionFor(const TriangleMesh& mesh, double voxelSize) {
  constexpr double kRounding = 1e-9;  // a side of exactly n voxels shall not become n + 1
  return static_cast<int>(std::ceil(longestSide(bounds(mesh)) / voxelSize - kRounding));
}

Solid voxelize(const TriangleMesh& source, const SolidOptions& options, const Progress* progress) {
  step(progress, "voxelize", 0.0);
  Solid solid;
  solid.frame.voxelSize = voxelSizeFor(source, options);
  solid.frame.origin.v = bounds(source).min + 0.5 * solid.frame.voxelSize;
  const double voxelSize = solid.frame.voxelSize;
  if (!(options.shellThickness >= 0.0) || !std::isfinite(options.shellThickness)) {
    throw Error(ErrorCode::usage, "a shell's thickness has to be above 0");
  }

  const TriangleMesh mesh = inIndexSpace(source, solid.frame);
  Repaired whole = repaired(mesh);
  SolidReport& report = solid.report;
  report.defects = whole.defects;
  step(progress, "voxelize", 0.1);
  const SearchedMesh clean = searched(std::move(whole.mesh));
  report.walls = wallThickness(clean, longestSide(bounds(mesh)));
  report.meshVolume = (volume(clean.mesh) + volume(clean.caps)) * std::pow(voxelSize, 3);
  const Filling filling = fillingOf(clean, mesh, options, voxelSize, progress);
  report.fill = filling.fill;
  report.fillReason = filling.reason;
  if (filling.fill == Fill::shell) {
    report.shellThickness = 2.0 * filling.halfThickness * voxelSize;
    report.meshVolume = 0.0;
  }
  step(progress, "voxelize", 0.3);

  if (!filling.surface->empty()) {
    const FloatGridPtr distance = levelSetOf(filling, solid.frame, progress);
    solid.blocks = leafBlocks(*distance);
    const std::vector<std::size_t> bridges = bridgesOf(solid.blocks, filling, progress);
    addVoxels(*distance, solid.blocks, bridges);
    report.bridges = bridges.size();
    solid.distance = distance;
    measureVoxels(solid);
  }
  if (solid.voxels == 0) {
    throw Error(ErrorCode::input, "no voxel centre lies inside the mesh at a voxel size of " +
                                      std::to_string(solid.frame.voxelSize) +
                                      "; try a higher --resolution");
  }
  step(progress, "voxelize", 1.0);
  return solid;
}

}  // namespace sherd
