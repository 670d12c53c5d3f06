// The bodies of a mesh of several closed components.
#include "remesh/bodies.h"

#include <glm/common.hpp>
#include <memory>
#include <numeric>
#include <utility>

#include "base/cancel_flag.h"
#include "mesh/search/triangle_tree.h"
#include "remesh/manifold.h"

namespace sherd {
namespace {

constexpr std::uint32_t kUnnumbered = 0xffffffffu;

// Returns [components] the meshes of components, with TriangleMesh::source.
std::vector<TriangleMesh> componentsOf(const TriangleMesh& mesh) {
  const MeshComponents components = meshComponents(mesh);
  std::vector<TriangleMesh> out(components.count);
  std::vector<std::uint32_t> number(mesh.vertices.size(), kUnnumbered);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    TriangleMesh& own = out[components.ofTriangle[t]];
    glm::uvec3 corner;
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& n = number[mesh.triangles[t][k]];  // a vertex is of one component
      if (n == kUnnumbered) {
        n = static_cast<std::uint32_t>(own.vertices.size());
        own.vertices.push_back(mesh.vertices[mesh.triangles[t][k]]);
      }
      corner[k] = n;
    }
    own.triangles.push_back(corner);
    own.source.push_back(t);
  }
  return out;
}

bool contains(const Box& box, const glm::dvec3& p) { return glm::clamp(p, box.min, box.max) == p; }

void appendCavity(const TriangleMesh& from, TriangleMesh& to) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), from.vertices.begin(), from.vertices.end());
  for (const glm::uvec3& t : from.triangles) to.triangles.push_back(t + first);
  to.source.insert(to.source.end(), from.source.begin(), from.source.end());
}

}  // namespace

std::vector<TriangleMesh> bodiesOf(const TriangleMesh& mesh, const Progress* progress) {
  LabeledMesh sheets{.mesh = {mesh.vertices, mesh.triangles}};
  sheets.positionId.resize(mesh.vertices.size());
  std::iota(sheets.positionId.begin(), sheets.positionId.end(), 0u);
  if (!makeManifold(sheets)) return {};
  std::vector<TriangleMesh> bodies, cavities;
  for (TriangleMesh& component : componentsOf(sheets.mesh)) {
    (volume(component) < 0.0 ? cavities : bodies).push_back(std::move(component));
  }
  std::vector<Box> boxes;
  std::vector<double> volumes;
  for (const TriangleMesh& body : bodies) {
    boxes.push_back(bounds(body));
    volumes.push_back(volume(body));
  }
  std::vector<std::unique_ptr<TriangleTree>> trees(bodies.size());  // made when needed
  const std::size_t count = bodies.size();
  std::vector<std::size_t> bodyOf;  // [cavities] the smallest around it
  for (const TriangleMesh& cavity : cavities) {
    const glm::dvec3& p = cavity.vertices.front();
    std::size_t smallest = count;
    throwIfCancelled(progress);
    for (std::size_t b = 0; b < count; ++b) {
      if (!contains(boxes[b], p)) continue;
      if (smallest != count && volumes[b] >= volumes[smallest]) continue;
      if (!trees[b]) trees[b] = std::make_unique<TriangleTree>(bodies[b]);
      if (trees[b]->winding(p) >= 0.5) smallest = b;
    }
    bodyOf.push_back(smallest);
  }
  for (std::size_t c = 0; c < cavities.size(); ++c) {
    if (bodyOf[c] == count) {
      bodies.push_back(std::move(cavities[c]));
    } else {
      appendCavity(cavities[c], bodies[bodyOf[c]]);
    }
  }
  return bodies;
}

}  // namespace sherd
