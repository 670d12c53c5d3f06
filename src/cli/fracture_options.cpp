// Options of a fracture.  Ranges that hold for every solid are checked here; ranges that depend on
// the solid are checked by the stage.
#include "cli/fracture_options.h"

#include <cmath>
#include <optional>
#include <span>

#include "base/option_names.h"
#include "cli/option_text.h"

namespace sherd::cli {
namespace {

// "K", or "Kn" for K per fragment.
void parseExtraSeeds(const std::string& text, FractureOptions& options) {
  std::string digits = text;
  const bool perPiece = !digits.empty() && digits.back() == 'n';
  if (perPiece) digits.pop_back();
  int count = 0;
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, count);
  const int most = perPiece ? 1000 : 10'000'000;
  if (error != std::errc() || stop != end || count < 0 || count > most) {
    refuse("--extra-seeds", text, "a whole number, or a whole number followed by n as in 2n");
  }
  options.extraSeedsPerPiece = perPiece ? count : 0;
  options.seeds.extraSeeds = perPiece ? 0 : count;
}

// x,y,z[,count[,spread]][,merge], or ray:ox,oy,oz,dx,dy,dz[,...].  The spread is a standard
// deviation in world units, or a bias as n=5.
Impact parseImpact(const std::string& text) {
  const std::string expected =
      "x,y,z or ray:ox,oy,oz,dx,dy,dz, then optionally ,count ,spread (or n=5) and ,merge";
  const bool isRay = text.starts_with("ray:");
  std::vector<std::string> parts = split(isRay ? text.substr(4) : text);
  Impact impact;
  if (parts.back() == "merge") {
    impact.merge = true;
    parts.pop_back();
  }
  const std::size_t coordinates = isRay ? 6 : 3;
  if (parts.size() < coordinates || parts.size() > coordinates + 2)
    refuse("--impact", text, expected);
  const auto at = numbersIn(std::span(parts).first(coordinates));
  if (!at) refuse("--impact", text, expected);
  const std::vector<double>& v = *at;
  if (isRay) {
    impact.target = Ray{{{v[0], v[1], v[2]}}, {v[3], v[4], v[5]}};
  } else {
    impact.target = WorldPoint{{v[0], v[1], v[2]}};
  }
  if (parts.size() > coordinates) {
    const std::optional<double> count = numberIn(parts[coordinates]);
    if (!count || *count < 1 || *count > kMaxFragments || *count != std::floor(*count)) {
      refuse("--impact", text, expected);
    }
    impact.count = static_cast<int>(*count);
  }
  if (parts.size() > coordinates + 1) {
    const std::string& sigma = parts[coordinates + 1];
    const bool isBias = sigma.starts_with("n=");
    const std::optional<double> value = numberIn(isBias ? sigma.substr(2) : sigma);
    if (!value || *value <= 0 || (isBias && (*value > kMaxBias || *value != std::floor(*value)))) {
      refuse("--impact", text, expected);
    }
    if (isBias) {
      impact.bias = static_cast<int>(*value);
    } else {
      impact.sigma = *value;
    }
  }
  return impact;
}

void parseAnisotropy(const std::string& text, Anisotropy& anisotropy) {
  const auto numbers = numbersIn(split(text));
  if (!numbers || numbers->size() != 4 || (*numbers)[3] < -0.75 || (*numbers)[3] > 9.0 ||
      ((*numbers)[0] == 0.0 && (*numbers)[1] == 0.0 && (*numbers)[2] == 0.0)) {
    refuse("--grain", text, "dx,dy,dz,strength with a strength in -0.75..9");
  }
  anisotropy = {{(*numbers)[0], (*numbers)[1], (*numbers)[2]}, (*numbers)[3]};
}

void parseRoughness(const std::string& text, GrowOptions& grow) {
  const auto numbers = numbersIn(split(text));
  const bool good = numbers && numbers->size() <= 2 && (*numbers)[0] >= 0.0 &&
                    (*numbers)[0] <= 100.0 &&
                    (numbers->size() == 1 || ((*numbers)[1] >= 0.1 && (*numbers)[1] <= 1.0));
  if (!good) refuse("--roughness", text, "r or r,H with r in 0..100 voxels and H in 0.1..1");
  grow.roughness = (*numbers)[0];
  if (numbers->size() == 2) grow.hurst = (*numbers)[1];
}

void parseMissing(const std::string& text, double& missing) {
  const std::optional<double> value = numberIn(text);
  const bool good = value && *value >= 0.0 && *value <= kMaxFragments &&
                    (*value < 1.0 || *value == std::floor(*value));
  if (!good) refuse("--missing", text, "a whole number of fragments, or a share below 1");
  missing = *value;
}

}  // namespace

