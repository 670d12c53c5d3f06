// The mesh of all labels is closed and manifold for any labels, and shared bit for bit.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <sherd/fracture.h>
#include <sherd/mesh.h>
#include <sherd/points.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "base/random.h"
#include "contact_boundaries.h"
#include "interface/cells/cell.h"
#include "interface/cells/creases.h"
#include "interface/interface_mesh.h"
#include "kernels/device_fixture.h"
#include "mesh_checks.h"
#include "remesh/resample/crack_jitter.h"
#include "remesh/resample/resample.h"
#include "shapes.h"
#include "voxelize/distance.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

using openvdb::Coord;

// A solid of whole voxels in a box of `side` voxels, its labels and their cut.
struct Labeled {
  Solid solid;
  Labels labels;
  Cut cut;
};

// `labelOf` returns 0 outside.  Distances to surface and cut are half a voxel at voxel centers.
template <class LabelOf>
Labeled labeled(int side, int fragments, const LabelOf& labelOf) {
  Labeled made;
  made.solid.frame = {glm::dvec3(0.0), 1.0};
  const FloatGridPtr distance = uniformGrid(3.0f);
  LeafBlocks blocks;
  for (int x = -8; x < side + 8; x += 8) {
    for (int y = -8; y < side + 8; y += 8) {
      for (int z = -8; z < side + 8; z += 8) blocks.origins.push_back({x, y, z});
    }
  }
  blocks.inside.assign(blocks.count() * 8, 0);
  blocks.exteriorBand.assign(blocks.count() * 8, 0);
  blocks.neighbors = leafNeighborTable(blocks.origins);
  made.labels.fragment.assign(blocks.count() * 512, 0);
  made.cut.only.assign(blocks.count(), 0);
  made.cut.snapWeight.assign(std::size_t{Labels::kEroded} + 1, 0.0f);
  for (std::size_t leaf = 0; leaf < blocks.count(); ++leaf) {
    CutLeaf cut;
    for (int id = 1; id <= fragments; ++id) cut.fragments.push_back(static_cast<std::uint16_t>(id));
    cut.distance.assign(cut.fragments.size() * 512, 0.5f);
    for (std::size_t voxel = leaf * 512; voxel < (leaf + 1) * 512; ++voxel) {
      const Coord at = blocks.voxelAt(voxel);
      const bool within = at.x() >= 0 && at.y() >= 0 && at.z() >= 0 && at.x() < side &&
                          at.y() < side && at.z() < side;
      const std::uint16_t label = within ? labelOf(at) : std::uint16_t{0};
      distance->tree().setValue(at, label ? -0.5f : 0.5f);
      if (!label) continue;
      blocks.inside[voxel / 64] |= std::uint64_t{1} << (voxel % 64);
      made.labels.fragment[voxel] = label;
      cut.distance[(label - std::size_t{1}) * 512 + voxel % 512] = -0.5f;
    }
    made.cut.index.push_back(static_cast<std::uint32_t>(leaf));
    made.cut.leaves.push_back(std::move(cut));
  }
  made.solid.distance = distance;
  made.solid.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  made.labels.blocks = made.solid.blocks;
  made.labels.fragmentCount = fragments;
  return made;
}

std::vector<LabeledMesh> meshesOf(const Labeled& made, int fragments) {
  const std::vector<LeafNeighbors> neighborhoods = leafNeighbors(made.solid.blocks->origins);
  const Creases creases(made.solid, neighborhoods, nullptr);
  const InterfaceSurface surface(made.solid, made.labels, made.cut, neighborhoods, creases, nullptr,
                                 SurfaceVertices::all, nullptr);
  const InterfaceMeshes all(surface, neighborhoods, nullptr);
  std::vector<LabeledMesh> meshes;
  for (int label = 1; label <= fragments; ++label)
    meshes.push_back(all.meshOf(static_cast<std::uint16_t>(label)));
  return meshes;
}

