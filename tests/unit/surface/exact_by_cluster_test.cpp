// Surface::exact where some bodies of the input can be cut and others can't: these have smooth
// surfaces, with the reason.
#include "surface/exact/exact_by_cluster.h"

#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/error.h>
#include <sherd/fracture.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "folder/manifest/mesh_report.h"
#include "mesh/positions.h"
#include "shapes.h"
#include "surface/exact/body_clusters.h"
#include "surface/extract.h"

namespace sherd {
namespace {

FractureOptions clusterOptions(int pieces, int resolution) {
  FractureOptions options;
  options.pieces = pieces;
  options.seed = 5;
  options.solid.resolution = resolution;
  options.surface = {.levelSets = false, .surface = Surface::exact};
  return options;
}

FractureOptions withVoxels(double size, int pieces) {
  FractureOptions options = clusterOptions(pieces, 64);
  options.solid.voxelSize = size;
  return options;
}

FractureResult brokenByCluster(const TriangleMesh& mesh, const FractureOptions& options,
                               const Progress* progress = nullptr) {
  Device device("builtin");
  return fracture(mesh, options, device, progress);
}

TriangleMesh box(const glm::dvec3& low, const glm::dvec3& size) {
  TriangleMesh mesh = shapes::cube(1.0);
  for (glm::dvec3& v : mesh.vertices) v = low + (v + 0.5) * size;
  return mesh;
}

TriangleMesh openBox(const glm::dvec3& low, const glm::dvec3& size) {
  TriangleMesh mesh = box(low, size);
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 2);
  return mesh;
}

// An open box with a small one beside it that no crack meets.  The gap is a third of a voxel wide,
// so that their voxels are joined: a fragment would be both, and they can't be cut.
TriangleMesh badBody(const glm::dvec3& center, double voxelSize) {
  const TriangleMesh large = openBox(center - 1.0, glm::dvec3(2.0));
  const double side = 4.0 * voxelSize;
  return shapes::append(
      large, openBox(center + glm::dvec3(1.0 + voxelSize / 3.0, 0.1, 0.1), glm::dvec3(side)));
}

using Face = std::array<std::array<double, 3>, 3>;

// Every face of a crack, with how often it is there, from either side.
std::map<Face, int> cracksOf(const FractureResult& result) {
  std::map<Face, int> cracks;
  for (const Fragment& fragment : result.fragments) {
    const TriangleMesh& own = fragment.mesh;
    for (std::size_t t = 0; t < own.triangles.size(); ++t) {
      if (own.neighbor[t] == 0) continue;
      Face face{};
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3& v = own.vertices[own.triangles[t][static_cast<int>(k)]];
        face[k] = {v.x, v.y, v.z};
      }
      std::sort(face.begin(), face.end());
      ++cracks[face];
    }
  }
  return cracks;
}

// Fragments are closed and one body, cracks are shared bit for bit, and faces have neighbors of
// their own kind alone.
void expectSound(const FractureResult& result) {
  for (const Fragment& fragment : result.fragments) {
    SCOPED_TRACE("fragment " + std::to_string(fragment.id));
    EXPECT_EQ(openEdges(fragment.mesh), 0u);
    EXPECT_EQ(nonManifoldEdges(fragment.mesh), 0u);
    EXPECT_EQ(meshComponents(fragment.mesh).count, 1u);
    EXPECT_GT(fragment.mass.volume, 0.0);
    EXPECT_NEAR(fragment.mass.volume, volume(fragment.mesh), 1e-9);
    ASSERT_EQ(fragment.mesh.neighbor.size(), fragment.mesh.triangles.size());
    for (const std::uint16_t neighbor : fragment.mesh.neighbor) {
      if (neighbor == 0) continue;
      EXPECT_EQ(result.fragments[neighbor - 1u].meshedAs, fragment.meshedAs);
    }
  }
  for (const auto& [face, sides] : cracksOf(result)) EXPECT_EQ(sides, 2);
}

std::vector<int> smoothIds(const FractureResult& result) {
  std::vector<int> ids;
  for (const Fragment& fragment : result.fragments) {
    if (fragment.meshedAs == Surface::smooth) ids.push_back(fragment.id);
  }
  return ids;
}

