// `sherd evaluate`: measures the quality of a finished fracture.
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/mesh.h>
#include <sherd/options.h>
#include <sherd/points.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "cli/arguments/option_text.h"
#include "cli/evaluate/cgal_checks.h"
#include "cli/evaluate/evaluate_report.h"
#include "cli/evaluate/statistics_report.h"
#include "cli/terminal/command.h"
#include "cli/terminal/held_files.h"
#include "cli/terminal/interrupts.h"
#include "cli/terminal/output_path.h"

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;

struct EvaluateArguments {
  std::string folder;
  std::string whole;
  EvaluateOptions options{};
  double tolerancePercent = 100.0 * EvaluateOptions().tolerance;
  bool statistics = false;
  StatisticsOptions statisticsOptions{};
  std::string faces = "auto";
  std::vector<double> propagation{};  ///< empty, or three
  std::string csv;
  std::string plot;
  int threads = 0;  ///< 0: all cores
  bool cgal = false;
  bool json = false;
};

std::vector<CgalVerdict> verdicts(const FragmentSet& set, const EvaluateOptions& options) {
  std::vector<CgalVerdict> result(set.fragments.size());
  tbb::parallel_for(std::size_t{0}, result.size(), [&](std::size_t i) {
    stopIfInterrupted();
    const TriangleMesh& mesh = set.fragments[i].mesh.mesh;
    if (!mesh.triangles.empty()) result[i] = checkWithCgal(mesh, options.samples, options.seed);
  });
  return result;
}

/// Reads the folder, and refuses to write over it.
FragmentSet fragmentsOf(const EvaluateArguments& arguments) {
  FragmentSet set =
      readFragments(arguments.folder, {.maxMemory = freeMemory()}, &untilInterrupted());
  std::vector<fs::path> inputs{arguments.whole};
  for (const EvaluatedFragment& fragment : set.fragments) {
    if (!fragment.name.empty()) inputs.push_back(fs::path(arguments.folder) / fragment.name);
  }
  for (const auto& [option, file] :
       {std::pair("--csv", arguments.csv), {"--plot", arguments.plot}}) {
    if (!file.empty()) requireNoInput(option, file, inputs);
  }
  return set;
}

EvaluateReport reportOf(const EvaluateArguments& arguments) {
  EvaluateReport report;
  report.folder = arguments.folder;
  report.set = fragmentsOf(arguments);
  std::optional<SourceMesh> whole;
  if (!arguments.whole.empty()) {
    whole = readMesh(arguments.whole, {.maxMemory = freeMemory()}, &untilInterrupted());
    report.whole = whole->name;
    if (report.set.offset) whole->mesh = moved(std::move(whole->mesh), -*report.set.offset);
  }
  report.evaluation =
      evaluate(report.set, whole ? &whole->mesh : nullptr, arguments.options, &untilInterrupted());
  if (arguments.cgal) report.cgal = verdicts(report.set, arguments.options);
  return report;
}

// Returns the source's name, or the folder's.
std::string headline(const FragmentSet& set, const std::string& path) {
  if (set.manifest) return set.source;
  const fs::path folder = fs::path(path).lexically_normal();
  return (folder.has_filename() ? folder : folder.parent_path()).filename().string();
}

void runStatistics(EvaluateArguments& arguments) {
  StatisticsOptions& options = arguments.statisticsOptions;
  options.seed = arguments.options.seed;
  options.tolerance = arguments.options.tolerance;
  if (arguments.faces == "planes") options.faces = FaceRule::planes;
  if (arguments.faces == "neighbors") options.faces = FaceRule::neighbors;
  if (arguments.faces == "splits") options.faces = FaceRule::splits;
  if (arguments.faces == "facets") options.faces = FaceRule::facets;
  if (const std::vector<double>& p = arguments.propagation; !p.empty()) {
    options.propagation = glm::dvec3(p[0], p[1], p[2]);
  }
  StatisticsReport report;
  report.folder = arguments.folder;
  report.set = fragmentsOf(arguments);
  report.statistics = statistics(report.set, options, &untilInterrupted());
  HeldFiles files;
  if (!arguments.csv.empty()) OutputFile(files, arguments.csv).write(statisticsCsv(report));
  if (!arguments.plot.empty()) {
    OutputFile(files, arguments.plot)
        .write(statisticsPlot(report.statistics, headline(report.set, report.folder)));
  }
  finish(files,
         [&] { printResult(arguments.json ? statisticsJson(report) : statisticsTable(report)); });
}