CLI::Option* addResolution(CLI::App& command, FractureOptions& options) {
  CLI::Validator number = wholeNumber(8, 4096);
  const CLI::Validator automatic(
      [number](std::string& text) {
        if (text != "auto") return number(text);
        text = std::to_string(kAutoResolution);
        return std::string();
      },
      "auto|8..4096");
  return command
      .add_option("--resolution", options.resolution,
                  "Voxels along the longest side; auto: as many as the mesh's walls need, 128..512")
      ->transform(automatic)
      ->default_str("auto");
}

void addFillOptions(CLI::App& command, FractureOptions& options) {
  const std::string group = "Solid";
  addChoice(command, "--fill", options.fill, names::kFill,
            "How the inside is found; auto is winding, or shell where the mesh encloses nothing")
      ->group(group);
  command
      .add_option(
          "--shell-thickness", options.shellThickness,
          "Make a shell of this thickness about the surface, in the mesh's own unit, at most "
          "its longest side; default of --fill shell: two and a half voxels")
      ->check(aboveZero())
      ->group(group);
}

void addVolumeOptions(CLI::App& command, VolumeOptions& options) {
  const std::string group = "Solid";
  command
      .add_option("--grid", options.grid,
                  "The grid of a .vdb file; default: the union of its level sets, or its only grid")
      ->type_name("NAME")
      ->group(group);
  command
      .add_option("--isovalue", options.isovalue,
                  "A grid other than a level set is solid where its values are above")
      ->check(numberBetween(-1e30, 1e30, "a number"))
      ->capture_default_str()
      ->group(group);
}

void addSeedOptions(CLI::App& command, FractureOptions& options) {
  const std::string group = "Seeds";
  SeedOptions& seeds = options.seeds;
  addChoice(command, "--sampler", seeds.sampler, names::kSampler, "How seeds are drawn")
      ->group(group);
  addChoice(command, "--seeds-on", seeds.on, names::kSeedsOn, "Where seeds may lie")->group(group);
  command
      .add_option_function<std::string>(
          "--extra-seeds", [&options](const std::string& text) { parseExtraSeeds(text, options); },
          "Additional seeds, merged into the nearest fragment: less convex pieces; 2n is two per "
          "fragment")
      ->type_name("K|Kn")
      ->default_str("0")
      ->group(group);
  addChoice(command, "--merge-metric", seeds.mergeMetric, names::kMetric,
            "Metric of the nearest fragment for extra seeds")
      ->group(group);
  command
      .add_option_function<std::vector<std::string>>(
          "--impact",
          [&seeds](const std::vector<std::string>& all) {
            for (const std::string& text : all) seeds.impacts.push_back(parseImpact(text));
          },
          "An impact at x,y,z or ray:ox,oy,oz,dx,dy,dz, then ,count ,spread (world units, or n=5 "
          "as "
          "the paper's bias) ,merge; repeatable")
      ->type_name("IMPACT")
      ->allow_extra_args(false)
      ->group(group);
  command.add_option("--impacts", seeds.randomImpacts, "Impacts at random surface points")
      ->transform(wholeNumber(0, 10000))
      ->capture_default_str()
      ->group(group);
  command
      .add_option_function<std::string>(
          "--seeds", [&options](const std::string& text) { options.seedFile = text; },
          "Read the seeds from a file, as --write seeds writes it, instead of drawing them")
      ->type_name("FILE")
      ->excludes("--pieces")
      ->group(group);
}

