// What is broken, and the seeds: one row for each option.
#include <algorithm>
#include <iterator>
#include <limits>
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

constexpr auto kVolume = [](auto& o) -> auto& { return o.volume; };
constexpr auto kSolid = [](auto& o) -> auto& { return o.fracture.solid; };
constexpr auto kSeeds = [](auto& o) -> auto& { return o.fracture.seeds; };

constexpr std::uint64_t kAnySeed = std::numeric_limits<std::uint64_t>::max();

// A preset with files of its own.
void setTraining(RunOptions& o) {
  o.fracture = trainingOptions();
  o.write.vdb = o.write.preview = false;
  o.write.meshFormats = {MeshFileFormat::ply};
}

std::vector<std::string> materialNames() {
  return {std::begin(names::kMaterial), std::end(names::kMaterial)};
}

void setMaterial(RunOptions& o, const std::string& text) {
  const auto material = static_cast<MaterialPreset>(indexOf(text, materialNames()));
  o.fracture = materialOptions(material, o.fracture);
}

bool drawsSeeds(R o) { return !o.fracture.seeds.given; }

const Row kGeneralRows[]{
    {.name = "preset",
     .group = "",
     .value = {OptionType::choice,
               "",
               {"paper", "training"},
               [](RunOptions& o, const std::string& text) {
                 if (indexOf(text, {"paper", "training"}) == 1) return setTraining(o);
                 o.fracture = paperOptions();
               },
               [](R) { return std::string(); }},
     .help = "Options of section 4.1 of the paper, or for training data; options that are given "
             "override them",
     .details = "set options to the paper's values, or to those for training networks (both "
                "below; the latter also draws some by the seed); explicit options override the "
                "preset, in any "
                "order"},
    {.name = "material",
     .group = "",
     .value = {OptionType::choice, "", materialNames(), setMaterial,
               [](R o) -> std::string { return names::of(names::kMaterial, o.fracture.material); }},
     .help = "Break as a material does; options that are given override it",
     .details = "set growth, roughness, grain, sizes and wear to those of a material "
                "([materials.md](materials.md)); explicit options override it, and it overrides "
                "`--preset`, in any order"},
    {.name = "material-name",
     .group = "",
     .value = V::choice(kFracture, &FractureOptions::material, names::kMaterial),
     .help = "The material whose options these are",
     .key = "material",
     .recorded = [](R o) { return o.fracture.material != MaterialPreset::none; },
     .hidden = true},
    {.name = "pieces",
     .group = "",
     .value = V::whole(kFracture, &FractureOptions::pieces, 1, kMaxFragments),
     .help = "Number of fragments",
     .key = "pieces",
     .single = true},
    {.name = "seed",
     .group = "",
     .value = V::whole(kFracture, &FractureOptions::seed, 0, kAnySeed),
     .help = "Seed of every random choice",
     .key = "seed",
     .single = true},
};

void setResolution(RunOptions& o, const std::string& text) {
  o.fracture.solid.resolution = text == "auto" ? kAutoResolution : wholeFrom(text, 8, 4096);
}

std::string resolutionText(R o) {
  const int resolution = o.fracture.solid.resolution;
  return resolution == kAutoResolution ? "auto" : std::to_string(resolution);
}

