// The bodies of a closed mesh that have nothing in common.
#include "voxelize/bodies/disjoint_bodies.h"

#include <algorithm>
#include <glm/common.hpp>
#include <optional>

#include "base/cancel_flag.h"
#include "base/union_find.h"
#include "intersect/self_crossings.h"
#include "mesh/search/near_boxes.h"
#include "mesh/search/triangle_tree.h"

namespace sherd {
namespace {

// A part of the mesh that encloses points of space.
class Enclosure {
 public:
  explicit Enclosure(TriangleMesh mesh)
      : mesh_(std::move(mesh)), box_(bounds(mesh_)), volume_(volume(mesh_)) {}

  [[nodiscard]] double enclosed() const { return volume_; }
  [[nodiscard]] const Box& box() const { return box_; }

  bool contains(const glm::dvec3& p) {
    if (glm::clamp(p, box_.min, box_.max) != p) return false;
    if (!tree_) tree_.emplace(mesh_);
    return tree_->winding(p) >= 0.5;
  }

 private:
  TriangleMesh mesh_;
  Box box_;
  double volume_;
  std::optional<TriangleTree> tree_{};  // made when needed
};

// Joins each cavity to the smallest body around it.  What fills the cavity is not around it.
void joinCavities(const ComponentMeshes& components, UnionFind& bodies) {
  constexpr double kRounding = 1e-9;
  std::vector<Enclosure> all;
  for (std::uint32_t c = 0; c < components.count(); ++c) {
    all.emplace_back(components.joined(std::span(&c, 1)));
  }
  std::vector<std::uint32_t> outsides, cavities;
  for (std::uint32_t c = 0; c < all.size(); ++c) {
    (all[c].enclosed() < 0.0 ? cavities : outsides).push_back(c);
  }
  if (cavities.empty() || outsides.empty()) return;
  std::vector<Box> boxes;
  for (const std::uint32_t outside : outsides) boxes.push_back(all[outside].box());
  const BoxTree tree(boxes);
  for (const std::uint32_t cavity : cavities) {
    const glm::dvec3 p = components.point(cavity);
    std::optional<std::uint32_t> smallest;
    for (const std::uint32_t i : tree.meeting({p, p})) {
      Enclosure& outside = all[outsides[i]];
      if (smallest && outside.enclosed() >= all[*smallest].enclosed()) continue;
      if (outside.enclosed() <= -(1.0 + kRounding) * all[cavity].enclosed()) continue;
      if (outside.contains(p)) smallest = outsides[i];
    }
    if (smallest) bodies.unite(cavity, *smallest);
  }
}

// Joins bodies to those within whose solids they lie.
//   body  [components] with their cavities
void joinNested(const ComponentMeshes& components, const std::vector<std::uint32_t>& body,
                std::span<const std::uint8_t> near, UnionFind& bodies, const Progress* progress) {
  std::vector<std::vector<std::uint32_t>> parts(components.count());  // of bodies, by their name
  for (std::uint32_t c = 0; c < body.size(); ++c) parts[body[c]].push_back(c);
  std::vector<std::uint32_t> names;
  std::vector<Enclosure> solids;
  for (std::uint32_t name = 0; name < parts.size(); ++name) {
    if (parts[name].empty()) continue;
    names.push_back(name);
    solids.emplace_back(components.joined(parts[name]));
  }
  std::vector<Box> boxes;
  for (const Enclosure& solid : solids) boxes.push_back(solid.box());
  const BoxTree tree(boxes);
  for (const std::uint32_t inner : names) {
    throwIfCancelled(progress);
    const bool isNear = std::any_of(parts[inner].begin(), parts[inner].end(),
                                    [&](std::uint32_t c) { return near[c] != 0; });
    if (!isNear) continue;
    const glm::dvec3 p = components.point(inner);
    for (const std::uint32_t i : tree.meeting({p, p})) {
      if (bodies.find(inner) == bodies.find(names[i])) continue;
      if (solids[i].contains(p)) bodies.unite(inner, names[i]);
    }
  }
}

}  // namespace

std::vector<std::uint32_t> withCavities(const ComponentMeshes& components) {
  UnionFind bodies(components.count());
  joinCavities(components, bodies);
  return std::move(bodies).all();
}

std::vector<std::uint32_t> disjointBodies(std::span<const glm::dvec3> vertices,
                                          const TriangleMesh& mesh,
                                          const MeshComponents& components,
                                          std::span<const std::uint8_t> near,
                                          const Progress* progress) {
  const ComponentMeshes parts(vertices, mesh, components);
  const std::vector<std::uint32_t> body = withCavities(parts);
  UnionFind bodies(components.count);
  for (std::uint32_t c = 0; c < components.count; ++c) bodies.unite(c, body[c]);
  std::vector<std::uint32_t> bodyOfTriangle;
  for (const std::uint32_t c : components.ofTriangle) bodyOfTriangle.push_back(body[c]);
  for (const auto& [s, t] :
       selfCrossings(vertices, mesh.triangles, progress, {.source = bodyOfTriangle})) {
    bodies.unite(bodyOfTriangle[s], bodyOfTriangle[t]);
  }
  joinNested(parts, body, near, bodies, progress);
  return std::move(bodies).all();
}

}  // namespace sherd
