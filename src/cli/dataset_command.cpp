// `sherd dataset` and `sherd merge`: break every mesh of a library.
#include <sherd/dataset.h>
#include <sherd/error.h>
#include <sherd/kernel_cache.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/option_names.h"
#include "cli/command.h"
#include "cli/dataset_printer.h"
#include "cli/drawn_options.h"
#include "cli/foreign_exit.h"
#include "cli/fracture_options.h"
#include "cli/interrupts.h"
#include "cli/machine_options.h"
#include "cli/option_rules.h"
#include "cli/option_text.h"

namespace sherd::cli {
namespace {

struct DatasetArguments {
  std::string library;
  std::string folder;
  DatasetOptions options;
  WriteArguments write{.names = {"labels", "mesh"}};
  std::vector<DrawnOption> drawn;
  std::vector<std::string> idle;  ///< sentences on options that do nothing
  MachineOptions machine;
  bool verify = false;
  bool dryRun = false;
  bool json = false;
  bool quiet = false;
};

// "A" or "A..B"
std::pair<int, int> parseRange(const std::string& option, const std::string& text, int least,
                               int most) {
  const auto number = [&](const std::string& part) {
    int value = 0;
    const char* const end = part.data() + part.size();
    const auto [stop, error] = std::from_chars(part.data(), end, value);
    if (error != std::errc() || stop != end || value < least || value > most) {
      refuse(
          option, text,
          "A or A..B of whole numbers in " + std::to_string(least) + ".." + std::to_string(most));
    }
    return value;
  };
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) return {number(text), number(text)};
  return {number(text.substr(0, dots)), number(text.substr(dots + 2))};
}

Shard parseShard(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto number = slash == std::string::npos ? std::nullopt : numberIn(text.substr(0, slash));
  const auto of = slash == std::string::npos ? std::nullopt : numberIn(text.substr(slash + 1));
  const bool good = number && of && *of >= 1 && *of <= 1'000'000 && *number >= 1 &&
                    *number <= *of && *number == std::floor(*number) && *of == std::floor(*of);
  if (!good) refuse("--shard", text, "i/N with i in 1..N");
  return {static_cast<int>(*number), static_cast<int>(*of)};
}

std::array<int, 3> parseSplit(const std::string& text) {
  std::string commas = text;
  for (char& c : commas) c = c == '/' ? ',' : c;
  const auto numbers = numbersIn(split(commas));
  std::array<int, 3> shares{};
  double sum = 0.0;
  if (numbers && numbers->size() == 3) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double share = (*numbers)[i];
      if (share >= 0.0 && share <= 1e6 && share == std::floor(share)) {
        shares[i] = static_cast<int>(share);
        sum += share;
      } else {
        sum = -1e9;
      }
    }
  }
  if (sum <= 0.0) refuse("--split", text, "three whole shares, such as 80/10/10");
  return shares;
}

void addScheduleOptions(CLI::App& command, DatasetOptions& options) {
  const std::string group = "Schedule";
  Schedule& schedule = options.schedule;
  command
      .add_option_function<std::string>(
          "--pieces",
          [&schedule](const std::string& text) {
            std::tie(schedule.fewest, schedule.most) =
                parseRange("--pieces", text, 1, kMaxFragments);
            if (schedule.fewest > schedule.most) refuse("--pieces", text, "a range that ascends");
          },
          "Number of fragments: every number of a range")
      ->type_name("A..B")
      ->default_str("2..10")
      ->group(group);
  command
      .add_option_function<std::string>(
          "--repeats",
          [&schedule](const std::string& text) {
            std::tie(schedule.repeatsOfFewest, schedule.repeatsOfMost) =
                parseRange("--repeats", text, 0, 65535);
          },
          "Fractures with the fewest pieces and with the most; in proportion between")
      ->type_name("A..B")
      ->default_str("25..15")
      ->group(group);
  command
      .add_option("--max-fragments", schedule.maxFragments,
                  "Maximum number of fragments of one object")
      ->transform(wholeNumber<std::size_t>(1, std::numeric_limits<std::size_t>::max()))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--seed", options.seed,
                  "Seed of the run; fractures' own seeds are made from it and the mesh's content")
      ->transform(wholeNumber<std::uint64_t>(0, std::numeric_limits<std::uint64_t>::max()))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--distinct", options.distinct,
                  "Least share of voxels in which fractures of one object differ; others are drawn "
                  "again")
      ->check(numberBetween(0.0, 0.99, "0..0.99"))
      ->capture_default_str()
      ->group(group);
  command.add_flag("--poses", options.poses, "A random pose of each fragment in the index")
      ->group(group);
  command
      .add_option_function<std::string>(
          "--split", [&options](const std::string& text) { options.split = parseSplit(text); },
          "Shares of objects for train.txt, val.txt and test.txt")
      ->type_name("A/B/C")
      ->default_str("80/10/10")
      ->group(group);
}