const Row kSolidRows[]{
    {.name = "resolution",
     .group = "",
     .value = V::custom(OptionType::whole, "auto|8..4096", setResolution, resolutionText),
     .help = "Voxels along the longest side; auto: as many as the mesh's walls need, 128..512",
     .details = "voxels along the longest side of the mesh's box; `auto` chooses 128 to "
                "512 from the wall thickness (below)",
     .key = "resolution",
     .recorded = [](R o) { return o.fracture.solid.voxelSize <= 0.0; },
     .unit = "voxels"},
    {.name = "voxel-size",
     .group = "",
     .value = V::number(kSolid, &SolidOptions::voxelSize, aboveZero()),
     .help = "Voxel size in the mesh's own unit, in place of --resolution",
     .details = "size of a voxel, in place of `--resolution`; the longest side may be at "
                "most 4096 voxels",
     .key = "voxel_size",
     .recorded = [](R o) { return o.fracture.solid.voxelSize > 0.0; },
     .excludes = "resolution",
     .unit = "world units"},
    {.name = "fill",
     .group = "Solid",
     .value = V::choice(kSolid, &SolidOptions::fill, names::kFill),
     .help = "How the inside is found; auto is winding, or shell where the mesh encloses nothing",
     .details = "how the inside of the mesh is determined",
     .key = "fill"},
    {.name = "shell-thickness",
     .group = "Solid",
     .value = V::number(kSolid, &SolidOptions::shellThickness, aboveZero()),
     .help = "Make a shell of this thickness about the surface, with --fill winding about sheets "
             "with both sides alone, in the mesh's own unit, at most its longest side; default: "
             "two and a half voxels",
     .details = "make a shell of this thickness around the surface; with `--fill auto` it "
                "selects `shell`, with `--fill winding` it applies to sheets with both sides; at "
                "most the mesh's longest side; default of shells: 2.5 voxels",
     .key = "shell_thickness",
     .recorded = [](R o) { return o.fracture.solid.shellThickness > 0.0; },
     .unit = "world units"},
    {.name = "bodies",
     .group = "Solid",
     .value = V::choice(kSolid, &SolidOptions::bodies, names::kBodies),
     .help = "What closed bodies that touch, overlap or lie within others are: united to one, or "
             "kept and each broken for itself",
     .details = "`unite`: closed bodies that touch, overlap or lie within others are one body. "
                "`keep`: each is broken for itself, and keeps all its faces (below)",
     .key = "bodies",
     .recorded = [](R o) { return o.fracture.solid.bodies == MeetingBodies::keep; }},
    {.name = "recenter",
     .group = "Solid",
     .value = V::flag(
         [](auto& o) -> auto& { return o; }, &RunOptions::recenter),
     .help = "Move the object so that the center of its box is the origin; the manifest has the "
             "offset",
     .details = "move the object so that the center of its box is the origin, where single "
                "precision resolves it. All files are in these coordinates; `offset` in the "
                "manifest, added to them, gives those of the input, in which options have their "
                "positions",
     .key = "recenter",
     .recorded = [](R o) { return o.recenter; }},
    {.name = "grid",
     .group = "Solid",
     .value = V::string(kVolume, &VolumeOptions::grid, "NAME"),
     .help = "The grid of a .vdb file; default: the union of its level sets, or its only grid",
     .details = "the grid of a `.vdb` file; default: all level sets, or the only grid",
     .elsewhere = "source.grids",
     .single = true},
    {.name = "isovalue",
     .group = "Solid",
     .value = V::number(kVolume, &VolumeOptions::isovalue, between(-1e30, 1e30, "a number")),
     .help = "A grid other than a level set is solid where its values are above",
     .details = "a grid that is not a level set is solid where its values are above",
     .elsewhere = "source.isovalue",
     .single = true},
};

