// Options that require or exclude others: one rule for each condition.
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/growth.h>
#include <sherd/options.h>

#include <algorithm>
#include <filesystem>

#include "base/text/lower_case.h"
#include "base/text/option_text.h"

namespace sherd {
namespace {

using O = const RunOptions&;
using U = const OptionUse&;
using Names = std::vector<const char*>;

enum class Verdict {
  idle,      ///< the option does nothing: a warning
  conflict,  ///< two options contradict each other: an error
};

/// Options, and the verdict on each that is given while a condition holds.
struct Rule {
  Names options;
  Verdict verdict;
  bool (*holds)(O options, U use);
  const char* sentence;  ///< after the option's name; names of others in braces
  Names by{};            ///< options that the condition depends on; skipped where one is drawn
};

bool writes(const RunOptions& options, std::initializer_list<const char*> names) {
  const std::vector<std::string> written = split(fractureOption("write")->value.text(options));
  return std::any_of(names.begin(), names.end(), [&](const char* name) {
    return std::find(written.begin(), written.end(), name) != written.end();
  });
}

bool isVdb(const OptionUse& use) {
  return lowerCase(std::filesystem::path(use.input).extension().string()) == ".vdb";
}

bool hasFormat(const RunOptions& options, UsdFormat format) {
  const std::vector<UsdFormat>& formats = options.write.usdFormats;
  return std::find(formats.begin(), formats.end(), format) != formats.end();
}

bool hasFormat(const RunOptions& options, MeshFileFormat format) {
  const std::vector<MeshFileFormat>& formats = options.write.meshFormats;
  return std::find(formats.begin(), formats.end(), format) != formats.end();
}

bool none(const Iterations& iterations) {
  return iterations.count == 0 && iterations.perVoxel == 0.0;
}

std::vector<Rule> joined(std::initializer_list<std::vector<Rule>> groups) {
  std::vector<Rule> all;
  for (const std::vector<Rule>& group : groups) all.insert(all.end(), group.begin(), group.end());
  return all;
}

std::vector<Rule> solidRules() {
  return {
      {{"shell-thickness"},
       Verdict::conflict,
       [](O o, U) {
         const Fill fill = o.fracture.solid.fill;
         return fill == Fill::parity || fill == Fill::flood;
       },
       "makes a shell, which {fill} parity and flood do not; omit one of them"},
      {{"bodies"},
       Verdict::conflict,
       [](O o, U) {
         const SolidOptions& solid = o.fracture.solid;
         const bool isWinding = solid.fill == Fill::automatic || solid.fill == Fill::winding;
         return solid.bodies == MeetingBodies::keep && (!isWinding || solid.shellThickness > 0.0);
       },
       "keep applies to meshes that are filled by winding, and {fill} parity, flood and shell and "
       "{shell-thickness} choose otherwise; omit one of them"},
      {{"grid", "isovalue"},
       Verdict::conflict,
       [](O, U u) { return !isVdb(u); },
       "applies to the grids of a .vdb file, and the input is not one"},
  };
}

std::vector<Rule> givenSeedRules() {
  return {
      {{"sampler", "extra-seeds", "merge-metric", "size-spread", "impact", "impacts"},
       Verdict::conflict,
       [](O o, U) { return o.fracture.seeds.given.has_value(); },
       "applies to seeds that are drawn, and {seeds} reads them from a file; omit one of them"},
      {{"seeds-on"},
       Verdict::conflict,
       [](O o, U) {
         return o.fracture.seeds.given.has_value() && o.fracture.seeds.on == SeedsOn::surface;
       },
       "surface applies to seeds that are drawn, and {seeds} reads them from a file; omit it, or "
       "choose volume, by which such seeds grow as they did"},
      {{"density-attribute"},
       Verdict::conflict,
       [](O o, U) { return o.fracture.seeds.given.has_value(); },
       "applies to seeds that are drawn, and {seeds} reads them from a file; omit one of them"},
  };
}

std::vector<Rule> seedRules() {
  return {
      {{"density-attribute"},
       Verdict::conflict,
       [](O o, U) {
         return o.fracture.seeds.sampler == Sampler::poisson &&
                !ruleOf(o.fracture.grow.growth).splits;
       },
       "makes distances between seeds uneven, and {sampler} poisson keeps them even; choose "
       "another sampler",
       {"sampler"}},
      {{"density-attribute"},
       Verdict::conflict,
       [](O o, U) {
         return o.fracture.shares.balance > 0 && !ruleOf(o.fracture.grow.growth).splits;
       },
       "makes sizes uneven, and {balance} evens them out; omit one of them",
       {"balance"}},
      {{"density-attribute"},
       Verdict::conflict,
       [](O o, U) { return o.fracture.shares.sizes != Sizes::grown; },
       "and {sizes} both set the sizes of pieces; omit one of them",
       {"sizes"}},
      {{"seeds"},
       Verdict::conflict,
       [](O o, U) { return ruleOf(o.fracture.grow.growth).splits; },
       "places seeds, and {growth} sequential has none; omit one of them"},
      {{"sampler", "extra-seeds", "merge-metric", "size-spread"},
       Verdict::idle,
       [](O o, U) { return ruleOf(o.fracture.grow.growth).splits; },
       "does nothing with {growth} sequential, which has no seeds",
       {"growth"}},
      {{"seeds-on"},
       Verdict::idle,
       [](O o, U) {
         return ruleOf(o.fracture.grow.growth).splits && o.fracture.seeds.on == SeedsOn::surface;
       },
       "surface does nothing with {growth} sequential, which has no seeds",
       {"growth"}},
      {{"merge-metric", "size-spread"},
       Verdict::idle,
       [](O o, U) {
         const SeedOptions& seeds = o.fracture.seeds;
         return seeds.extraSeeds == 0 && seeds.extraSeedsPerPiece == 0 &&
                std::none_of(seeds.impacts.begin(), seeds.impacts.end(),
                             [](const Impact& impact) { return impact.merge; });
       },
       "does nothing without {extra-seeds}, or an {impact} that merges",
       {"extra-seeds", "impact"}},
  };
}

std::vector<Rule> growthRules() {
  return {
      {{"guide"},
       Verdict::conflict,
       [](O o, U) { return !ruleOf(o.fracture.grow.growth).splits; },
       "gives the first cracks of {growth} sequential; the other growths do not follow it",
       {"growth"}},
      {{"neighborhood"},
       Verdict::idle,
       [](O o, U) { return !ruleOf(o.fracture.grow.growth).usesNeighborhood; },
       "does nothing without {growth} flood",
       {"growth"}},
      {{"propagation"},
       Verdict::idle,
       [](O o, U) { return o.fracture.grow.roughness.isZero(); },
       "does nothing without {roughness}",
       {"roughness"}},
      {{"metric"},
       Verdict::idle,
       [](O o, U) { return !ruleOf(o.fracture.grow.growth).usesMetric; },
       "does nothing without {growth} nearest or chain",
       {"growth"}},
      {{"split-power", "split-offset", "split-tilt"},
       Verdict::idle,
       [](O o, U) { return !ruleOf(o.fracture.grow.growth).splits; },
       "does nothing without {growth} sequential",
       {"growth"}},
      {{"split-power"},
       Verdict::idle,
       [](O o, U) {
         return ruleOf(o.fracture.grow.growth).splits && o.fracture.shares.sizes != Sizes::grown;
       },
       "does nothing with {sizes}, which draws the shares of pieces",
       {"growth", "sizes"}},
      {{"impact", "impacts"},
       Verdict::idle,
       [](O o, U) {
         return ruleOf(o.fracture.grow.growth).splits && sharesOf(o.fracture).sizes != Sizes::grown;
       },
       "does nothing with {growth} sequential and {sizes}, which draws sizes anywhere",
       {"growth", "sizes"}},
      {{"impact"},
       Verdict::idle,
       [](O o, U) {
         const std::vector<Impact>& impacts = o.fracture.seeds.impacts;
         return ruleOf(o.fracture.grow.growth).splits &&
                sharesOf(o.fracture).sizes == Sizes::grown &&
                std::any_of(impacts.begin(), impacts.end(),
                            [](const Impact& impact) { return impact.merge; });
       },
       "makes no further seeds with {growth} sequential, which has none: merge does nothing there",
       {"growth"}},
  };
}

std::vector<Rule> splitRules() {
  return {
      {{"balance"},
       Verdict::idle,
       [](O o, U) { return ruleOf(o.fracture.grow.growth).splits; },
       "does nothing with {growth} sequential, whose pieces have no seeds",
       {"growth"}},
      {{"isolated"},
       Verdict::idle,
       [](O o, U) {
         return ruleOf(o.fracture.grow.growth).splits && o.fracture.grow.roughness.isZero();
       },
       "does nothing with {growth} sequential without {roughness}, whose pieces are connected",
       {"growth", "roughness"}},
  };
}

std::vector<Rule> sizeRules() {
  return {
      {{"sizes"},
       Verdict::conflict,
       [](O o, U) {
         const GrowOptions& grow = o.fracture.grow;
         return o.fracture.shares.sizes != Sizes::grown && !givesCells(grow) &&
                !ruleOf(grow.growth).splits;
       },
       "cannot be met by {growth} flood or chain, nor by another {metric} than the Euclidean; use "
       "{growth} euclid, nearest or sequential",
       {"growth", "metric"}},
  };
}

std::vector<Rule> erosionRules() {
  return {
      {{"erode-shape", "erode-size", "erode-planes", "erode-threshold", "erode-probability",
        "erode-on", "erode-islands"},
       Verdict::idle,
       [](O o, U) { return o.fracture.erode.iterations.isZero(); },
       "does nothing without {erode-iterations}",
       {"erode-iterations"}},
      {{"missing-rule"},
       Verdict::idle,
       [](O o, U) { return o.fracture.missing == 0.0; },
       "does nothing without {missing}",
       {"missing"}},
  };
}

std::vector<Rule> surfaceRules() {
  return {
      {{"interface"},
       Verdict::idle,
       [](O o, U) { return o.fracture.surface.surface == Surface::labels; },
       "does nothing with {surface} labels, which meshes fragments separately",
       {"surface"}},
      {{"interface"},
       Verdict::idle,
       [](O o, U) { return o.fracture.surface.surface == Surface::exact; },
       "does nothing where {surface} exact succeeds, whose fragments always share their surfaces",
       {"surface"}},
      {{"surface"},
       Verdict::idle,
       [](O o, U u) {
         const Surface surface = o.fracture.surface.surface;
         return (surface == Surface::labels || surface == Surface::exact) &&
                !u.isGiven("interface") && o.fracture.surface.scanNoise.rms == 0.0 &&
                o.fracture.surface.interface == Interface::independent;
       },
       "makes neighbors share vertices, which {preset} training prevents for smooth surfaces only",
       {"surface", "interface", "scan-noise"}},
      {{"smoothing"},
       Verdict::idle,
       [](O o, U) {
         const SmoothOptions& smooth = o.fracture.surface.smooth;
         return none(smooth.iterations) && none(smooth.boundaryIterations);
       },
       "does nothing without {smooth-iterations} or {smooth-boundary-iterations}",
       {"smooth-iterations", "smooth-boundary-iterations"}},
      {{"smooth-weight"},
       Verdict::idle,
       [](O o, U) { return none(o.fracture.surface.smooth.iterations); },
       "does nothing without {smooth-iterations}",
       {"smooth-iterations"}},
      {{"smooth-boundary-weight"},
       Verdict::idle,
       [](O o, U) { return none(o.fracture.surface.smooth.boundaryIterations); },
       "does nothing without {smooth-boundary-iterations}",
       {"smooth-boundary-iterations"}},
      {{"mismatch-common"},
       Verdict::idle,
       [](O o, U) { return o.fracture.surface.mismatch.rms == 0.0; },
       "does nothing without {mismatch}",
       {"mismatch"}},
      {{"mismatch", "scan-noise"},
       Verdict::idle,
       [](O o, U) { return !o.write.needsMeshes() && o.write.points.count == 0; },
       "does nothing to labels and .vdb files; add mesh to {write}, or {points}"},
      {{"triangles"},
       Verdict::idle,
       [](O o, U) {
         return !writes(o, {"mesh", "scene", "usd", "houdini"});
       },
       "does nothing without mesh, scene, usd or houdini in {write}"},
  };
}

std::vector<Rule> formatRules() {
  return {
      {{"mesh-format"},
       Verdict::idle,
       [](O o, U) { return !writes(o, {"mesh"}); },
       "does nothing without mesh in {write}"},
      {{"plain-meshes"},
       Verdict::idle,
       [](O o, U) {
         return !writes(o, {"mesh", "scene", "usd", "houdini"});
       },
       "does nothing without mesh, scene, usd or houdini in {write}"},
      {{"plain-meshes"},
       Verdict::idle,
       [](O o, U) {
         return writes(o, {"mesh"}) && !writes(o, {"scene", "usd", "houdini"}) &&
                !hasFormat(o, MeshFileFormat::ply) && !hasFormat(o, MeshFileFormat::obj) &&
                !hasFormat(o, MeshFileFormat::glb);
       },
       "does nothing without ply, obj or glb in {mesh-format}"},
      {{"source-faces"},
       Verdict::idle,
       [](O o, U) { return o.write.plainMeshes; },
       "does nothing with {plain-meshes}",
       {"plain-meshes"}},
      {{"source-faces"},
       Verdict::idle,
       [](O o, U) { return !writes(o, {"mesh"}) || !hasFormat(o, MeshFileFormat::ply); },
       "does nothing without mesh in {write} and ply in {mesh-format}"},
      {{"precision"},
       Verdict::idle,
       [](O o, U) {
         const bool hasDoubles = hasFormat(o, MeshFileFormat::ply) ||
                                 hasFormat(o, MeshFileFormat::obj) ||
                                 hasFormat(o, MeshFileFormat::stlText);
         return !(writes(o, {"mesh"}) && hasDoubles) && !writes(o, {"proxy", "boundaries"});
       },
       "does nothing without proxy or boundaries in {write}, or mesh in {write} and ply, obj or "
       "stl-ascii in {mesh-format}"},
      {{"voxel-format"},
       Verdict::idle,
       [](O o, U) { return !writes(o, {"labels"}); },
       "does nothing without labels in {write}"},
      {{"vdb", "half", "vdb-compress"},
       Verdict::idle,
       [](O o, U) { return !writes(o, {"vdb"}); },
       "does nothing without vdb in {write}"},
      {{"density"},
       Verdict::idle,
       [](O o, U) {
         return !writes(o, {"vdb", "scene", "usd", "graph"});
       },
       "does nothing without vdb, scene, usd or graph in {write}"},
      {{"proxy-gap"},
       Verdict::idle,
       [](O o, U) { return !writes(o, {"proxy"}); },
       "does nothing without proxy in {write}"},
  };
}

std::vector<Rule> usdRules() {
  return {
      {{"joint-strength"},
       Verdict::idle,
       [](O o, U) {
         return !writes(o, {"scene", "usd", "graph", "houdini"});
       },
       "does nothing without scene, usd, graph or houdini in {write}"},
      {{"usd-format", "usd-volumes"},
       Verdict::idle,
       [](O o, U) { return !writes(o, {"usd"}); },
       "does nothing without usd in {write}"},
      {{"usd-volumes"},
       Verdict::idle,
       [](O o, U) {
         const bool hasFiles = writes(o, {"vdb"}) && o.write.vdbFiles != VdbFiles::single;
         return writes(o, {"usd"}) && (!hasFiles || !hasFormat(o, UsdFormat::usda));
       },
       "does nothing without vdb in {write}, a file for each fragment, and usda in {usd-format}"},
  };
}

std::vector<Rule> writeRules() {
  return {
      {{"write"},
       Verdict::idle,
       [](O o, U) { return writes(o, {"fog"}) && !writes(o, {"vdb"}); },
       "fog does nothing without vdb: fog is written to the .vdb files"},
      {{"write"},
       Verdict::idle,
       [](O o, U) {
         return writes(o, {"solid"}) && !writes(o, {"vdb", "mesh"});
       },
       "solid does nothing without vdb or mesh: the intact solid is written in their formats"},
  };
}

std::vector<Rule> pointRules() {
  return {
      {{"share-points", "point-sampler", "point-rule", "point-format"},
       Verdict::idle,
       [](O o, U) { return o.write.points.count == 0; },
       "does nothing without {points}, or points in {write}"},
      {{"point-rule"},
       Verdict::conflict,
       [](O o, U) {
         return o.write.points.sampler == PointSampler::poisson &&
                o.write.points.rule == PointRule::perTriangle;
       },
       "per-triangle is not possible with {point-sampler} poisson"},
      {{"sdf-type"},
       Verdict::idle,
       [](O o, U) { return o.write.distances.count == 0; },
       "does nothing without {sdf-samples}"},
  };
}

const std::vector<Rule>& rules() {
  static const std::vector<Rule> kRules = joined(
      {solidRules(), givenSeedRules(), seedRules(), growthRules(), splitRules(), sizeRules(),
       erosionRules(), surfaceRules(), formatRules(), usdRules(), writeRules(), pointRules()});
  return kRules;
}

// Returns the sentence on an option, with names as the user wrote them.
std::string sentenceOn(const char* option, std::string_view rest, const OptionUse& use) {
  std::string sentence = use.spelled(option) + " ";
  for (std::size_t open; (open = rest.find('{')) != rest.npos;) {
    const std::size_t close = rest.find('}', open);
    sentence += rest.substr(0, open);
    sentence += use.spelled(rest.substr(open + 1, close - open - 1));
    rest.remove_prefix(close + 1);
  }
  return sentence.append(rest);
}

bool isDrawn(const OptionUse& use, const char* name) { return use.isDrawn && use.isDrawn(name); }

}  // namespace

std::vector<std::string> idleOptions(const RunOptions& options, const OptionUse& use) {
  std::vector<std::string> sentences;
  for (const Rule& rule : rules()) {
    const bool isKnown = std::none_of(rule.by.begin(), rule.by.end(),
                                      [&](const char* name) { return isDrawn(use, name); });
    if (!isKnown) continue;
    for (const char* option : rule.options) {
      if (!use.isGiven(option) || !rule.holds(options, use)) continue;
      const std::string sentence = sentenceOn(option, rule.sentence, use);
      if (rule.verdict == Verdict::conflict) throw Error(ErrorCode::usage, sentence);
      sentences.push_back(sentence);
    }
  }
  return sentences;
}

std::vector<std::string> idleOptions(const Volume& volume, const OptionUse& use) {
  std::vector<std::string> sentences;
  const auto addIfGiven = [&](const char* option, const char* sentence) {
    if (use.isGiven(option)) sentences.push_back(sentenceOn(option, sentence, use));
  };
  if (volume.solid) {
    for (const char* option : {"fill", "shell-thickness", "bodies"}) {
      addIfGiven(option,
                 "does nothing with a level set's own voxels; {resolution} or {voxel-size} "
                 "resamples it");
    }
  }
  addIfGiven("source-faces", "does nothing with a volume, which has no faces");
  if (volume.isLevelSet) {
    addIfGiven("isovalue", "does nothing with a level set, whose surface is at 0");
  }
  return sentences;
}

}  // namespace sherd
