// `sherd fracture`: break one mesh into a folder.
#include <sherd/error.h>
#include <sherd/fracture.h>
#include <sherd/io.h>
#include <sherd/refracture.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>

#include "cli/command.h"
#include "cli/fracture_options.h"
#include "cli/fracture_telling.h"
#include "cli/interrupts.h"
#include "cli/progress_line.h"

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct FractureArguments {
  std::string mesh;
  std::string folder;
  std::vector<int>
      only;  ///< fragments of a finished fracture to break again; empty: MESH is a mesh
  FractureOptions options;
  std::vector<std::string> write{"labels", "vdb", "mesh", "preview"};
  WriteOptions files;  ///< all of it but what `write` and `up` name
  std::string up = "y";
  std::string device = "auto";
  int threads = 0;  ///< 0: all cores
  bool json = false;
  bool quiet = false;
};

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

WriteOptions writeOptions(const FractureArguments& arguments) {
  const auto named = [&](const char* name) {
    return std::find(arguments.write.begin(), arguments.write.end(), name) != arguments.write.end();
  };
  WriteOptions write = arguments.files;
  write.labels = named("labels");
  write.vdb = named("vdb");
  write.mesh = named("mesh");
  write.preview = named("preview");
  write.seeds = named("seeds");
  write.rims = named("rims");
  write.cost = named("cost");
  write.solid = named("solid");
  write.scene = named("scene");
  write.graph = named("graph");
  write.proxy = named("proxy");
  write.vdbOptions.fog = named("fog");
  write.up = arguments.up.front();
  return write;
}

// What is wrong with a mesh is found by functions that do not know the file's name.
FractureResult breakSource(const FractureArguments& arguments, const SourceMesh& source,
                           Device& device, const Progress& progress) {
  try {
    return fracture(source.mesh, arguments.options, device, &progress);
  } catch (const Error& e) {
    const std::string seedFile = arguments.options.seedFile.string();
    const bool aboutSeeds = !seedFile.empty() && std::string_view(e.what()).starts_with(seedFile);
    if (e.code() != ErrorCode::input || aboutSeeds) throw;
    throw Error(ErrorCode::input, arguments.mesh + ": " + e.what());
  }
}

void breakMesh(FractureArguments& arguments) {
  const Clock::time_point start = Clock::now();
  std::optional<tbb::global_control> threads;
  if (arguments.threads > 0) {
    threads.emplace(tbb::global_control::max_allowed_parallelism,
                    static_cast<std::size_t>(arguments.threads));
  }
  ProgressLine line(::isatty(STDERR_FILENO) == 1 && !arguments.quiet);
  const Progress progress{
      .report = [&](std::string_view stage, double fraction) { line.show(stage, fraction); },
      .cancelled = isInterrupted};

  std::vector<StageTime> times;
  const auto timed = [&](const char* stage, auto&& work) {
    stopIfInterrupted();
    line.show(stage, 0.0);
    const Clock::time_point begin = Clock::now();
    auto result = work();
    times.push_back({stage, secondsSince(begin)});
    return result;
  };

  checkFractureFolder(arguments.folder);
  const bool again = !arguments.only.empty();
  const FinishedFracture finished = timed("read", [&] {
    FinishedFracture read;
    if (again) {
      read = readFracture(arguments.mesh);
    } else {
      read.source = readMesh(arguments.mesh);
    }
    return read;
  });
  const SourceMesh& source = finished.source;
  if (again) arguments.options.resolution = finished.resolution;
  Device device = timed("device", [&] { return Device(arguments.device); });
  stopIfInterrupted();
  const FractureResult result =
      again ? refracture(finished, arguments.only, arguments.options, device, &progress)
            : breakSource(arguments, source, device, progress);
  times.insert(times.end(), result.times.begin(), result.times.end());
  const fs::path manifest = timed("write", [&] {
    return writeFracture(arguments.folder, source, arguments.options, result,
                         writeOptions(arguments), &progress);
  });
  times.push_back({"total", secondsSince(start)});

  const FractureTelling told{arguments.mesh,    arguments.folder, source,
                             arguments.options, arguments.files,  result,
                             device.info(),     manifest,         times};
  line.clear();
  for (const std::string& warning : warningsOf(told)) printMessage("sherd: warning: " + warning);
  if (arguments.json) {
    printResult(jsonOf(told).dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  } else if (!arguments.quiet) {
    printResult(textOf(told));
  }
}

void runFracture(FractureArguments& arguments) {
  watchForInterrupts();
  checkWriteOptions(writeOptions(arguments), arguments.options);
  arguments.options.grow.keepCost = writeOptions(arguments).cost;
  try {
    breakMesh(arguments);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::cancelled) throw;
    throw Error(ErrorCode::cancelled, "interrupted; " + arguments.folder + " is as it was before");
  }
}

}  // namespace