const Row kSeedRows[]{
    {.name = "seeds",
     .group = "Seeds",
     .value = V::custom(
         OptionType::text, "FILE",
         [](RunOptions& o, const std::string& text) {
           o.fracture.seeds.given = {text, {}};
         },
         [](R o) { return o.fracture.seeds.given ? o.fracture.seeds.given->file : ""; }),
     .help = "Read the seeds from a file, as --write seeds writes it, instead of drawing them",
     .details = "read seeds from a file, in the format of `--write seeds`; excludes "
                "`--pieces`",
     .key = "seeds.file",
     .recorded = [](R o) { return o.fracture.seeds.given.has_value(); },
     .excludes = "pieces",
     .single = true},
    {.name = "sampler",
     .group = "Seeds",
     .value = V::choice(kSeeds, &SeedOptions::sampler, names::kSampler),
     .help = "How seeds are drawn",
     .details = "distribution of seeds: uniform; low-discrepancy; denser towards the "
                "center of the box; with a minimum distance",
     .key = "seeds.sampler",
     .recorded = drawsSeeds,
     .drawn = true},
    {.name = "seeds-on",
     .group = "Seeds",
     .value = V::choice(kSeeds, &SeedOptions::on, names::kSeedsOn),
     .help = "Where seeds may lie",
     .details =
         "where seeds are drawn: anywhere inside; at most 1/256 of the longest side "
         "below the surface; or anywhere, and moved to the middle of walls that are thinner "
         "than a cube of a piece's volume. With `wall` cracks by `--growth euclid`, `nearest` and "
         "`sequential` pass straight through thin walls, those between seeds of a file too. "
         "`auto`: `wall` where three quarters of the solid are such walls, else `volume`; the "
         "manifest has the one that was used. With `--growth sequential`, which has no "
         "seeds, cracks are rotated into walls with `auto` in other solids, and ignore walls with "
         "`volume`",
     .key = "seeds.on",
     .drawn = true},
    {.name = "extra-seeds",
     .group = "Seeds",
     .value = V::custom(
         OptionType::text, "K|Kn",
         [](RunOptions& o, const std::string& text) { setExtraSeeds(o.fracture.seeds, text); },
         [](R o) { return extraSeedsText(o.fracture.seeds); }),
     .help = "Additional seeds, merged into the nearest fragment: less convex pieces; 2n is two "
             "per fragment",
     .details = "additional seeds, given to the nearest fragment: less convex fragments; "
                "`2n` is two per fragment",
     .drawn = true},
    {.name = "extra-seeds-count",
     .group = "Seeds",
     .value = V::whole(kSeeds, &SeedOptions::extraSeeds, 0, kMostHidden),
     .help = "Additional seeds",
     .key = "seeds.extra",
     .recorded = drawsSeeds,
     .hidden = true},
    {.name = "extra-seeds-per-piece",
     .group = "Seeds",
     .value = V::whole(kSeeds, &SeedOptions::extraSeedsPerPiece, 0, kMostHidden),
     .help = "Additional seeds for each fragment",
     .key = "seeds.extra_per_piece",
     .recorded = drawsSeeds,
     .hidden = true},
    {.name = "merge-metric",
     .group = "Seeds",
     .value = V::choice(kSeeds, &SeedOptions::mergeMetric, names::kMetric),
     .help = "Metric of the nearest fragment for extra seeds",
     .details = "distance for extra seeds",
     .key = "seeds.merge_metric",
     .recorded = drawsSeeds,
     .drawn = true},
    {.name = "size-spread",
     .group = "Seeds",
     .value = V::number(kSeeds, &SeedOptions::sizeSpread, between(0.0, kMostSizeSpread, "0..4")),
     .help =
         "Makes sizes uneven: extra seeds go rather to some fragments than to others; 2 is much",
     .details = "uneven sizes: the distance of extra seeds to a fragment is divided by a random "
                "number of its own, whose logarithm to the base 2 has this standard deviation",
     .key = "seeds.size_spread",
     .recorded = [](R o) { return drawsSeeds(o) && o.fracture.seeds.sizeSpread > 0.0; },
     .drawn = true},
    {.name = "density-attribute",
     .group = "Seeds",
     .value = V::custom(
         OptionType::text, "NAME|FILE.vdb[:GRID]",
         [](RunOptions& o, const std::string& text) {
           if (text.empty()) refuseValue(text, "the name of an attribute or a .vdb file");
           o.fracture.seeds.density = {text, {}};
         },
         [](R o) { return o.fracture.seeds.density.source; }),
     .help =
         "Small pieces where an attribute of the mesh's vertices, or a grid of a .vdb file, has "
         "high values: the number of pieces per volume is proportional to them",
     .details =
         "where pieces are small: their number per volume is proportional to an attribute of "
         "the mesh's vertices, or to a grid of floats in a `.vdb` file (below)",
     .key = "seeds.density",
     .recorded = [](R o) { return drawsSeeds(o) && !o.fracture.seeds.density.source.empty(); },
     .single = true},
    {.name = "impacts",
     .group = "Seeds",
     .value = V::whole(kSeeds, &SeedOptions::randomImpacts, 0, 10000),
     .help = "Impacts at random surface points",
     .details = "impacts at random points of the surface",
     .key = "seeds.random_impacts",
     .recorded = drawsSeeds,
     .drawn = true},
    {.name = "impact",
     .group = "Seeds",
     .value = V::custom(
         OptionType::text, "IMPACT",
         [](RunOptions& o, const std::string& text) {
           o.fracture.seeds.impacts.push_back(impactFrom(text));
         },
         [](R o) {
           std::vector<std::string> texts;
           for (const Impact& impact : o.fracture.seeds.impacts) {
             texts.push_back(impactText(impact));
           }
           return joinedText(texts, " ");
         }),
     .help = "An impact at x,y,z or ray:ox,oy,oz,dx,dy,dz, then ,count ,sigma (world units, or "
             "n=5 as the paper's bias) ,energy=E ,merge; repeatable",
     .details =
         "an impact at `x,y,z` or `ray:ox,oy,oz,dx,dy,dz`, then optionally "
         "`,count` `,sigma` `,energy=E` `,merge`; may be repeated: `count` of the fragments "
         "come from seeds scattered around the point, `sigma` being their "
         "standard deviation in the mesh's unit, or the paper's bias as `n=5` "
         "(side / sqrt(12 n)); with an energy (0.01 to 100) a thin wall breaks by 8 E^(1/4) "
         "radial cracks and 3 E^(1/4) rings, `sigma` being the radius of the last; with "
         "`merge` the seeds go to existing fragments instead.  Sizes that the material draws "
         "give way to it.  With `--growth sequential` a count without an energy has one of 1.  "
         "A point farther from the surface than 5 % of the longest side is an error",
     .key = "seeds.impacts",
     .recorded = drawsSeeds,
     .repeats = true,
     .drawn = true},
};

}  // namespace

std::span<const FractureOptionRow> generalRows() { return kGeneralRows; }
std::span<const FractureOptionRow> solidRows() { return kSolidRows; }
std::span<const FractureOptionRow> seedRows() { return kSeedRows; }

}  // namespace sherd