void addRunOptions(CLI::App& command, DatasetArguments& arguments) {
  const std::string group = "Run";
  DatasetOptions& options = arguments.options;
  command
      .add_option("--match", options.library.match,
                  "Only meshes whose path in the library matches a pattern, such as '*.ply'")
      ->type_name("PATTERN")
      ->group(group);
  command.add_option("--limit", options.library.limit, "Only the first so many of these")
      ->transform(wholeNumber<std::size_t>(1, std::numeric_limits<std::size_t>::max()))
      ->group(group);
  addChoice(command, "--layout", options.layout, names::kDatasetLayout,
            "Files: a folder for each fracture, a ZIP file for each object, the paper's layout, "
            "Breaking Bad's")
      ->group(group);
  addChoice(command, "--compress", options.compression, names::kFileCompression,
            "How each file is packed; with --layout packed within the archive")
      ->group(group);
  command.add_flag("--resume", options.resume, "Continue an interrupted dataset")->group(group);
  command
      .add_option_function<std::string>(
          "--shard", [&options](const std::string& text) { options.shard = parseShard(text); },
          "This machine's share of the work; sherd merge joins all shares")
      ->type_name("i/N")
      ->default_str("1/1")
      ->group(group);
  command
      .add_flag("--verify", arguments.verify,
                "Read all files again at the end, with --resume also those of earlier runs")
      ->group(group);
  command
      .add_flag("--dry-run", arguments.dryRun, "Only estimate files and time, from a few objects")
      ->group(group);
  command
      .add_option("--object-timeout", options.objectTimeout,
                  "Seconds after which an object counts as failed; default never")
      ->check(aboveZero())
      ->group(group);
  command
      .add_option("--config",
                  "Read options from a TOML or JSON file; the command line overrides them")
      ->type_name("FILE")
      ->group(group);
  command.add_option("--plan", options.plan)->group("");
  command
      .add_option_function<std::vector<std::string>>(
          "--drawn",
          [&arguments](const std::vector<std::string>& all) {
            for (const std::string& text : all) {
              const std::size_t equals = text.find('=');
              if (auto drawn = drawnOption(text.substr(0, equals), text.substr(equals + 1))) {
                arguments.drawn.push_back(std::move(*drawn));
              }
            }
          })
      ->allow_extra_args(false)
      ->group("");
}

