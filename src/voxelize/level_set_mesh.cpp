// Level sets to triangles, by the mesher that OpenVDB's library holds: nothing of it is compiled
// here.
#include "voxelize/level_set_mesh.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "mesh/flipped_orientation.h"

namespace sherd {
namespace {

double squaredDistance(const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(a - b, a - b); }

// The same tree with an identity transform, so that float positions lose no precision far from the
// origin.  GridBase makes it: a constructor of FloatGrid would compile the whole class here.
openvdb::FloatGrid::ConstPtr indexSpaceGrid(const openvdb::GridBase& grid) {
  openvdb::MetaMap levelSet;
  levelSet.insertMeta(
      openvdb::GridBase::META_GRID_CLASS,
      openvdb::StringMetadata(openvdb::GridBase::gridClassToString(openvdb::GRID_LEVEL_SET)));
  return openvdb::gridConstPtrCast<openvdb::FloatGrid>(grid.copyGridReplacingMetadataAndTransform(
      levelSet, openvdb::math::Transform::createLinearTransform()));
}

// In index space.
TriangleMesh meshAt(double isovalue, const openvdb::FloatGrid& grid) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*indexSpaceGrid(grid), points, triangles, quads, isovalue,
                               /*adaptivity=*/0.0);

  TriangleMesh out;
  std::vector<glm::dvec3>& vertices = out.vertices;
  vertices.reserve(points.size());
  for (const openvdb::Vec3s& p : points) vertices.push_back({p.x(), p.y(), p.z()});
  // OpenVDB winds a level set's faces clockwise seen from outside.
  const auto add = [&](unsigned a, unsigned b, unsigned c) { out.triangles.push_back({c, b, a}); };
  for (const openvdb::Vec4I& q : quads) {
    if (squaredDistance(vertices[q[0]], vertices[q[2]]) <=
        squaredDistance(vertices[q[1]], vertices[q[3]])) {
      add(q[0], q[1], q[2]);
      add(q[0], q[2], q[3]);
    } else {
      add(q[1], q[2], q[3]);
      add(q[1], q[3], q[0]);
    }
  }
  for (const openvdb::Vec3I& t : triangles) add(t[0], t[1], t[2]);
  return out;
}

}  // namespace

TriangleMesh meshInWorld(const openvdb::FloatGrid& grid, double isovalue) {
  TriangleMesh mesh = meshAt(isovalue, grid);
  for (glm::dvec3& v : mesh.vertices) {
    const openvdb::Vec3d at = grid.indexToWorld(openvdb::Vec3d(v.x, v.y, v.z));
    v = {at.x(), at.y(), at.z()};
  }
  return volume(mesh) < 0.0 ? flippedOrientation(std::move(mesh))
                            : mesh;  // a mirroring transform, or a fog volume
}

}  // namespace sherd
