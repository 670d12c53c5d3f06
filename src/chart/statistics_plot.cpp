// Plots statistics of a fracture as SVG: faces, sizes, and the roughness of cracks or contacts.
#include <sherd/evaluate.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string_view>

#include "base/text/formatted.h"
#include "chart/axis.h"
#include "chart/panel.h"
#include "chart/svg.h"

namespace sherd {
namespace {

using namespace chart;

constexpr double kPlotWidth = 960, kPlotHeight = 360;

std::string percentOf(double share) { return formatted("%g %%", std::round(1e4 * share) / 100); }

/// A panel whose horizontal axis has values too.
struct Plane {
  Panel panel;
  double least, greatest;  ///< at its left and right

  double x(double value) const {
    const double share = std::clamp((value - least) / (greatest - least), 0.0, 1.0);
    return panel.left + share * (panel.right - panel.left);
  }
};

/// Draws how many fragments have each count, with lines at published figures.
void drawCounts(Svg& svg, Panel panel, const std::vector<std::size_t>& counts,
                const std::string& title, std::string_view quantity) {
  std::map<std::size_t, std::size_t> bins;
  for (const std::size_t count : counts) ++bins[count];
  std::size_t most = 0, last = 1;
  for (const auto& [count, fragments] : bins) {
    most = std::max(most, fragments);
    last = std::max(last, count);
  }
  for (const PublishedFigure& figure : publishedFigures()) {
    if (figure.quantity == quantity)
      last = std::max(last, static_cast<std::size_t>(figure.high) + 1);
  }
  const double all = std::max<double>(1.0, static_cast<double>(counts.size()));
  panel.high = std::max(1.05 * static_cast<double>(most) / all, 1e-6);
  drawFrame(svg, panel, title, "number; dashed: published means", percentOf);
  const std::size_t columns = last + 1;
  for (const auto& [count, fragments] : bins) {
    const Column at = column(panel, count, columns);
    const double top = panel.y(static_cast<double>(fragments) / all);
    svg.rect(at.left, top, at.width, kBottom - top, kBlue);
  }
  const auto step =
      std::max<std::size_t>(1, static_cast<std::size_t>(niceStep(static_cast<double>(columns))));
  for (std::size_t i = 0; i <= last; i += step) {
    svg.text(column(panel, i, columns).middle(), kBottom + 16, std::to_string(i), 11, kGray,
             Svg::Anchor::middle);
  }
  const double pitch = (panel.right - panel.left) / static_cast<double>(columns);
  for (const PublishedFigure& figure : publishedFigures()) {
    if (figure.quantity != quantity || figure.low != figure.high) continue;
    const double x = panel.left + pitch * (figure.low + 0.5);
    svg.line(x, kTop, x, kBottom, kOrange, /*dashed=*/true);
  }
}

/// Draws a curve over the logarithm of x.
void drawCurve(Svg& svg, const Plane& plane, const std::function<double(double)>& y,
               const char* color) {
  constexpr int kSteps = 80;
  for (int i = 0; i < kSteps; ++i) {
    const auto at = [&](int k) {
      return plane.least + (plane.greatest - plane.least) * k / kSteps;
    };
    const double a = y(std::exp(at(i))), b = y(std::exp(at(i + 1)));
    if (std::isfinite(a) && std::isfinite(b)) {
      svg.line(plane.x(at(i)), plane.panel.y(a), plane.x(at(i + 1)), plane.panel.y(b), color);
    }
  }
}

void labelLogarithms(Svg& svg, const Plane& plane,
                     const std::function<std::string(double)>& label) {
  const double step =
      std::max(1.0, std::ceil((plane.greatest - plane.least) / std::log(10.0) / 4.0));
  for (double power = std::ceil(plane.least / std::log(10.0));
       power * std::log(10.0) <= plane.greatest; power += step) {
    svg.text(plane.x(power * std::log(10.0)), kBottom + 16, label(std::pow(10.0, power)), 11, kGray,
             Svg::Anchor::middle);
  }
}

/// Draws the share of fragments larger than a size, and the fits.
void drawSizes(Svg& svg, const Panel& panel, const FractureStatistics& s) {
  drawFrame(svg, panel, "Fragments larger than a share", "share of the whole", percentOf);
  std::vector<double> sizes;
  for (const FragmentShape& shape : s.fragments) {
    if (shape.share > 0.0) sizes.push_back(shape.share);
  }
  std::sort(sizes.begin(), sizes.end());
  if (sizes.empty()) return;
  const double low = std::log(sizes.front()), high = std::log(sizes.back());
  const Plane plane{panel, low - 0.1, high + 0.1};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double above = 1.0 - (static_cast<double>(i) + 0.5) / static_cast<double>(sizes.size());
    svg.circle(plane.x(std::log(sizes[i])), panel.y(above), 1.8, kBlue);
  }
  if (s.sizes.exponential) {
    drawCurve(
        svg, plane, [&](double x) { return std::exp(-x / s.sizes.exponential->parameter); },
        kOrange);
    svg.text(panel.right - 4, kTop + 12, "exponential", 11, kOrange, Svg::Anchor::end);
  }
  if (s.sizes.power && high > low) {
    const double b = s.sizes.power->parameter - 1.0, length = high - low;
    drawCurve(
        svg, plane,
        [&](double x) {
          const double y = std::clamp((std::log(x) - low) / length, 0.0, 1.0);
          if (std::abs(b * length) < 1e-9) return 1.0 - y;
          return 1.0 - std::expm1(-b * length * y) / std::expm1(-b * length);
        },
        kGreen);
    svg.text(panel.right - 4, kTop + 28, formatted("power law, tau %.2f", s.sizes.power->parameter),
             11, kGreen, Svg::Anchor::end);
  }
  labelLogarithms(svg, plane, percentOf);
}

/// Draws correlations of heights in log-log axes.
void drawRoughness(Svg& svg, Panel panel, const FractureStatistics& s) {
  Plane plane{panel, 1e300, -1e300};
  plane.panel.low = 1e300;
  plane.panel.high = -1e300;
  for (const RoughnessAlong& along : s.hurst) {
    for (std::size_t i = 0; i < along.lags.size(); ++i) {
      const double lag = std::log(along.lags[i] / s.unit);
      const double value = std::log10(along.correlation[i] / s.unit);
      plane.least = std::min(plane.least, lag - 0.1);
      plane.greatest = std::max(plane.greatest, lag + 0.1);
      plane.panel.low = std::min(plane.panel.low, value - 0.1);
      plane.panel.high = std::max(plane.panel.high, value + 0.1);
    }
  }
  drawFrame(svg, plane.panel, "Correlation of crack heights", "distance, units",
            [](double value) { return formatted("%.3g", std::pow(10.0, value)); });
  labelLogarithms(svg, plane, [](double value) { return formatted("%g", value); });
  const char* colors[] = {kBlue, kOrange, kGreen};
  for (std::size_t k = 0; k < s.hurst.size(); ++k) {
    const RoughnessAlong& along = s.hurst[k];
    for (std::size_t i = 0; i < along.lags.size(); ++i) {
      svg.circle(plane.x(std::log(along.lags[i] / s.unit)),
                 plane.panel.y(std::log10(along.correlation[i] / s.unit)), 2.5, colors[k % 3]);
    }
    svg.text(panel.left + 6, kTop + 12 + 16 * static_cast<double>(k),
             along.direction + formatted(": %.2f", along.hurst), 11, colors[k % 3]);
  }
}

std::string subtitleOf(const FractureStatistics& s) {
  std::string text = formatted("%zu fragments", s.fragments.size());
  const auto add = [&](const char* name, const std::optional<MeanFigure>& figure) {
    if (figure) text += formatted(", %s %.2f", name, figure->mean);
  };
  add("interior faces", s.interiorFaces);
  add("interior vertices", s.interiorVertices);
  add("corners", s.corners);
  add("contacts", s.contacts);
  return text + (s.rule == FaceRule::planes   ? "; faces are planes"
                 : s.rule == FaceRule::splits ? "; faces are cracks of splits"
                                              : "; faces are contacts");
}

}  // namespace

