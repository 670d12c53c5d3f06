// `sherd fracture`: breaks one mesh into a folder of fragments.
#include <sherd/device.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>
#include <sherd/options.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>

#include "base/text/lower_case.h"
#include "base/text/safe_name.h"
#include "base/text/text_scan.h"
#include "base/threads.h"
#include "cli/arguments/config_arguments.h"
#include "cli/arguments/machine_options.h"
#include "cli/arguments/table_options.h"
#include "cli/fracture_printer.h"
#include "cli/terminal/command.h"
#include "cli/terminal/foreign_exit.h"
#include "cli/terminal/interrupts.h"
#include "cli/terminal/progress_events.h"
#include "cli/terminal/progress_line.h"

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct FractureArguments {
  std::string mesh;
  std::string folder;
  std::vector<int>
      only;  ///< fragments of a finished fracture to break again; empty: MESH is a mesh or volume
  RunOptions run;
  Surface surface = Surface::automatic;  ///< as asked; that of `run` is what it came to
  bool splitObjects = false;
  OptionUse use;
  MachineOptions machine;
  bool json = false;
  bool quiet = false;
  bool progress = false;
};

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// The input of a run: meshes, a solid, or a finished fracture.
struct Input {
  std::vector<SourceMesh>
      meshes;                  // the file's, or its objects'; for a solid the name without a mesh
  std::optional<Solid> solid;  // moved from when it is broken
  std::optional<FinishedFracture> finished;
  std::vector<std::optional<glm::dvec3>> offsets;  // [meshes] of those that were recentered
};

// Moves every object to the origin.
void recenter(Input& input) {
  for (std::size_t i = 0; i < input.meshes.size(); ++i) {
    TriangleMesh& mesh = input.meshes[i].mesh;
    const glm::dvec3 offset = input.solid ? boxCenter(*input.solid) : boxCenter(mesh);
    if (input.solid) input.solid = moved(std::move(*input.solid), -offset);
    mesh = moved(std::move(mesh), -offset);
    input.offsets[i] = offset;
  }
}

// Reads the files that options name.
void readGiven(FractureArguments& arguments, const Progress& progress) {
  FractureOptions& options = arguments.run.fracture;
  const ReadOptions memory{.maxMemory = arguments.run.volume.maxMemory};
  for (Guide& guide : options.guides) guide = readGuide(guide.file, memory, &progress);
  Density& density = options.seeds.density;
  if (!density.source.empty()) {
    density = readDensity(density.source, arguments.mesh, memory, &progress);
  }
}

// Chooses smooth surfaces where exact ones are not asked for and have no mesh to cut.
void useSmooth(FractureArguments& arguments) {
  if (arguments.surface != Surface::automatic) return;
  FractureOptions& options = arguments.run.fracture;
  options.surface.surface = Surface::smooth;
  options = optionsFor(options, arguments.run.write);
}

Input readInput(FractureArguments& arguments, const Progress& progress) {
  Input input;
  readGiven(arguments, progress);
  if (!arguments.only.empty()) {
    input.finished = readFracture(arguments.mesh, {.maxMemory = arguments.run.volume.maxMemory});
    try {
      readFragmentMeshes(arguments.mesh, *input.finished, arguments.run.volume.maxMemory);
    } catch (const Error& e) {
      const bool isAsked = arguments.surface == Surface::exact;
      if (isAsked || e.code() != ErrorCode::input) throw;
      printMessage("sherd: warning: " + std::string(e.what()) + "; edges are rounded");
    }
    if (!input.finished->isExact) useSmooth(arguments);
    input.meshes = {input.finished->source};
    const Manifest manifest = readManifest(manifestIn(arguments.mesh));
    input.meshes.front().coordinates = manifest.coordinates;
    input.offsets = {manifest.offset};
    arguments.run.fracture.solid.resolution = input.finished->resolution;
    return input;
  }
  std::error_code none;
  if (fs::is_directory(arguments.mesh, none)) {
    throw Error(ErrorCode::input, arguments.mesh +
                                      ": is a folder, a mesh is needed; --only breaks fragments of "
                                      "a fracture's folder again");
  }
  SourceMesh source;
  if (isVolumeName(arguments.mesh)) {
    useSmooth(arguments);
    Volume volume = readVolume(arguments.mesh, arguments.run.volume, &progress);
    if (arguments.run.volume.ownVoxels) {
      arguments.run.fracture.solid.voxelSize = volume.voxelSize;
    }
    for (const std::string& sentence : idleOptions(volume, arguments.use)) {
      printMessage("sherd: warning: " + sentence);
    }
    input.solid = std::move(volume.solid);
    source = std::move(volume.source);
  } else {
    source = readMesh(arguments.mesh, {.maxMemory = arguments.run.volume.maxMemory}, &progress);
  }
  source.coordinates = coordinatesOfFile(arguments.mesh, source.coordinates);
  const RunOptions& run = arguments.run;
  const bool isExact = run.fracture.surface.surface == Surface::exact;
  // Only exact surfaces have them, and they take more memory than the triangles.
  if (!isExact) std::exchange(source.mesh.attributes.normals, {});
  const bool hasFaces = isExact || run.write.sourceFaces;
  if (!hasFaces) std::exchange(source.polygons, {});
  if (arguments.splitObjects) {
    input.meshes = splitObjects(source);
    for (SourceMesh& mesh : input.meshes) {
      if (!hasFaces) std::exchange(mesh.polygons, {});
    }
  } else {
    input.meshes = {std::move(source)};
  }
  input.offsets.resize(input.meshes.size());
  if (run.recenter) recenter(input);
  return input;
}

