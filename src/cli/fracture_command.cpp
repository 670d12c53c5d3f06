// `sherd fracture`: break one mesh into a folder.
#include <sherd/error.h>
#include <sherd/fracture.h>
#include <sherd/io.h>
#include <sherd/refracture.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "cli/command.h"
#include "cli/fracture_options.h"
#include "io/mesh_report.h"
#include "mesh/text_scan.h"

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

// ---- Ctrl-C: a flag that long work asks for.

std::atomic<bool> interrupted{false};

// Signals are blocked in every thread and waited for in one, instead of handled: while a kernel is
// built, LLVM puts handlers of its own in place, which delete the compiler's files and turn a
// ctrl-C into a failed build.  A signal that the caller ignores stays ignored.
void watchForInterrupts() {
  sigset_t watched;
  ::sigemptyset(&watched);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    ::sigaction(number, nullptr, &action);
    if (action.sa_handler != SIG_IGN) ::sigaddset(&watched, number);
  }
  ::pthread_sigmask(SIG_BLOCK, &watched, nullptr);
  std::thread([watched] {
    int number = 0;
    while (::sigwait(&watched, &number) == 0) interrupted = true;
  }).detach();
}

void stopIfInterrupted() {
  if (interrupted) throw Error(ErrorCode::cancelled, "");
}

// ---- Progress: one line on a terminal, redrawn some ten times a second.

class ProgressLine {
 public:
  explicit ProgressLine(bool shown) : shown_(shown) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(std::string_view stage, double fraction) {
    constexpr int kWidth = 40;
    if (!shown_ || (drawn_ && secondsSince(last_) < 0.1)) return;
    const int full = static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * kWidth));
    const std::string bar(static_cast<std::size_t>(full), '#');
    std::fprintf(stderr, "\r%-10.*s [%-*s] %3d %%", static_cast<int>(stage.size()), stage.data(),
                 kWidth, bar.c_str(), full * 100 / kWidth);
    last_ = Clock::now();
    drawn_ = true;
  }

  void clear() {
    if (drawn_) std::fputs("\r\x1b[K", stderr);
    drawn_ = false;
  }

 private:
  bool shown_;
  bool drawn_ = false;
  Clock::time_point last_;
};

// ---- What is told afterwards

std::string number(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

void warn(const FractureArguments& arguments, const SourceMesh& source,
          const FractureResult& result) {
  for (const std::string& warning : source.warnings) {
    printMessage("sherd: warning: " + warning);
  }
  const std::vector<MeshFileFormat>& formats = arguments.files.meshFormats;
  if (std::find(formats.begin(), formats.end(), MeshFileFormat::glb) != formats.end()) {
    for (const Texture& texture : source.appearance.textures) {
      if (imageType(texture.bytes) != ImageType::other) continue;
      printMessage("sherd: warning: " + source.name + ": its texture " + inQuotes(texture.name) +
                   " is neither PNG nor JPEG, so .glb files go without it");
    }
  }
  const std::size_t fragments = result.fragments.size();
  if (arguments.options.seedFile.empty() && arguments.only.empty() &&
      static_cast<std::size_t>(arguments.options.pieces) < fragments) {
    printMessage("sherd: warning: " + arguments.mesh + " has " + std::to_string(result.parts) +
                 " separate parts, so it became " + std::to_string(fragments) + " fragments, not " +
                 std::to_string(arguments.options.pieces));
  }
  if (arguments.only.empty()) {
    for (const std::string& warning : reportWarnings(source, result)) {
      printMessage("sherd: warning: " + warning);
    }
  }
  if (result.solid.specks > 0) {
    printMessage("sherd: warning: " + arguments.mesh + ": " + std::to_string(result.solid.specks) +
                 (result.solid.specks == 1 ? " part" : " parts") + " under " +
                 std::to_string(kSpeckVoxels) + " voxels dropped, " +
                 std::to_string(result.solid.speckVoxels) + " voxels in all");
  }
}

std::string asText(const FractureArguments& arguments, const SourceMesh& source,
                   const FractureResult& result, const DeviceInfo& device, double seconds) {
  const std::string withheld =
      result.withheld > 0 ? ", " + std::to_string(result.withheld) + " of them withheld," : "";
  return arguments.folder + ": " + std::to_string(result.fragments.size()) + " fragments of " +
         source.name + withheld + " in " + number(seconds, 3) + " s (" +
         std::to_string(result.solid.voxels) + " voxels of " +
         number(result.solid.frame.voxelSize, 4) + ", seed " +
         std::to_string(arguments.options.seed) + ", " + device.name + ")\n";
}

std::string asJson(const FractureArguments& arguments, const SourceMesh& source,
                   const FractureResult& result, const DeviceInfo& device, const fs::path& manifest,
                   const std::vector<StageTime>& times) {
  double volumeOut = 0.0;
  for (const Fragment& fragment : result.fragments) volumeOut += fragment.mass.volume;
  nlohmann::ordered_json seconds;
  for (const StageTime& time : times) seconds[time.stage] = time.seconds;
  const nlohmann::ordered_json json = {
      {"schema", "sherd-report/1"},
      {"command", "fracture"},
      {"source", source.name},
      {"manifest", manifest.string()},
      {"seed", arguments.options.seed},
      {"device", {{"platform", device.platform}, {"name", device.name}}},
      {"pieces_asked", arguments.options.pieces},
      {"fragments", result.fragments.size()},
      {"withheld", result.withheld},
      {"parts", result.parts},
      {"freed_voxels", result.labels.freed},
      {"worn_voxels", result.worn.front()},
      {"specks", result.solid.specks},
      {"voxel_size", result.solid.frame.voxelSize},
      {"voxels", result.solid.voxels},
      {"vertices_in", source.mesh.vertices.size()},
      {"triangles_in", source.mesh.triangles.size()},
      {"volume_in", std::abs(volume(source.mesh))},
      {"volume_out", volumeOut},
      {"report", arguments.only.empty() ? reportJson(source, result) : nlohmann::ordered_json()},
      {"seconds", seconds}};
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

// ---- The command

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
      .cancelled = [] { return interrupted.load(); }};

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

  line.clear();
  warn(arguments, source, result);
  if (arguments.json) {
    printResult(asJson(arguments, source, result, device.info(), manifest, times));
  } else if (!arguments.quiet) {
    if (!again) printResult(reportText(source, result));
    printResult(asText(arguments, source, result, device.info(), times.back().seconds));
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