TEST(ExactByCluster, OtherBodiesStayExactWhereverTheBadOneIs) {
  const double h = 7.0 / 64;
  const glm::dvec3 at(4.0, 0.3, 0.0);
  const TriangleMesh bad = badBody(at, h), cube = box({-1.0, -1.0, -1.0}, glm::dvec3(2.0)),
                     plate = box({-1.0, 2.0, -1.0}, {3.0, 1.0, 2.0});
  for (const std::vector<TriangleMesh>& bodies :
       {std::vector{bad, cube, plate}, std::vector{cube, bad, plate},
        std::vector{cube, plate, bad}}) {
    const TriangleMesh mesh = shapes::joined(bodies);
    const FractureResult result = brokenByCluster(mesh, withVoxels(h, 9));
    ASSERT_EQ(result.exactFailure, "");
    ASSERT_EQ(result.smooth.size(), 1u);
    EXPECT_NE(result.smooth[0].reason.find("would be several bodies"), std::string::npos)
        << result.smooth[0].reason;
    EXPECT_EQ(result.smooth[0].fragments, smoothIds(result));
    std::vector<std::uint32_t> ofBad;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.vertices[mesh.triangles[t].x].x > 2.5) ofBad.push_back(t);
    }
    EXPECT_EQ(result.smooth[0].triangles, ofBad);
    expectSound(result);
    double ofCube = 0.0, ofPlate = 0.0, ofBoth = 0.0;
    for (const Fragment& fragment : result.fragments) {
      const bool isBad = fragment.mass.centroid.x > 2.5;
      EXPECT_EQ(fragment.meshedAs, isBad ? Surface::smooth : Surface::exact);
      EXPECT_EQ(fragment.mesh.source.empty(), isBad);
      const double own = fragment.mass.volume;
      (isBad ? ofBoth : fragment.mass.centroid.y > 1.5 ? ofPlate : ofCube) += own;
    }
    EXPECT_NEAR(ofCube, 8.0, 1e-9);
    EXPECT_NEAR(ofPlate, 6.0, 1e-9);
    EXPECT_NEAR(ofBoth, 8.0, 24.0 * h / 2);  // the surface may be half a voxel off
  }
}

// The exact fragments have the triangles of their bodies that they would have without the bad one.
TEST(ExactByCluster, TrianglesThatNoCrackMeetsStayAsTheyAre) {
  const TriangleMesh ball = shapes::ball(1.0, 4);
  const double h = 0.1;
  const TriangleMesh mesh = shapes::joined({badBody({4.0, 0.0, 0.0}, h), ball});
  const FractureResult result = brokenByCluster(mesh, withVoxels(h, 6));
  ASSERT_EQ(result.smooth.size(), 1u);
  std::set<Face> input;
  const auto keyOf = [](const TriangleMesh& m, const glm::uvec3& t) {
    Face face{};
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& v = m.vertices[t[static_cast<int>(k)]];
      face[k] = {v.x, v.y, v.z};
    }
    std::sort(face.begin(), face.end());
    return face;
  };
  for (const glm::uvec3& t : ball.triangles) input.insert(keyOf(ball, t));
  std::size_t whole = 0;
  double area = 0.0;
  for (const Fragment& fragment : result.fragments) {
    if (fragment.meshedAs != Surface::exact) continue;
    area += fragment.area - fragment.fractureArea;
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      if (!input.contains(keyOf(fragment.mesh, fragment.mesh.triangles[t]))) continue;
      ++whole;
      const glm::uvec3& from = mesh.triangles[fragment.mesh.source[t]];
      EXPECT_EQ(keyOf(mesh, from), keyOf(fragment.mesh, fragment.mesh.triangles[t]));
    }
  }
  EXPECT_NEAR(area, sherd::area(ball), 1e-9);
  EXPECT_GT(whole, ball.triangles.size() / 2);
}

TEST(ExactByCluster, EachReasonIsOfItsOwnBodies) {
  const double h = 0.1;
  const FractureResult result = brokenByCluster(
      shapes::joined({badBody({4.0, 0.0, 0.0}, h), shapes::cube(2.0), badBody({8.0, 0.0, 0.0}, h)}),
      withVoxels(h, 12));
  ASSERT_EQ(result.exactFailure, "");
  ASSERT_EQ(result.smooth.size(), 2u);
  for (const SmoothBodies& bodies : result.smooth) {
    // "fragment 7 would be several bodies"
    const int named = std::stoi(bodies.reason.substr(bodies.reason.find(' ')));
    EXPECT_NE(std::ranges::find(bodies.fragments, named), bodies.fragments.end());
    std::set<bool> places;
    for (const int id : bodies.fragments) {
      places.insert(result.fragments[static_cast<std::size_t>(id) - 1].mass.centroid.x > 6.0);
    }
    EXPECT_EQ(places.size(), 1u);
  }
  double sum = 0.0;
  for (const Fragment& fragment : result.fragments) {
    if (fragment.meshedAs == Surface::exact) sum += fragment.mass.volume;
  }
  EXPECT_NEAR(sum, 8.0, 1e-9);
}

