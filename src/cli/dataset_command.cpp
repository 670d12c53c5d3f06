// `sherd dataset` and `sherd merge`: break every mesh of a library.
#include <sherd/dataset.h>
#include <sherd/device.h>
#include <sherd/error.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "cli/arguments/config_arguments.h"
#include "cli/arguments/machine_options.h"
#include "cli/arguments/table_options.h"
#include "cli/dataset_printer.h"
#include "cli/terminal/command.h"
#include "cli/terminal/foreign_exit.h"
#include "cli/terminal/interrupts.h"

namespace sherd::cli {
namespace {

constexpr std::size_t kPointsOfPfpp = 1000;  // of each fragment, as its loaders expect

struct DatasetArguments {
  std::string library;
  std::string folder;
  DatasetOptions options;
  std::vector<std::string> idle;  ///< sentences on options that do nothing
  MachineOptions machine;
  std::string licenses;                 ///< file; empty: none
  std::string recipeFile;               ///< empty: none
  std::optional<DatasetRecipe> recipe;  ///< its content
  bool verify = false;
  bool dryRun = false;
  bool json = false;
  bool quiet = false;
};

// Adds what concerns recipe.json, which assemblages do not have.
void addRecipeOptions(CLI::App& command, DatasetArguments& arguments) {
  const std::string group = "Run";
  command
      .add_option("--licenses", arguments.licenses,
                  "File with the licenses of meshes, for recipe.json: a line for each, its path in "
                  "the library or a pattern, a tab, and the license")
      ->type_name("FILE")
      ->group(group);
  command
      .add_option("--recipe", arguments.recipeFile,
                  "Make the dataset of a recipe.json again from the same meshes, and compare all "
                  "files by their checksums")
      ->type_name("FILE")
      ->group(group);
}

void addRunOptions(CLI::App& command, DatasetArguments& arguments, bool isAssemblage) {
  const std::string group = "Run";
  command
      .add_flag("--verify", arguments.verify,
                "Read all files again at the end, with --resume also those of earlier runs")
      ->group(group);
  command
      .add_flag("--strict", arguments.options.strict,
                "Status 3 if any object could not be broken, not only if none could; with "
                "--replace the old dataset stays then")
      ->group(group);
  command
      .add_flag("--dry-run", arguments.dryRun, "Only estimate files and time, from a few objects")
      ->group(group);
  if (!isAssemblage) addRecipeOptions(command, arguments);
  addConfig(command)->group(group);
}

// Options that do not change a dataset, and so may be given with a recipe.
constexpr std::array kWithRecipe{"--recipe", "--output",  "--resume",         "--replace",
                                 "--strict", "--verify",  "--shard",          "--viewers",
                                 "--device", "--threads", "--object-timeout", "--max-memory",
                                 "--json",   "--quiet",   "--dry-run"};

// Takes the options of the recipe's dataset, and keeps those of the run.
void useRecipe(const CLI::App& command, DatasetArguments& arguments) {
  for (const CLI::Option* const option : command.parse_order()) {
    const std::string name = option->get_name();
    const bool isOfRun =
        std::find(kWithRecipe.begin(), kWithRecipe.end(), name) != kWithRecipe.end();
    if (isOfRun || option->get_positional()) continue;
    throw Error(ErrorCode::usage,
                name + " can't be given with --recipe, which has the options of its dataset");
  }
  arguments.recipe = readRecipe(arguments.recipeFile);
  const DatasetOptions run = std::move(arguments.options);
  DatasetOptions& options = arguments.options;
  options = optionsOfRecipe(*arguments.recipe);
  options.shard = run.shard;
  options.resume = run.resume;
  options.replace = run.replace;
  options.strict = run.strict;
  options.viewers = run.viewers;
  options.objectTimeout = run.objectTimeout;
}

// Warns of each mesh whose files are others than the recipe's.  Returns a sentence on all; empty:
// there are none.
std::string comparison(const DatasetRecipe& recipe, const std::filesystem::path& folder,
                       const DatasetCallbacks& callbacks) {
  const DatasetRecipe made = readRecipe(folder / "recipe.json");
  const std::vector<std::string> sentences = differences(recipe, made);
  if (sentences.empty()) return {};
  for (const std::string& sentence : sentences) callbacks.warning(sentence);
  const std::string versions =
      made.program == recipe.program
          ? std::string()
          : "; it was made by sherd " + recipe.program + ", this is sherd " + made.program;
  return std::to_string(sentences.size()) + " of " + std::to_string(recipe.meshes.size()) +
         " meshes gave other files than the recipe's" + versions;
}

// Reads all files again.
//   changed  the dataset's own files that differed before the run
void verify(const DatasetArguments& arguments, const std::filesystem::path& folder,
            const std::vector<std::string>& changed, DatasetPrinter& printer) {
  DatasetCheck check = verifyDataset(folder, &untilInterrupted(), arguments.options.shard);
  // Those that were not written anew differ still.
  std::set<std::string> problems(check.problems.begin(), check.problems.end());
  problems.insert(changed.begin(), changed.end());
  check.problems.assign(problems.begin(), problems.end());
  printer.printVerified(folder.string(), check);
}

// Keeps the old dataset where the new one is not that of the recipe.
void compareBeforeReplacing(const DatasetArguments& arguments, DatasetPrinter& printer,
                            DatasetCallbacks& callbacks) {
  callbacks.beforeReplacing = [&](const std::filesystem::path& made) {
    const std::string reason = comparison(*arguments.recipe, made, callbacks);
    if (reason.empty()) return;
    if (arguments.verify) verify(arguments, made, {}, printer);
    throw Error(ErrorCode::input, reason + ", so " + arguments.folder +
                                      " keeps its dataset; the new one is in " + made.string() +
                                      ", and sherd merge puts it in place");
  };
}

// Says which of the licenses match no mesh: a name is mistyped, or the mesh is gone.
void warnOfIdleLicenses(const DatasetArguments& arguments, const DatasetCallbacks& callbacks) {
  if (arguments.licenses.empty()) return;
  const std::vector<MeshLicense>& all = arguments.options.library.licenses;
  const std::vector<std::string> idle = idleLicenses(arguments.library, all);
  if (idle.empty()) return;
  callbacks.warning(arguments.licenses + ": " + std::to_string(idle.size()) + " of " +
                    std::to_string(all.size()) + " licenses match no mesh, the first is of " +
                    idle.front());
}

void runDatasetCommand(DatasetArguments& arguments) {
  if (!arguments.dryRun) {
    setInterruptedState(arguments.options.replace
                            ? arguments.folder + " keeps its dataset until the new one is " +
                                  "complete; go on with the same command"
                            : "go on with the same command and --resume");
  }
  prepareDevice(arguments.machine);
  DatasetOptions& options = arguments.options;
  options.maxMemory = arguments.machine.memory();
  options.each.write.samplingMemory = samplingMemoryOf(options.maxMemory);
  const auto threads = limitedThreads(arguments.machine);
  keepFreedMemory();
  Device device(arguments.machine.device);
  warnOfCaveat(device);
  const ForeignExit guard;
  DatasetPrinter printer(arguments.json, arguments.quiet);
  DatasetCallbacks callbacks = printer.callbacks();
  callbacks.progress = &untilInterrupted();
  for (const std::string& sentence : arguments.idle) callbacks.warning(sentence);
  try {
    warnOfIdleLicenses(arguments, callbacks);
    if (arguments.recipe) {
      requireMeshes(arguments.library, *arguments.recipe, &untilInterrupted());
      compareBeforeReplacing(arguments, printer, callbacks);
    }
    if (arguments.dryRun) {
      return printer.printForecast(forecastDataset(arguments.library, arguments.folder, options,
                                                   device, &untilInterrupted()));
    }
    // Before the run writes them anew.  Whoever removes one wants that.
    std::vector<std::string> changed;
    if (arguments.verify && !options.replace) changed = changedOwnFiles(arguments.folder, false);
    const DatasetSummary summary =
        runDataset(arguments.library, arguments.folder, options, device, callbacks);
    const std::string failures = (summary.folder / "failures.jsonl").string();
    if (summary.objects == 0 && summary.failures > 0) {
      throw Error(ErrorCode::input, "no object could be broken; " + failures + " has the reasons");
    }
    printer.printSummary(arguments.folder, summary);
    if (options.strict && summary.failures > 0) {
      throw Error(ErrorCode::input, std::to_string(summary.failures) +
                                        (summary.failures == 1 ? " object" : " objects") +
                                        " could not be broken; " + failures + " has the reasons");
    }
    const std::string other = arguments.recipe && summary.complete
                                  ? comparison(*arguments.recipe, summary.folder, callbacks)
                                  : std::string();
    if (arguments.verify) verify(arguments, summary.folder, changed, printer);
    if (!other.empty()) throw Error(ErrorCode::input, other);
  } catch (const Error&) {
    printer.stopped();
    throw;
  }
}

// The index lists drawn values in the order of the command line.
void sortAsGiven(std::vector<DrawnOption>& drawn, const CLI::App& command) {
  const std::vector<CLI::Option*>& given = command.parse_order();
  const auto place = [&](const DrawnOption& option) {
    return std::find(given.begin(), given.end(), command.get_option("--" + option.name));
  };
  std::stable_sort(drawn.begin(), drawn.end(),
                   [&](const DrawnOption& a, const DrawnOption& b) { return place(a) < place(b); });
}

// Adds sentences on options of files that a layout of one kind of file does not have.
void addIdleOfLayout(DatasetLayout layout, const OptionUse& use,
                     std::vector<std::string>& sentences) {
  const bool isHdf5 = layout == DatasetLayout::hdf5;
  for (const char* option : {"removal", "redundant-pieces"}) {
    if (!isHdf5 && use.isGiven(option)) {
      sentences.push_back(use.spelled(option) + " does nothing without --layout hdf5");
    }
  }
  if (!isHdf5 && layout != DatasetLayout::pfpp) return;
  std::vector<const char*> idle{"write",           "mesh-format",  "plain-meshes", "precision",
                                "source-faces",    "voxel-format", "sdf-samples",  "point-format",
                                "correspondences", "share-points"};
  if (isHdf5) {
    idle.insert(idle.end(), {"points", "point-sampler", "point-rule"});
  } else {
    idle.push_back("triangles");
  }
  for (const char* option : idle) {
    if (!use.isGiven(option)) continue;
    sentences.push_back(use.spelled(option) + " does nothing with --layout " +
                        (isHdf5 ? "hdf5, which holds meshes of vertices and faces"
                                : "pfpp, which holds points and their matches"));
  }
}

// Draws what a preset draws, too, but what contradicts a value that another option may get.
void addDraws(const std::string& preset, const CLI::App& command, DatasetOptions& options) {
  const OptionUse use = useOf(command);
  std::vector<DrawnOption> drawn = presetDraws(preset, options.each, use.isGiven);
  for (const DrawnOption& other : options.drawn) {
    const std::vector<std::string> ends =
        other.choices.empty() ? std::vector{other.low, other.high} : other.choices;
    for (const std::string& end : ends) {
      RunOptions each = options.each;
      fractureOption(other.name)->value.set(each, end);
      const std::vector<DrawnOption> possible = presetDraws(preset, each, use.isGiven);
      std::erase_if(drawn, [&](const DrawnOption& option) {
        return std::none_of(possible.begin(), possible.end(),
                            [&](const DrawnOption& one) { return one.name == option.name; });
      });
    }
  }
  options.drawn.insert(options.drawn.end(), drawn.begin(), drawn.end());
}

// Refuses choices, of one drawn option or of several, that contradict another option: the objects
// for which they are drawn would fail.
void checkChoices(const DatasetOptions& options, OptionUse use) {
  constexpr std::size_t kMostTried = 4096;
  std::vector<const DrawnOption*> drawn;
  for (const DrawnOption& option : options.drawn) {
    if (!option.choices.empty()) drawn.push_back(&option);
  }
  const auto isRange = [&](std::string_view name) {
    return std::any_of(options.drawn.begin(), options.drawn.end(), [&](const DrawnOption& option) {
      return option.choices.empty() && option.name == name;
    });
  };
  use.isDrawn = isRange;
  std::vector<std::size_t> at(drawn.size(), 0);
  for (std::size_t tried = 0; tried < kMostTried; ++tried) {
    RunOptions each = options.each;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      fractureOption(drawn[i]->name)->value.set(each, drawn[i]->choices[at[i]]);
    }
    (void)idleOptions(each, use);
    std::size_t next = 0;
    while (next < at.size() && ++at[next] == drawn[next]->choices.size()) at[next++] = 0;
    if (next == at.size()) return;
  }
}

// Returns a sentence for each option that does nothing.
std::vector<std::string> idleOptionsOf(const CLI::App& command, const DatasetArguments& arguments) {
  const DatasetOptions& options = arguments.options;
  OptionUse use = useOf(command);
  use.isDataset = true;
  use.isDrawn = [&](std::string_view name) {
    return std::any_of(options.drawn.begin(), options.drawn.end(),
                       [&](const DrawnOption& option) { return option.name == name; });
  };
  checkChoices(options, use);
  std::vector<std::string> sentences = idleOptions(options.each, use);
  const DatasetLayout layout = options.layout;
  if (use.isGiven("write") && options.each.write.solid &&
      (layout == DatasetLayout::paper || layout == DatasetLayout::bb)) {
    sentences.emplace_back(
        "--write solid does nothing with --layout paper and bb, which hold the intact object once");
  }
  if (use.isGiven("compress") && layout == DatasetLayout::packed &&
      options.compression == FileCompression::zstd) {
    sentences.emplace_back(
        "--compress zstd is the same as zip with --layout packed, which deflates archives");
  }
  addIdleOfLayout(layout, use, sentences);
  if (use.isGiven("licenses") && options.assemblage.most > 1) {
    sentences.push_back(use.spelled("licenses") +
                        " does nothing with --objects, as assemblages have no recipe.json");
  }
  for (const char* option : {"verify", "resume", "replace"}) {
    if (arguments.dryRun && use.isGiven(option)) {
      sentences.push_back(use.spelled(option) +
                          " does nothing with --dry-run, which writes no dataset");
    }
  }
  return sentences;
}

}  // namespace

