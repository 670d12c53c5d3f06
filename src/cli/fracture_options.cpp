// From text to the options of a fracture.  Ranges are checked here where they are the same for
// every solid; what depends on the solid is checked by the stage that knows it.
#include "cli/fracture_options.h"

#include <cmath>
#include <optional>
#include <span>

#include "base/option_names.h"
#include "cli/option_text.h"

namespace sherd::cli {
namespace {

// "K", or "Kn" for K of each fragment.
void parseExtraSeeds(const std::string& text, FractureOptions& options) {
  std::string digits = text;
  const bool perPiece = !digits.empty() && digits.back() == 'n';
  if (perPiece) digits.pop_back();
  int count = 0;
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, count);
  const int most = perPiece ? 1000 : 10'000'000;
  if (error != std::errc() || stop != end || count < 0 || count > most) {
    refuse("--extra-seeds", text, "a whole number, or one times n as in 2n");
  }
  options.extraSeedsPerPiece = perPiece ? count : 0;
  options.seeds.extraSeeds = perPiece ? 0 : count;
}

// x,y,z[,count[,spread]][,merge], or ray:ox,oy,oz,dx,dy,dz[,...]; spread in world units or as n=5.
Impact parseImpact(const std::string& text) {
  const std::string expected =
      "x,y,z or ray:ox,oy,oz,dx,dy,dz, then ,count ,spread (or n=5) and ,merge as wanted";
  const bool isRay = text.starts_with("ray:");
  std::vector<std::string> parts = split(isRay ? text.substr(4) : text);
  Impact impact;
  if (parts.back() == "merge") {
    impact.merge = true;
    parts.pop_back();
  }
  const std::size_t place = isRay ? 6 : 3;
  if (parts.size() < place || parts.size() > place + 2) refuse("--impact", text, expected);
  const auto at = numbersIn(std::span(parts).first(place));
  if (!at) refuse("--impact", text, expected);
  const std::vector<double>& v = *at;
  if (isRay) {
    impact.place = Ray{{{v[0], v[1], v[2]}}, {v[3], v[4], v[5]}};
  } else {
    impact.place = WorldPoint{{v[0], v[1], v[2]}};
  }
  if (parts.size() > place) {
    const std::optional<double> count = numberIn(parts[place]);
    if (!count || *count < 1 || *count > kMaxFragments || *count != std::floor(*count)) {
      refuse("--impact", text, expected);
    }
    impact.count = static_cast<int>(*count);
  }
  if (parts.size() > place + 1) {
    const std::string& spread = parts[place + 1];
    const bool isBias = spread.starts_with("n=");
    const std::optional<double> value = numberIn(isBias ? spread.substr(2) : spread);
    if (!value || *value <= 0 || (isBias && (*value > kMaxBias || *value != std::floor(*value)))) {
      refuse("--impact", text, expected);
    }
    if (isBias) {
      impact.bias = static_cast<int>(*value);
    } else {
      impact.spread = *value;
    }
  }
  return impact;
}

void parseGrain(const std::string& text, Grain& grain) {
  const auto numbers = numbersIn(split(text));
  if (!numbers || numbers->size() != 4 || (*numbers)[3] < -0.75 || (*numbers)[3] > 9.0 ||
      ((*numbers)[0] == 0.0 && (*numbers)[1] == 0.0 && (*numbers)[2] == 0.0)) {
    refuse("--grain", text, "dx,dy,dz,strength with a strength in -0.75..9");
  }
  grain = {{(*numbers)[0], (*numbers)[1], (*numbers)[2]}, (*numbers)[3]};
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
            "How the mesh tells its inside; auto takes winding, or shell where the mesh encloses "
            "nothing")
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
                  "The grid of a .vdb file; default: its level sets, united, or its only grid")
      ->type_name("NAME")
      ->group(group);
  command
      .add_option("--isovalue", options.isovalue,
                  "A grid that is no level set is solid where its values are above")
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
          "Further seeds, given to the nearest fragment: less convex pieces; 2n is two a fragment")
      ->type_name("K|Kn")
      ->default_str("0")
      ->group(group);
  addChoice(command, "--merge-metric", seeds.mergeMetric, names::kMetric,
            "What nearest means for extra seeds")
      ->group(group);
  command
      .add_option_function<std::vector<std::string>>(
          "--impact",
          [&seeds](const std::vector<std::string>& all) {
            for (const std::string& text : all) seeds.impacts.push_back(parseImpact(text));
          },
          "A blow at x,y,z or ray:ox,oy,oz,dx,dy,dz, then ,count ,spread (world units, or n=5 as "
          "the paper's bias) ,merge; repeatable")
      ->type_name("IMPACT")
      ->allow_extra_args(false)
      ->group(group);
  command.add_option("--impacts", seeds.randomImpacts, "Blows at random places of the surface")
      ->transform(wholeNumber(0, 10000))
      ->capture_default_str()
      ->group(group);
  command
      .add_option_function<std::string>(
          "--seeds", [&options](const std::string& text) { options.seedFile = text; },
          "Take the seeds of a file, as --write seeds makes it, in place of drawn ones")
      ->type_name("FILE")
      ->excludes("--pieces")
      ->group(group);
}

