// `sherd evaluate`: measures the quality of a finished fracture.
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/mesh.h>
#include <sherd/points.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "cli/cgal_checks.h"
#include "cli/command.h"
#include "cli/evaluate_report.h"
#include "cli/held_files.h"
#include "cli/interrupts.h"
#include "cli/output_path.h"

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;

struct EvaluateArguments {
  std::string folder;
  std::string whole;
  EvaluateOptions options{};
  double tolerancePercent = 100.0 * EvaluateOptions().tolerance;
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

EvaluateReport reportOf(const EvaluateArguments& arguments) {
  EvaluateReport report;
  report.folder = arguments.folder;
  report.set = readFragments(arguments.folder, {.maxMemory = freeMemory()}, &untilInterrupted());
  std::vector<fs::path> inputs{arguments.whole};
  for (const EvaluatedFragment& fragment : report.set.fragments) {
    if (!fragment.name.empty()) inputs.push_back(fs::path(arguments.folder) / fragment.name);
  }
  for (const auto& [option, file] :
       {std::pair("--csv", arguments.csv), {"--plot", arguments.plot}}) {
    if (!file.empty()) requireNoInput(option, file, inputs);
  }
  std::optional<SourceMesh> whole;
  if (!arguments.whole.empty()) {
    whole = readMesh(arguments.whole, {.maxMemory = freeMemory()}, &untilInterrupted());
    report.whole = whole->name;
  }
  report.evaluation =
      evaluate(report.set, whole ? &whole->mesh : nullptr, arguments.options, &untilInterrupted());
  if (arguments.cgal) report.cgal = verdicts(report.set, arguments.options);
  return report;
}

// Returns the source's name, or the folder's.
std::string headline(const EvaluateReport& report) {
  if (report.set.manifest) return report.set.source;
  const fs::path folder = fs::path(report.folder).lexically_normal();
  return (folder.has_filename() ? folder : folder.parent_path()).filename().string();
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
  const EvaluateReport report = reportOf(arguments);
  HeldFiles files;
  if (!arguments.csv.empty()) OutputFile(files, arguments.csv).write(reportCsv(report));
  if (!arguments.plot.empty()) {
    OutputFile(files, arguments.plot)
        .write(evaluationPlot(report.evaluation, headline(report), report.set.voxelSize));
  }
  finish(files, [&] { printResult(arguments.json ? reportJson(report) : reportTable(report)); });
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
  command->add_option("--threads", arguments->threads, "Threads; default all cores")
      ->transform(wholeNumber(1, 4096));
  command->add_flag("--json", arguments->json, "Print one JSON object");
  command->callback([arguments, &run] { run = [arguments] { runEvaluate(*arguments); }; });
}

}  // namespace sherd::cli