namespace {

constexpr const char* kGrowthGroup = "Growth";

void addRuleOptions(CLI::App& command, GrowOptions& grow) {
  const std::string group = kGrowthGroup;
  std::vector<const char*> rules;
  for (const GrowthRule& rule : kGrowthRules) rules.push_back(rule.name);
  addChoice(command, "--growth", grow.growth, rules, "How fragments grow from their seeds")
      ->group(group);
  command
      .add_option("--neighborhood", grow.neighborhood, "Neighbors of a voxel in a flood: 6 or 26")
      ->check(oneOf({6, 26}))
      ->type_name("")
      ->capture_default_str()
      ->group(group);
  addChoice(command, "--metric", grow.metric, names::kMetric,
            "Metric of --growth nearest and chain")
      ->group(group);
  command
      .add_option_function<std::string>(
          "--grain", [&grow](const std::string& text) { parseAnisotropy(text, grow.anisotropy); },
          "Grain along a direction: splinters with a strength of 0..9, plates across it with "
          "-0.75..0")
      ->type_name("dx,dy,dz,strength")
      ->group(group);
  command
      .add_option_function<std::string>(
          "--roughness", [&grow](const std::string& text) { parseRoughness(text, grow); },
          "Rough cracks: rms height r in voxels over a tenth of the solid, Hurst exponent H "
          "(default 0.8)")
      ->type_name("r[,H]")
      ->default_str("0")
      ->group(group);
  addChoice(command, "--isolated", grow.regrowIsolated, names::kIsolated,
            "Voxels disconnected from their fragment's first seed: regrow gives them to neighbors, "
            "keep leaves them")
      ->group(group);
}

void addShareOptions(CLI::App& command, FractureOptions& options) {
  const std::string group = kGrowthGroup;
  command
      .add_option(
          "--min-share", options.shares.minShare,
          "Least share of the solid in a fragment; seeds are drawn again until all reach it")
      ->check(numberBetween(0.0, 1.0, "0..1"))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--balance", options.shares.balance,
                  "Lloyd steps, which move seeds to their fragments' centers and even out sizes")
      ->transform(wholeNumber(0, 100))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--drop-share", options.dropShare,
                  "Withhold fragments with a smaller share of the solid")
      ->check(numberBetween(0.0, 1.0, "0..1"))
      ->capture_default_str()
      ->group(group);
  command
      .add_option_function<std::string>(
          "--missing", [&options](const std::string& text) { parseMissing(text, options.missing); },
          "Withhold further fragments at random: a number, or below 1 a share of them; the "
          "manifest lists them")
      ->type_name("k|share")
      ->default_str("0")
      ->group(group);
}

}  // namespace

void addGrowthOptions(CLI::App& command, FractureOptions& options) {
  addRuleOptions(command, options.grow);
  addShareOptions(command, options);
}

void addErosionOptions(CLI::App& command, FractureOptions& options) {
  const std::string group = "Erosion";
  ErodeOptions& erode = options.erode;
  command.add_option("--erode-iterations", erode.iterations, "Number of erosion passes; 0 none")
      ->transform(wholeNumber(0, 1000))
      ->capture_default_str()
      ->group(group);
  addChoice(command, "--erode-shape", erode.shape, names::kErodeShape,
            "Structuring element around a voxel")
      ->group(group);
  command.add_option("--erode-size", erode.size, "Size of the structuring element, odd")
      ->check(oneOf({3, 5, 7, 9, 11, 13}))
      ->type_name("")
      ->capture_default_str()
      ->group(group);
  command
      .add_flag(
          "--erode-planes", erode.planes,
          "Structuring elements in the three axis planes, as in the paper, instead of one in 3-D")
      ->group(group);
  command
      .add_option("--erode-threshold", erode.threshold,
                  "Share of the structuring element that its fragment must fill")
      ->check(numberBetween(1e-6, 1.0, "0.000001..1"))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--erode-probability", erode.probability,
                  "Probability that a voxel is tested, drawn again in each pass")
      ->check(numberBetween(0.0, 1.0, "0..1"))
      ->capture_default_str()
      ->group(group);
  addChoice(command, "--erode-on", erode.on, names::kErodeOn,
            "Erode fracture surfaces only, or the original surface too")
      ->group(group);
  addChoice(command, "--erode-islands", erode.islands, names::kIslands,
            "Smaller components of a fragment that erosion splits")
      ->group(group);
}

void addPreset(CLI::App& command, FractureOptions& options) {
  command
      .add_option_function<std::string>(
          "--preset", [&options](const std::string&) { options = paperOptions(); },
          "Options of section 4.1 of the paper; options that are given override them")
      ->check(CLI::IsMember({"paper"}))
      ->type_name("");
}

}  // namespace sherd::cli
