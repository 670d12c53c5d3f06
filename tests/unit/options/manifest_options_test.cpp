// Every option that shapes a fracture or its files is in its manifest.
//
// The options are taken apart by structured bindings: a field that is added to one of the structs
// does not compile here until it has a line of its own.
#include <gtest/gtest.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>

#include <string>
#include <utility>

#include "folder/manifest/manifest.h"
#include "kernels/device_fixture.h"
#include "shapes.h"

namespace sherd {
namespace {

class ManifestOptions : public DeviceTest {
 protected:
  void SetUp() override {
    DeviceTest::SetUp();
    if (IsSkipped()) return;
    result_ = fracture(source_.mesh, options_, device());
    facts_ = meshFacts(result_.fragments);
  }

  // The manifest of one fracture with these options: its text follows from them, whether or not the
  // fracture was made by them.
  std::string text() const {
    return manifestText(source_, options_, result_, facts_, {}, {}, write_);
  }

  template <class Value>
  void expectRecorded(const char* name, Value& field, Value other) {
    const std::string before = text();
    const Value kept = std::exchange(field, other);
    EXPECT_NE(text(), before) << name;
    field = kept;
    EXPECT_EQ(text(), before) << name;
  }

  template <class Value>
  void expectNotRecorded(const char* name, Value& field, Value other) {
    const std::string before = text();
    const Value kept = std::exchange(field, other);
    EXPECT_EQ(text(), before) << name;
    field = kept;
  }

