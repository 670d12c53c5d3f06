// Inside and outside by flood fill between surfaces.
#include "voxelize/fill/flood.h"

#include <sherd/solid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>

#include "base/cancel_flag.h"

namespace sherd {
namespace {

constexpr std::uint8_t kUnvisited = 255;
constexpr std::uint8_t kDeepest = 254;
constexpr std::size_t kVoxelsPerCancelCheck = 65536;

// Returns the mesh with permuted axes, so that columns along z are the original's along `axis`.
//
// Winding snaps only two axes to its lattice, so all three are snapped here: otherwise columns
// along x and z would be those of different meshes.  Vertices are also moved a few lattice steps
// off the voxel centers, because ties on a surface would be broken differently along x and z.  The
// number of steps differs per axis, or surfaces at 45 degrees would not move.
TriangleMesh columnsAlong(TriangleMesh mesh, int axis) {
  const double step = std::ldexp(1.0, -Winding::latticeBits(bounds(mesh)));
  for (glm::dvec3& v : mesh.vertices) {
    v = (glm::round(v / step) + glm::dvec3(1.0, 2.0, 3.0)) * step;
    v = {v[(axis + 1) % 3], v[(axis + 2) % 3], v[axis]};
  }
  return mesh;
}

}  // namespace

FloodedBox::FloodedBox(const TriangleMesh& mesh, const Progress* progress) {
  const Box box = bounds(mesh);
  for (int axis = 0; axis < 3; ++axis) {
    box_.min[axis] = static_cast<int>(std::floor(box.min[axis])) - 1;
    box_.max[axis] = static_cast<int>(std::ceil(box.max[axis])) + 1;
  }
  const openvdb::Coord dims = box_.dims();
  depth_.assign(static_cast<std::size_t>(dims.x()) * static_cast<std::size_t>(dims.y()) *
                    static_cast<std::size_t>(dims.z()),
                kUnvisited);
  const std::array<Winding, 3> columns{
      Winding(columnsAlong(mesh, 0), Winding::Rule::parity, progress),
      Winding(columnsAlong(mesh, 1), Winding::Rule::parity, progress),
      Winding(columnsAlong(mesh, 2), Winding::Rule::parity, progress)};
  const auto state = [&](int axis, const openvdb::Coord& p) {
    return columns[static_cast<std::size_t>(axis)].at(
        {p[(axis + 1) % 3], p[(axis + 2) % 3], p[axis]});
  };

  // Level by level: first the voxels reached without a crossing, then those one crossing farther.
  std::size_t reached = 0;
  std::vector<openvdb::Coord> level{box_.min}, beyond;
  depth_[indexOf(box_.min)] = 0;
  for (std::uint8_t depth = 0; !level.empty() && depth <= kDeepest; ++depth) {
    beyond.clear();
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (++reached % kVoxelsPerCancelCheck == 0) throwIfCancelled(progress);
      const openvdb::Coord from = level[i];
      for (int axis = 0; axis < 3; ++axis) {
        for (const int step : {-1, 1}) {
          openvdb::Coord to = from;
          to[axis] += step;
          if (to[axis] < box_.min[axis] || to[axis] > box_.max[axis]) continue;
          std::uint8_t& seen = depth_[indexOf(to)];
          if (seen != kUnvisited) continue;
          if (state(axis, from) == state(axis, to)) {
            seen = depth;
            level.push_back(to);
          } else {
            beyond.push_back(to);
          }
        }
      }
    }
    level.clear();
    for (const openvdb::Coord& to : beyond) {
      std::uint8_t& seen = depth_[indexOf(to)];
      if (seen != kUnvisited) continue;
      seen = static_cast<std::uint8_t>(depth + 1);
      level.push_back(to);
    }
  }
}

bool FloodedBox::isInside(const openvdb::Coord& voxel) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (voxel[axis] < box_.min[axis] || voxel[axis] > box_.max[axis]) return false;
  }
  return (depth_[indexOf(voxel)] & 1) != 0;
}

}  // namespace sherd
