// Options of a fracture's output: meshes, points, files.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "base/option_names.h"
#include "cli/fracture_options.h"
#include "cli/option_text.h"

namespace sherd::cli {
namespace {

// "K", or "Fk" for F times the voxels along the longest side.
void parseIterations(const std::string& option, const std::string& text, Iterations& iterations) {
  const bool perVoxel = text.ends_with('k');
  const std::optional<double> value = numberIn(text.substr(0, text.size() - perVoxel));
  const bool good = value && *value >= 0.0 && *value <= (perVoxel ? 1.0 : 1000.0) &&
                    (perVoxel || *value == std::floor(*value));
  if (!good) refuse(option, text, "a whole number in 0..1000, or F in 0..1 times k as in 0.048k");
  iterations = {.count = perVoxel ? 0 : static_cast<int>(*value),
                .perVoxel = perVoxel ? *value : 0.0};
}

// Formats separated by commas, each once.
template <class Format, std::size_t n>
void parseFormats(const std::string& option, const std::string& text,
                  const char* const (&formatNames)[n], std::vector<Format>& formats) {
  std::string all;
  for (std::size_t i = 0; i < n; ++i) {
    all += (i == 0 ? "" : i + 1 < n ? ", " : " and ") + std::string(formatNames[i]);
  }
  formats.clear();
  for (const std::string& part : split(text)) {
    const auto* const at = std::find(std::begin(formatNames), std::end(formatNames), part);
    const auto format = static_cast<Format>(at - std::begin(formatNames));
    if (at == std::end(formatNames) ||
        std::find(formats.begin(), formats.end(), format) != formats.end()) {
      refuse(option, text, "a list of " + all + ", each once");
    }
    formats.push_back(format);
  }
}

}  // namespace

void addSurfaceOptions(CLI::App& command, FractureOptions& options) {
  const std::string group = "Surface";
  SurfaceOptions& surface = options.surface;
  SmoothOptions& smooth = surface.smooth;
  const auto addIterations = [&](const std::string& name, Iterations& iterations,
                                 const std::string& help) {
    command
        .add_option_function<std::string>(
            name,
            [name, &iterations](const std::string& text) {
              parseIterations(name, text, iterations);
            },
            help)
        ->type_name("K|Fk")
        ->default_str("0")
        ->group(group);
  };
  const auto addWeight = [&](const std::string& name, double& weight, const std::string& help) {
    command.add_option(name, weight, help)
        ->check(numberBetween(0.0, 1.0, "0..1"))
        ->capture_default_str()
        ->group(group);
  };
  addChoice(command, "--surface", surface.surface, names::kSurface,
            "Meshes of the smooth level sets, or of the faces of the labels' voxels")
      ->group(group);
  addChoice(command, "--interface", surface.interface, names::kInterface,
            "Surfaces between fragments: shared bit for bit, or each fragment meshed separately")
      ->group(group);
  command
      .add_option("--adaptivity", surface.adaptivity,
                  "Simplify flat regions: error in voxels that a vertex may have; 0 none")
      ->check(numberBetween(0.0, 1.0, "0..1"))
      ->capture_default_str()
      ->group(group);
  addChoice(command, "--smoothing", smooth.method, names::kSmoothing,
            "Smoothing: taubin keeps the volume; laplacian, as in the paper, shrinks")
      ->group(group);
  addIterations(
      "--smooth-iterations", smooth.iterations,
      "Passes over all vertices but those of cracks; 0.048k is 0.048 times the voxels of the "
      "longest side");
  addWeight("--smooth-weight", smooth.weight,
            "How far a vertex moves to its neighbors' mean in a pass; taubin: at most 2/3");
  addIterations("--smooth-boundary-iterations", smooth.boundaryIterations,
                "The same for vertices of cracks and their boundaries");
  addWeight("--smooth-boundary-weight", smooth.boundaryWeight,
            "How far these move; with 0 fragments keep fitting");
  command
      .add_option("--triangles", surface.triangles,
                  "Also write each mesh decimated to at most so many triangles, once per number")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->transform(wholeNumber<std::size_t>(4, 1'000'000'000))
      ->type_name("T,...")
      ->group(group);
}

void addPointOptions(CLI::App& command, WriteOptions& write) {
  const std::string group = "Points";
  constexpr std::size_t kMost = kMaxPoints;
  CLI::Option* points =
      command
          .add_option("--points", write.points.count,
                      "Points drawn on each fragment's surface, written to points/; 0 none")
          ->transform(wholeNumber<std::size_t>(0, kMost))
          ->capture_default_str()
          ->group(group);
  command
      .add_flag("--share-points", write.sharePoints,
                "--points counts for all fragments together, distributed by area")
      ->needs(points)
      ->group(group);
  addChoice(command, "--point-sampler", write.points.sampler, names::kPointSampler,
            "Distribution of points: independent, even, or well apart")
      ->needs(points)
      ->group(group);
  addChoice(command, "--point-rule", write.points.rule, names::kPointRule,
            "Points by area, or at least one per triangle, shuffled and truncated, as in the paper")
      ->needs(points)
      ->group(group);
  command
      .add_option_function<std::string>(
          "--point-format",
          [&write](const std::string& text) {
            parseFormats("--point-format", text, names::kPointFormat, write.pointFormats);
          },
          "Files of points, one or more: binary, text, NumPy's, the paper's compressed octree")
      ->type_name("ply,xyz,npz,binp")
      ->default_str("ply")
      ->needs(points)
      ->group(group);
  command
      .add_option("--correspondences", write.correspondences,
                  "Points on the surface between each two fragments that touch, written to "
                  "correspondences.npz")
      ->transform(wholeNumber<std::size_t>(0, kMost))
      ->capture_default_str()
      ->group(group);
  CLI::Option* samples =
      command
          .add_option("--sdf-samples", write.distances.count,
                      "Points in and around each fragment and the whole, with their signed "
                      "distance, written to sdf/; 0 none")
          ->transform(wholeNumber<std::size_t>(0, kMost))
          ->capture_default_str()
          ->group(group);
  addChoice(command, "--sdf-type", write.distances.type, names::kSampleType,
            "Number type of these files")
      ->needs(samples)
      ->group(group);
}

void addVoxelFormatOption(CLI::App& command, WriteOptions& write) {
  command
      .add_option_function<std::string>(
          "--voxel-format",
          [&write](const std::string& text) {
            parseFormats("--voxel-format", text, names::kVoxelFormat, write.voxelFormats);
          },
          "Files of labels, one or more: run-length, NumPy's dense array, the same deflated with "
          "its grid transform, MagicaVoxel, quad-stack, raw cube")
      ->type_name("rle,npy,npz,vox,qstack,bing")
      ->default_str("rle");
}

void addMeshFormatOption(CLI::App& command, WriteOptions& write) {
  command
      .add_option_function<std::string>(
          "--mesh-format",
          [&write](const std::string& text) {
            parseFormats("--mesh-format", text, names::kMeshFileFormat, write.meshFormats);
          },
          "Files of meshes, one or more: PLY, OBJ with materials, binary glTF, STL, STL as text, "
          "the "
          "paper's")
      ->type_name("ply,obj,glb,stl,stl-ascii,binm")
      ->default_str("ply");
  command.add_flag(
      "--plain-meshes", write.plainMeshes,
      "Only vertices and triangles in .ply and .obj: no normals, neighbors or materials");
}

void addHostOptions(CLI::App& command, WriteOptions& write, const std::string& compress) {
  const std::string group = "Files for hosts";
  addChoice(command, "--vdb", write.vdbFiles, names::kVdbFiles,
            "A .vdb for each fragment, one fragments.vdb with all and their ids, or both")
      ->group(group);
  command
      .add_flag("--half", write.vdbOptions.half,
                "16-bit values in .vdb files: a third smaller, error up to 0.002 voxel")
      ->group(group);
  addChoice(command, compress, write.vdbOptions.compression, names::kVdbCompression,
            "Compression of .vdb files")
      ->group(group);
  command
      .add_option("--density", write.density,
                  "Mass per unit of volume, for masses and inertia in .vdb files and scene.glb")
      ->check(aboveZero())
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--proxy-gap", write.proxyGap,
                  "Gap between the convex hulls of neighbors, in the mesh's unit")
      ->check(numberBetween(0.0, 1e9, "0..1e9"))
      ->capture_default_str()
      ->group(group);
}

void addWriteOptions(CLI::App& command, WriteArguments& arguments) {
  std::string usual;
  for (const std::string& name : arguments.names) usual += (usual.empty() ? "" : ",") + name;
  command.add_option("--write", arguments.names, "What to write, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"labels", "vdb", "mesh", "preview", "seeds", "boundaries", "cost",
                             "fog", "solid", "scene", "graph", "proxy"}))
      ->default_str(usual);
  command.add_option("--up", arguments.up, "The mesh's axis that points up in the preview")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->default_str("y");
}

WriteOptions writeOptions(const WriteArguments& arguments) {
  const auto named = [&](const char* name) {
    return std::find(arguments.names.begin(), arguments.names.end(), name) != arguments.names.end();
  };
  WriteOptions write = arguments.files;
  write.labels = named("labels");
  write.vdb = named("vdb");
  write.mesh = named("mesh");
  write.preview = named("preview");
  write.seeds = named("seeds");
  write.boundaries = named("boundaries");
  write.cost = named("cost");
  write.solid = named("solid");
  write.scene = named("scene");
  write.graph = named("graph");
  write.proxy = named("proxy");
  write.vdbOptions.fog = named("fog");
  write.up = arguments.up.front();
  return write;
}

}  // namespace sherd::cli