struct Vertices {
  std::size_t all = 0, coincident = 0;
};

Vertices expectManifold(const Labeled& made, int fragments) {
  const std::vector<std::uint64_t> voxels = countVoxels(made.labels);
  const std::vector<LabeledMesh> meshes = meshesOf(made, fragments);
  EXPECT_EQ(meshes.size(), static_cast<std::size_t>(fragments));
  Vertices vertices;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    SCOPED_TRACE("label " + std::to_string(i + 1));
    EXPECT_EQ(meshes[i].mesh.triangles.empty(), voxels[i + 1] == 0);
    expectClosedManifold(meshes[i].mesh);
    if (voxels[i + 1] > 0) {
      EXPECT_GT(volume(meshes[i].mesh), 0.0);
    }
    vertices.all += meshes[i].mesh.vertices.size();
    vertices.coincident += coincidentVertices(meshes[i].mesh);
  }
  return vertices;
}

TEST(Interface, EveryPairOfNeighboringCellsIsManifold) {
  // All labelings of 2 x 2 x 3 voxels with 0 or 1: every pair of cells that share a face.
  for (unsigned bits = 1; bits < 1u << 12; ++bits) {
    const Labeled made = labeled(3, 1, [&](const Coord& v) {
      const int n = v.x() * 4 + v.y() * 2 + v.z();
      return static_cast<std::uint16_t>(v.y() < 2 && v.z() < 2 && ((bits >> n) & 1));
    });
    SCOPED_TRACE(testing::Message() << "voxels " << bits);
    EXPECT_EQ(expectManifold(made, 1).coincident, 0u);
    if (HasFailure()) return;
  }
}

TEST(Interface, RandomLabelsGiveManifoldMeshes) {
  Vertices vertices;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const int fragments = 1 + static_cast<int>(seed % 5);
    const std::uint64_t outside = seed / 5 % 4;  // quarters of the voxels that are outside
    const Labeled made = labeled(12, fragments, [&](const Coord& v) {
      const auto item = static_cast<std::uint64_t>((v.x() * 64 + v.y()) * 64 + v.z());
      if (mixed(item * 977 + seed) % 4 < outside) return std::uint16_t{0};
      return static_cast<std::uint16_t>(1 + mixed(item * 7919 + seed * 31 + 5) %
                                                static_cast<std::uint64_t>(fragments));
    });
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Vertices found = expectManifold(made, fragments);
    // In noise, sheets of several labels meet, and some cannot be split.
    if (fragments == 1) {
      EXPECT_EQ(found.coincident, 0u);
    }
    vertices.all += found.all;
    vertices.coincident += found.coincident;
    if (HasFailure()) return;
  }
  EXPECT_LT(1000 * vertices.coincident, vertices.all);
}

TEST(Interface, IndependentMeshesOfRandomLabelsAreManifold) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const int fragments = 1 + static_cast<int>(seed % 5);
    const std::uint64_t outside = seed / 5 % 4, eroded = seed / 20 % 2;
    const Labeled made = labeled(12, fragments, [&](const Coord& v) {
      const auto item = static_cast<std::uint64_t>((v.x() * 64 + v.y()) * 64 + v.z());
      if (mixed(item * 977 + seed) % 4 < outside) return std::uint16_t{0};
      return static_cast<std::uint16_t>(1 + mixed(item * 7919 + seed * 31 + 5) %
                                                static_cast<std::uint64_t>(fragments));
    });
    Labels labels = made.labels;
    made.solid.blocks->forEachInside([&](std::size_t voxel) {
      if (eroded > 0 && mixed(voxel * 271 + seed) % 8 == 0)
        labels.fragment[voxel] = Labels::kEroded;
    });
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    for (const Fragment& fragment :
         extractFragments(made.solid, labels,
                          {.surface = {.levelSets = false, .interface = Interface::independent},
                          .uneroded = eroded > 0 ? &made.labels : nullptr})) {
      expectClosedManifold(fragment.mesh);
      EXPECT_GT(volume(fragment.mesh), 0.0);
    }
  }
}

