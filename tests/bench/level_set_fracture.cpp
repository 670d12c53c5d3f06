// What tools/bench/bench_peers.py compares Sherd with: OpenVDB's LevelSetFracture, whose cutters
// are the Voronoi cells of random seeds.
//
// usage: level_set_fracture MESH FOLDER PIECES SEED RESOLUTION FRACTURES
// Writes FOLDER/0/piece_0.ply, ...  The level set of the mesh is made once for all fractures.
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetFracture.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <sherd/files.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <list>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;
using openvdb::FloatGrid, openvdb::Vec3d;
using Polygon = std::vector<Vec3d>;

constexpr float kHalfWidth = 3.0f;  // voxels

struct HalfSpace {  // normal . p <= offset
  Vec3d normal;
  double offset;
  double beyond(const Vec3d& p) const { return normal.dot(p) - offset; }
};

// The convex polygon around points of a plane.
Polygon sortedAround(const Vec3d& normal, Polygon points) {
  Vec3d center(0.0);
  for (const Vec3d& p : points) center += p / static_cast<double>(points.size());
  const Vec3d u = (points.front() - center).unit(), v = normal.unit().cross(u);
  const auto angle = [&](const Vec3d& p) {
    return std::atan2((p - center).dot(v), (p - center).dot(u));
  };
  std::sort(points.begin(), points.end(),
            [&](const Vec3d& a, const Vec3d& b) { return angle(a) < angle(b); });
  return points;
}

// Cuts what is beyond a plane off a convex polyhedron, given by its faces.
std::vector<Polygon> clipped(const std::vector<Polygon>& faces, const HalfSpace& keep) {
  std::vector<Polygon> made;
  Polygon cap;
  for (const Polygon& face : faces) {
    Polygon kept;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Vec3d &a = face[i], &b = face[(i + 1) % face.size()];
      const double da = keep.beyond(a), db = keep.beyond(b);
      if (da <= 0.0) kept.push_back(a);
      if ((da <= 0.0) == (db <= 0.0)) continue;
      kept.push_back(a + (b - a) * (da / (da - db)));
      cap.push_back(kept.back());
    }
    if (kept.size() >= 3) made.push_back(std::move(kept));
  }
  if (cap.size() >= 3) made.push_back(sortedAround(keep.normal, std::move(cap)));
  return made;
}

std::vector<Polygon> boxFaces(const Vec3d& low, const Vec3d& high) {
  std::vector<Polygon> faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      Polygon face;
      for (const auto& [u, v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        Vec3d p;
        p[axis] = upper ? high[axis] : low[axis];
        p[(axis + 1) % 3] = u ? high[(axis + 1) % 3] : low[(axis + 1) % 3];
        p[(axis + 2) % 3] = v ? high[(axis + 2) % 3] : low[(axis + 2) % 3];
        face.push_back(p);
      }
      if (!upper) std::reverse(face.begin(), face.end());
      faces.push_back(std::move(face));
    }
  }
  return faces;
}

FloatGrid::Ptr levelSet(const std::vector<Polygon>& faces,
                        const openvdb::math::Transform& transform) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Polygon& face : faces) {
    const auto first = static_cast<openvdb::Index32>(points.size());
    for (const Vec3d& p : face) points.emplace_back(p);
    for (openvdb::Index32 i = 2; i < face.size(); ++i)
      triangles.emplace_back(first, first + i - 1, first + i);
  }
  return openvdb::tools::meshToLevelSet<FloatGrid>(transform, points, triangles, kHalfWidth);
}

FloatGrid::Ptr levelSet(const sherd::TriangleMesh& mesh,
                        const openvdb::math::Transform& transform) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const glm::dvec3& v : mesh.vertices) points.emplace_back(v.x, v.y, v.z);
  for (const glm::uvec3& t : mesh.triangles) triangles.emplace_back(t.x, t.y, t.z);
  return openvdb::tools::meshToLevelSet<FloatGrid>(transform, points, triangles, kHalfWidth);
}