TEST(ExactByCluster, AllBadFallBackTogether) {
  const FractureResult result = brokenByCluster(
      shapes::joined({badBody({0.0, 0.0, 0.0}, 0.1), badBody({4.0, 0.0, 0.0}, 0.1)}),
      withVoxels(0.1, 4));
  EXPECT_NE(result.exactFailure, "");
  EXPECT_TRUE(result.smooth.empty());
  EXPECT_EQ(smoothIds(result).size(), result.fragments.size());
}

TEST(ExactByCluster, BudgetsErosionAndLevelSetsAreOfBothKinds) {
  FractureOptions options = withVoxels(0.1, 8);
  options.surface.levelSets = true;
  options.surface.triangles = {400, 100};
  options.erode.iterations = 1;
  const FractureResult result = brokenByCluster(
      shapes::joined({badBody({4.0, 0.0, 0.0}, 0.1), shapes::ball(1.0, 4)}), options);
  ASSERT_EQ(result.smooth.size(), 1u);
  std::set<Surface> kinds;
  for (const Fragment& fragment : result.fragments) {
    kinds.insert(fragment.meshedAs);
    EXPECT_NE(fragment.surface, nullptr);
    EXPECT_EQ(openEdges(fragment.mesh), 0u);
    ASSERT_EQ(fragment.coarse.size(), 2u);
    for (const TriangleMesh& coarse : fragment.coarse) {
      EXPECT_EQ(openEdges(coarse), 0u);
      EXPECT_NEAR(volume(coarse), fragment.mass.volume, 0.2 * fragment.mass.volume);
    }
    EXPECT_LE(fragment.coarse[0].triangles.size(),
              std::max(std::size_t{400}, fragment.mesh.triangles.size()));
    for (const Contact& contact : fragment.contacts) {
      EXPECT_EQ(result.fragments[static_cast<std::size_t>(contact.fragment) - 1].meshedAs,
                fragment.meshedAs);
    }
  }
  EXPECT_EQ(kinds, (std::set<Surface>{Surface::smooth, Surface::exact}));
}

TEST(ExactByCluster, IndependentInterfacesAreOfTheSmoothFragments) {
  FractureOptions options = withVoxels(0.1, 8);
  options.surface.interface = Interface::independent;
  const FractureResult result = brokenByCluster(
      shapes::joined({badBody({4.0, 0.0, 0.0}, 0.1), shapes::ball(1.0, 3)}), options);
  ASSERT_EQ(result.smooth.size(), 1u);
  std::map<Surface, int> shared, alone;
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(openEdges(fragment.mesh), 0u);
    EXPECT_FALSE(fragment.mesh.triangles.empty());
  }
  const std::map<Face, int> cracks = cracksOf(result);
  for (const auto& [face, sides] : cracks) {
    ++(face[0][0] > 2.0 ? alone : shared)[Surface::exact];
    EXPECT_EQ(sides, face[0][0] > 2.0 ? 1 : 2);
  }
  EXPECT_EQ(alone.size() + shared.size(), 2u);
}

TEST(ExactByCluster, ThreadsDoNotMatter) {
  const TriangleMesh mesh = shapes::joined({shapes::cube(2.0), badBody({4.0, 0.0, 0.0}, 0.1)});
  std::vector<FractureResult> results;
  for (const int threads : {1, 2}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { results.push_back(brokenByCluster(mesh, withVoxels(0.1, 7))); });
  }
  ASSERT_EQ(results[0].smooth.size(), 1u);
  for (std::size_t i = 0; i < results[0].fragments.size(); ++i) {
    EXPECT_EQ(results[0].fragments[i].mesh.vertices, results[1].fragments[i].mesh.vertices);
    EXPECT_EQ(results[0].fragments[i].mesh.triangles, results[1].fragments[i].mesh.triangles);
    EXPECT_EQ(results[0].fragments[i].mesh.neighbor, results[1].fragments[i].mesh.neighbor);
  }
}