TEST(Interface, SplitsNonManifoldVertices) {
  // Voxels of label 1 that share only a corner, only an edge, and edges around a corner.  The mesh
  // must stay manifold when equal positions are merged.
  const std::vector<std::vector<Coord>> cases{
      {{2, 2, 2}, {3, 3, 3}}, {{2, 2, 2}, {3, 3, 2}}, {{2, 2, 2}, {2, 3, 3}, {3, 3, 2}}};
  for (const std::vector<Coord>& ones : cases) {
    for (const int others : {1, 2, 3}) {
      const Labeled made = labeled(6, 4, [&](const Coord& v) {
        if (std::find(ones.begin(), ones.end(), v) != ones.end()) return std::uint16_t{1};
        const int k = others == 1 ? 0 : others == 2 ? v.x() > 2 : (v.x() > 2) + (v.y() > 2);
        return static_cast<std::uint16_t>(2 + k);
      });
      SCOPED_TRACE(testing::Message() << ones.size() << " voxels, " << others << " neighbors");
      EXPECT_EQ(expectManifold(made, 4).coincident, 0u);
    }
  }
}

TEST(Interface, SingleVoxelKeepsMostOfItsVolume) {
  Labeled made = labeled(5, 2, [](const Coord& v) {
    return v == Coord(2, 2, 2) ? std::uint16_t{1} : std::uint16_t{2};
  });
  // The crossings are at the middles of edges.  The mean of a cell's three is 1/6 from the voxel's
  // center along each axis; nine tenths of the way from there to the cell's center it is 7/15.
  made.cut.snapWeight[1] = 1.0f;
  EXPECT_NEAR(volume(meshesOf(made, 2)[0].mesh), std::pow(14.0 / 15.0, 3), 1e-6);
  made.cut.snapWeight[1] = 0.0f;
  EXPECT_NEAR(volume(meshesOf(made, 2)[0].mesh), std::pow(1.0 / 3.0, 3), 1e-6);
}

TEST(Interface, SingleVoxelKeepsItsVolumeMeshedIndependently) {
  const Labeled made = labeled(9, 2, [](const Coord& v) {
    return v == Coord(4, 4, 4) ? std::uint16_t{1} : std::uint16_t{2};
  });
  std::vector<double> volumes;
  for (const Interface interface : {Interface::shared, Interface::independent}) {
    const std::vector<Fragment> fragments = extractFragments(
        made.solid, made.labels, {.surface = {.levelSets = false, .interface = interface}});
    volumes.push_back(volume(fragments[0].mesh));
  }
  EXPECT_GT(volumes[0], 0.7);
  // All its vertices are corners, which do not slide: each side moves by the jitter at most.
  const double side = std::cbrt(volumes[0]);
  EXPECT_NEAR(volumes[1], volumes[0], std::pow(side + 2.0 * kCrackJitter, 3) - volumes[0]);
}

// The middle one of three has triangles enough, but its faces are those of the others, which have
// too many.
TEST(Interface, AThinFragmentKeepsItsVolumeBesideDecimatedOnes) {
  const Labeled made = labeled(48, 3, [](const Coord& v) {
    const int wave = (v.y() / 6 * 5 + v.z() / 6 * 3) % 7;
    return static_cast<std::uint16_t>(v.x() < 20 + wave ? 1 : (v.x() < 22 + wave ? 2 : 3));
  });
  const std::vector<Fragment> fragments = extractFragments(
      made.solid, made.labels, {.surface = {.levelSets = false, .triangles = {200}}});
  for (const Fragment& fragment : fragments) {
    EXPECT_NEAR(volume(fragment.coarse[0]) / volume(fragment.mesh), 1.0, 0.1 + 1e-9) << fragment.id;
  }
}