// Returns the file's name, with the object's name if `source` is one object of the file.
std::string titled(const std::string& file, const SourceMesh& source) {
  return source.objects.size() == 1 ? file + ", " + inQuotes(source.objects.front()) : file;
}

// Breaks a part of the input into a folder.  Prefixes errors about the mesh with its name, which
// the stages do not have.
//   run  as the part was moved
StagedFracture breakInput(const FractureArguments& arguments, const RunOptions& run, Input& input,
                          const SourceMesh& source, const std::string& folder, Device& device,
                          const Progress& progress) {
  try {
    FractureInput part{.source = source,
                       .solid = std::move(input.solid),
                       .finished = input.finished ? &*input.finished : nullptr,
                       .only = arguments.only};
    requireMemory(part, run.fracture, run.write, run.volume.maxMemory);
    return stageFracture(folder, std::move(part), run.fracture, device, run.write, &progress);
  } catch (const Error& e) {
    const std::optional<GivenSeeds>& given = run.fracture.seeds.given;
    const std::string_view sentence = e.what();
    const std::vector<Guide>& guides = run.fracture.guides;
    const bool namesFile =
        (given && sentence.starts_with(given->file)) || sentence.starts_with(folder) ||
        std::any_of(guides.begin(), guides.end(),
                    [&](const Guide& guide) { return sentence.starts_with(guide.file); });
    if (e.code() != ErrorCode::input || namesFile || input.finished) throw;
    throw Error(ErrorCode::input, titled(arguments.mesh, source) + ": " + e.what(), e.options());
  }
}

// Returns a folder for each object, by its name; names that are equal up to case get numbers.
std::vector<std::string> objectFolders(const std::string& folder,
                                       const std::vector<SourceMesh>& objects) {
  std::vector<std::string> folders;
  std::set<std::string> taken;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const SourceMesh& object = objects[i];
    const std::string unnamed = "object_" + std::to_string(i + 1);
    const std::string name =
        safeName(object.objects.empty() ? object.stem : object.objects.front(), unnamed);
    std::string unique = name;
    for (int n = 2; !taken.insert(lowerCase(unique)).second; ++n) {
      unique = name + "_" + std::to_string(n);
    }
    folders.push_back((fs::path(folder) / unique).string());
  }
  return folders;
}

// Each folder is locked by an open file until all of them are in place.
void allowOpenFiles() {
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  files.rlim_cur = files.rlim_max;
  (void)::setrlimit(RLIMIT_NOFILE, &files);
}

// Pending replacements of all objects' folders.
class Replacements {
 public:
  Replacements() = default;
  ~Replacements() {
    while (!all_.empty()) all_.pop_back();  // later ones may lie in folders of earlier ones
  }
  Replacements(const Replacements&) = delete;
  Replacements& operator=(const Replacements&) = delete;

  void add(FractureReplacement one) { all_.push_back(std::move(one)); }
  [[nodiscard]] const FractureReplacement& back() const { return all_.back(); }
  void putInPlace() {
    for (FractureReplacement& one : all_) one.putInPlace();
  }
  void keep() {
    for (FractureReplacement& one : all_) one.keep();
  }
  std::string drop() {
    std::string left;
    for (; !all_.empty(); all_.pop_back()) {
      const std::string one = all_.back().takeBack();
      if (!one.empty()) left += (left.empty() ? "" : "; ") + one;
    }
    return left;
  }

 private:
  std::vector<FractureReplacement> all_;
};

class FractureRun {
 public:
  explicit FractureRun(FractureArguments& arguments)
      : arguments_(arguments),
        line_(::isatty(STDERR_FILENO) == 1 && !arguments.quiet && !arguments.progress),
        events_(arguments.progress, arguments.run.fracture.surface.surface == Surface::exact) {}

