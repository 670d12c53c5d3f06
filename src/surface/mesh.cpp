// Level sets to triangles.  Only this file compiles OpenVDB's mesher.
#include "surface/mesh.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "mesh/flipped_orientation.h"

namespace sherd {
namespace {

double squaredDistance(const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(a - b, a - b); }

// The same tree with an identity transform, so that float positions lose no precision far from the
// origin.
openvdb::FloatGrid::ConstPtr inIndexSpace(const openvdb::FloatGrid& grid) {
  openvdb::FloatGrid::Ptr view =
      openvdb::FloatGrid::create(openvdb::ConstPtrCast<openvdb::FloatTree>(grid.constTreePtr()));
  view->setGridClass(openvdb::GRID_LEVEL_SET);
  return view;
}

// In index space.
TriangleMesh meshAt(double isovalue, const openvdb::FloatGrid& grid) {
  openvdb::tools::VolumeToMesh mesher(isovalue,
                                      /*adaptivity=*/0.0);  // new: a mesher keeps state
  mesher(*inIndexSpace(grid));

  TriangleMesh out;
  std::vector<glm::dvec3>& vertices = out.vertices;
  vertices.reserve(mesher.pointListSize());
  for (std::size_t i = 0; i < mesher.pointListSize(); ++i) {
    const openvdb::Vec3s& p = mesher.pointList()[i];
    vertices.push_back({p.x(), p.y(), p.z()});
  }
  // OpenVDB winds a level set's faces clockwise seen from outside.
  for (std::size_t n = 0; n < mesher.polygonPoolListSize(); ++n) {
    const openvdb::tools::PolygonPool& pool = mesher.polygonPoolList()[n];
    const auto add = [&](unsigned a, unsigned b, unsigned c) {
      out.triangles.push_back({c, b, a});
    };
    for (std::size_t i = 0; i < pool.numQuads(); ++i) {
      const openvdb::Vec4I& q = pool.quad(i);
      if (squaredDistance(vertices[q[0]], vertices[q[2]]) <=
          squaredDistance(vertices[q[1]], vertices[q[3]])) {
        add(q[0], q[1], q[2]);
        add(q[0], q[2], q[3]);
      } else {
        add(q[1], q[2], q[3]);
        add(q[1], q[3], q[0]);
      }
    }
    for (std::size_t i = 0; i < pool.numTriangles(); ++i) {
      const openvdb::Vec3I& t = pool.triangle(i);
      add(t[0], t[1], t[2]);
    }
  }
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