using Face = std::array<std::array<double, 3>, 3>;

// The faces of a mesh with a neighbor, sorted, each starting at its least corner.
std::vector<Face> facesTowards(const TriangleMesh& mesh, int other, bool reversed) {
  std::vector<Face> faces;
  for (std::size_t t = 0; t < mesh.neighbor.size(); ++t) {
    if (mesh.neighbor[t] != other) continue;
    Face face;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& v =
          mesh.vertices[mesh.triangles[t][static_cast<int>(reversed ? 2 - k : k)]];
      face[k] = {v.x, v.y, v.z};
    }
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

using InterfaceOfFracture = DeviceTest;

// Counts the faces that two fragments share; expects them to be identical from both sides.
std::size_t sharedFaces(const FractureResult& result) {
  std::size_t faces = 0;
  const auto compare = [&](const Fragment& a, const Fragment& b, const auto& meshOf) {
    const std::vector<Face> ours = facesTowards(meshOf(a), b.id, false);
    EXPECT_TRUE(ours == facesTowards(meshOf(b), a.id, true)) << a.id << " and " << b.id;
    faces += ours.size();
  };
  for (const Fragment& a : result.fragments) {
    for (const Fragment& b : result.fragments) {
      if (b.id <= a.id) continue;
      compare(a, b, [](const Fragment& f) { return f.mesh; });
      for (std::size_t i = 0; i < a.coarse.size(); ++i) {
        compare(a, b, [&](const Fragment& f) { return f.coarse[i]; });
      }
    }
  }
  return faces;
}

TEST_F(InterfaceOfFracture, IsIdenticalFromBothSides) {
  for (const TriangleMesh& mesh :
       {shapes::ball(1.0), shapes::cup(1.0, 0.08, 1.5, 0.25, 64), shapes::torus(1.0, 0.4)}) {
    EXPECT_GT(
        sharedFaces(fracture(
            mesh,
            {.pieces = 12, .seed = 4, .solid = {.resolution = 64}, .grow = {.roughness = 1.0}},
            device())),
        500u);
  }
}

TEST_F(InterfaceOfFracture, StaysIdenticalSimplifiedSmoothedAndDecimated) {
  for (const double roughness : {0.0, 1.0}) {
    for (const double adaptivity : {0.0, 0.1}) {
      for (const int iterations : {0, 3}) {
        for (const int erosions : {0, 1}) {
          SCOPED_TRACE(testing::Message()
                       << roughness << ' ' << adaptivity << ' ' << iterations << ' ' << erosions);
          FractureOptions options{.pieces = 9, .seed = 4, .solid = {.resolution = 48}};
          options.grow.roughness = roughness;
          options.surface.adaptivity = adaptivity;
          options.surface.smooth.iterations = {iterations};
          options.surface.smooth.boundaryIterations = {iterations};
          options.surface.triangles = {800, 200};
          options.erode.iterations = erosions;
          options.erode.probability = 0.2;
          const FractureResult result =
              fracture(shapes::cup(1.0, 0.3, 1.5, 0.3, 64), options, device());
          // Eroded faces have a neighbor, but are not shared.
          if (erosions == 0) {
            EXPECT_GT(sharedFaces(result), 100u);
          }
          for (const Fragment& fragment : result.fragments) {
            expectClosedManifold(fragment.mesh);
            EXPECT_EQ(coincidentVertices(fragment.mesh), 0u);
            ASSERT_EQ(fragment.coarse.size(), 2u);
            for (std::size_t i = 0; i < 2; ++i) {
              const TriangleMesh& coarse = fragment.coarse[i];
              expectClosedManifold(coarse);
              EXPECT_EQ(coincidentVertices(coarse), 0u);
              // Eroded and rough cracks have many regions, whose boundaries are preserved.
              if (roughness == 0.0 && erosions == 0) {
                EXPECT_LE(coarse.triangles.size(), options.surface.triangles[i]);
              }
            }
          }
        }
      }
    }
  }
}

TEST_F(InterfaceOfFracture, SimplificationPreservesVolumeAndArea) {
  // Flat faces and flat cracks need few polygons.
  FractureOptions options{.pieces = 6, .seed = 2, .solid = {.resolution = 64}};
  options.surface.adaptivity = 0.0;
  const FractureResult all = fracture(shapes::cube(1.0), options, device());
  options.surface.adaptivity = 0.05;
  const FractureResult fewer = fracture(shapes::cube(1.0), options, device());
  const double h = all.solid.frame.voxelSize;
  for (std::size_t i = 0; i < all.fragments.size(); ++i) {
    const Fragment &a = all.fragments[i], &b = fewer.fragments[i];
    EXPECT_LT(5 * b.mesh.triangles.size(), a.mesh.triangles.size());
    EXPECT_NEAR(a.mass.volume, b.mass.volume, 0.05 * h * a.area);
    EXPECT_NEAR(a.fractureArea, b.fractureArea, 0.01 * a.area);
  }
}

// Smoothing weights all edges alike, so meshes are simplified after it.
TEST_F(InterfaceOfFracture, SmoothingKeepsTheVolumeOfSimplifiedMeshes) {
  for (const Interface interface : {Interface::shared, Interface::independent}) {
    FractureOptions options{.pieces = 4, .seed = 2, .solid = {.resolution = 96}};
    options.surface.interface = interface;
    options.surface.adaptivity = 0.5;
    const FractureResult simplified = fracture(shapes::torus(1.0, 0.15), options, device());
    options.surface.smooth.iterations = {20};
    const FractureResult smoothed = fracture(shapes::torus(1.0, 0.15), options, device());
    for (std::size_t i = 0; i < simplified.fragments.size(); ++i) {
      const double before = simplified.fragments[i].mass.volume;
      EXPECT_NEAR(smoothed.fragments[i].mass.volume, before, 0.05 * before);
    }
  }
}

// The smaller of two closed surfaces.
TriangleMesh smallerComponent(const TriangleMesh& mesh) {
  const MeshComponents components = meshComponents(mesh);
  EXPECT_EQ(components.count, 2u);
  const auto first = std::count(components.ofTriangle.begin(), components.ofTriangle.end(), 0u);
  const std::uint32_t smaller = 2 * static_cast<std::size_t>(first) > mesh.triangles.size();
  TriangleMesh component{mesh.vertices, {}};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (components.ofTriangle[t] == smaller) component.triangles.push_back(mesh.triangles[t]);
  }
  return component;
}

