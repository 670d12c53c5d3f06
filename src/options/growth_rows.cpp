// Growth, erosion, and the fragments that are withheld: one row for each option.
#include <sherd/growth.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/text/option_names.h"
#include "options/parsed.h"
#include "options/rows.h"

namespace sherd {
namespace {

using V = ValuesOf<RunOptions>;
using Row = FractureOptionRow;
using R = const RunOptions&;

constexpr auto kGrow = [](auto& o) -> auto& { return o.fracture.grow; };
constexpr auto kSplit = [](auto& o) -> auto& { return o.fracture.grow.split; };
constexpr auto kGrain = [](auto& o) -> auto& { return o.fracture.grow.anisotropy; };
constexpr auto kShares = [](auto& o) -> auto& { return o.fracture.shares; };
constexpr auto kErode = [](auto& o) -> auto& { return o.fracture.erode; };

bool erodes(R o) { return !o.fracture.erode.iterations.isZero(); }
bool splits(R o) { return ruleOf(o.fracture.grow.growth).splits; }
bool hasGrain(R o) { return o.fracture.grow.anisotropy.strength != 0.0; }
bool hasPropagation(R o) { return o.fracture.grow.propagationHurst != 0.0; }

std::vector<const char*> growthNames() {
  std::vector<const char*> names;
  for (const GrowthRule& rule : kGrowthRules) names.push_back(rule.name);
  return names;
}

const Row kGrowthRows[]{
    {.name = "growth",
     .group = "Growth",
     .value = V::choice(kGrow, &GrowOptions::growth, growthNames()),
     .help = "How fragments grow from their seeds, or by splits one after another",
     .details = "growth of fragments: layer by layer; nearest seed, ignoring gaps; over "
                "voxel faces in the order of the distance to the seed; nearest seed, "
                "disconnected voxels regrown ([decision 0009](decisions/0009-growth.md)); without "
                "seeds, by splitting pieces in two one after another, so that older cracks stop "
                "newer ones ([decision 0020](decisions/0020-cracks-in-order.md))",
     .key = "grow.growth",
     .drawn = true},
    {.name = "neighborhood",
     .group = "Growth",
     .value = V::oneOf(kGrow, &GrowOptions::neighborhood, {6, 26}),
     .help = "Neighbors of a voxel in a flood: 6 or 26",
     .details = "neighbors of a voxel in a flood",
     .key = "grow.neighborhood",
     .recorded = [](R o) { return ruleOf(o.fracture.grow.growth).usesNeighborhood; },
     .drawn = true},
    {.name = "metric",
     .group = "Growth",
     .value = V::choice(kGrow, &GrowOptions::metric, names::kMetric),
     .help = "Metric of --growth nearest and chain",
     .details = "distance of `nearest` and `chain`",
     .key = "grow.metric",
     .recorded = [](R o) { return ruleOf(o.fracture.grow.growth).usesMetric; },
     .drawn = true},
    {.name = "split-power",
     .group = "Growth",
     .value = V::number(kSplit, &SplitOptions::power, between(0.0, 10.0, "0..10")),
     .help = "Which piece --growth sequential splits next: drawn by its size to this power",
     .details =
         "the piece that `sequential` splits next is drawn by its size to this power: 0 each "
         "alike, so that sizes spread widely; 10 nearly always the largest",
     .key = "grow.split.power",
     .recorded = splits,
     .drawn = true},
    {.name = "split-offset",
     .group = "Growth",
     .value = V::number(kSplit, &SplitOptions::offset, between(0.0, 0.5, "0..0.5")),
     .help = "How far from the middle of a piece --growth sequential splits it: standard deviation "
             "of the share that is cut off",
     .details = "standard deviation of the share of a piece that a crack of `sequential` cuts off, "
                "from one half",
     .key = "grow.split.offset",
     .recorded = splits,
     .drawn = true},
    {.name = "split-tilt",
     .group = "Growth",
     .value = V::number(kSplit, &SplitOptions::tilt, between(0.0, 90.0, "0..90")),
     .help =
         "Standard deviation in degrees of the angle between a crack of --growth sequential and "
         "the section across its piece's long axis",
     .details = "standard deviation of the angle between the normal of a crack of `sequential` and "
                "the long axis of its piece",
     .key = "grow.split.tilt",
     .recorded = splits,
     .drawn = true,
     .unit = "degrees"},
    {.name = "grain",
     .group = "Growth",
     .value = V::custom(
         OptionType::text, "dx,dy,dz,strength",
         [](RunOptions& o, const std::string& text) { setGrain(kGrain(o), text); },
         [](R o) { return grainText(kGrain(o)); }),
     .help = "Grain along a direction: splinters with a strength of 0..9, plates across it with "
             "-0.75..0",
     .details = "anisotropy: lengths along the direction are divided by 1 + strength: "
                "splinters for 0 to 9, plates across it for -0.75 to 0",
     .drawn = true},
    {.name = "grain-direction",
     .group = "Growth",
     .value = V::custom(
         OptionType::numbers, "dx,dy,dz",
         [](RunOptions& o, const std::string& text) { setDirection(kGrain(o), text); },
         [](R o) { return directionText(kGrain(o)); }),
     .help = "Direction of the grain",
     .key = "grow.grain.direction",
     .recorded = hasGrain,
     .hidden = true},
    {.name = "grain-strength",
     .group = "Growth",
     .value = V::number(kGrain, &Anisotropy::strength, between(-0.75, 9.0, "-0.75..9")),
     .help = "Strength of the grain",
     .key = "grow.grain.strength",
     .recorded = hasGrain,
     .hidden = true},
    {.name = "roughness",
     .group = "Growth",
     .value = V::custom(
         OptionType::text, "r[,H[,W]]|P%[,H[,W]]",
         [](RunOptions& o, const std::string& text) { setRoughness(o.fracture.grow, text); },
         [](R o) { return roughnessText(o.fracture.grow); }),
     .help = "Rough cracks: rms height in voxels, or in % of the longest side, over W (default a "
             "tenth of it); Hurst exponent H (default 0.8)",
     .details = "rough cracks: rms height of r voxels (0 to 100), or of P % of the longest side, "
                "which is the same at any resolution, over a window of side W (voxels or %, "
                "default a tenth of the longest side), self-affine with Hurst exponent H (0.1 to "
                "1, default 0.8) up to four windows",
     .drawn = true},
    {.name = "roughness-height",
     .group = "Growth",
     .value = V::length(kGrow, &GrowOptions::roughness, between(0.0, 100.0, "0..100")),
     .help = "Rms height of a crack",
     .key = "grow.roughness",
     .hidden = true,
     .unit = "voxels"},
    {.name = "hurst",
     .group = "Growth",
     .value = V::number(kGrow, &GrowOptions::hurst, between(0.1, 1.0, "0.1..1")),
     .help = "Hurst exponent of rough cracks",
     .key = "grow.hurst",
     .hidden = true},
    {.name = "roughness-window",
     .group = "Growth",
     .value = V::length(kGrow, &GrowOptions::roughnessWindow, kNotNegative),
     .help = "Side over which the roughness is measured; 0: a tenth of the longest side of what "
             "is broken",
     .key = "grow.roughness_window",
     .hidden = true,
     .unit = "voxels"},
    {.name = "guide",
     .group = "Growth",
     .value = V::custom(
         OptionType::text, "FILE",
         [](RunOptions& o, const std::string& text) {
           if (text.empty()) refuseValue(text, "a file");
           o.fracture.guides.push_back({.file = text});
         },
         [](R o) {
           std::vector<std::string> files;
           for (const Guide& guide : o.fracture.guides) files.push_back(guide.file);
           return joinedText(files, " ");
         }),
     .help = "Cracks along the lines of an OBJ or PLY file, drawn on the surface, or along the "
             "surface of a mesh; repeatable",
     .details =
         "cracks that are given, in the mesh's space: the lines of an `.obj` or `.ply` file, "
         "each across the wall on whose surface it is drawn, or the surface of a mesh; may "
         "be repeated ([growth](growth.md#guides))",
     .key = "guides",
     .recorded = [](R o) { return !o.fracture.guides.empty(); },
     .repeats = true,
     .single = true},
    {.name = "propagation",
     .group = "Growth",
     .value = V::custom(
         OptionType::text, "dx,dy,dz,H",
         [](RunOptions& o, const std::string& text) { setPropagation(o.fracture.grow, text); },
         [](R o) { return propagationText(o.fracture.grow); }),
     .help = "Direction in which rough cracks propagate, and the Hurst exponent along it; that of "
             "--roughness is along the other axes then",
     .details = "anisotropic roughness: Hurst exponent H (0.1 to 1) along the axis nearest to this "
                "direction, in which cracks propagate; that of `--roughness` is along the others, "
                "the front of a crack among them. 0.6 and 0.75 are measured on glass, mortar and "
                "wood",
     .drawn = true},
    {.name = "propagation-direction",
     .group = "Growth",
     .value = V::custom(
         OptionType::numbers, "dx,dy,dz",
         [](RunOptions& o, const std::string& text) {
           setPropagationDirection(o.fracture.grow, text);
         },
         [](R o) { return propagationDirectionText(o.fracture.grow); }),
     .help = "Direction of propagation",
     .key = "grow.propagation",
     .recorded = hasPropagation,
     .hidden = true},
    {.name = "propagation-hurst",
     .group = "Growth",
     .value = V::number(kGrow, &GrowOptions::propagationHurst, between(0.0, 1.0, "0..1")),
     .help = "Hurst exponent along propagation",
     .key = "grow.propagation_hurst",
     .recorded = hasPropagation,
     .hidden = true},
    {.name = "outer-steps",
     .group = "Growth",
     .value = V::whole(kGrow, &GrowOptions::outerSteps, 0, 64),
     .help = "Steps by which labels are extended beyond the surface",
     .key = "grow.outer_steps",
     .hidden = true,
     .unit = "voxels"},
    {.name = "isolated",
     .group = "Growth",
     .value = V::choice(kGrow, &GrowOptions::regrowIsolated, names::kIsolated),
     .help = "Voxels disconnected from their fragment's first seed: regrow gives them to "
             "neighbors, keep leaves them",
     .details = "voxels disconnected from the fragment's first seed go to neighbors, or "
                "stay (fragments may then have several connected components)",
     .key = "grow.isolated",
     .drawn = true},
    {.name = "sizes",
     .group = "Growth",
     .value = V::custom(
         OptionType::text, "grown|uniform|lognormal:s|power:t|exponential",
         [](RunOptions& o, const std::string& text) { setSizes(kShares(o), text); },
         [](R o) { return sizesText(sharesOf(o.fracture)); }),
     .help = "Sizes of fragments: as grown, or drawn: all equal, lognormal:s, power:t, exponential",
     .details =
         "sizes of the fragments: as they grow, or shares that are drawn and met: all equal; "
         "lognormal with a standard deviation s of the logarithm (0.01 to 3); by a density "
         "that falls as size^-t (t of 1 to 4) over a factor of 1,000; exponential "
         "([growth.md](growth.md#sizes))",
     .key = "sizes",
     .recorded = [](R o) { return sharesOf(o.fracture).sizes != Sizes::grown; },
     .drawn = true},
    {.name = "min-share",
     .group = "Growth",
     .value = V::numberOrAuto(kShares, &ShareOptions::minShare, kAutoShare, kShare),
     .help =
         "Least share of the solid in a fragment; seeds are drawn again until all reach it.  auto: "
         "27 voxels or a quarter of the mean, which small ones get from their neighbors",
     .details =
         "least share of the solid's voxels for a fragment; a smaller one gets a "
         "new seed elsewhere, until all are large enough, else an error with "
         "status 2.  `auto`: no fragment has fewer than 27 voxels, or than a quarter of the "
         "mean if that is less, grown or eroded: a smaller one gets the voxels of its neighbors "
         "that are nearest to it, and one that another fragment encloses moves to the surface of "
         "that.  0: fragments of one voxel are possible",
     .key = "min_share",
     .drawn = true},
    {.name = "balance",
     .group = "Growth",
     .value = V::whole(kShares, &ShareOptions::balance, 0, 100),
     .help = "Lloyd steps, which move seeds to their fragments' centers and even out sizes",
     .details = "iterations in which every seed moves to its fragment's center, which "
                "evens out sizes",
     .key = "balance",
     .drawn = true},
    {.name = "share-tries",
     .group = "Growth",
     .value = V::whole(kShares, &ShareOptions::tries, 1, kMostHidden),
     .help = "Growths that may be spent on the least share",
     .key = "share_tries",
     .hidden = true},
};

const Row kErosionRows[]{
    {.name = "erode-iterations",
     .group = "Erosion",
     .value = V::wholeLength(kErode, &ErodeOptions::iterations, 1000),
     .help = "Number of erosion passes, or a depth in % of the longest side; 0 none",
     .details = "tests of the outermost layer, each of which removes at most a voxel; in % of "
                "the longest side a depth, the same at any resolution, rounded to voxels",
     .key = "erode.iterations",
     .drawn = true},
    {.name = "erode-shape",
     .group = "Erosion",
     .value = V::choice(kErode, &ErodeOptions::shape, names::kErodeShape),
     .help = "Structuring element around a voxel",
     .details = "shape around a voxel that its fragment must fill",
     .key = "erode.shape",
     .recorded = erodes,
     .drawn = true},
    {.name = "erode-size",
     .group = "Erosion",
     .value = V::lengthOf(kErode, &ErodeOptions::size, {3, 5, 7, 9, 11, 13}),
     .help = "Size of the structuring element, odd, or in % of the longest side",
     .details = "size of the shape; in % of the longest side rounded to the nearest of these",
     .key = "erode.size",
     .recorded = erodes,
     .drawn = true,
     .unit = "voxels"},
    {.name = "erode-planes",
     .group = "Erosion",
     .value = V::flag(kErode, &ErodeOptions::planes),
     .help = "Structuring elements in the three axis planes, as in the paper, instead of one in "
             "3-D",
     .details = "the shape in each of the three axis planes, as in the paper, in place of "
                "3-D",
     .key = "erode.planes",
     .recorded = erodes},
    {.name = "erode-threshold",
     .group = "Erosion",
     .value = V::number(kErode, &ErodeOptions::threshold, between(1e-6, 1.0, "0.000001..1")),
     .help = "Share of the structuring element that its fragment must fill",
     .details = "least filled share of the shape",
     .key = "erode.threshold",
     .recorded = erodes,
     .drawn = true},
    {.name = "erode-probability",
     .group = "Erosion",
     .value = V::number(kErode, &ErodeOptions::probability, kShare),
     .help = "Probability that a voxel is tested, drawn again in each pass",
     .details = "probability that a voxel is tested, drawn in each iteration",
     .key = "erode.probability",
     .recorded = erodes,
     .drawn = true},
    {.name = "erode-on",
     .group = "Erosion",
     .value = V::choice(kErode, &ErodeOptions::on, names::kErodeOn),
     .help = "Erode fracture surfaces only, the original surface too, or cracks with their rims "
             "first",
     .details =
         "erode fracture surfaces only; the original surface too; or voxels at cracks, where cells "
         "outside the object are empty, so that rims wear first: with a threshold of 0.6 only rims",
     .key = "erode.on",
     .recorded = erodes,
     .drawn = true},
    {.name = "erode-islands",
     .group = "Erosion",
     .value = V::choice(kErode, &ErodeOptions::islands, names::kIslands),
     .help = "Smaller components of a fragment that erosion splits",
     .details = "the smaller components (islands) of a fragment that falls apart",
     .key = "erode.islands",
     .recorded = erodes,
     .drawn = true},
};

const Row kWithheldRows[]{
    {.name = "drop-share",
     .group = "Growth",
     .value = V::number(kFracture, &FractureOptions::dropShare, kShare),
     .help = "Withhold fragments with a smaller share of the solid",
     .details = "withhold fragments of a smaller share of the solid: they get the last "
                "ids",
     .key = "drop_share",
     .recorded = [](R o) { return o.fracture.dropShare > 0.0; },
     .drawn = true},
    {.name = "missing",
     .group = "Growth",
     .value = V::custom(
         OptionType::number, "k|share",
         [](RunOptions& o, const std::string& text) { setMissing(o.fracture.missing, text); },
         [](R o) { return shortestText(o.fracture.missing); }),
     .help = "Withhold further fragments at random: a number, or below 1 a share of them; the "
             "manifest lists them",
     .details = "withhold this number (from 1) or share (below 1) of the remaining fragments: in "
                "the manifest's `withheld`, not in the files. Each that is kept touches another "
                "one that is, unless that cannot be, as where one is kept or bodies do not touch; "
                "a warning says so",
     .key = "missing",
     .drawn = true},
    {.name = "missing-rule",
     .group = "Growth",
     .value = V::choice(kFracture, &FractureOptions::missingRule, names::kMissingRule),
     .help = "Which --missing withholds: those that leave each other one a neighbor, or any",
     .details = "which fragments `--missing` withholds: those that leave each that is kept a "
                "neighbor, or any by chance",
     .key = "missing_rule",
     .recorded = [](R o) { return o.fracture.missingRule != MissingRule::neighbors; },
     .drawn = true},
};

}  // namespace

std::span<const FractureOptionRow> growthRows() { return kGrowthRows; }
std::span<const FractureOptionRow> erosionRows() { return kErosionRows; }
std::span<const FractureOptionRow> withheldRows() { return kWithheldRows; }

}  // namespace sherd