// A fracture is cancelled at any report of its progress, those of clusters among them.
TEST(ExactByCluster, CanBeCancelledWhileClustersAreCut) {
  const TriangleMesh mesh = shapes::joined({shapes::cube(2.0), badBody({4.0, 0.0, 0.0}, 0.1)});
  const auto reports = [&](int stop) {
    std::atomic<int> count = 0;
    const Progress progress{.report = [&](std::string_view, double) { ++count; },
                            .cancelled = [&] { return stop > 0 && count >= stop; }};
    try {
      (void)brokenByCluster(mesh, withVoxels(0.1, 4), &progress);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
      return -1;
    }
    return count.load();
  };
  const int all = reports(0);
  for (int stop = 1; stop < all; stop += std::max(1, all / 12)) EXPECT_EQ(reports(stop), -1);
}

// Two fractures in one: a fragment of one box is smooth, of the other exact, and their voxels lie
// side by side.
TEST(ExactByCluster, BodiesNearerThanAVoxelHaveNoFacesInCommon) {
  const double h = 4.1 / 40;
  const TriangleMesh mesh = shapes::append(box({-2.0, -1.0, -1.0}, glm::dvec3(2.0)),
                                           box({0.3 * h, -1.0, -1.0}, glm::dvec3(2.0)));
  FractureOptions options = clusterOptions(6, 40);
  const FractureResult whole = brokenByCluster(mesh, options);
  ASSERT_EQ(whole.exactFailure, "");
  ASSERT_TRUE(whole.smooth.empty());
  Solid solid = whole.solid;
  ASSERT_FALSE(solid.blocks->layers.empty());
  const auto isLeft = [](const TriangleMesh& m) { return m.vertices[m.triangles[0].x].x < 0.0; };
  ExactSurface exact = cutByCluster(
      solid, whole.labels, whole.labels, {.failure = "of the whole"},
      [&](const ClusterSolid& part) -> ExactSurface {
        if (isLeft(part.solid.mesh->mesh)) return {.failure = "of the left"};
        ExactSurface own;
        for (const Fragment& fragment : whole.fragments) {
          LabeledMesh labeled{.mesh = fragment.mesh, .other = fragment.mesh.neighbor};
          own.meshes.push_back(std::move(labeled));
        }
        return own;
      },
      nullptr);
  ASSERT_EQ(exact.failure, "");
  ASSERT_EQ(exact.smooth.size(), 1u);
  EXPECT_EQ(exact.smooth[0].reason, "of the left");
  ExtractOptions extract{.surface = options.surface, .exact = &exact};
  const ExtractedFragments all = extractAll(solid, whole.labels, extract);
  FractureResult result;
  result.fragments = all.fragments;
  expectSound(result);
  double left = 0.0, right = 0.0;
  for (const Fragment& fragment : result.fragments) {
    const bool isSmooth = fragment.mass.centroid.x < 0.0;
    EXPECT_EQ(fragment.meshedAs, isSmooth ? Surface::smooth : Surface::exact);
    (isSmooth ? left : right) += fragment.mass.volume;
  }
  EXPECT_NEAR(right, 8.0, 1e-9);
  EXPECT_NEAR(left, 8.0, 24.0 * h / 2);  // its surface may be half a voxel off
}