TEST_F(InterfaceOfFracture, SmoothingPreservesASmallPore) {
  const TriangleMesh ball = shapes::hollowBall(1.0, 0.04);  // a pore little larger than a voxel
  FractureOptions options{.pieces = 1, .solid = {.resolution = 64}};
  const TriangleMesh before = fracture(ball, options, device()).fragments[0].mesh;
  options.surface.smooth.iterations = {20};
  options.surface.smooth.weight = 0.9;
  options.surface.smooth.method = Smoothing::laplacian;
  const TriangleMesh after = fracture(ball, options, device()).fragments[0].mesh;
  EXPECT_LT(volume(smallerComponent(before)), 0.0);
  EXPECT_NEAR(volume(smallerComponent(after)) / volume(smallerComponent(before)), 1.0, 1e-9);
  EXPECT_LT(volume(after), volume(before));
}

TEST_F(InterfaceOfFracture, LeavesNoGap) {
  // Shared faces cancel, so volumes add up to that of the outside faces.
  const FractureResult result = fracture(shapes::cup(1.0, 0.2, 1.5, 0.25, 64),
                                         {.pieces = 9, .solid = {.resolution = 64}}, device());
  double volumes = 0.0;
  TriangleMesh outside;
  for (const Fragment& f : result.fragments) {
    volumes += volume(f.mesh);
    const auto first = static_cast<unsigned>(outside.vertices.size());
    outside.vertices.insert(outside.vertices.end(), f.mesh.vertices.begin(), f.mesh.vertices.end());
    for (std::size_t t = 0; t < f.mesh.neighbor.size(); ++t) {
      if (f.mesh.neighbor[t] == 0) outside.triangles.push_back(f.mesh.triangles[t] + first);
    }
  }
  EXPECT_NEAR(volumes, volume(outside), 1e-9 * volumes);
}

