// OUT/report.html.
#include "dataset/report/report.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include "base/files/atomic_file.h"
#include "base/files/file_bytes.h"
#include "base/text/base64.h"
#include "base/text/formatted.h"
#include "base/version.h"
#include "chart/charts.h"
#include "chart/svg.h"
#include "dataset/journal/object_folder.h"
#include "dataset/report/run_record.h"
#include "dataset/report/thumbnails.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

using chart::escapedXml, chart::HistogramOptions, chart::HistogramRow;

std::string bytesText(double bytes) {
  constexpr const char* kUnits[] = {"B", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  while (bytes >= 1000.0 && unit < 4) {
    bytes /= 1000.0;
    ++unit;
  }
  return formatted(unit == 0 ? "%.0f %s" : "%.3g %s", bytes, kUnits[unit]);
}

std::string secondsText(double seconds) {
  if (seconds < 120.0) return formatted("%.3g s", seconds);
  if (seconds < 7200.0) return formatted("%.3g min", seconds / 60.0);
  return formatted("%.3g h", seconds / 3600.0);
}

// 1500 as 1.5k.
std::string countText(double count) {
  return count >= 1e6   ? formatted("%gM", count / 1e6)
         : count >= 1e3 ? formatted("%gk", count / 1e3)
                        : formatted("%g", count);
}

std::string percentText(double share) { return formatted("%g %%", std::round(share * 1e4) / 1e2); }

std::string row(const std::vector<std::string>& cells, const char* tag = "td") {
  std::string text = "<tr>";
  for (const std::string& cell : cells) {
    text += std::string("<") + tag + ">" + escapedXml(cell) + "</" + tag + ">";
  }
  return text + "</tr>\n";
}

std::string section(const std::string& title, const std::string& body) {
  return "<h2>" + title + "</h2>\n" + body + "\n";
}

// The mean over all fragments.
double mean(const DatasetStatistics& statistics, std::vector<float> FragmentStatistics::*values) {
  double sum = 0.0;
  for (const auto& [pieces, own] : statistics.byPieces) {
    for (const float value : own.*values) sum += static_cast<double>(value);
  }
  return sum / static_cast<double>(std::max<std::size_t>(statistics.fragments, 1));
}

// The rows of the paper's Table 3.
std::string table3(const DatasetStatistics& statistics, const std::vector<RunStatistics>& runs) {
  const auto files = [](const FileStatistics& kind) {
    return formatted("%zu (%s)", kind.files, bytesText(static_cast<double>(kind.bytes)).c_str());
  };
  double seconds = 0.0;
  for (const RunStatistics& run : runs) seconds += run.seconds;
  std::string text = "<table id=\"table3\">\n";
  text += row({"Voxel files", files(statistics.voxels)});
  text += row({"Triangle mesh files", files(statistics.meshes)});
  text += row({"Point cloud files", files(statistics.points)});
  text += row({"Models", std::to_string(statistics.objects)});
  text += row({"Fractures", std::to_string(statistics.fractures)});
  text += row({"Fragments", std::to_string(statistics.fragments)});
  text += row({"Response time", secondsText(seconds)});
  text += row({"Fragments / s", formatted("%.2f", static_cast<double>(statistics.fragments) /
                                                      std::max(seconds, 1e-9))});
  text +=
      row({"Average vertices", formatted("%.0f", mean(statistics, &FragmentStatistics::vertices))});
  text += row({"Average faces", formatted("%.0f", mean(statistics, &FragmentStatistics::faces))});
  return text + "</table>";
}

// One row per number of pieces, or per range of it where there are more than kMostRows.
std::vector<HistogramRow> rowsOf(const DatasetStatistics& statistics,
                                 std::vector<float> FragmentStatistics::*values) {
  constexpr std::size_t kMostRows = 12;
  const std::size_t each = (statistics.byPieces.size() + kMostRows - 1) / kMostRows;
  std::vector<HistogramRow> rows;
  std::size_t i = 0;
  int first = 0;
  for (const auto& [pieces, own] : statistics.byPieces) {
    if (i++ % each == 0) {
      rows.emplace_back();
      first = pieces;
    }
    HistogramRow& current = rows.back();
    current.name = first == pieces ? std::to_string(pieces)
                                   : std::to_string(first) + ".." + std::to_string(pieces);
    current.values.insert(current.values.end(), (own.*values).begin(), (own.*values).end());
  }
  return rows;
}

std::string histogramOf(const DatasetStatistics& statistics,
                        std::vector<float> FragmentStatistics::*values, HistogramOptions options) {
  options.high = 0.0;
  for (const auto& [pieces, own] : statistics.byPieces) {
    for (const float value : own.*values) {
      options.high = std::max(options.high, static_cast<double>(value));
    }
  }
  options.high = std::max(options.high * 1.0001, 1e-6);
  return chart::histograms(rowsOf(statistics, values), options);
}

std::string histogramsText(const DatasetStatistics& statistics) {
  std::string text = "<p>Rows: the number of pieces of a fracture.</p>\n<div class=\"charts\">";
  text += histogramOf(statistics, &FragmentStatistics::faces,
                      {.title = "Faces of fragments", .label = countText});
  text += histogramOf(statistics, &FragmentStatistics::vertices,
                      {.title = "Vertices of fragments", .label = countText});
  text += histogramOf(
      statistics, &FragmentStatistics::share,
      {.title = "Share of the object's volume", .lines = {0.025, 0.1}, .label = percentText});
  text += "</div>\n<table>\n" +
          row({"Pieces", "Fractures", "Fragments", "below 2.5 %", "below 10 %"}, "th");
  for (const auto& [pieces, own] : statistics.byPieces) {
    const auto below = [&share = own.share](float least) {
      const auto count =
          std::count_if(share.begin(), share.end(), [&](float s) { return s < least; });
      return percentText(static_cast<double>(count) /
                         static_cast<double>(std::max<std::size_t>(share.size(), 1)));
    };
    text += row({std::to_string(pieces), std::to_string(own.fractures),
                 std::to_string(own.share.size()), below(0.025f), below(0.1f)});
  }
  return text + "</table>";
}

std::string runsText(const std::vector<RunStatistics>& runs) {
  constexpr std::size_t kMostRuns = 8;  // more are shards of a cluster, which are much alike
  std::string text;
  for (std::size_t i = 0; i < std::min(runs.size(), kMostRuns); ++i) {
    const RunStatistics& run = runs[i];
    text += "<h3>" + escapedXml(run.name + ", " + secondsText(run.seconds) + ", " + run.device) +
            "</h3>\n<div class=\"charts\">";
    text += chart::bars({run.stages.begin(), run.stages.end()}, "Stages, over all threads",
                        secondsText);
    text += chart::timeLine(run.sampleSeconds, run.cores, "Busy cores", countText);
    text += chart::timeLine(run.sampleSeconds, run.memory, "Memory", bytesText);
    text += chart::timeLine(run.sampleSeconds, run.deviceMemory, "Memory of the device", bytesText);
    text += "</div>\n";
  }
  if (runs.size() > kMostRuns) {
    text += "<p>And " + std::to_string(runs.size() - kMostRuns) + " more.</p>\n";
  }
  return text;
}

std::string storageText(const DatasetStatistics& statistics) {
  std::vector<std::pair<std::string, double>> bytes;
  for (const auto& [name, files] : statistics.byFormat) {
    bytes.emplace_back(name, static_cast<double>(files.bytes));
  }
  std::string text = "<div class=\"charts\">" + chart::bars(bytes, "Bytes", bytesText) + "</div>\n";
  text += "<table>\n" + row({"Format", "Files", "Bytes"}, "th");
  for (const auto& [name, files] : statistics.byFormat) {
    text += row({name, std::to_string(files.files), std::to_string(files.bytes)});
  }
  return text + "</table>";
}

std::string failuresText(const DatasetStatistics& statistics) {
  constexpr std::size_t kMost = 500;
  if (statistics.failures.empty()) return "<p>None.</p>";
  std::string text = "<table id=\"failures\">\n" + row({"Object", "Reason"}, "th");
  for (std::size_t i = 0; i < std::min(statistics.failures.size(), kMost); ++i) {
    text += row({statistics.failures[i].first, statistics.failures[i].second});
  }
  text += "</table>";
  if (statistics.failures.size() > kMost) {
    text += "<p>And " + std::to_string(statistics.failures.size() - kMost) +
            " more, see failures.jsonl.</p>";
  }
  return text;
}

// A path as a link from the report: bytes that have a meaning in links are escaped.
std::string linkTo(const std::string& path) {
  std::string link;
  for (const char c : path) {
    const bool isPlain = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                         std::string_view("/-_.").find(c) != std::string_view::npos;
    link += isPlain ? std::string(1, c)
                    : formatted("%%%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
  }
  return link;
}

std::string figureText(const Thumbnail& image) {
  const std::string caption = escapedXml(image.caption);
  const std::string begin = image.viewer.empty() ? "" : "<a href=\"" + linkTo(image.viewer) + "\">";
  return "<figure>" + begin +
         formatted("<img width=\"%d\" height=\"%d\" alt=\"", kThumbnailSide, kThumbnailSide) +
         caption + "\" src=\"data:image/png;base64," + base64(readFileBytes(image.file)) + "\">" +
         (image.viewer.empty() ? "" : "</a>") + "<figcaption>" + caption +
         "</figcaption></figure>\n";
}

std::string contactSheet(const DatasetStatistics& statistics) {
  std::string text = "<div class=\"sheet\">\n";
  for (const Thumbnail& image : statistics.thumbnails) {
    text += figureText(image);
  }
  return text + "</div>";
}

constexpr const char* kStyle =
    "body{font:15px/1.5 'DejaVu Sans',Helvetica,Arial,sans-serif;color:#222;max-width:1240px;"
    "margin:2em auto;padding:0 1em}"
    "h1{font-size:1.5em}h2{font-size:1.2em;border-bottom:1px solid #ddd;margin-top:2em}"
    "h3{font-size:1em}"
    "table{border-collapse:collapse}td,th{padding:.15em 1em .15em 0;text-align:left;"
    "vertical-align:top}th{color:#777;font-weight:normal}"
    ".charts,.sheet{display:flex;flex-wrap:wrap;gap:12px}"
    "figure{margin:0;width:200px}figcaption{font-size:11px;color:#777;overflow-wrap:anywhere}";

}  // namespace

void writeReport(const fs::path& out, const DatasetStatistics& statistics) {
  const std::vector<RunStatistics> runs = readRuns(out);
  const std::string name = fs::absolute(out).lexically_normal().filename().string();
  const std::string title = name.empty() ? "Dataset" : name;
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>" +
      escapedXml(title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n";
  page += "<h1>" + escapedXml(title) + "</h1>\n";
  page += formatted("<p>%zu fragments of %zu fractures of %zu objects; %zu failed. sherd %s.</p>\n",
                    statistics.fragments, statistics.fractures, statistics.objects,
                    statistics.failures.size(), SHERD_VERSION);
  page += section("Objects and fractures", contactSheet(statistics));
  page += section("Details", table3(statistics, runs));
  page += section("Fragments", histogramsText(statistics));
  page += section("Time and resources", runsText(runs));
  page += section("Storage", storageText(statistics));
  page += section("Failures", failuresText(statistics));
  writeWhole(out / kReportName, page + "</body>\n</html>\n");
}

}  // namespace sherd
