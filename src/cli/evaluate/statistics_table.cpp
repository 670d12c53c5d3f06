// Prints statistics of a fracture as a table of text, beside published figures.
#include <array>
#include <string_view>

#include "base/text/formatted.h"
#include "base/text/printable.h"
#include "cli/evaluate/statistics_report.h"

namespace sherd::cli {
namespace {

std::string valueLine(const char* name, const std::string& value) {
  return formatted("%-26s", name) + " " + value + "\n";
}

std::string publishedLines(std::string_view quantity) {
  std::string text;
  for (const PublishedFigure& figure : publishedFigures()) {
    if (figure.quantity != quantity) continue;
    const std::string value = figure.low == figure.high
                                  ? formatted("%g", figure.low)
                                  : formatted("%g to %g", figure.low, figure.high);
    text += formatted("    %-12s", value.c_str()) + " " + figure.of + " (" + figure.source + ")\n";
  }
  return text;
}

std::string meanLines(const char* name, const std::optional<MeanFigure>& figure,
                      const char* quantity) {
  if (!figure) return {};
  return valueLine(name, formatted("%.2f +- %.2f (%zu fragments)", figure->mean,
                                   figure->standardError(), figure->count)) +
         publishedLines(quantity);
}

std::string statisticsTitle(const StatisticsReport& report) {
  const std::size_t count = report.statistics.fragments.size();
  std::string text = printable(report.folder) + ": " + std::to_string(count) +
                     (count == 1 ? " fragment" : " fragments");
  if (!report.set.manifest) return text + " (meshes without a manifest)\n";
  return text + " of " + report.set.source + ", seed " + std::to_string(report.set.seed) + "\n";
}

std::string ruleLines(const FractureStatistics& s) {
  std::string text =
      s.rule == FaceRule::planes   ? formatted("faces are planes, within %.3g", s.planeTolerance)
      : s.rule == FaceRule::splits ? std::string("faces are the cracks of one split")
      : s.rule == FaceRule::facets ? std::string("faces are facets of rough cracks")
                                   : std::string("faces are contacts with one neighbor");
  return text + formatted("; areas below %.3g are not counted (unit %.3g)\n", s.leastArea, s.unit);
}

std::string fitLine(const char* name, const char* parameter,
                    const std::optional<DistributionFit>& fit, const char* quantity) {
  if (!fit) return valueLine(name, "-");
  return valueLine(name, formatted("%s %.4g +- %.2g; distance %.4f, p = %.4f%s", parameter,
                                   fit->parameter, fit->standardError, fit->distance, fit->pValue,
                                   fit->pValue < 0.05 ? ", rejected" : "")) +
         publishedLines(quantity);
}

std::string sizeLines(const SizeFits& sizes) {
  std::string text = valueLine(
      "shares", formatted("%.4g %% to %.4g %%", 100.0 * sizes.least, 100.0 * sizes.greatest));
  return text + fitLine("  exponential", "mean", sizes.exponential, "exponential_p") +
         fitLine("  lognormal", "s", sizes.lognormal, "") +
         fitLine("  power law", "tau", sizes.power, "tau");
}

std::string crackLines(const FractureStatistics& s) {
  std::string text;
  if (s.orientation) {
    const glm::dvec3& v = *s.orientation;
    text += valueLine("orientation of cracks",
                      formatted("%.3f, %.3f, %.3f (1/3 each if isotropic)", v.x, v.y, v.z));
  }
  if (s.roughness) {
    text += valueLine("rms height of cracks", formatted("%.3f units", *s.roughness / s.unit));
  }
  for (const RoughnessAlong& along : s.hurst) {
    const std::string name = "Hurst exponent, " + along.direction;
    text += valueLine(name.c_str(), formatted("%.3f (%zu cracks, deviation %.3f)", along.hurst,
                                              along.cracks, along.deviation));
    const bool axis = along.direction.size() == 1;
    text += publishedLines(axis ? "" : "hurst_" + along.direction);
  }
  if (!s.hurst.empty()) text += publishedLines("hurst");
  return text;
}

std::string jointLines(const FractureStatistics& s) {
  if (!s.joints) return {};
  const std::array<double, 4>& gap = s.joints->gap;
  std::string text =
      valueLine("gap, % of the diagonal",
                formatted("%.4f; 10 %% below %.4f, 90 %% below %.4f, 99 %% below %.4f",
                          100.0 * gap[1], 100.0 * gap[0], 100.0 * gap[2], 100.0 * gap[3]));
  if (s.joints->difference) {
    text += valueLine("difference of both sides",
                      formatted("%.4f %% of the diagonal, rms", 100.0 * *s.joints->difference));
  }
  if (s.joints->removed) {
    text += valueLine("removed from cracks", formatted("%.2f %%", 100.0 * *s.joints->removed));
  }
  return text + valueLine("inside other fragments",
                          formatted("%.2f %% of the surface", 100.0 * s.joints->deepShare));
}

std::string gridLine(const std::optional<GridTrace>& grid) {
  if (!grid) return {};
  return valueLine("grid of voxels",
                   formatted("power %.2f +- %.2f, found in %.0f %% of %zu fragments; pitch %.4g%s",
                             grid->power, grid->standardError, 100.0 * grid->found, grid->fragments,
                             grid->pitch, grid->isKnown ? "" : ", a guess"));
}

std::string traceLines(const FractureStatistics& s) {
  if (s.objects == 0) return {};
  std::string text = valueLine("coincident vertices", formatted("%.1f %%", 100.0 * s.coincident)) +
                     gridLine(s.grid);
  if (s.unmatched > 0.0) {
    text += valueLine("cracks without neighbor",
                      formatted("%.2f %% of their area", 100.0 * s.unmatched));
  }
  if (s.consecutiveExcess) {
    text += valueLine("order of fragments",
                      formatted("share of the first %.3f, mean %.3f; consecutive ones touch %+.3f "
                                "more often than any two",
                                s.fragments[0].share, 1.0 / static_cast<double>(s.fragments.size()),
                                *s.consecutiveExcess));
  }
  return text + valueLine("objects", formatted("%zu", s.objects));
}

}  // namespace

std::string statisticsTable(const StatisticsReport& report) {
  const FractureStatistics& s = report.statistics;
  std::string text = statisticsTitle(report) + ruleLines(s) + "\n";
  text += meanLines("faces, interior", s.interiorFaces, "interior_faces");
  text += meanLines("vertices, interior", s.interiorVertices, "interior_vertices");
  text += meanLines("neighbors, interior", s.interiorNeighbors, "");
  text += meanLines("faces of cracks", s.faces, "");
  text += meanLines("faces, original too", s.flatFaces, s.interiorFaces ? "" : "interior_faces");
  text += meanLines("vertices, original too", s.flatVertices,
                    s.interiorVertices ? "" : "interior_vertices");
  text += meanLines("corners across the plate", s.corners, "corners");
  text += meanLines("contacts per fragment", s.contacts, "contacts");
  text += meanLines("neighbors", s.neighbors, "");
  text += valueLine("break area, median", formatted("%.4f of a fragment's surface", s.breakShare)) +
          publishedLines("break_share");
  text += sizeLines(s.sizes) + crackLines(s) + jointLines(s) + traceLines(s);
  for (const std::string& note : s.notes) text += "note: " + note + "\n";
  return text;
}

}  // namespace sherd::cli