// The cubes are apart.  The mesh of a piece of one has lost half its faces, so that it can't be
// cut.
TEST(ExactByCluster, PiecesThatTouchOneThatCannotBeBrokenAgainAreSmooth) {
  const TriangleMesh mesh = shapes::append(shapes::cube(2.0), box({3, -1, -1}, glm::dvec3(2.0)));
  const FractureResult result = brokenByCluster(mesh, clusterOptions(8, 50));
  ASSERT_TRUE(result.exactFailure.empty() && result.smooth.empty());
  FinishedFracture finished;
  finished.solid = result.solid;
  finished.labels = result.labels;
  finished.isExact = true;
  finished.firstFace.push_back(0);
  int bad = 0, good = 0;
  for (const Fragment& fragment : result.fragments) {
    const bool isLeft = fragment.mass.centroid.x < 2.0;
    int& first = isLeft ? bad : good;
    TriangleMesh own = fragment.mesh;
    if (first == 0 && isLeft) {
      own.triangles.clear();
      own.neighbor.clear();
    }
    if (first == 0) first = fragment.id;
    const auto base = static_cast<std::uint32_t>(finished.faces.vertices.size());
    finished.faces.vertices.insert(finished.faces.vertices.end(), own.vertices.begin(),
                                   own.vertices.end());
    for (const glm::uvec3& t : own.triangles) finished.faces.triangles.push_back(t + base);
    finished.faces.neighbor.insert(finished.faces.neighbor.end(), own.neighbor.begin(),
                                   own.neighbor.end());
    finished.firstFace.push_back(finished.faces.triangles.size());
  }
  Device device("builtin");
  FractureOptions options = clusterOptions(3, 50);
  const std::array<int, 2> only{bad, good};
  const FractureResult again = refracture(finished, only, options, device);
  ASSERT_EQ(again.exactFailure, "");
  ASSERT_EQ(again.smooth.size(), 1u);
  EXPECT_EQ(again.smooth[0].reason.find("fragment " + std::to_string(bad) + ": "), 0u)
      << again.smooth[0].reason;
  double right = 0.0;
  for (const Fragment& fragment : again.fragments) {
    const bool isLeft = fragment.mass.centroid.x < 2.0;
    EXPECT_EQ(fragment.meshedAs, isLeft ? Surface::smooth : Surface::exact);
    EXPECT_EQ(openEdges(fragment.mesh), 0u);
    for (const std::uint16_t neighbor : fragment.mesh.neighbor) {
      if (neighbor == 0) continue;
      EXPECT_EQ(again.fragments[neighbor - 1u].meshedAs, fragment.meshedAs);
    }
    if (!isLeft) right += fragment.mass.volume;
  }
  EXPECT_NEAR(right, 8.0, 1e-9);
}

// --- clusters

struct Clustered {
  Solid solid;
  Labels labels;
  std::vector<BodyCluster> clusters;
};

Clustered clustersOf(const TriangleMesh& mesh, int pieces, int resolution) {
  const FractureResult result = brokenByCluster(mesh, clusterOptions(pieces, resolution));
  Clustered out{result.solid, result.labels, {}};
  out.clusters = bodyClusters(out.solid, *out.solid.mesh, out.labels);
  return out;
}

TEST(BodyClusters, BodiesThatTouchOrCrossOrLieInEachOtherAreOne) {
  const TriangleMesh first = box({0, 0, 0}, glm::dvec3(1.0));
  for (const auto& [low, count] :
       {std::pair{glm::dvec3(1.0, 0.0, 0.0), 1u}, std::pair{glm::dvec3(1.0, 1.0, 1.0), 1u},
        std::pair{glm::dvec3(0.5, 0.5, 0.5), 1u}, std::pair{glm::dvec3(0.25, 0.25, 0.25), 1u},
        std::pair{glm::dvec3(1.01, 0.0, 0.0), 2u}, std::pair{glm::dvec3(3.0, 0.0, 0.0), 2u}}) {
    const double side = low.x == 0.25 ? 0.5 : 1.0;
    const TriangleMesh mesh = shapes::append(first, box(low, glm::dvec3(side)));
    EXPECT_EQ(clustersOf(mesh, 5, 40).clusters.size(), count) << low.x;
  }
}

TEST(BodyClusters, HaveAllTrianglesAndFragmentsOnce) {
  // A ball in a hollow one, a bar with a neck thinner than a voxel, and a box without voxels.
  TriangleMesh neck = shapes::append(box({3, 0, 0}, {1, 1, 1}), box({5, 0, 0}, {1, 1, 1}));
  neck = shapes::append(neck, box({3.9, 0.503, 0.503}, {1.2, 0.01, 0.01}));
  const TriangleMesh mesh = shapes::joined({shapes::hollowBall(1.5, 1.0, 3), shapes::ball(0.5, 2),
                                            neck, box({-1, 2.503, -1}, {2, 0.01, 2})});
  const Clustered found = clustersOf(mesh, 9, 64);
  std::vector<int> triangles(mesh.triangles.size(), 0),
      fragments(static_cast<std::size_t>(found.labels.fragmentCount) + 1, 0);
  for (const BodyCluster& cluster : found.clusters) {
    EXPECT_FALSE(cluster.fragments.empty());
    for (const std::uint32_t t : cluster.triangles) ++triangles[t];
    for (const std::uint16_t f : cluster.fragments) ++fragments[f];
  }
  EXPECT_EQ(std::ranges::count(triangles, 1), static_cast<std::ptrdiff_t>(triangles.size()));
  EXPECT_EQ(std::count(fragments.begin() + 1, fragments.end(), 1), found.labels.fragmentCount);
  // The hollow ball with the box that has no voxels, the ball within, and the bar, whose halves
  // have voxels that are not connected.
  EXPECT_EQ(found.clusters.size(), 3u);
}

