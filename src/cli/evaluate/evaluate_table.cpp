// Prints an evaluation as a table of text.
#include <algorithm>

#include "base/text/formatted.h"
#include "base/text/printable.h"
#include "cli/evaluate/evaluate_report.h"

namespace sherd::cli {
namespace {

std::string title(const EvaluateReport& report) {
  const std::size_t count = report.evaluation.fragments.size();
  std::string text = printable(report.folder) + ": " + std::to_string(count) +
                     (count == 1 ? " fragment" : " fragments");
  if (!report.set.manifest) return text + " (meshes without a manifest)";
  return text + " of " + report.set.source + ", seed " + std::to_string(report.set.seed);
}

std::string fragmentLine(const FragmentMetrics& f) {
  std::string line = formatted("%5d %6.2f %% %13.6g %12.2f %% %9zu", f.id, 100.0 * f.share,
                               f.volume, 100.0 * ratio(f.fractureArea, f.area), f.contacts);
  if (f.quality) {
    line += formatted(" %10zu %7zu %6.1f", f.quality->triangles, faults(*f.quality),
                      f.quality->smallestAngle);
  } else {
    line += "          -       -      -";
  }
  return line + (f.convexity ? formatted(" %10.4f\n", f.convexity->value) : "          -\n");
}

std::string convexityLine(const Evaluation& evaluation) {
  if (!evaluation.convexity) {
    return evaluation.quality.triangles > 0
               ? "convexity              - (no closed mesh here)\n"
               : "convexity              - (no meshes here; sherd fracture --write mesh makes "
                 "them)\n";
  }
  if (!evaluation.convexityStandardError) {
    return formatted("convexity              %.4f\n", *evaluation.convexity);
  }
  return formatted("convexity              %.4f +- %.4f (mean and its standard error)\n",
                   *evaluation.convexity, *evaluation.convexityStandardError);
}

std::string qualityLines(const Evaluation& evaluation) {
  const MeshQuality& q = evaluation.quality;
  const auto meshes = std::count_if(evaluation.fragments.begin(), evaluation.fragments.end(),
                                    [](const FragmentMetrics& f) { return f.quality.has_value(); });
  std::string text = formatted("sound meshes           %zu of %td", evaluation.sound, meshes);
  const std::pair<std::size_t, const char*> kinds[] = {
      {q.boundaryEdges, "boundary edges"},
      {q.nonManifoldEdges, "non-manifold edges"},
      {q.flippedEdges, "flipped edges"},
      {q.nonManifoldVertices, "non-manifold vertices"},
      {q.degenerateTriangles, "triangles without area"},
      {q.duplicateTriangles, "duplicate triangles"}};
  for (const auto& [count, name] : kinds) {
    if (count > 0) text += formatted("; %zu %s", count, name);
  }
  return text + formatted(
                    "\nsmallest angles        mean %.1f, least %.2g degrees; %.2f %% of %zu "
                    "triangles under 10\n",
                    q.meanSmallestAngle, q.smallestAngle, 100.0 * q.sliverShare, q.triangles);
}

/// Returns a line of distances, in voxels where known, else in percent of the diagonal.
std::string distanceLine(const char* name, const std::optional<DistanceSummary>& d,
                         const EvaluateReport& report) {
  if (!d) return {};
  const double voxel = report.set.voxelSize, diagonal = report.evaluation.fit.diagonal;
  const double unit = voxel > 0.0 ? voxel : diagonal / 100.0;
  return formatted("%-22s mean %.4f, 99 %% within %.4f, at most %.4f %s\n", name, d->mean / unit,
                   d->p99 / unit, d->max / unit, voxel > 0.0 ? "voxels" : "% of the diagonal");
}

std::string fitLines(const EvaluateReport& report) {
  const Evaluation& evaluation = report.evaluation;
  const Fit& fit = evaluation.fit;
  std::string text = distanceLine("surface error", fit.surfaceError, report) +
                     distanceLine("missing surface", fit.missing, report) +
                     distanceLine("gap", fit.gap, report);
  if (fit.overlapShare) {
    text += formatted("overlap                %.4f %% of the volume, %.4g deep\n",
                      100.0 * *fit.overlapShare, fit.overlapDepth);
  }
  if (fit.voidShare) {
    text +=
        formatted("void                   %.4f %% of the intact volume\n", 100.0 * *fit.voidShare);
  }
  if (const std::optional<double> error = volumeError(evaluation)) {
    text += formatted("volume error           %+.4f %%\n", 100.0 * *error);
  }
  return text;
}

std::string cgalLine(const EvaluateReport& report) {
  if (report.cgal.empty()) return {};
  std::size_t bounding = 0, crossing = 0, count = 0;
  double sum = 0.0;
  for (const CgalVerdict& v : report.cgal) {
    bounding += v.boundsVolume;
    crossing += v.selfIntersections.value_or(0) > 0;
    if (!v.convexity) continue;
    sum += v.convexity->value;
    ++count;
  }
  std::string text = formatted(
      "CGAL                   %zu of %zu bound a volume, %zu intersect "
      "themselves",
      bounding, report.cgal.size(), crossing);
  if (count > 0)
    text += formatted("; convexity %.4f of %zu", sum / static_cast<double>(count), count);
  return text + "\n";
}

}  // namespace

std::string reportTable(const EvaluateReport& report) {
  const Evaluation& evaluation = report.evaluation;
  std::string text = title(report) + "\n\n";
  text +=
      "   id    share        volume  fracture area  contacts  triangles  faults  angle  "
      "convexity\n";
  for (const FragmentMetrics& f : evaluation.fragments) text += fragmentLine(f);
  text += formatted("\neffective fragments    %.2f of %zu\n", evaluation.effectiveFragments,
                    evaluation.fragments.size());
  text += formatted("shares                 %.2f %% to %.2f %%\n", 100.0 * evaluation.smallestShare,
                    100.0 * evaluation.largestShare);
  text += formatted("volume                 %.6g\n", evaluation.volume);
  text += formatted("fracture area          %.2f %% of all surface\n",
                    100.0 * ratio(evaluation.fractureArea, evaluation.area));
  text += formatted("contacts per fragment  %.2f\n", contactsPerFragment(evaluation));
  text += convexityLine(evaluation);
  if (evaluation.quality.triangles > 0) text += qualityLines(evaluation) + fitLines(report);
  text += cgalLine(report);
  for (const std::string& note : evaluation.notes) text += "note: " + note + "\n";
  return text;
}

}  // namespace sherd::cli
