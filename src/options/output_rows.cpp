// Points, files and surfaces: one row for each option.
#include <algorithm>
#include <string>
#include <vector>

#include "base/text/option_names.h"
#include "mesh/coordinate_system.h"
#include "options/parsed.h"
#include "options/rows.h"

namespace sherd {
namespace {

using V = ValuesOf<RunOptions>;
using Row = FractureOptionRow;
using R = const RunOptions&;

constexpr auto kSurface = [](auto& o) -> auto& { return o.fracture.surface; };
constexpr auto kSmooth = [](auto& o) -> auto& { return o.fracture.surface.smooth; };
constexpr auto kSmoothed = [](auto& o) -> auto& { return o.fracture.surface.smooth.iterations; };
constexpr auto kSmoothedBoundary = [](auto& o) -> auto& {
  return o.fracture.surface.smooth.boundaryIterations;
};
constexpr auto kWrite = [](auto& o) -> auto& { return o.write; };
constexpr auto kPoints = [](auto& o) -> auto& { return o.write.points; };
constexpr auto kDistances = [](auto& o) -> auto& { return o.write.distances; };
constexpr auto kVdb = [](auto& o) -> auto& { return o.write.vdbOptions; };

bool samplesPoints(R o) { return o.write.points.count > 0; }
bool samplesDistances(R o) { return o.write.distances.count > 0; }
// Names what writes .usdc, which the program cannot.
OptionValue<RunOptions> usdFormats() {
  OptionValue<RunOptions> value = V::choices(kWrite, &WriteOptions::usdFormats, names::kUsdFormat);
  value.set = [set = value.set](RunOptions& o, const std::string& text) {
    const std::vector<std::string> asked = split(text);
    if (std::find(asked.begin(), asked.end(), "usdc") != asked.end()) {
      refuseValue(text, "a list of usda, usdz; pysherd.usd makes a .usdc of a .usda");
    }
    set(o, text);
  };
  return value;
}

void setUp(RunOptions& o, const std::string& text) {
  o.write.up.reset();
  const std::size_t index = indexOf(text, {"auto", "x", "y", "z"});
  if (index > 0) o.write.up = "xyz"[index - 1];
}

std::string upText(R o) { return o.write.up ? std::string(1, *o.write.up) : "auto"; }

std::vector<std::string> unitChoices() {
  std::vector<std::string> choices{"auto"};
  for (const LengthUnit& unit : kLengthUnits) choices.emplace_back(unit.name);
  return choices;
}

void setUnit(RunOptions& o, const std::string& text) {
  o.write.metersPerUnit = metersOf(text);
  if (text == "auto" || o.write.metersPerUnit) return;
  const std::optional<double> meters = numberIn(text);
  if (!meters || !isUnit(*meters)) {
    refuseValue(text, "one of " + joinedText(unitChoices(), ", ") +
                          ", or a number of meters above 0, from 1e-30 to 1e30");
  }
  o.write.metersPerUnit = exactUnit(*meters);
}

std::string unitText(R o) {
  if (!o.write.metersPerUnit) return "auto";
  const LengthUnit* const known = unitOf(*o.write.metersPerUnit);
  return known != nullptr ? known->name : shortestText(*o.write.metersPerUnit);
}

bool writesUsd(R o) { return o.write.usd; }
bool writesVdb(R o) { return o.write.needsLevelSets(); }

const Row kPointRows[]{
    {.name = "points",
     .group = "Points",
     .value = V::whole(kPoints, &PointOptions::count, 0, kMaxPoints),
     .help = "Points drawn on each fragment's surface, written to points/; 0 none",
     .details = "number of points on each fragment's surface, written to `points/` "
                "whatever `--write` says",
     .key = "points.count",
     .recorded = samplesPoints},
    {.name = "share-points",
     .group = "Points",
     .value = V::flag(kWrite, &WriteOptions::sharePoints),
     .help = "--points counts for all fragments together, distributed by area",
     .details = "`--points` is the total over all fragments, distributed by area; the "
                "counts add up exactly",
     .key = "points.shared",
     .recorded = samplesPoints},
    {.name = "point-sampler",
     .group = "Points",
     .value = V::choice(kPoints, &PointOptions::sampler, names::kPointSampler),
     .help = "Distribution of points: independent, even, or well apart",
     .details = "distribution of points: independent; low-discrepancy; with a minimum "
                "distance",
     .key = "points.sampler",
     .recorded = samplesPoints},
    {.name = "point-rule",
     .group = "Points",
     .value = V::choice(kPoints, &PointOptions::rule, names::kPointRule),
     .help = "Points by area, or at least one per triangle, shuffled and truncated, as in the "
             "paper",
     .details = "points by area; or as in the paper (section 3.4) at least one per "
                "triangle and more by area, shuffled and truncated to the number: if "
                "there are more triangles than points, small ones count as much as large "
                "ones. Not with `poisson`",
     .key = "points.rule",
     .recorded = samplesPoints},
    {.name = "point-format",
     .group = "Points",
     .value = V::choices(kWrite, &WriteOptions::pointFormats, names::kPointFormat),
     .help = "Files of points, one or more: binary, text, NumPy's, the paper's compressed octree",
     .details = "files of points: binary with neighbors; text; NumPy; the paper's "
                "compressed octree",
     .key = "points.formats",
     .recorded = samplesPoints},
    {.name = "sdf-samples",
     .group = "Points",
     .value = V::whole(kDistances, &DistanceOptions::count, 0, kMaxPoints),
     .help = "Points in and around each fragment and the whole, with their signed distance, "
             "written to sdf/; 0 none",
     .details = "number of points in and around each fragment, and around the intact "
                "solid, with their signed distance, written to `sdf/`",
     .key = "sdf.count",
     .recorded = samplesDistances},
    {.name = "sdf-type",
     .group = "Points",
     .value = V::choice(kDistances, &DistanceOptions::type, names::kSampleType),
     .help = "Number type of these files",
     .details = "type of these numbers; 16 bits need a mesh near the origin; one that reaches "
                "beyond 65504, or whose longest side is under 6.1e-5, is refused",
     .key = "sdf.type",
     .recorded = samplesDistances,
     .needs = "sdf-samples"},
    {.name = "sdf-sigma",
     .group = "Points",
     .value = V::number(kDistances, &DistanceOptions::sigma, kNotNegative),
     .help = "Standard deviation of samples near the surface; 0: the voxel size",
     .key = "sdf.sigma",
     .recorded = samplesDistances,
     .hidden = true,
     .unit = "world units"},
    {.name = "correspondences",
     .group = "Points",
     .value = V::whole(kWrite, &WriteOptions::correspondences, 0, kMaxPoints),
     .help = "Points on the surface between each two fragments that touch, written to "
             "correspondences.npz",
     .details = "number of points on each contact, written to `correspondences.npz`; the "
                "fragments must share the surface: not with `--interface independent` or "
                "`--erode-iterations`, nor with `--surface labels` that is smoothed at "
                "cracks or simplified",
     .key = "correspondences",
     .recorded = [](R o) { return o.write.correspondences > 0; }},
};

const Row kFileRows[]{
    {.name = "density",
     .group = "Files for hosts",
     .value = V::number(kWrite, &WriteOptions::density, aboveZero()),
     .help = "Kilograms per cubic meter, for masses and inertia in .vdb files and scenes",
     .details = "kilograms per cubic meter, by `--unit`: for mass and inertia in `.vdb` files, "
                "`scene.glb`, `scene.usda` and `graph.json`",
     .key = "density",
     .recorded = [](R o) { return o.write.density != WriteOptions().density; }},
    {.name = "proxy-gap",
     .group = "Files for hosts",
     .value = V::number(kWrite, &WriteOptions::proxyGap, between(0.0, 1e9, "0..1e9")),
     .help = "Gap between the convex hulls of neighbors, in the mesh's unit",
     .details = "gap between the convex hulls of neighbors (`--write proxy`): each side "
                "moves inwards by half of it, at most half of its distance from the "
                "hull's center",
     .key = "proxy_gap",
     .recorded = [](R o) { return o.write.proxy; },
     .unit = "world units"},
    {.name = "usd-format",
     .group = "Files for hosts",
     .value = usdFormats(),
     .help = "Files of USD scenes, one or both: text, or an archive with its textures",
     .details = "files of the scene of `--write usd`: `scene.usda`, text beside its textures; "
                "`scene.usdz`, an archive with them",
     .elsewhere = "files"},
    {.name = "usd-volumes",
     .group = "Files for hosts",
     .value = V::flag(kWrite, &WriteOptions::usdVolumes),
     .help = "The fragments' .vdb files as volumes of scene.usda",
     .details = "the fragments' `.vdb` files as volumes (OpenVDBAsset) of `scene.usda`, invisible "
                "until shown",
     .key = "usd.volumes",
     .recorded = writesUsd},
    {.name = "joint-strength",
     .group = "Files for hosts",
     .value = V::number(kWrite, &WriteOptions::jointStrength, aboveZero()),
     .help = "Newtons per square meter of a contact that break its joint in a scene or graph.geo",
     .details = "newtons per square meter of a contact, by `--unit`, that break its joint in "
                "`scene.glb`, `scene.usda` or `graph.geo`: a tensile strength in pascals",
     .key = "joint_strength",
     .recorded =
         [](R o) { return o.write.scene || o.write.usd || o.write.graph || o.write.houdini; }},
    {.name = "vdb",
     .group = "Files for hosts",
     .value = V::choice(kWrite, &WriteOptions::vdbFiles, names::kVdbFiles),
     .help = "A .vdb for each fragment, one fragments.vdb with all and their ids, or both",
     .details = "a `.vdb` per fragment; `fragments.vdb` with grids `surface_1`, "
                "`surface_2`, ... and `fragment_id`; or both",
     .key = "vdb.files",
     .recorded = writesVdb},
    {.name = "fog",
     .group = "Files for hosts",
     .value = V::flag(kVdb, &VdbOptions::fog),
     .help = "A fog volume in each .vdb file",
     .key = "vdb.fog",
     .recorded = writesVdb,
     .hidden = true},
    {.name = "half",
     .group = "Files for hosts",
     .value = V::flag(kVdb, &VdbOptions::half),
     .help = "16-bit values in .vdb files: a third smaller, error up to 0.002 voxel",
     .details = "16-bit values in `.vdb` files, read back as 32: a third smaller, error "
                "at most 0.002 voxel",
     .key = "vdb.half",
     .recorded = writesVdb},
    {.name = "vdb-compress",
     .group = "Files for hosts",
     .value = V::choice(kVdb, &VdbOptions::compression, names::kVdbCompression),
     .help = "Compression of .vdb files",
     .details = "compression of `.vdb` files; `none` is a tenth larger and readable by "
                "every OpenVDB build",
     .key = "vdb.compression",
     .recorded = writesVdb,
     .alias = "compress"},
    {.name = "write",
     .group = "",
     .value = {OptionType::choices, "", writtenNames(),
               [](RunOptions& o, const std::string& text) { setWritten(o.write, text); },
               [](R o) { return writtenText(o.write); }},
     .help = "What to write, separated by commas",
     .details = "files to write besides `manifest.json` ([formats.md](formats.md)); `fog` "
                "is added to the `.vdb` files, `solid` writes the intact object in the "
                "other formats written, `points` are 1000 on each fragment or as many as "
                "`--points` says",
     .elsewhere = "files"},
    {.name = "voxel-format",
     .group = "",
     .value = V::choices(kWrite, &WriteOptions::voxelFormats, names::kVoxelFormat),
     .help = "Files of labels, one or more: run-length, NumPy's dense array, the same deflated "
             "with its grid transform, MagicaVoxel, quad-stack, raw cube",
     .details = "files of the labels, `labels.rle` and so on ([formats.md](formats.md)); "
                "`.npz` also records their position",
     .elsewhere = "files"},
    {.name = "mesh-format",
     .group = "",
     .value = V::choices(kWrite, &WriteOptions::meshFormats, names::kMeshFileFormat),
     .help = "Files of meshes, one or more: PLY, OBJ with materials, binary glTF, STL, STL as "
             "text, the paper's",
     .details = "files of the meshes; `.obj` with a material library, `.glb` with "
                "embedded textures, `.stl` with triangles only, binary or (`stl-ascii`) "
                "text, `.binm` the paper's binary mesh ([formats.md](formats.md))",
     .elsewhere = "files"},
    {.name = "plain-meshes",
     .group = "",
     .value = V::flag(kWrite, &WriteOptions::plainMeshes),
     .help = "Only vertices and triangles in .ply, .obj, .glb, USD and Houdini's .geo: no normals, "
             "neighbors or materials",
     .details = "vertices and triangles only in `.ply`, `.obj`, `.glb`, `scene.usda`, `scene.usdz` "
                "and `pieces.geo`: no normals, neighbors or materials, and no vertex is repeated "
                "for them. Scenes keep names, masses and joints",
     .key = "plain_meshes",
     .recorded =
         [](R o) { return o.write.mesh || o.write.scene || o.write.usd || o.write.houdini; }},
    {.name = "precision",
     .group = "",
     .value = V::choice(kWrite, &WriteOptions::precision, names::kPrecision),
     .help = "Number type of vertices in meshes as .ply, .obj and text STL, proxies and "
             "boundaries.obj; auto: double of exact surfaces, and where single would move them by "
             "more than a hundredth of a voxel",
     .details = "number type of the vertices in meshes as `.ply`, `.obj` and text STL, also of the "
                "intact solid (`--write solid`), in proxies and in `boundaries.obj`; `auto` is "
                "`double` with `--surface exact`, whose uncut vertices are the input's bit for bit "
                "then, and where `single` would move vertices by more than a hundredth of a voxel, "
                "far from the origin. Other formats have single "
                "precision "
                "only, and a warning says so where that matters",
     .key = "mesh_precision",
     .recorded =
         [](R o) {
           const bool isWritten = o.write.mesh || o.write.proxy || o.write.boundaries;
           return isWritten && o.write.precision != Precision::automatic;
         }},
    {.name = "source-faces",
     .group = "",
     .value = V::flag(kWrite, &WriteOptions::sourceFaces),
     .help = "The face of the input on which each face of .ply meshes lies",
     .details = "`.ply` meshes have a property `source_face` of each face: the index, from 0, of "
                "the face of the input's file on which it lies, -1 on cracks and where a hole was "
                "closed ([formats.md](formats.md)). Other formats have no place for it",
     .key = "source_faces",
     .recorded = [](R o) { return o.write.mesh && o.write.sourceFaces; }},
    {.name = "up",
     .group = "",
     .value = {OptionType::choice, "", {"auto", "x", "y", "z"}, setUp, upText},
     .help = "The mesh's axis that points up in images, the viewer and scenes; auto: as the file "
             "says, else z in .stl, .off and .3mf, y in others",
     .details =
         "the mesh's axis that points up in `preview.png`, `viewer.html` and scenes; `auto`: "
         "as the file says (glTF, FBX, DAE), else `z` in `.stl`, `.off` and `.3mf`, `y` in "
         "others. Coordinates stay as they are ([formats.md](formats.md#units-and-axes))",
     .key = "up",
     .recorded = [](R o) { return o.write.up.has_value(); }},
    {.name = "unit",
     .group = "",
     .value = {OptionType::number, "> 0", unitChoices(), setUnit, unitText},
     .help =
         "The mesh's unit of length, by a name or in meters, for scenes and masses; auto: as the "
         "file says, else mm in .stl, .off and .3mf, m in others",
     .details =
         "the mesh's unit of length, by a name or in meters: scenes have the object in its "
         "size, and masses are those of it; `auto`: as the file says (glTF, FBX, DAE, 3MF), "
         "else `mm` in `.stl`, `.off` and `.3mf`, `m` in others. Coordinates stay as they are "
         "([formats.md](formats.md#units-and-axes))",
     .key = "unit",
     .recorded = [](R o) { return o.write.metersPerUnit.has_value(); },
     .unit = "meters"},
};

// Passes of smoothing, in a field of its own once the size of the solid is known.
template <class Parent>
OptionValue<RunOptions> passes(Parent parent) {
  return V::custom(
      OptionType::text, "K|Fk",
      [=](RunOptions& o, const std::string& text) { setIterations(parent(o), text); },
      [=](R o) { return iterationsText(parent(o)); });
}

const Row kSurfaceRows[]{
    {.name = "surface",
     .group = "Surface",
     .value = V::choice(kSurface, &SurfaceOptions::surface, names::kSurface),
     .help =
         "The input's own triangles, cut by the cracks; meshes of the smooth level sets; or the "
         "faces of the labels' voxels; auto: exact where it succeeds, else smooth",
     .details =
         "`exact`: the triangles of the input, which stay as they are where no crack cuts "
         "them: sharp edges, normals, texture coordinates, polygons and all. Bodies that "
         "overlap or touch are united first, and holes are closed by faces of their own. It "
         "needs a mesh filled by `winding`, or a shell that does not cross itself, and "
         "cracks that are not so rough that they "
         "cross each other; where it does not succeed, the fragments of the bodies concerned "
         "get the smooth surface, with a warning that says which and why. `smooth`: meshes of the "
         "level sets, with "
         "the creases and corners of the input as sharp as they are where its details are "
         "larger than a voxel. `labels`: the voxel faces of the fragment, as in the paper. "
         "`auto` is `exact`, but `smooth` for volumes, with `--interface independent`, with "
         "smoothing or `--scan-noise`, where all surfaces are eroded, and where no file has meshes "
         "or points; with "
         "`--only` `exact` if some fragments are. In datasets `auto` is `smooth`, which "
         "takes less time. The `.vdb` files are the same for all",
     .key = "surface.of",
     .drawn = true},
    {.name = "interface",
     .group = "Surface",
     .value = V::choice(kSurface, &SurfaceOptions::interface, names::kInterface),
     .help = "Surfaces between fragments: shared bit for bit, or each fragment meshed by random "
             "points of its own surface",
     .details = "two fragments share the vertices and faces between them, bit for bit; or "
                "each fragment is meshed by random points of its own surface: no vertex is a "
                "neighbor's, and the grid of the voxels is not found in them ([decision "
                "0010](decisions/0010-one-mesh-of-all-labels.md))",
     .key = "surface.interface",
     .drawn = true},
    {.name = "adaptivity",
     .group = "Surface",
     .value = V::numberOrAuto(kSurface, &SurfaceOptions::adaptivity, kAutoAdaptivity, kShare),
     .help =
         "Simplify flat regions: error in voxels that a vertex may have; 0 none; auto: merge the "
         "triangles in each plane where the mesh is piecewise flat; exact surfaces' cracks have "
         "0.1 "
         "at least",
     .details =
         "fewer polygons in flat regions: the largest rms distance, in voxels, "
         "from a vertex to the planes of the faces it replaces. Applied after "
         "smoothing, which needs the even triangles of the extracted mesh. `auto` merges "
         "the triangles within 0.005 voxels of a plane, of cracks within 0.1, where at "
         "least half of the mesh's surface is flat at the scale of a voxel, and its texture "
         "coordinates and colors are linear in its planes. With `--surface exact` the outside "
         "keeps the input's triangles, and only cracks are simplified, planar, bent and rough ones "
         "alike: their planes are merged within 0.1 voxels, then all of them within the error. "
         "`auto` is 0.1 for them, and so is any number below it but 0, which keeps all faces. "
         "In the mean over a crack the distance from the full one stays below the error; "
         "single points are up to six times as far "
         "([triangles, distances and cost](decisions/0018-exact-surfaces.md#simplified-cracks))",
     .key = "surface.adaptivity",
     .drawn = true,
     .unit = "voxels"},
    {.name = "smoothing",
     .group = "Surface",
     .value = V::choice(kSmooth, &SmoothOptions::method, names::kSmoothing),
     .help = "Smoothing: taubin keeps the volume; laplacian, as in the paper, shrinks",
     .details = "vertices move towards the mean of their neighbors and then almost as far "
                "back, which keeps the volume (Taubin 1995, pass band 0.1); or towards it "
                "only, as in the paper, which shrinks thin features",
     .key = "surface.smooth.method",
     .drawn = true},
    {.name = "smooth-iterations",
     .group = "Surface",
     .value = passes(kSmoothed),
     .help = "Passes over all vertices but those of cracks; 0.048k is 0.048 times the voxels of "
             "the longest side",
     .details = "iterations for all vertices except those of cracks; `0.048k` is 0.048 "
                "times the voxels of the solid's longest side, truncated",
     .drawn = true},
    {.name = "smooth-passes",
     .group = "Surface",
     .value = V::whole(kSmoothed, &Iterations::count, 0, kMostHidden),
     .help = "Passes over all vertices but those of cracks",
     .key = "surface.smooth.iterations",
     .hidden = true},
    {.name = "smooth-weight",
     .group = "Surface",
     .value = V::number(kSmooth, &SmoothOptions::weight, kShare),
     .help = "How far a vertex moves to its neighbors' mean in a pass; taubin: at most 2/3",
     .details = "step towards the mean of the neighbors; with `taubin` at most 2/3",
     .key = "surface.smooth.weight",
     .drawn = true},
    {.name = "smooth-boundary-iterations",
     .group = "Surface",
     .value = passes(kSmoothedBoundary),
     .help = "The same for vertices of cracks and their boundaries",
     .details = "the same for the vertices of cracks with their contact boundaries, after "
                "all others",
     .drawn = true},
    {.name = "smooth-boundary-passes",
     .group = "Surface",
     .value = V::whole(kSmoothedBoundary, &Iterations::count, 0, kMostHidden),
     .help = "Passes over the vertices of cracks and their boundaries",
     .key = "surface.smooth.boundary_iterations",
     .hidden = true},
    {.name = "smooth-boundary-weight",
     .group = "Surface",
     .value = V::number(kSmooth, &SmoothOptions::boundaryWeight, kShare),
     .help = "How far these move; with 0 fragments keep fitting",
     .details = "step for these; with 0 they stay, and fragments of `labels` fit without "
                "a gap",
     .key = "surface.smooth.boundary_weight",
     .drawn = true},
    {.name = "mismatch",
     .group = "Surface",
     .value = V::custom(
         OptionType::text, "P%[,H[,W%]]",
         [](RunOptions& o, const std::string& text) { setNoise(kSurface(o).mismatch, text); },
         [](R o) { return noiseText(kSurface(o).mismatch); }),
     .help = "Displace each side of a crack by rough noise of its own: rms in % of the mesh's "
             "diagonal, Hurst exponent H (default 0.6), W beyond which heights are independent "
             "(default 3%)",
     .details =
         "the two sides of a crack fit only roughly, as those of real fragments do: each is "
         "displaced by self-affine noise of its own, with an rms of P % (0 to 5) of the diagonal "
         "of the mesh's box, a Hurst exponent H (0.1 to 1, default 0.6), and heights that are "
         "independent beyond W % (default 3). It falls to nothing at the contact boundary, over "
         "a voxel or three times the rms, so meshes stay closed and the outside stays as it is. "
         "Meshes and points alone: labels, `.vdb` files and contacts are those without. `0.15%` "
         "is about that of real ceramics ([realism.md](realism.md#joints))",
     .key = "surface.mismatch",
     .recorded = [](R o) { return kSurface(o).mismatch.rms > 0.0; },
     .drawn = true},
    {.name = "mismatch-common",
     .group = "Surface",
     .value = V::number(kSurface, &SurfaceOptions::mismatchCommon, kShare),
     .help = "Share of the mismatch's variance by which both sides of a crack move alike",
     .details = "share of the mismatch's variance by which both sides of a crack move alike, which "
                "roughens the crack and opens no gap",
     .key = "surface.mismatch_common",
     .recorded = [](R o) { return kSurface(o).mismatch.rms > 0.0; },
     .drawn = true},
    {.name = "scan-noise",
     .group = "Surface",
     .value = V::custom(
         OptionType::text, "P%[,H[,W%]]",
         [](RunOptions& o, const std::string& text) { setNoise(kSurface(o).scanNoise, text); },
         [](R o) { return noiseText(kSurface(o).scanNoise); }),
     .help = "Displace all of each fragment's surface by rough noise: as --mismatch",
     .details =
         "displaces all vertices of a fragment, those outside too, by noise as that of "
         "`--mismatch`, another for each fragment. With smooth surfaces, which `auto` is then",
     .key = "surface.scan_noise",
     .recorded = [](R o) { return kSurface(o).scanNoise.rms > 0.0; },
     .drawn = true},
    {.name = "triangles",
     .group = "Surface",
     .value = V::custom(
         OptionType::wholes, "T,...:4..1000000000",
         [](RunOptions& o, const std::string& text) {
           setTriangles(o.fracture.surface.triangles, text);
         },
         [](R o) { return trianglesText(o.fracture.surface.triangles); }),
     .help = "Also write each mesh decimated to at most so many triangles, once per number, as "
             "levels of detail in scenes",
     .details = "also write every mesh decimated to at most this number of triangles, one file per "
                "number; in `scene.glb` and `scene.usda` as levels of detail of each fragment, "
                "for Houdini as `pieces_tT.geo`. Neighbors share their cracks at each number",
     .key = "surface.triangles",
     .drawn = true},
};

}  // namespace

std::span<const FractureOptionRow> pointRows() { return kPointRows; }
std::span<const FractureOptionRow> fileRows() { return kFileRows; }
std::span<const FractureOptionRow> surfaceRows() { return kSurfaceRows; }

}  // namespace sherd