  void run() {
    if (!arguments_.splitObjects) checkFractureFolder(arguments_.folder);
    // Opening a device loads a compiler, which takes as long as reading 100,000 triangles.
    std::future<Device> opening = startedTask([this] { return Device(arguments_.machine.device); });
    Input input = timed("read", [&] { return readInput(arguments_, progress_); });
    std::vector<std::string> folders{arguments_.folder};
    if (arguments_.splitObjects) {
      folders = objectFolders(arguments_.folder, input.meshes);
      for (const std::string& folder : folders) checkFractureFolder(folder);
      allowOpenFiles();
    }
    Device device = timed("device", [&] { return opening.get(); });
    warnOfCaveat(device);
    const ForeignExit guard;
    const std::vector<StageTime> before = times_;
    std::optional<Error> refused;
    events_.overall().setParts(input.meshes.size());
    for (std::size_t i = 0; i < input.meshes.size(); ++i) {
      try {
        breakOne(input, i, folders[i], device);
      } catch (const Error& e) {  // the other objects are broken nevertheless
        if (input.meshes.size() == 1 || e.code() != ErrorCode::input) throw;
        line_.clear();
        printMessage("sherd: " + sentenceOf(e));
        if (!refused) refused = Error(e.code(), "not all objects could be broken");
      }
      times_ = before;
      start_ = Clock::now();
      events_.overall().nextPart();
    }
    line_.clear();
    finish(
        replacements_, [this] { printReports(); }, refused ? static_cast<int>(refused->code()) : 0);
    if (refused) throw *refused;
    events_.finish();
  }

 private:
  void showProgress(std::string_view stage, double fraction) {
    line_.show(stage, fraction);
    events_.show(stage, fraction);
  }

  template <class Work>
  std::invoke_result_t<Work> timed(const char* stage, const Work& work) {
    stopIfInterrupted();
    showProgress(stage, 0.0);
    const Clock::time_point begin = Clock::now();
    auto result = work();
    times_.push_back({stage, secondsSince(begin)});
    return result;
  }

  void breakOne(Input& input, std::size_t part, const std::string& folder, Device& device) {
    stopIfInterrupted();
    const SourceMesh& source = input.meshes[part];
    const std::optional<glm::dvec3>& offset = input.offsets[part];
    const RunOptions run = offset ? recentered(arguments_.run, *offset) : arguments_.run;
    const std::string title = titled(arguments_.mesh, source);
    StagedFracture aside = breakInput(arguments_, run, input, source, folder, device, progress_);
    replacements_.add(std::move(aside.replacement));
    const FractureResult& result = aside.result;
    times_.insert(times_.end(), result.times.begin(), result.times.end());
    times_.push_back({"total", secondsSince(start_)});
    const FractureSummary summary{title,
                                  folder,
                                  source,
                                  run.fracture,
                                  run.write,
                                  result,
                                  device.info(),
                                  fs::path(folder) / kManifestName,
                                  replacements_.back().warnings(),
                                  times_};
    line_.clear();
    for (const std::string& warning : warningsOf(summary)) {
      printMessage("sherd: warning: " + warning);
    }
    if (arguments_.json) {
      reports_.push_back(jsonOf(summary));
    } else {
      text_ += textOf(summary);
    }
  }