std::vector<Vec3d> seedsInside(const FloatGrid& solid, const Vec3d& low, const Vec3d& high,
                               int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share;
  const auto distance = solid.getConstAccessor();
  std::vector<Vec3d> seeds;
  while (static_cast<int>(seeds.size()) < count) {
    const Vec3d p = low + Vec3d(share(random), share(random), share(random)) * (high - low);
    if (distance.getValue(solid.transform().worldToIndexNodeCentered(p)) < 0.0f) seeds.push_back(p);
  }
  return seeds;
}

// All pieces: those that cutters make, and what the last one leaves.
std::list<FloatGrid::Ptr> broken(const FloatGrid& solid, const std::vector<Polygon>& box,
                                 const std::vector<Vec3d>& seeds) {
  openvdb::tools::LevelSetFracture<FloatGrid> fracture;
  std::list<FloatGrid::Ptr> rest{solid.deepCopy()};
  for (std::size_t i = 0; i + 1 < seeds.size(); ++i) {
    std::vector<Polygon> cell = box;
    for (std::size_t j = 0; j < seeds.size(); ++j) {
      if (j == i) continue;
      const Vec3d normal = seeds[j] - seeds[i];
      cell = clipped(cell, {normal, normal.dot((seeds[i] + seeds[j]) * 0.5)});
    }
    // Cells do not overlap, so that pieces are not cut again.
    fracture.fracture(rest, *levelSet(cell, solid.transform()), false, nullptr, nullptr, false);
  }
  std::list<FloatGrid::Ptr> pieces = fracture.fragments();
  pieces.splice(pieces.end(), rest);
  return pieces;
}

sherd::TriangleMesh meshOf(const FloatGrid& piece) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(piece, points, quads);
  sherd::TriangleMesh mesh;
  for (const openvdb::Vec3s& p : points) mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  for (const openvdb::Vec4I& q : quads) {  // OpenVDB's are clockwise
    mesh.triangles.emplace_back(q[0], q[2], q[1]);
    mesh.triangles.emplace_back(q[0], q[3], q[2]);
  }
  return mesh;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 7) {
    std::cerr << "usage: level_set_fracture MESH FOLDER PIECES SEED RESOLUTION FRACTURES\n";
    return 2;
  }
  const sherd::TriangleMesh mesh = sherd::readMesh(arguments[1]).mesh;
  const int pieces = std::atoi(arguments[3]), seed = std::atoi(arguments[4]),
            resolution = std::atoi(arguments[5]), fractures = std::atoi(arguments[6]);
  Vec3d low(1e300), high(-1e300);
  for (const glm::dvec3& v : mesh.vertices) {
    low = openvdb::math::minComponent(low, Vec3d(v.x, v.y, v.z));
    high = openvdb::math::maxComponent(high, Vec3d(v.x, v.y, v.z));
  }
  const Vec3d side = high - low;
  const double size = std::max({side.x(), side.y(), side.z()}) / resolution;
  const auto transform = openvdb::math::Transform::createLinearTransform(size);
  const FloatGrid::Ptr solid = levelSet(mesh, *transform);
  const Vec3d margin(8.0 * size);  // so that no face of the box is in the solid's band
  const std::vector<Polygon> box = boxFaces(low - margin, high + margin);
  for (int i = 0; i < fractures; ++i) {
    const fs::path folder = fs::path(arguments[2]) / std::to_string(i);
    fs::create_directories(folder);
    const auto first = static_cast<unsigned>(seed + i);
    int number = 0;
    for (const FloatGrid::Ptr& piece :
         broken(*solid, box, seedsInside(*solid, low, high, pieces, first))) {
      sherd::writePly(folder / ("piece_" + std::to_string(number++) + ".ply"), meshOf(*piece));
    }
  }
}
