// Plots an evaluation as SVG: shares, convexity and angles.
#include <sherd/evaluate.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text/formatted.h"
#include "chart/axis.h"
#include "chart/panel.h"
#include "chart/svg.h"

namespace sherd {
namespace {

using chart::kBlue, chart::kGreen, chart::kGray, chart::kInk, chart::kOrange, chart::kRule;
using chart::Panel, chart::Column, chart::column, chart::drawFrame, chart::kBottom, chart::kTop;
using chart::Svg;

constexpr double kEvaluationWidth = 960, kHeight = 360;
constexpr std::size_t kMostLabels = 30;  // ids are omitted above this number of fragments

void drawNumbers(Svg& svg, const Panel& panel, const Evaluation& evaluation,
                 const std::vector<std::size_t>& order) {
  if (order.size() > kMostLabels) return;
  const double size = order.size() > 16 ? 8 : 11;
  for (std::size_t i = 0; i < order.size(); ++i) {
    svg.text(column(panel, i, order.size()).middle(), kBottom + 16,
             std::to_string(evaluation.fragments[order[i]].id), size, kGray, Svg::Anchor::middle);
  }
}

std::string percent(double share) { return formatted("%g %%", std::round(1e4 * share) / 100); }

void drawShares(Svg& svg, const Evaluation& evaluation, const std::vector<std::size_t>& order) {
  const Panel panel{60, 320, 0.0, std::max(1.05 * evaluation.largestShare, 1e-6)};
  drawFrame(svg, panel, "Share of the whole", "fragments, the largest first", percent);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Column at = column(panel, i, order.size());
    const double top = panel.y(evaluation.fragments[order[i]].share);
    svg.rect(at.left, top, at.width, kBottom - top, kBlue);
  }
  drawNumbers(svg, panel, evaluation, order);
}

void drawConvexity(Svg& svg, const Evaluation& evaluation, const std::vector<std::size_t>& order) {
  double least = 0.95;
  for (const FragmentMetrics& f : evaluation.fragments) {
    if (f.convexity) least = std::min(least, f.convexity->value);
  }
  const Panel panel{390, 650, std::floor(least * 10.0 - 0.5) / 10.0, 1.0};
  drawFrame(svg, panel, "Convexity", "fragments, in the same order",
            [](double value) { return formatted("%.2g", std::round(value * 1e6) / 1e6); });
  if (!evaluation.convexity) {
    svg.text((panel.left + panel.right) / 2, (kTop + kBottom) / 2, "no closed mesh", 12, kGray,
             Svg::Anchor::middle);
    return;
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    const FragmentMetrics& f = evaluation.fragments[order[i]];
    const Column at = column(panel, i, order.size());
    if (f.convexity) {
      svg.line(at.middle(), panel.y(1.0), at.middle(), panel.y(f.convexity->value), kRule);
      svg.circle(at.middle(), panel.y(f.convexity->value), std::clamp(at.width / 3, 1.5, 4.5),
                 kOrange);
    } else if (order.size() <= kMostLabels) {
      svg.text(at.middle(), kBottom - 6, "?", 11, kGray, Svg::Anchor::middle);
    }
  }
  svg.line(panel.left, panel.y(*evaluation.convexity), panel.right, panel.y(*evaluation.convexity),
           kOrange, /*dashed=*/true);
  drawNumbers(svg, panel, evaluation, order);
}

void drawAngles(Svg& svg, const Evaluation& evaluation) {
  const MeshQuality& quality = evaluation.quality;
  const double triangles = std::max(1.0, static_cast<double>(quality.triangles));
  const auto most = *std::max_element(quality.smallestAngles.begin(), quality.smallestAngles.end());
  const Panel panel{720, 940, 0.0, std::max(1.05 * static_cast<double>(most) / triangles, 1e-6)};
  drawFrame(svg, panel, "Smallest angles", "degrees", percent);
  constexpr std::size_t kBins = MeshQuality::kAngleBins;
  for (std::size_t i = 0; i < kBins; ++i) {
    const Column at = column(panel, i, kBins);
    const double top = panel.y(static_cast<double>(quality.smallestAngles[i]) / triangles);
    svg.rect(at.left, top, at.width, kBottom - top, i < 2 ? kOrange : kGreen);
  }
  for (int degrees = 0; degrees <= 60; degrees += 10) {
    const double x = panel.left + (panel.right - panel.left) * degrees / 60.0;
    svg.text(x, kBottom + 16, std::to_string(degrees), 11, kGray, Svg::Anchor::middle);
  }
}

std::string subtitle(const Evaluation& evaluation, double voxelSize) {
  std::string text = formatted("%zu fragments, as even as %.2f equal ones",
                               evaluation.fragments.size(), evaluation.effectiveFragments);
  if (evaluation.convexity) text += formatted(", convexity %.3f", *evaluation.convexity);
  if (evaluation.quality.triangles > 0) text += formatted(", %zu sound meshes", evaluation.sound);
  const std::optional<DistanceSummary>& error = evaluation.fit.surfaceError;
  if (error && voxelSize > 0.0) {
    text += formatted(", surface error %.3f voxels", error->mean / voxelSize);
  } else if (error && evaluation.fit.diagonal > 0.0) {
    text += formatted(", surface error %.2g %% of the diagonal",
                      100.0 * error->mean / evaluation.fit.diagonal);
  }
  return text;
}

}  // namespace

std::string evaluationPlot(const Evaluation& evaluation, const std::string& title,
                           double voxelSize) {
  std::vector<std::size_t> order(evaluation.fragments.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return evaluation.fragments[a].share > evaluation.fragments[b].share;
  });
  Svg svg(kEvaluationWidth, kHeight);
  svg.text(24, 34, title, 18, kInk, Svg::Anchor::start, true);
  svg.text(24, 56, subtitle(evaluation, voxelSize), 12, kGray);
  drawShares(svg, evaluation, order);
  drawConvexity(svg, evaluation, order);
  drawAngles(svg, evaluation);
  return svg.done();
}

}  // namespace sherd