// Points on fragments, and how deep they lie in other fragments at most, in voxels.
struct Depths {
  double deepest = 0.0;  // anywhere
  double apart = 0.0;    // from points on a crack, two voxels off its boundary, to the neighbor
  std::size_t onCracks = 0;
};

Depths depthsOf(const FractureResult& result) {
  const double h = result.solid.frame.voxelSize;
  Depths depths;
  for (const Fragment& fragment : result.fragments) {
    const SurfacePoints points = samplePoints(fragment.mesh, {.count = 1000});
    const Boundary boundary(fragment, h, Boundary::Of::regions);
    for (const Fragment& other : result.fragments) {
      if (other.id == fragment.id) continue;
      const std::vector<double> distance = signedDistances(other.mesh, points.positions);
      for (std::size_t i = 0; i < distance.size(); ++i) {
        depths.deepest = std::max(depths.deepest, -distance[i] / h);
        if (points.neighbor[i] != other.id || boundary.isWithin(2.0, points.positions[i])) continue;
        ++depths.onCracks;
        depths.apart = std::max(depths.apart, std::abs(distance[i]) / h);
      }
    }
  }
  return depths;
}

// Fragments that share voxel faces; those that only share voxel edges may have faces so near that
// each seems to be behind one of the other's.
TEST_F(InterfaceOfFracture, ContactsAreThoseOfVoxelsMeshedIndependentlyToo) {
  FractureOptions options{.pieces = 60, .solid = {.resolution = 32}};
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    options.seed = seed;
    options.surface.interface = Interface::shared;
    const FractureResult shared = fracture(shapes::cube(1.0), options, device());
    options.surface.interface = Interface::independent;
    const FractureResult independent = fracture(shapes::cube(1.0), options, device());
    for (std::size_t i = 0; i < shared.fragments.size(); ++i) {
      std::set<int> ofShared, ofIndependent, ofFaces;
      for (const Contact& c : shared.fragments[i].contacts) ofShared.insert(c.fragment);
      for (const Contact& c : independent.fragments[i].contacts) ofIndependent.insert(c.fragment);
      for (const std::uint16_t other : independent.fragments[i].mesh.neighbor) {
        if (other != 0) ofFaces.insert(other);
      }
      EXPECT_EQ(ofIndependent, ofShared) << "seed " << seed << ", fragment " << i + 1;
      EXPECT_TRUE(std::ranges::includes(ofIndependent, ofFaces)) << i + 1;
    }
  }
}

TEST_F(InterfaceOfFracture, PointsLieInOneFragmentOnly) {
  FractureOptions options{.pieces = 6, .seed = 3, .solid = {.resolution = 64}};
  for (const TriangleMesh& mesh : {shapes::ball(1.0), shapes::cup(1.0, 0.3, 1.5, 0.3, 64)}) {
    options.surface.interface = Interface::shared;
    const Depths shared = depthsOf(fracture(mesh, options, device()));
    EXPECT_GT(shared.onCracks, 500u);
    EXPECT_LT(shared.deepest, 1e-9);
    EXPECT_LT(shared.apart, 1e-9);
    options.surface.interface = Interface::independent;
    const Depths independent = depthsOf(fracture(mesh, options, device()));
    EXPECT_GT(independent.onCracks, 500u);
    EXPECT_LT(independent.apart, kMostResampled + 0.05);
  }
}

}  // namespace
}  // namespace sherd