  void printReports() const {
    if (arguments_.json) {
      const nlohmann::ordered_json& all = arguments_.splitObjects ? reports_ : reports_.front();
      printResult(all.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    } else if (!arguments_.quiet && !text_.empty()) {
      printResult(text_);
    }
  }

  FractureArguments& arguments_;
  Clock::time_point start_ = Clock::now();
  ProgressLine line_;
  ProgressEvents events_;
  Progress progress_{
      .report = [this](std::string_view stage, double fraction) { showProgress(stage, fraction); },
      .cancelled = isInterrupted};
  std::vector<StageTime> times_;
  nlohmann::ordered_json reports_ = nlohmann::ordered_json::array();
  std::string text_;
  Replacements replacements_;
};

void runFracture(FractureArguments& arguments) {
  setInterruptedState(arguments.folder + " is as it was before");
  prepareDevice(arguments.machine);
  FractureOptions& options = arguments.run.fracture;
  checkWriteOptions(arguments.run.write, options);
  arguments.surface = options.surface.surface;
  options = optionsFor(options, arguments.run.write);
  if (options.seeds.given) options.seeds.given->points = readSeedPoints(options.seeds.given->file);
  const auto threads = limitedThreads(arguments.machine);
  keepFreedMemory();
  FractureRun(arguments).run();
}

// Adds the options that select what of the input is broken.
void addSelection(CLI::App& command, FractureArguments& arguments) {
  CLI::Option* only =
      command
          .add_option("--only", arguments.only,
                      "Break these fragments of a finished fracture again; MESH is its folder, or "
                      "its manifest.json, and --pieces counts for each of them. Options that are "
                      "not given are those of that fracture. Other fragments keep their ids; the "
                      "first part of a broken one has its id, the others follow the last id")
          ->delimiter(',')
          ->allow_extra_args(false)
          ->transform(wholeNumber(1, kMaxFragments))
          ->type_name("ID,...");
  for (const char* option : kOptionsOfWhole) only->excludes("--" + std::string(option));
  command
      .add_flag("--split-objects", arguments.splitObjects,
                "Break each object of the file separately, into a folder of its name below DIR")
      ->excludes(only);
}

// Records what was given on the command line.
void setGiven(const CLI::App& command, FractureArguments& arguments) {
  arguments.run.volume.maxMemory = arguments.machine.memory();
  arguments.run.write.samplingMemory = samplingMemoryOf(arguments.run.volume.maxMemory);
  const bool isGiven = command.count("--voxel-size") > 0 ||
                       (command.count("--resolution") > 0 &&
                        arguments.run.fracture.solid.resolution != kAutoResolution);
  arguments.run.volume.ownVoxels = !isGiven;
  arguments.use = useOf(command);
  arguments.use.input = arguments.mesh;
}

// Sets what the preset draws, by the fracture's seed.
void drawOfPreset(const CLI::App& command, FractureArguments& arguments) {
  const CLI::Option* const preset = command.get_option("--preset");
  if (preset->count() == 0) return;
  for (const DrawnOption& drawn :
       presetDraws(preset->as<std::string>(), arguments.run, arguments.use.isGiven)) {
    const std::string value = drawn.valueFor(arguments.run.fracture.seed);
    fractureOption(drawn.name)->value.set(arguments.run, value);
  }
}

// Takes the options that are not given from the fracture that is broken again.
void inheritOptions(const CLI::App& command, FractureArguments& arguments) {
  RunOptions options = inheritedOptions(arguments.mesh);
  if (command.count("--material") >
      0) {  // also that with none: no option of another material stays
    FractureOptions fresh;
    fresh.seed = options.fracture.seed;
    fresh.surface = options.fracture.surface;
    options.fracture = std::move(fresh);
  }
  const std::uint64_t seed = options.fracture.seed;
  setGivenOptions(command, options);
  if (command.count("--seed") == 0) options.fracture.seed = seed;  // presets have one of their own
  arguments.run = std::move(options);
}

// Returns a sentence for each option that does nothing.
std::vector<std::string> checkedOptions(const FractureArguments& arguments) {
  if (arguments.splitObjects && isVolumeName(arguments.mesh)) {
    throw Error(ErrorCode::usage,
                "--split-objects breaks the objects of a mesh, and MESH is a volume without "
                "objects");
  }
  return idleOptions(arguments.run, arguments.use);
}

}  // namespace

CLI::App* addFractureCommand(CLI::App& app, Action& run) {
  CLI::App* command = app.add_subcommand("fracture", "Break one mesh into fragments");
  auto arguments = std::make_shared<FractureArguments>();
  command
      ->add_option(
          "MESH", arguments->mesh,
          "The mesh: .obj .ply .stl .off .gltf .glb .binm .fbx .dae .3mf, also .gz; or a volume: "
          ".vdb .rle .npy .npz .vox .qstack .bing; with --only a fracture's folder")
      ->required();
  command
      ->add_option(
          "-o,--output", arguments->folder,
          "Folder for the fragments: absent, empty or an earlier fracture's, which is replaced")
      ->type_name("DIR")
      ->required();
  addFractureOptions(*command, arguments->run);
  addSelection(*command, *arguments);
  addMachineOptions(*command, arguments->machine);
  addConfig(*command);
  command->add_flag("--json", arguments->json, "Print one JSON object: counts, volumes, seconds");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but warnings and errors");
  command->add_flag("--progress", arguments->progress,
                    "Print progress as JSON on standard error, an object a line");
  command->callback([arguments, command, &run] {
    if (!arguments->only.empty()) inheritOptions(*command, *arguments);
    setGiven(*command, *arguments);
    if (arguments->only.empty()) drawOfPreset(*command, *arguments);
    const std::vector<std::string> idle = checkedOptions(*arguments);
    run = [arguments, idle] {
      for (const std::string& sentence : idle) printMessage("sherd: warning: " + sentence);
      runFracture(*arguments);
    };
  });
  return command;
}

}  // namespace sherd::cli
