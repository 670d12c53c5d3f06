// Samples points on the faces that two fragments share.
#include <sherd/points.h>

#include <functional>
#include <set>
#include <utility>

#include "base/random.h"
#include "mesh/triangle_area.h"
#include "points/check_points.h"
#include "points/contact_sequence.h"
#include "points/point_sequence.h"

namespace sherd {
namespace {

// The faces of a contact, of one side.
struct ContactFaces {
  std::vector<std::uint32_t> triangles;
  std::vector<double> areaSums;
};

SurfaceTriangle triangleOf(const TriangleMesh& mesh, std::size_t triangle) {
  const glm::uvec3& t = mesh.triangles[triangle];
  return {{mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]}, mesh.neighborOf(triangle)};
}

ContactFaces facesOf(const TriangleMesh& mesh, int neighbor) {
  ContactFaces faces;
  for (std::size_t t = 0; t < mesh.neighbor.size(); ++t) {
    if (mesh.neighbor[t] != neighbor) continue;
    faces.triangles.push_back(static_cast<std::uint32_t>(t));
    const auto& [a, b, c] = triangleOf(mesh, t).corner;
    addArea(faces.areaSums, 0, a, b, c);
  }
  return faces;
}

std::set<int> neighborsWithArea(const TriangleMesh& mesh) {
  std::set<int> neighbors;
  for (std::size_t t = 0; t < mesh.neighbor.size(); ++t) {
    if (areaOf(triangleOf(mesh, t).corner) > 0.0) neighbors.insert(mesh.neighbor[t]);
  }
  return neighbors;
}

}  // namespace

ContactSequence::ContactSequence(std::span<const Fragment> fragments, std::size_t countPerContact,
                                 std::uint64_t seed)
    : fragments_(fragments), countPerContact_(countPerContact), seed_(seed) {
  if (countPerContact == 0) return;
  const auto most = static_cast<int>(fragments.size());
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const std::set<int> shown = neighborsWithArea(fragments[i].mesh);
    for (const Contact& contact : fragments[i].contacts) {
      const bool isLower = contact.fragment >= fragments[i].id && contact.fragment <= most;
      if (isLower && shown.contains(contact.fragment)) contacts_.push_back({i, contact.fragment});
    }
  }
}

void ContactSequence::visitContact(const Pair& pair,
                                   const std::function<void(const Correspondences&)>& visit) const {
  const Fragment& fragment = fragments_[pair.fragment];
  const ContactFaces faces = facesOf(fragment.mesh, pair.neighbor);
  SurfaceParts parts;
  parts.areaSums = {faces.areaSums};
  parts.triangle = [&](std::size_t, std::size_t triangle) {
    return triangleOf(fragment.mesh, faces.triangles[triangle]);
  };
  const SurfaceByArea surface(std::move(parts));
  const auto item =
      static_cast<std::uint64_t>(fragment.id) << 16 | static_cast<std::uint64_t>(pair.neighbor);
  const PointSequence points(
      surface, {.count = countPerContact_, .seed = randomBits(seed_, Stage::pointContact, item)});
  points.blocks().forEach([&](const SurfacePoints& block) {
    requireFinite(block, fragment.id);
    Correspondences some;
    some.fragments.assign(block.positions.size(), {fragment.id, pair.neighbor});
    some.positions = block.positions;
    some.normals = block.normals;
    visit(some);
  });
}

Blocks<Correspondences> ContactSequence::blocks() const {
  return {contacts_.size() * countPerContact_, [this](const auto& visit) {
            if (contacts_.empty()) visit(Correspondences());
            for (const Pair& pair : contacts_) visitContact(pair, visit);
          }};
}

Correspondences sampleCorrespondences(std::span<const Fragment> fragments,
                                      std::size_t countPerContact, std::uint64_t seed) {
  Correspondences found;
  const auto append = [](auto& to, const auto& some) {
    to.insert(to.end(), some.begin(), some.end());
  };
  ContactSequence(fragments, countPerContact, seed)
      .blocks()
      .forEach([&](const Correspondences& block) {
        append(found.fragments, block.fragments);
        append(found.positions, block.positions);
        append(found.normals, block.normals);
      });
  return found;
}

}  // namespace sherd