  SourceMesh source_{
      .mesh = shapes::ball(1.0, 3), .name = "ball.obj", .stem = "ball", .sha256 = "0"};
  FractureOptions options_{.pieces = 3, .solid = {.resolution = 24}};
  FractureResult result_;
  std::vector<MeshFacts> facts_;
  WriteOptions write_;
};

TEST_F(ManifestOptions, OfAFractureAreRecorded) {
  auto& [material, pieces, seed, solid, seeds, grow, shares, erode, guides, dropShare, missing,
         missingRule, surface] = options_;
  expectRecorded("pieces", pieces, 2);  // of a solid that gave three
  expectRecorded("seed", seed, std::uint64_t{7});
  expectRecorded("dropShare", dropShare, 0.01);
  expectRecorded("missing", missing, 0.5);
  expectRecorded("missingRule", missingRule, MissingRule::any);
  auto& [resolution, voxelSize, fill, shellThickness, bodies, objects, keepMesh, keepSeams] = solid;
  EXPECT_FALSE(keepMesh);                     // follows from the surface
  EXPECT_TRUE(keepSeams && objects.empty());  // follow from the files
  expectRecorded("resolution", resolution, 25);
  expectRecorded("resolution", resolution, kAutoResolution);
  expectRecorded("voxelSize", voxelSize, 0.1);
  expectRecorded("fill", fill, Fill::parity);
  expectRecorded("bodies", bodies, MeetingBodies::keep);
  expectRecorded("shellThickness", shellThickness, 0.2);

  auto& [seedPieces, seedSeed, sampler, on, extraSeeds, extraSeedsPerPiece, mergeMetric, sizeSpread,
         impacts, randomImpacts, pieceDensity, given] = seeds;
  expectRecorded("extraSeedsPerPiece", extraSeedsPerPiece, 2);
  expectRecorded("given", given, {GivenSeeds{"seeds.json", {}}});
  expectNotRecorded("seeds.pieces", seedPieces, 9);  // this and the next are taken from above
  expectNotRecorded("seeds.seed", seedSeed, std::uint64_t{9});
  expectRecorded("sampler", sampler, Sampler::halton);
  expectRecorded("on", on, SeedsOn::surface);
  expectRecorded("extraSeeds", extraSeeds, 3);
  expectRecorded("mergeMetric", mergeMetric, Metric::manhattan);
  expectRecorded("sizeSpread", sizeSpread, 1.5);
  expectRecorded("randomImpacts", randomImpacts, 2);
  expectRecorded("impacts", impacts, {Impact{}});
  impacts.push_back({.target = glm::dvec3{1, 0, 0}});
  auto& [place, count, sigma, bias, energy, merge, placeGiven] = impacts.front();
  expectRecorded("place", place, {glm::dvec3{0, 1, 0}});
  expectRecorded("place", place, {Ray{{2, 0, 0}, {-1, 0, 0}}});
  expectRecorded("placeGiven", placeGiven, {glm::dvec3{0, 1, 0}});
  expectRecorded("count", count, 4);
  expectRecorded("sigma", sigma, 0.1);
  expectRecorded("bias", bias, 9);
  expectRecorded("merge", merge, true);
  auto& [sizes, sizeParameter, minShare, balance, tries] = shares;
  expectRecorded("minShare", minShare, 0.01);
  expectRecorded("minShare", minShare, 0.0);
  expectRecorded("balance", balance, 2);
  expectRecorded("tries", tries, 32);
}

TEST_F(ManifestOptions, OfAnErosionAreRecorded) {
  auto& [shape, size, planes, iterations, threshold, probability, erodeOn, islands, least,
         erodeSeed, erodeSide] = options_.erode;
  expectRecorded("iterations", iterations, Length(1));
  expectRecorded("iterations", iterations, Length::ofSide(1.0));
  iterations = 2;  // without any the others do nothing
  expectRecorded("shape", shape, ErodeShape::cross);
  expectRecorded("size", size, Length(5));
  expectRecorded("size", size, Length::ofSide(3.0));
  expectRecorded("planes", planes, true);
  expectRecorded("threshold", threshold, 0.5);
  expectRecorded("probability", probability, 0.5);
  expectRecorded("on", erodeOn, ErodeOn::all);
  expectRecorded("islands", islands, Islands::kept);
  expectNotRecorded("erode.least", least, std::uint64_t{9});
  expectNotRecorded("erode.seed", erodeSeed, std::uint64_t{9});  // taken from above
  expectNotRecorded("erode.longestSideVoxels", erodeSide, 9.0);
}

TEST_F(ManifestOptions, OfGivenFilesAreRecorded) {
  expectRecorded("density", options_.seeds.density, {"field.vdb", {}});
  expectRecorded("guides", options_.guides, {Guide{.file = "crack.obj"}});
  options_.guides = {Guide{.file = "crack.obj"}};
  expectRecorded("guides' hashes", options_.guides.front().sha256, std::string(64, 'a'));
}

TEST_F(ManifestOptions, OfSizesAndEnergiesAreRecorded) {
  ShareOptions& shares = options_.shares;
  expectRecorded("sizes", shares.sizes, Sizes::uniform);
  shares.sizes = Sizes::power;
  expectRecorded("sizeParameter", shares.sizeParameter, 2.5);
  options_.seeds.impacts.push_back({.target = glm::dvec3{1, 0, 0}});
  expectRecorded("energy", options_.seeds.impacts.front().energy, 2.0);
}

TEST_F(ManifestOptions, OfGrowthAreRecorded) {
  auto& [growth, neighborhood, metric, anisotropy, split, roughness, hurst, roughnessWindow,
         propagationHurst, propagation, longestSideVoxels, regrowIsolated, noiseSeeds, noiseAnchors,
         walls, keepCost, outerSteps, tuning] = options_.grow;
  expectRecorded("growth", growth, Growth::nearest);
  expectRecorded("material", options_.material, MaterialPreset::stone);
  expectRecorded("roughness", roughness, Length(2.0));
  expectRecorded("roughness", roughness, Length::ofSide(2.0));
  expectRecorded("hurst", hurst, 0.5);
  expectRecorded("roughnessWindow", roughnessWindow, Length(9.0));
  expectRecorded("propagationHurst", propagationHurst, 0.6);
  expectNotRecorded("propagation", propagation, {1.0, 0.0, 0.0});
  propagationHurst = 0.6;  // without it there is no propagation
  expectRecorded("propagation", propagation, {1.0, 0.0, 0.0});
  propagationHurst = 0.0;
  expectRecorded("regrowIsolated", regrowIsolated, false);
  expectRecorded("outerSteps", outerSteps, 5);
  growth = Growth::flood;
  expectRecorded("neighborhood", neighborhood, 26);
  growth = Growth::chain;
  expectRecorded("metric", metric, Metric::manhattan);
  auto& [direction, strength] = anisotropy;
  expectRecorded("strength", strength, 1.0);
  strength = 1.0;  // without it there is no direction
  expectRecorded("direction", direction, {1.0, 0.0, 0.0});
  // Made from the fracture's seed or solid, beside the labels, or how fast they come.
  expectNotRecorded("noiseSeeds", noiseSeeds, {7});
  expectNotRecorded("noiseAnchors", noiseAnchors, {openvdb::Coord(1, 2, 3)});
  expectNotRecorded("longestSideVoxels", longestSideVoxels, 9.0);
  expectNotRecorded("keepCost", keepCost, true);
  auto& [stepsPerReadback, workGroupSize, warmUp] = tuning;
  expectNotRecorded("stepsPerReadback", stepsPerReadback, 1);
  expectNotRecorded("workGroupSize", workGroupSize, 1);
  expectNotRecorded("warmUp", warmUp, true);
}

TEST_F(ManifestOptions, OfSurfacesAreRecorded) {
  auto& [levelSets, meshes, points, surface, interface, smooth, adaptivity, mismatch,
         mismatchCommon, scanNoise, triangles] = options_.surface;
  expectNotRecorded("levelSets", levelSets, false);  // its files say so
  expectNotRecorded("meshes", meshes, false);
  expectNotRecorded("points", points, true);
  expectRecorded("surface", surface, Surface::labels);
  expectRecorded("interface", interface, Interface::independent);
  expectRecorded("adaptivity", adaptivity, 0.5);
  expectRecorded("triangles", triangles, {100});
  expectRecorded("scanNoise", scanNoise.rms, 0.25);
  expectRecorded("mismatch", mismatch.rms, 0.25);
  mismatch.rms = 0.25;  // without it there is no noise to shape
  expectRecorded("mismatch.hurst", mismatch.hurst, 0.5);
  expectRecorded("mismatch.wavelength", mismatch.wavelength, 7.0);
  expectRecorded("mismatchCommon", mismatchCommon, 0.5);
  auto& [iterations, weight, boundaryIterations, boundaryWeight, method] = smooth;
  expectRecorded("iterations", iterations, {3});
  expectRecorded("iterations", iterations, {.perVoxel = 0.5});
  expectRecorded("boundaryIterations", boundaryIterations, {3});
  expectRecorded("weight", weight, 0.25);
  expectRecorded("boundaryWeight", boundaryWeight, 0.25);
  expectRecorded("method", method, Smoothing::laplacian);
}

TEST_F(ManifestOptions, OfFilesAreRecorded) {
  auto& [labels, vdb, mesh, preview, seeds, boundaries, cost, solid, scene, graph, viewer, usd,
         houdini, plainMeshes, proxy, vdbFiles, vdbOptions, density, proxyGap, voxelFormats,
         meshFormats, usdFormats, usdVolumes, jointStrength, points, sharePoints, pointFormats,
         samplingMemory, distances, correspondences, precision, sourceFaces, offset, metersPerUnit,
         up] = write_;
  // Which files there are is in the list of files, their formats in their names.
  for (bool* file : {&labels, &seeds, &boundaries, &cost, &solid, &viewer}) {
    expectNotRecorded("a file", *file, !*file);
  }
  expectNotRecorded("voxelFormats", voxelFormats, {VoxelFormat::npz});
  expectNotRecorded("meshFormats", meshFormats, {MeshFileFormat::obj});
  usd = true;
  expectNotRecorded("usdFormats", usdFormats, {UsdFormat::usdz});
  expectRecorded("usdVolumes", usdVolumes, true);
  expectRecorded("jointStrength", jointStrength, 2.0);
  expectRecorded("metersPerUnit", metersPerUnit, {0.01});

  vdb = mesh = preview = true;
  expectRecorded("plainMeshes", plainMeshes, true);
  expectRecorded("precision", precision, Precision::full);
  expectRecorded("precision", precision, Precision::single);
  expectRecorded("offset", offset, {glm::dvec3(1.0, 2.0, 3.0)});
  expectRecorded("sourceFaces", sourceFaces, true);
  expectRecorded("vdbFiles", vdbFiles, VdbFiles::single);
  expectRecorded("density", density, 2.0);
  expectRecorded("correspondences", correspondences, std::size_t{5});
  expectRecorded("up", up, {'z'});
  expectRecorded("proxy", proxy, true);
  proxy = true;
  expectRecorded("proxyGap", proxyGap, 0.1);

  auto& [fog, half, compression] = vdbOptions;
  expectRecorded("fog", fog, true);
  expectRecorded("half", half, true);
  expectRecorded("compression", compression, VdbCompression::zip);

  points.count = 10;
  auto& [count, sampler, rule, pointSeed] = points;
  expectRecorded("points.count", count, std::size_t{11});
  expectRecorded("points.sampler", sampler, PointSampler::halton);
  expectRecorded("points.rule", rule, PointRule::perTriangle);
  expectNotRecorded("points.seed", pointSeed, std::uint64_t{9});  // made from the fracture's
  expectRecorded("sharePoints", sharePoints, true);
  expectRecorded("pointFormats", pointFormats, {PointFormat::npz});
  expectNotRecorded("samplingMemory", samplingMemory, std::uint64_t{1});  // changes no file

  distances.count = 10;
  auto& [samples, type, sigma, sampleSeed] = distances;
  expectRecorded("distances.count", samples, std::size_t{11});
  expectRecorded("distances.type", type, SampleType::float16);
  expectRecorded("distances.spread", sigma, 0.5);
  expectNotRecorded("distances.seed", sampleSeed, std::uint64_t{9});  // made from the fracture's
}

}  // namespace
}  // namespace sherd