void addFractureCommand(CLI::App& app, Action& run) {
  CLI::App* command = app.add_subcommand("fracture", "Break one mesh into fragments");
  auto arguments = std::make_shared<FractureArguments>();
  FractureOptions& options = arguments->options;

  command
      ->add_option(
          "MESH", arguments->mesh,
          "The mesh: .obj .ply .stl .off .gltf .glb .binm .fbx .dae .3mf, also .gz; with --only a "
          "manifest.json")
      ->required();
  command
      ->add_option(
          "-o,--output", arguments->folder,
          "Folder for the fragments: absent, empty or an earlier fracture's, which is replaced")
      ->type_name("DIR")
      ->required();
  addPreset(*command, options);
  command->add_option("--pieces", options.pieces, "Fragments wanted")
      ->transform(wholeNumber(1, kMaxFragments))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Seed of every random choice")
      ->transform(wholeNumber<std::uint64_t>(0, std::numeric_limits<std::uint64_t>::max()))
      ->capture_default_str();
  CLI::Option* resolution =
      command->add_option("--resolution", options.resolution, "Voxels along the longest side")
          ->transform(wholeNumber(8, 4096))
          ->capture_default_str();
  command
      ->add_option("--voxel-size", options.voxelSize,
                   "Voxel size in the mesh's own unit, in place of --resolution")
      ->check(aboveZero())
      ->excludes(resolution);
  command
      ->add_option("--only", arguments->only,
                   "Break these fragments of a finished fracture again, MESH being its "
                   "manifest.json; --pieces is for each of them")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->transform(wholeNumber(1, kMaxFragments))
      ->type_name("ID,...")
      ->excludes(resolution)
      ->excludes("--voxel-size");
  addFillOptions(*command, options);
  addSeedOptions(*command, options);
  addGrowthOptions(*command, options);
  addErosionOptions(*command, options);
  addSurfaceOptions(*command, options);
  addPointOptions(*command, arguments->files);
  for (const char* ofMeshes :
       {"--seeds", "--missing", "--erode-iterations", "--fill", "--shell-thickness"}) {
    command->get_option("--only")->excludes(ofMeshes);
  }
  command->add_option("--write", arguments->write, "What to write, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"labels", "vdb", "mesh", "preview", "seeds", "rims", "cost", "fog",
                             "solid", "scene", "graph", "proxy"}))
      ->default_str("labels,vdb,mesh,preview");
  addVoxelFormatOption(*command, arguments->files);
  addMeshFormatOption(*command, arguments->files);
  addHostOptions(*command, arguments->files);
  command->add_option("--up", arguments->up, "The mesh's axis that points up in the picture")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->default_str("y");
  command
      ->add_option("--device", arguments->device,
                   "OpenCL device: auto, gpu, cpu or a part of its name (see sherd devices)")
      ->capture_default_str();
  command
      ->add_option(
          "--threads", arguments->threads,
          "Threads of the host's work; default all cores (PoCL's own: POCL_MAX_PTHREAD_COUNT)")
      ->transform(wholeNumber(1, 4096));
  command->add_flag("--json", arguments->json, "Print one JSON object: counts, volumes, seconds");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but warnings and errors");
  command->callback([arguments, &run] {
    checkPointOptions(arguments->files);
    run = [arguments] { runFracture(*arguments); };
  });
}

}  // namespace sherd::cli
