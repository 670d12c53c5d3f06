// The table of options: values as text, in manifests and in a dataset's identity.
#include <gtest/gtest.h>
#include <sherd/dataset.h>
#include <sherd/error.h>
#include <sherd/options.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "dataset/layouts/identity.h"
#include "options/record.h"

namespace sherd {
namespace {

// Options of which every row is recorded but those that exclude one another.
RunOptions everything() {
  RunOptions options;
  options.fracture.grow.growth = Growth::flood;
  options.fracture.grow.anisotropy = {{0.0, 1.0, 0.0}, 2.0};
  options.fracture.grow.propagationHurst = 0.5;
  options.fracture.erode.iterations = 2;
  options.fracture.dropShare = 0.01;
  options.fracture.missingRule = MissingRule::any;
  options.fracture.solid.shellThickness = 0.25;
  options.write.points.count = 10;
  options.write.distances = {.count = 10, .sigma = 0.5};
  options.write.correspondences = 5;
  options.write.proxy = options.write.usd = true;
  options.write.density = 2.0;
  options.fracture.surface.mismatch.rms = 0.25;
  return options;
}

// Values that an option accepts.
std::vector<std::string> valuesOf(const FractureOptionRow& row) {
  const std::string name = row.name;
  if (name == "write") return {"labels,proxy", "mesh"};
  if (name == "seed") return {"9", "18446744073709551615"};
  if (name == "extra-seeds") return {"7", "3n"};
  if (name == "impact")
    return {"1,2,3", "ray:0.5,0,0,-1,0,0,4,0.25,merge", "1,0,0,6,n=9", "1,0,0,energy=2.5",
            "1,0,0,6,0.5,energy=0.01,merge"};
  if (name == "sizes") return {"uniform", "lognormal:0.8", "power:1.6", "exponential", "grown"};
  if (name == "grain") return {"1,0,0,0.5", "0,0,1,-0.5"};
  if (name == "grain-direction") return {"1,0,0"};
  if (name == "roughness") return {"1.5", "2,0.6", "0.7%", "0.8%,0.5", "1%,0.8,3%", "2,0.5,7"};
  if (name == "mismatch" || name == "scan-noise") return {"0.1%", "0.2%,0.5", "0.3%,0.6,10%"};
  if (name == "propagation") return {"1,0,0,0.6", "0,-1,0.5,0.75"};
  if (name == "propagation-direction") return {"1,0,0"};
  if (name == "split-offset") return {"0.25", "0.5"};
  if (name == "missing") return {"1", "0.25"};
  if (name.ends_with("-iterations") && row.value.type == OptionType::text) return {"4", "0.05k"};
  if (name == "triangles") return {"100,50"};
  if (row.value.type == OptionType::choices) {
    return {row.value.choices.back(), row.value.choices.back() + "," + row.value.choices.front()};
  }
  if (row.value.type == OptionType::length) return {"9", "0.7%"};
  if (!row.value.choices.empty()) return row.value.choices;
  switch (row.value.type) {
    case OptionType::flag:
      return {"true", "false"};
    case OptionType::whole:
      return {"9", "10"};
    case OptionType::number:
      return {"0.5", "0.75"};
    default:
      return {"a.json", "b.json"};
  }
}

TEST(OptionTable, NamesAndKeysAreUnique) {
  std::set<std::string> names, keys;
  for (const FractureOptionRow& row : fractureOptionTable()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(*row.key == '\0' || keys.insert(row.key).second) << row.key;
    EXPECT_FALSE(std::string(row.help).ends_with('.')) << row.name;
    EXPECT_EQ(fractureOption(row.name), row.hidden ? nullptr : &row);
  }
  std::set<std::string> own;
  for (const DatasetOptionRow& row : datasetOptionTable()) {
    EXPECT_TRUE(own.insert(row.name).second) << row.name;
    const FractureOptionRow* const other = fractureOption(row.name);
    EXPECT_TRUE(other == nullptr || other->single || other->name != std::string(row.name))
        << row.name << " is an option of each fracture too";
  }
}

TEST(OptionTable, ValuesAreReadBackFromTheirText) {
  for (const FractureOptionRow& row : fractureOptionTable()) {
    for (const std::string& value : valuesOf(row)) {
      RunOptions options;
      row.value.set(options, value);
      const std::string text = row.value.text(options);
      if (std::string(row.name) != "preset") {
        EXPECT_EQ(text, value) << row.name;
      }
      if (text.empty()) continue;
      RunOptions again;
      row.value.set(again, text);
      EXPECT_EQ(row.value.text(again), text) << row.name;
    }
    if (row.value.type == OptionType::text && row.value.range.size() > 3 &&
        row.value.range != "IMPACT") {
      continue;  // any text: a name
    }
    for (const char* text : {"", "what", "-1e400", "nan", "1,2,", "0x10", " 1", "1 "}) {
      if (row.name == std::string("seeds") || row.name == std::string("grid")) continue;
      RunOptions options;
      EXPECT_THROW(row.value.set(options, text), Error) << row.name << " " << text;
    }
  }
}

TEST(OptionTable, EveryRowShapesTheManifestOrSaysWhereElse) {
  for (const FractureOptionRow& row : fractureOptionTable()) {
    bool isSeen = false;
    for (const std::string& value : valuesOf(row)) {
      RunOptions options = everything();
      if (std::string(row.name) == "metric") options.fracture.grow.growth = Growth::chain;
      if (std::string(row.name).starts_with("split-")) {
        options.fracture.grow.growth = Growth::sequential;
      }
      const auto before = recordedOptions(options, false);
      row.value.set(options, value);
      isSeen |= recordedOptions(options, false) != before;
    }
    EXPECT_TRUE(isSeen || *row.elsewhere != '\0') << row.name;
  }
}

TEST(OptionTable, ManifestsAreReadBack) {
  for (const FractureOptionRow& row : fractureOptionTable()) {
    if (std::string(row.key).empty()) continue;
    for (const std::string& value : valuesOf(row)) {
      RunOptions options = everything();
      row.value.set(options, value);
      const auto recorded = recordedOptions(options, false);
      const RunOptions again = optionsRecorded(nlohmann::json::parse(recorded.dump()));
      // Whether the .vdb files and meshes are written stands in the list of files.
      RunOptions written = again;
      written.write.proxy = options.write.proxy;
      written.write.usd = options.write.usd;
      EXPECT_EQ(recordedOptions(written, false).dump(), recorded.dump()) << row.name;
    }
  }
  EXPECT_THROW((void)optionsRecorded({{"fill", "sand"}}), Error);
  EXPECT_THROW((void)optionsRecorded({{"seed", -1}}), Error);
  EXPECT_THROW((void)optionsRecorded({{"seeds", {{"impacts", {{{"count", "x"}}}}}}}), Error);
  EXPECT_NO_THROW((void)optionsRecorded({{"future", 1}}));
}

TEST(OptionTable, EveryOptionOfADatasetIsInItsIdentity) {
  const DatasetOptions usual;
  EXPECT_EQ(datasetIdentity(usual), "");
  for (const FractureOptionRow& row : fractureOptionTable()) {
    if (row.hidden || row.single || std::string(row.name) == "preset") continue;
    bool isSeen = false;
    for (const std::string& value : valuesOf(row)) {
      DatasetOptions options;
      row.value.set(options.each, value);
      const std::string identity = datasetIdentity(options);
      isSeen |= (" " + identity).find(" --" + std::string(row.name)) != std::string::npos;
      EXPECT_TRUE(isIdentityOf(options, identity));
      EXPECT_EQ(isIdentityOf(usual, identity), identity.empty()) << identity;
    }
    EXPECT_TRUE(isSeen) << row.name;
  }
}

TEST(OptionTable, AnIdentityMayNameOptionsInAnyOrder) {
  DatasetOptions options;
  options.each.fracture = paperOptions();
  options.each.fracture.solid.resolution = 24;
  options.drawn = {*drawnOption("erode-iterations", "0..3"),
                   *drawnOption("sampler", "uniform|poisson")};
  options.schedule.most = 4;
  options.poses = true;
  const std::string now = datasetIdentity(options);
  EXPECT_NE(now.find("--erode-iterations=0..3"), std::string::npos) << now;
  EXPECT_NE(now.find("--pieces=2..4 --poses"), std::string::npos) << now;
  EXPECT_TRUE(isIdentityOf(options, now));
  // As it was written from the command line.
  const std::string before =
      "--erode-iterations=0..3 --pieces=2..4 --poses --preset=paper "
      "--repeats=25..15 --resolution=24 --sampler=uniform|poisson";
  EXPECT_TRUE(isIdentityOf(options, before));
  EXPECT_FALSE(isIdentityOf(options, before + " --seed=1"));
  EXPECT_FALSE(isIdentityOf(options, before + " --unknown=1"));
}

TEST(OptionTable, OnlySomeOptionsAreDrawn) {
  EXPECT_TRUE(drawnOption("roughness", "0..2"));
  EXPECT_TRUE(drawnOption("growth", "flood|euclid"));
  EXPECT_FALSE(drawnOption("growth", "flood"));
  EXPECT_FALSE(drawnOption("roughness", "2..0"));
  EXPECT_FALSE(drawnOption("resolution", "16..32"));
  EXPECT_FALSE(drawnOption("unknown", "0..2"));
  EXPECT_NO_THROW(checkDrawn(*drawnOption("roughness", "0..2"), {}));
  EXPECT_THROW(checkDrawn(*drawnOption("roughness", "0..200"), {}), Error);
  const std::optional<DrawnOption> relative = drawnOption("erode-iterations", "1%..3%");
  ASSERT_TRUE(relative);
  EXPECT_EQ(relative->text(), "1%..3%");
  EXPECT_NO_THROW(checkDrawn(*relative, {}));
  std::set<std::string> drawn;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    RunOptions options;
    fractureOption("erode-iterations")->value.set(options, relative->valueFor(seed));
    const Length depth = options.fracture.erode.iterations;
    EXPECT_TRUE(depth.voxels == 0.0 && depth.percent >= 1.0 && depth.percent <= 3.0);
    drawn.insert(relative->valueFor(seed));
  }
  EXPECT_EQ(drawn.size(), 20u);
  EXPECT_FALSE(drawnOption("roughness", "1..3%"));
  EXPECT_THROW(checkDrawn(*drawnOption("growth", "flood|moss"), {}), Error);
}

TEST(OptionTable, IdleOptionsAreSpelledAsTheUserDoes) {
  const OptionUse all{.isGiven = [](std::string_view name) { return name != "guide"; },
                      .spelled =
                          [](std::string_view name) {
                            EXPECT_TRUE(fractureOption(name)) << name;
                            return "<" + std::string(name) + ">";
                          },
                      .input = "a.vdb"};
  const std::vector<std::string> idle = idleOptions(RunOptions{}, all);
  EXPECT_GT(idle.size(), 15u);  // seven are of erosion
  EXPECT_NE(std::find(idle.begin(), idle.end(),
                      "<merge-metric> does nothing without <extra-seeds>, or an <impact> that "
                      "merges"),
            idle.end());

  OptionUse drawn = all;
  drawn.isDrawn = [](std::string_view name) { return name == "erode-iterations"; };
  EXPECT_EQ(idleOptions(RunOptions{}, drawn).size(), idle.size() - 7);

  OptionUse ofMesh = all;
  ofMesh.input = "a.obj";
  EXPECT_THROW((void)idleOptions(RunOptions{}, ofMesh), Error);
  ofMesh.isGiven = [](std::string_view) { return false; };
  EXPECT_TRUE(idleOptions(RunOptions{}, ofMesh).empty());

  Volume levelSet;
  levelSet.solid.emplace();
  levelSet.isLevelSet = true;
  EXPECT_EQ(idleOptions(levelSet, all).size(), 5u);
  EXPECT_EQ(
      idleOptions(Volume{}, all),
      std::vector<std::string>{"<source-faces> does nothing with a volume, which has no faces"});
}

}  // namespace
}  // namespace sherd