void addGrowthOptions(CLI::App& command, FractureOptions& options) {
  const std::string group = "Growth";
  GrowOptions& grow = options.grow;
  addChoice(command, "--growth", grow.growth, names::kGrowth,
            "How fragments spread from their seeds")
      ->group(group);
  command.add_option("--neighborhood", grow.neighborhood, "Neighbours a flood steps to: 6 or 26")
      ->check(oneOf({6, 26}))
      ->type_name("")
      ->capture_default_str()
      ->group(group);
  addChoice(command, "--metric", grow.metric, names::kMetric, "Distance of nearest and chain")
      ->group(group);
  command
      .add_option_function<std::string>(
          "--grain", [&grow](const std::string& text) { parseGrain(text, grow.grain); },
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
            "What is cut off from its fragment's first seed: regrow gives it to neighbours, keep "
            "leaves it")
      ->group(group);
  command
      .add_option(
          "--min-share", options.shares.minShare,
          "Least share of the solid that a fragment may have; seeds are drawn again until so")
      ->check(numberBetween(0.0, 1.0, "0..1"))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--balance", options.shares.balance,
                  "Steps that move seeds to their fragments' centres: sizes even out")
      ->transform(wholeNumber(0, 100))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--drop-share", options.dropShare,
                  "Withhold fragments that have a lesser share of the solid")
      ->check(numberBetween(0.0, 1.0, "0..1"))
      ->capture_default_str()
      ->group(group);
  command
      .add_option_function<std::string>(
          "--missing", [&options](const std::string& text) { parseMissing(text, options.missing); },
          "Withhold fragments, of those that are left: a number, or below 1 a share of them; the "
          "manifest tells which")
      ->type_name("k|share")
      ->default_str("0")
      ->group(group);
}

void addErosionOptions(CLI::App& command, FractureOptions& options) {
  const std::string group = "Erosion";
  ErodeOptions& erode = options.erode;
  command
      .add_option("--erode-iterations", erode.iterations, "How often fragments are worn; 0 never")
      ->transform(wholeNumber(0, 1000))
      ->capture_default_str()
      ->group(group);
  addChoice(command, "--erode-shape", erode.shape, names::kErodeShape,
            "Shape that must be filled about a voxel")
      ->group(group);
  command.add_option("--erode-size", erode.size, "Size of the shape, odd")
      ->check(oneOf({3, 5, 7, 9, 11, 13}))
      ->type_name("")
      ->capture_default_str()
      ->group(group);
  command
      .add_flag("--erode-planes", erode.planes,
                "The shape in the three axis planes, as in the paper, in place of 3-D")
      ->group(group);
  command
      .add_option("--erode-threshold", erode.threshold, "Share of the shape that must be filled")
      ->check(numberBetween(1e-6, 1.0, "0.000001..1"))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--erode-probability", erode.probability,
                  "Chance of a voxel to be tested, drawn afresh each time")
      ->check(numberBetween(0.0, 1.0, "0..1"))
      ->capture_default_str()
      ->group(group);
  addChoice(command, "--erode-on", erode.on, names::kErodeOn,
            "Wear cracks only, or the original surface too")
      ->group(group);
  addChoice(command, "--erode-crumbs", erode.crumbs, names::kCrumbs,
            "Smaller parts of a fragment that falls apart")
      ->group(group);
}

void addPreset(CLI::App& command, FractureOptions& options) {
  command
      .add_option_function<std::string>(
          "--preset", [&options](const std::string&) { options = paperOptions(); },
          "Options as the paper has them in its section 4.1; any that is given beats it")
      ->check(CLI::IsMember({"paper"}))
      ->type_name("");
}

}  // namespace sherd::cli
