// Options that require or exclude others: one rule for each condition.
#include "cli/option_rules.h"

#include <sherd/error.h>
#include <sherd/files.h>

#include <algorithm>

#include "base/lower_case.h"
#include "base/option_text.h"

namespace sherd::cli {
namespace {

using Names = std::vector<const char*>;

enum class Verdict {
  idle,      ///< the option does nothing: a warning
  conflict,  ///< two options contradict each other: an error
};

/// Options, and the verdict on each that is given while a condition holds.
struct Rule {
  Names options;
  Verdict verdict;
  bool (*holds)(const ParsedOptions& parsed);
  const char* sentence;  ///< after the option's name
  Names by{};            ///< options that the condition depends on; skipped where one is drawn
};

bool writes(const ParsedOptions& parsed, std::initializer_list<const char*> names) {
  const std::vector<std::string> written = split(fractureOption("write")->value.text(parsed.run));
  return std::any_of(names.begin(), names.end(), [&](const char* name) {
    return std::find(written.begin(), written.end(), name) != written.end();
  });
}

bool isVdb(const ParsedOptions& parsed) {
  return lowerCase(std::filesystem::path(parsed.mesh).extension().string()) == ".vdb";
}

bool hasFormat(const ParsedOptions& parsed, MeshFileFormat format) {
  const std::vector<MeshFileFormat>& formats = parsed.run.write.meshFormats;
  return std::find(formats.begin(), formats.end(), format) != formats.end();
}

bool none(const Iterations& iterations) {
  return iterations.count == 0 && iterations.perVoxel == 0.0;
}

bool hasLayout(const ParsedOptions& parsed, DatasetLayout layout) {
  return parsed.dataset != nullptr && parsed.dataset->layout == layout;
}

using P = const ParsedOptions&;

std::vector<Rule> joined(std::initializer_list<std::vector<Rule>> groups) {
  std::vector<Rule> all;
  for (const std::vector<Rule>& group : groups) all.insert(all.end(), group.begin(), group.end());
  return all;
}

std::vector<Rule> solidRules() {
  return {
      {{"--shell-thickness"},
       Verdict::conflict,
       [](P p) {
         const Fill fill = p.run.fracture.solid.fill;
         return fill != Fill::automatic && fill != Fill::shell;
       },
       "makes a shell, which --fill winding, parity and flood do not; omit one of them"},
      {{"--grid", "--isovalue"},
       Verdict::conflict,
       [](P p) { return !isVdb(p); },
       "applies to the grids of a .vdb file, and MESH is not one"},
      {{"--split-objects"},
       Verdict::conflict,
       [](P p) { return isVolumeName(p.mesh); },
       "breaks the objects of a mesh, and MESH is a volume without objects"},
  };
}

std::vector<Rule> seedRules() {
  return {
      {{"--sampler", "--seeds-on", "--extra-seeds", "--merge-metric", "--impact", "--impacts"},
       Verdict::conflict,
       [](P p) { return p.run.fracture.seeds.given.has_value(); },
       "applies to seeds that are drawn, and --seeds reads them from a file; omit one of them"},
      {{"--merge-metric"},
       Verdict::idle,
       [](P p) {
         const SeedOptions& seeds = p.run.fracture.seeds;
         return seeds.extraSeeds == 0 && seeds.extraSeedsPerPiece == 0 &&
                std::none_of(seeds.impacts.begin(), seeds.impacts.end(),
                             [](const Impact& impact) { return impact.merge; });
       },
       "does nothing without --extra-seeds, or an --impact that merges",
       {"--extra-seeds", "--impact"}},
  };
}

std::vector<Rule> growthRules() {
  return {
      {{"--neighborhood"},
       Verdict::idle,
       [](P p) { return !ruleOf(p.run.fracture.grow.growth).usesNeighborhood; },
       "does nothing without --growth flood",
       {"--growth"}},
      {{"--metric"},
       Verdict::idle,
       [](P p) { return !ruleOf(p.run.fracture.grow.growth).usesMetric; },
       "does nothing without --growth nearest or chain",
       {"--growth"}},
  };
}

std::vector<Rule> erosionRules() {
  return {
      {{"--erode-shape", "--erode-size", "--erode-planes", "--erode-threshold",
        "--erode-probability", "--erode-on", "--erode-islands"},
       Verdict::idle,
       [](P p) { return p.run.fracture.erode.iterations.isZero(); },
       "does nothing without --erode-iterations",
       {"--erode-iterations"}},
  };
}

std::vector<Rule> surfaceRules() {
  return {
      {{"--interface"},
       Verdict::idle,
       [](P p) { return p.run.fracture.surface.surface == Surface::labels; },
       "does nothing with --surface labels, which meshes fragments separately",
       {"--surface"}},
      {{"--interface"},
       Verdict::idle,
       [](P p) { return p.run.fracture.surface.surface == Surface::exact; },
       "does nothing where --surface exact succeeds, whose fragments always share their surfaces",
       {"--surface"}},
      {{"--smoothing"},
       Verdict::idle,
       [](P p) {
         const SmoothOptions& smooth = p.run.fracture.surface.smooth;
         return none(smooth.iterations) && none(smooth.boundaryIterations);
       },
       "does nothing without --smooth-iterations or --smooth-boundary-iterations",
       {"--smooth-iterations", "--smooth-boundary-iterations"}},
      {{"--smooth-weight"},
       Verdict::idle,
       [](P p) { return none(p.run.fracture.surface.smooth.iterations); },
       "does nothing without --smooth-iterations",
       {"--smooth-iterations"}},
      {{"--smooth-boundary-weight"},
       Verdict::idle,
       [](P p) { return none(p.run.fracture.surface.smooth.boundaryIterations); },
       "does nothing without --smooth-boundary-iterations",
       {"--smooth-boundary-iterations"}},
  };
}

std::vector<Rule> formatRules() {
  return {
      {{"--triangles", "--mesh-format", "--plain-meshes"},
       Verdict::idle,
       [](P p) { return !writes(p, {"mesh"}); },
       "does nothing without mesh in --write"},
      {{"--plain-meshes"},
       Verdict::idle,
       [](P p) {
         return writes(p, {"mesh"}) && !hasFormat(p, MeshFileFormat::ply) &&
                !hasFormat(p, MeshFileFormat::obj);
       },
       "does nothing without ply or obj in --mesh-format"},
      {{"--precision"},
       Verdict::idle,
       [](P p) { return !writes(p, {"mesh"}) || !hasFormat(p, MeshFileFormat::ply); },
       "does nothing without mesh in --write and ply in --mesh-format"},
      {{"--voxel-format"},
       Verdict::idle,
       [](P p) { return !writes(p, {"labels"}); },
       "does nothing without labels in --write"},
      {{"--vdb", "--half", "--vdb-compress"},
       Verdict::idle,
       [](P p) { return !writes(p, {"vdb"}); },
       "does nothing without vdb in --write"},
      {{"--density"},
       Verdict::idle,
       [](P p) {
         return !writes(p, {"vdb", "scene", "graph"});
       },
       "does nothing without vdb, scene or graph in --write"},
      {{"--proxy-gap"},
       Verdict::idle,
       [](P p) { return !writes(p, {"proxy"}); },
       "does nothing without proxy in --write"},
      {{"--up"},
       Verdict::idle,
       [](P p) { return p.dataset == nullptr && !writes(p, {"preview"}); },
       "does nothing without preview in --write"},
  };
}

std::vector<Rule> writeRules() {
  return {
      {{"--write"},
       Verdict::idle,
       [](P p) { return writes(p, {"fog"}) && !writes(p, {"vdb"}); },
       "fog does nothing without vdb: fog is written to the .vdb files"},
      {{"--write"},
       Verdict::idle,
       [](P p) {
         return writes(p, {"solid"}) && !writes(p, {"vdb", "mesh"});
       },
       "solid does nothing without vdb or mesh: the intact solid is written in their formats"},
      {{"--write"},
       Verdict::idle,
       [](P p) {
         return writes(p, {"solid"}) &&
                (hasLayout(p, DatasetLayout::paper) || hasLayout(p, DatasetLayout::bb));
       },
       "solid does nothing with --layout paper and bb, which hold the intact object once"},
  };
}

std::vector<Rule> pointRules() {
  return {
      {{"--share-points", "--point-sampler", "--point-rule", "--point-format"},
       Verdict::idle,
       [](P p) { return p.run.write.points.count == 0; },
       "does nothing without --points, or points in --write"},
      {{"--point-rule"},
       Verdict::conflict,
       [](P p) {
         return p.run.write.points.sampler == PointSampler::poisson &&
                p.run.write.points.rule == PointRule::perTriangle;
       },
       "per-triangle is not possible with --point-sampler poisson"},
      {{"--sdf-type"},
       Verdict::idle,
       [](P p) { return p.run.write.distances.count == 0; },
       "does nothing without --sdf-samples"},
  };
}

std::vector<Rule> datasetRules() {
  return {
      {{"--compress"},
       Verdict::idle,
       [](P p) {
         return hasLayout(p, DatasetLayout::packed) &&
                p.dataset->compression == FileCompression::zstd;
       },
       "zstd is the same as zip with --layout packed, which deflates archives"},
      {{"--verify", "--resume"},
       Verdict::idle,
       [](P p) { return p.dryRun; },
       "does nothing with --dry-run, which writes no dataset"},
  };
}

const std::vector<Rule>& rules() {
  static const std::vector<Rule> kRules =
      joined({solidRules(), seedRules(), growthRules(), erosionRules(), surfaceRules(),
              formatRules(), writeRules(), pointRules(), datasetRules()});
  return kRules;
}

bool isDrawn(const ParsedOptions& parsed, const std::string& name) {
  if (parsed.dataset == nullptr) return false;
  const std::vector<DrawnOption>& drawn = parsed.dataset->drawn;
  return std::any_of(drawn.begin(), drawn.end(),
                     [&](const DrawnOption& option) { return "--" + option.name == name; });
}

bool isGiven(const ParsedOptions& parsed, const std::string& name) {
  const CLI::Option* const option = parsed.command.get_option_no_throw(name);
  return option != nullptr && option->count() > 0;
}

}  // namespace

std::vector<std::string> idleOptions(const ParsedOptions& parsed) {
  std::vector<std::string> sentences;
  for (const Rule& rule : rules()) {
    const bool isKnown = std::none_of(rule.by.begin(), rule.by.end(),
                                      [&](const char* name) { return isDrawn(parsed, name); });
    if (!isKnown) continue;
    for (const char* option : rule.options) {
      if (!isGiven(parsed, option) || !rule.holds(parsed)) continue;
      const std::string sentence = std::string(option) + " " + rule.sentence;
      if (rule.verdict == Verdict::conflict) throw Error(ErrorCode::usage, sentence);
      sentences.push_back(sentence);
    }
  }
  return sentences;
}

}  // namespace sherd::cli