namespace {

DatasetOptions assemblageDefaults() {
  DatasetOptions options;
  options.assemblage.fewest = 2;
  options.assemblage.most = 5;
  options.poses = true;
  return options;
}

void addFolders(CLI::App& command, DatasetArguments& arguments) {
  command
      .add_option(
          "LIBRARY", arguments.library,
          "A folder of meshes, with all below it, one mesh, or a text file with a path a line")
      ->required();
  command
      .add_option("-o,--output", arguments.folder,
                  "Folder for the dataset: absent, empty, with --resume an unfinished one, or with "
                  "--replace any dataset")
      ->type_name("DIR")
      ->required();
}

// Adds `sherd dataset`, or `sherd assemblage`: the same with other defaults.
CLI::App* addCommand(CLI::App& app, Action& run, bool isAssemblage) {
  CLI::App* command =
      isAssemblage
          ? app.add_subcommand("assemblage", "Mix fragments of several objects of a library")
          : app.add_subcommand("dataset", "Break every mesh of a library, many times each");
  auto arguments = std::make_shared<DatasetArguments>();
  addFolders(*command, *arguments);
  if (isAssemblage) arguments->options = assemblageDefaults();
  addDatasetOptions(*command, arguments->options);
  addRunOptions(*command, *arguments, isAssemblage);
  addMachineOptions(*command, arguments->machine);
  command->add_flag("--json", arguments->json, "Print JSON, an event a line");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but warnings and errors");
  command->footer(
      "In the groups Seeds, Growth, Erosion and Surface a value may be a range, as in\n"
      "--erode-probability 0..0.4, or a choice, as in --sampler 'uniform|poisson'; it is drawn at\n"
      "random for each fracture.");
  command->callback([arguments, command, &run] {
    DatasetOptions& options = arguments->options;
    if (!arguments->recipeFile.empty()) {
      useRecipe(*command, *arguments);
      run = [arguments] { runDatasetCommand(*arguments); };
      return;
    }
    if (!arguments->licenses.empty()) options.library.licenses = readLicenses(arguments->licenses);
    sortAsGiven(options.drawn, *command);
    const CLI::Option* const preset = command->get_option("--preset");
    const bool isPly = preset->count() > 0 && preset->as<std::string>() == "training";
    if (options.layout == DatasetLayout::bb && command->count("--mesh-format") == 0 && !isPly) {
      options.each.write.meshFormats = {MeshFileFormat::obj};
    }
    if (options.layout == DatasetLayout::pfpp && command->count("--points") == 0) {
      options.each.write.points.count = kPointsOfPfpp;
    }
    const bool isOneNumber = options.schedule.fewest == options.schedule.most;
    const bool isPaper = preset->count() > 0 && !isPly;
    const bool isMixed = options.assemblage.most > 1;
    if ((isMixed || (isOneNumber && !isPaper)) && command->count("--repeats") == 0) {
      options.schedule.repeatsOfFewest = options.schedule.repeatsOfMost = 1;
    }
    for (const DrawnOption& drawn : options.drawn) {
      try {
        checkDrawn(drawn, options.each);
      } catch (const Error& e) {
        throw CLI::ValidationError("--" + drawn.name, e.what());
      }
    }
    if (preset->count() > 0) addDraws(preset->as<std::string>(), *command, options);
    arguments->idle = idleOptionsOf(*command, *arguments);
    run = [arguments] { runDatasetCommand(*arguments); };
  });
  return command;
}

}  // namespace

CLI::App* addDatasetCommand(CLI::App& app, Action& run) { return addCommand(app, run, false); }

CLI::App* addAssemblageCommand(CLI::App& app, Action& run) { return addCommand(app, run, true); }

void addMergeCommand(CLI::App& app, Action& run) {
  CLI::App* command = app.add_subcommand("merge", "Join the shards of a dataset");
  auto folder = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  command->add_option("DIR", *folder, "The dataset's folder")->required();
  command->add_flag("--json", *json, "Print JSON");
  command->callback([folder, json, &run] {
    run = [folder, json] {
      DatasetPrinter printer(*json, false);
      const DatasetSummary summary = mergeDataset(*folder, &untilInterrupted());
      for (const std::string& warning : summary.warnings) printer.callbacks().warning(warning);
      printer.printSummary(*folder, summary);
    };
  });
}

}  // namespace sherd::cli