TEST(BodyClusters, ErodedVoxelsAreOfNoFragment) {
  for (const auto& [x, count] : {std::pair{1.01, 2u}, std::pair{1.0, 1u}}) {
    const TriangleMesh mesh =
        shapes::append(box({0, 0, 0}, glm::dvec3(1.0)), box({x, 0.2, 0.0}, glm::dvec3(1.0)));
    Clustered found = clustersOf(mesh, 6, 40);
    std::size_t i = 0;
    found.labels.blocks->forEachInside([&](std::size_t voxel) {
      if (++i % 3 == 0) found.labels.fragment[voxel] = Labels::kEroded;
    });
    const auto eroded = bodyClusters(found.solid, *found.solid.mesh, found.labels);
    ASSERT_EQ(eroded.size(), count);
    for (std::size_t c = 0; c < count; ++c) {
      EXPECT_EQ(eroded[c].fragments, found.clusters[c].fragments);
      EXPECT_EQ(eroded[c].triangles, found.clusters[c].triangles);
    }
  }
}

TEST(BodyClusters, AreSolidsWithTheirOwnVoxels) {
  const TriangleMesh mesh =
      shapes::append(box({0, 0, 0}, glm::dvec3(1.0)), box({1.01, 0.2, 0.0}, glm::dvec3(1.0)));
  const Clustered found = clustersOf(mesh, 6, 40);
  ASSERT_EQ(found.clusters.size(), 2u);
  const ClusterSolids parts(found.solid, found.labels, found.labels, found.clusters);
  std::uint64_t voxels = 0;
  for (std::size_t c = 0; c < 2; ++c) {
    const ClusterSolid part = parts.of(c);
    EXPECT_EQ(part.solid.voxels, part.solid.blocks->insideVoxels());
    EXPECT_EQ(part.labels.blocks, part.solid.blocks);
    EXPECT_EQ(part.solid.mesh->mesh.triangles.size(), 12u);
    EXPECT_TRUE(part.solid.blocks->layers.empty());
    voxels += part.solid.voxels;
    part.solid.blocks->forEachInside([&](std::size_t voxel) {
      const auto& own = found.clusters[c].fragments;
      EXPECT_NE(std::ranges::find(own, part.labels.fragment[voxel]), own.end());
    });
  }
  EXPECT_EQ(voxels, found.solid.voxels);
}

// --- the sentence

TEST(SmoothText, NamesFragmentsObjectsAndReasons) {
  SourceMesh source;
  EXPECT_EQ(smoothText(source, 4, "", {}), "");
  EXPECT_EQ(smoothText(source, 4, "it is open", {}),
            "it is open, so the fragments have the smooth surface instead of the exact one");
  std::vector<SmoothBodies> smooth{{"it is open", {2, 9}, {0}}, {"it crosses itself", {4}, {2}}};
  EXPECT_EQ(smoothText(source, 12, "", smooth),
            "3 of 12 fragments have the smooth surface instead of the exact one: 2 and 9, since it "
            "is open; 4, since it crosses itself");
  source.objects = {"lid", "box", "rod"};
  source.objectOfTriangle = {1, 1, 0};
  smooth[1].reason = "it is open";
  EXPECT_EQ(smoothText(source, 12, "", smooth),
            "3 of 12 fragments have the smooth surface instead of the exact one: 2, 4 and 9 "
            "('lid' and 'box'), since it is open");
  smooth = {{"it is open", {1, 2, 3, 4, 5, 6, 7}, {}}};
  EXPECT_EQ(smoothText(source, 12, "", smooth),
            "7 of 12 fragments have the smooth surface instead of the exact one: 1, 2, 3, 4 and 3 "
            "others, since it is open");
  smooth.clear();
  for (int i = 1; i <= 5; ++i) smooth.push_back({"reason " + std::to_string(i), {i}, {}});
  EXPECT_NE(smoothText(source, 12, "", smooth).find("reason 3; others for 2 other reasons"),
            std::string::npos);
}

}  // namespace
}  // namespace sherd