std::string statisticsPlot(const FractureStatistics& s, const std::string& title) {
  Svg svg(kPlotWidth, kPlotHeight);
  svg.text(24, 34, title, 18, kInk, Svg::Anchor::start, true);
  svg.text(24, 56, subtitleOf(s), 12, kGray);
  const bool interior = s.interiorFaces.has_value(), plate = s.corners.has_value();
  std::vector<std::size_t> faces, contacts;
  for (const FragmentShape& shape : s.fragments) {
    contacts.push_back(shape.contacts);
    if (!shape.hasMesh || (interior && !shape.interior)) continue;
    if (!interior && plate && !shape.corners) continue;
    faces.push_back(!interior && plate ? *shape.corners : shape.faces);
  }
  drawCounts(svg, {60, 320, 0.0, 1.0}, faces,
             interior ? "Faces of interior fragments"
             : plate  ? "Corners"
                      : "Faces of cracks",
             interior ? "interior_faces"
             : plate  ? "corners"
                      : "");
  drawSizes(svg, {390, 650, 0.0, 1.0}, s);
  if (s.hurst.empty()) {
    drawCounts(svg, {720, 940, 0.0, 1.0}, contacts, "Contacts", "contacts");
  } else {
    drawRoughness(svg, {720, 940, 0.0, 1.0}, s);
  }
  return svg.done();
}

}  // namespace sherd
