// Sheets of a fragment that touch along edges, and are moved apart there.
#include "remesh/parts/part_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <numeric>
#include <vector>

#include "intersect/self_crossings.h"
#include "mesh/positions.h"
#include "shapes.h"

namespace sherd {
namespace {

// A fragment of several tetrahedra, each with vertices of its own.
LabeledMesh tetrahedra(const std::vector<std::array<glm::dvec3, 4>>& all) {
  LabeledMesh out;
  for (std::array<glm::dvec3, 4> corner : all) {
    const glm::dvec3 &a = corner[0], &b = corner[1], &c = corner[2], &d = corner[3];
    if (glm::dot(glm::cross(b - a, c - a), d - a) < 0.0) std::swap(corner[2], corner[3]);
    const auto first = static_cast<std::uint32_t>(out.mesh.vertices.size());
    out.mesh.vertices.insert(out.mesh.vertices.end(), corner.begin(), corner.end());
    for (const glm::uvec3& t :
         {glm::uvec3(0, 2, 1), glm::uvec3(0, 1, 3), glm::uvec3(1, 2, 3), glm::uvec3(0, 3, 2)}) {
      out.mesh.triangles.push_back(t + first);
    }
  }
  out.other.assign(out.mesh.triangles.size(), 0);
  for (std::uint32_t v = 0; v < out.mesh.vertices.size(); ++v) out.positionId.push_back(v);
  return out;
}

std::size_t crossingsBetween(const TriangleMesh& mesh) {
  std::vector<glm::uvec3> merged = mesh.triangles;
  const std::vector<std::uint32_t> first = firstAtPosition(mesh.vertices);
  for (glm::uvec3& t : merged) t = {first[t.x], first[t.y], first[t.z]};
  return selfCrossings(mesh.vertices, merged).size();
}

void expectParted(const LabeledMesh& touching) {
  ASSERT_GT(volume(touching.mesh), 0.0);
  ASSERT_GT(touchingEdges(touching), 0u);
  std::vector<LabeledMesh> meshes{touching};
  EXPECT_EQ(partSheets(meshes), "");
  EXPECT_EQ(touchingEdges(meshes[0]), 0u);
  EXPECT_EQ(crossingsBetween(meshes[0].mesh), 0u);
  const Box box = bounds(touching.mesh);
  const glm::dvec3 size = box.max - box.min;
  const double side = std::max({size.x, size.y, size.z});
  for (std::size_t v = 0; v < touching.mesh.vertices.size(); ++v) {
    const glm::dvec3 by = meshes[0].mesh.vertices[v] - touching.mesh.vertices[v];
    EXPECT_LE(glm::length(by), 1.0001 * kPartedSheets * side);
  }
}

const std::array<glm::dvec3, 4> kBelow{glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 0),
                                       glm::dvec3(0.5, -1, 0), glm::dvec3(0.5, 0, -1)};

TEST(PartSheets, MovesOneIntoTheFragment) {
  expectParted(tetrahedra({kBelow, {kBelow[0], kBelow[1], {0.5, 1, 0}, {0.5, 0, 1}}}));
}

// The faces at the tip of a needle lean on each other: their mean normal is along the needle, which
// leads along the edge.
TEST(PartSheets, MovesTheTipOfANeedleThatLiesOnAnEdge) {
  for (const double e : {1e-3, 1e-4, 1e-5}) {
    SCOPED_TRACE(e);
    expectParted(tetrahedra({kBelow, {kBelow[0], kBelow[1], {1, e, 0}, {1, 0, e}}}));
  }
}

// Both ends of the edge are tips.
TEST(PartSheets, MovesASliverThatLiesOnAnEdge) {
  for (const double e : {1e-3, 1e-4}) {
    SCOPED_TRACE(e);
    expectParted(tetrahedra({kBelow, {kBelow[0], kBelow[1], {0.3, e, 0}, {0.7, 0, e}}}));
  }
}

// Two cavities have an edge in common: what lies inwards of one is the other.
TEST(PartSheets, MovesOneOutOfTheFragmentWhereCavitiesTouch) {
  LabeledMesh cavities = tetrahedra({kBelow, {kBelow[0], kBelow[1], {0.5, 1, 0}, {0.5, 0, 1}}});
  for (glm::uvec3& t : cavities.mesh.triangles) std::swap(t.y, t.z);
  LabeledMesh solid{.mesh = shapes::append(cavities.mesh, shapes::cube(4.0))};
  solid.other.assign(solid.mesh.triangles.size(), 0);
  solid.positionId.resize(solid.mesh.vertices.size());
  std::iota(solid.positionId.begin(), solid.positionId.end(), 0u);
  expectParted(solid);
}

}  // namespace
}  // namespace sherd