void runDatasetCommand(DatasetArguments& arguments) {
  if (!arguments.dryRun) setInterruptedState("go on with the same command and --resume");
  provideKernelCache();
  DatasetOptions& options = arguments.options;
  options.write = writeOptions(arguments.write);
  // Loaders of Breaking Bad read only vertices and faces, and every file as a piece.
  const bool isBb = options.layout == DatasetLayout::bb;
  options.write.plainMeshes |= isBb;
  if (isBb && arguments.write.files.meshFormats.size() > 1) {
    throw Error(ErrorCode::usage, "--layout bb takes one --mesh-format");
  }
  options.maxMemory = arguments.machine.memory();
  if (!arguments.drawn.empty()) {
    options.draw = [drawn = arguments.drawn](std::uint64_t seed, FractureOptions& fracture) {
      return drawInto(drawn, seed, fracture);
    };
  }
  const auto threads = limitedThreads(arguments.machine);
  keepFreedMemory();
  Device device(arguments.machine.device);
  const ForeignExit guard;
  DatasetPrinter printer(arguments.json, arguments.quiet);
  DatasetCallbacks callbacks = printer.callbacks();
  callbacks.cancelled = isInterrupted;
  for (const std::string& sentence : arguments.idle) callbacks.warning(sentence);
  try {
    if (arguments.dryRun) {
      return printer.printForecast(
          forecastDataset(arguments.library, arguments.folder, options, device, isInterrupted));
    }
    const DatasetSummary summary =
        runDataset(arguments.library, arguments.folder, options, device, callbacks);
    if (summary.objects == 0 && summary.failures > 0) {
      throw Error(ErrorCode::input, "no object could be broken; " + arguments.folder +
                                        "/failures.jsonl has the reasons");
    }
    printer.printSummary(arguments.folder, summary);
    if (arguments.verify)
      printer.printVerified(arguments.folder, verifyDataset(arguments.folder, isInterrupted));
  } catch (const Error&) {
    printer.stopped();
    throw;
  }
}

}  // namespace

CLI::App* addDatasetCommand(CLI::App& app, Action& run) {
  CLI::App* command =
      app.add_subcommand("dataset", "Break every mesh of a library, many times each");
  auto arguments = std::make_shared<DatasetArguments>();
  FractureOptions& fracture = arguments->options.fracture;
  command
      ->add_option("LIBRARY", arguments->library,
                   "A folder of meshes, with all below it, or a text file with a path a line")
      ->required();
  command
      ->add_option("-o,--output", arguments->folder,
                   "Folder for the dataset: absent, empty, or with --resume an unfinished one")
      ->type_name("DIR")
      ->required();
  addPreset(*command, fracture);
  addScheduleOptions(*command, arguments->options);
  addRunOptions(*command, *arguments);
  CLI::Option* resolution = addResolution(*command, fracture);
  command
      ->add_option("--voxel-size", fracture.voxelSize,
                   "Voxel size in the meshes' own unit, in place of --resolution")
      ->check(aboveZero())
      ->excludes(resolution);
  addFillOptions(*command, fracture);
  addSeedOptions(*command, fracture);
  command->remove_option(command->get_option("--seeds"));
  addGrowthOptions(*command, fracture);
  addErosionOptions(*command, fracture);
  addSurfaceOptions(*command, fracture);
  addPointOptions(*command, arguments->write.files);
  addWriteOptions(*command, arguments->write);
  addVoxelFormatOption(*command, arguments->write.files);
  addMeshFormatOption(*command, arguments->write.files);
  addHostOptions(*command, arguments->write.files, "--vdb-compress");
  addMachineOptions(*command, arguments->machine);
  command->add_flag("--json", arguments->json, "Print JSON, an event a line");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but warnings and errors");
  command->footer(
      "In the groups Seeds, Growth, Erosion and Surface a value may be a range, as in\n"
      "--erode-probability 0..0.4, or a choice, as in --sampler 'uniform|poisson'; it is drawn at\n"
      "random for each fracture.");
  command->callback([arguments, command, &run] {
    if (arguments->options.layout == DatasetLayout::bb && command->count("--mesh-format") == 0) {
      arguments->write.files.meshFormats = {MeshFileFormat::obj};
    }
    checkDrawn(arguments->drawn, arguments->options.fracture);
    arguments->idle = idleOptions({*command,
                                   arguments->options.fracture,
                                   arguments->write,
                                   {},
                                   arguments->dryRun,
                                   &arguments->options,
                                   &arguments->drawn});
    run = [arguments] { runDatasetCommand(*arguments); };
  });
  return command;
}

void addMergeCommand(CLI::App& app, Action& run) {
  CLI::App* command = app.add_subcommand("merge", "Join the shards of a dataset");
  auto folder = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  command->add_option("DIR", *folder, "The dataset's folder")->required();
  command->add_flag("--json", *json, "Print JSON");
  command->callback([folder, json, &run] {
    run = [folder, json] {
      DatasetPrinter(*json, false).printSummary(*folder, mergeDataset(*folder, isInterrupted));
    };
  });
}

}  // namespace sherd::cli