void runEvaluate(EvaluateArguments& arguments) {
  if (arguments.cgal && !hasCgalChecks()) {
    throw Error(ErrorCode::usage,
                "--cgal: CGAL's mesh checks are under the GPL and not in this build; configure it "
                "with -DSHERD_GPL=ON to have them");
  }
  std::optional<tbb::global_control> threads;
  if (arguments.threads > 0) {
    threads.emplace(tbb::global_control::max_allowed_parallelism,
                    static_cast<std::size_t>(arguments.threads));
  }
  if (!arguments.csv.empty() && !arguments.plot.empty()) {
    requireDifferent("--plot", arguments.plot, "--csv", arguments.csv);
  }
  arguments.options.tolerance = arguments.tolerancePercent / 100.0;
  if (arguments.statistics) return runStatistics(arguments);
  const EvaluateReport report = reportOf(arguments);
  HeldFiles files;
  if (!arguments.csv.empty()) OutputFile(files, arguments.csv).write(reportCsv(report));
  if (!arguments.plot.empty()) {
    OutputFile(files, arguments.plot)
        .write(evaluationPlot(report.evaluation, headline(report.set, report.folder),
                              report.set.voxelSize));
  }
  finish(files, [&] { printResult(arguments.json ? reportJson(report) : reportTable(report)); });
}

// --mesh, --samples and --cgal measure what --statistics leaves out.
void addStatisticsOptions(CLI::App& command, EvaluateArguments& arguments) {
  StatisticsOptions& options = arguments.statisticsOptions;
  CLI::Option* statistics = command.add_flag(
      "--statistics", arguments.statistics,
      "Measure shapes, sizes and cracks beside published figures, in place of quality and fit");
  for (const char* other : {"--mesh", "--samples", "--cgal"}) {
    statistics->excludes(command.get_option(other));
  }
  command
      .add_option(
          "--faces", arguments.faces,
          "A face is a plane, the contact with one neighbor, the crack of one split, or a facet, "
          "which is a plane but for relief; auto: splits of a manifest that has some, else facets "
          "if the cracks are rough, else planes")
      ->check(CLI::IsMember({"auto", "planes", "neighbors", "splits", "facets"}))
      ->type_name("")
      ->capture_default_str()
      ->needs(statistics);
  command
      .add_option("--unit", options.unit,
                  "World units, of the next two; default: a voxel, or without a manifest 1/128 of "
                  "the longest side")
      ->check(numberBetween(1e-100, 1e100, "1e-100..1e100"))
      ->needs(statistics);
  command
      .add_option("--plane-tolerance", options.planeTolerance,
                  "Rms distance up to which triangles lie in one plane, in units")
      ->check(numberBetween(1e-9, 1e9, "1e-9..1e9"))
      ->capture_default_str()
      ->needs(statistics);
  command
      .add_option("--least-face", options.leastFace,
                  "Area, in units squared, below which no face is counted")
      ->check(numberBetween(0.0, 1e9, "0..1e9"))
      ->capture_default_str()
      ->needs(statistics);
  command
      .add_option("--propagation", arguments.propagation,
                  "Direction dx,dy,dz in which cracks ran, for Hurst exponents; default: the "
                  "coordinate axes")
      ->delimiter(',')
      ->expected(3)
      ->type_name("dx,dy,dz")
      ->check(numberBetween(-1e9, 1e9, "a number"))
      ->needs(statistics);
}

}  // namespace

void addEvaluateCommand(CLI::App& app, Action& run) {
  CLI::App* command = app.add_subcommand(
      "evaluate", "Measure the fragments of a fracture, or of any folder of meshes");
  auto arguments = std::make_shared<EvaluateArguments>();
  command
      ->add_option("DIR", arguments->folder,
                   "The folder of a fracture, or one that holds a mesh for each fragment")
      ->required();
  command->add_option(
      "--mesh", arguments->whole,
      "The intact mesh: measure the distance of the fragments' surface from it, and "
      "compare volumes");
  command
      ->add_option("--samples", arguments->options.samples,
                   "Points per fragment, on its surface and inside it")
      ->transform(wholeNumber<std::size_t>(1, 1000000))
      ->capture_default_str();
  command->add_option("--seed", arguments->options.seed, "Seed of these points")
      ->transform(wholeNumber<std::uint64_t>(0, std::numeric_limits<std::uint64_t>::max()))
      ->capture_default_str();
  command
      ->add_option(
          "--tolerance", arguments->tolerancePercent,
          "Percent of the diagonal: distance at which surfaces count as matching, where meshes "
          "have no neighbor per face")
      ->check(CLI::Range(1e-6, 10.0))
      ->capture_default_str();
  command->add_option("--csv", arguments->csv, "Also write a row for each fragment to this file");
  command->add_option("--plot", arguments->plot,
                      "Also write a plot of shares, convexity and angles to this .svg");
  command->add_flag(
      "--cgal", arguments->cgal,
      "Also check with CGAL whether each mesh is closed, bounds a volume or intersects "
      "itself, and measure its convexity; needs a build with SHERD_GPL=ON");
  addStatisticsOptions(*command, *arguments);
  command->add_option("--threads", arguments->threads, "Threads; default all cores")
      ->transform(wholeNumber(1, 4096));
  command->add_flag("--json", arguments->json, "Print one JSON object");
  command->callback([arguments, &run] { run = [arguments] { runEvaluate(*arguments); }; });
}

}  // namespace sherd::cli
