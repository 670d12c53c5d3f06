// Prints the progress and results of a dataset run.
#include "cli/dataset_printer.h"

#include <sherd/error.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/text/printable.h"
#include "cli/terminal/command.h"
#include "cli/terminal/progress_line.h"

namespace sherd::cli {
namespace {

using Json = nlohmann::ordered_json;

void printEvent(const Json& json) {
  printResult(json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::string timeText(double seconds) {
  const auto all = static_cast<long>(std::lround(seconds));
  char text[32];
  if (all >= 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", all / 3600, all / 60 % 60, all % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld", all / 60, all % 60);
  }
  return text;
}

double secondsLeft(const DatasetProgress& progress) {
  if (progress.fractures == 0) return 0.0;
  const double rest =
      static_cast<double>(progress.ofFractures) - static_cast<double>(progress.fractures);
  return std::max(0.0, rest) * progress.seconds / static_cast<double>(progress.fractures);
}

double fragmentsPerSecond(const DatasetProgress& progress) {
  return progress.seconds > 0.0 ? static_cast<double>(progress.fragments) / progress.seconds : 0.0;
}

// Returns the first names, and how many others there are.
std::string namesOf(const std::vector<std::string>& objects) {
  constexpr std::size_t kMost = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(objects.size(), kMost); ++i) {
    text += (i == 0 ? "" : ", ") + printable(objects[i]);
  }
  if (objects.size() > kMost) text += " and " + std::to_string(objects.size() - kMost) + " others";
  return text;
}

}  // namespace

DatasetPrinter::DatasetPrinter(bool json, bool quiet)
    : json_(json), terminal_(!json && !quiet && ::isatty(STDERR_FILENO) == 1), quiet_(quiet) {}

DatasetCallbacks DatasetPrinter::callbacks() {
  DatasetCallbacks callbacks;
  callbacks.fractured = [this](const DatasetProgress& progress) { printProgress(progress); };
  callbacks.failed = [this](const std::string& object, const Error& reason) {
    failed_.push_back(object);
    if (json_)
      return printEvent({{"event", "failed"}, {"object", object}, {"reason", reason.what()}});
    printSentence("sherd: " + object + " failed: " + sentenceOf(reason));
  };
  callbacks.warning = [this](const std::string& sentence) {
    if (json_) return printEvent({{"event", "warning"}, {"warning", sentence}});
    printSentence("sherd: warning: " + sentence);
  };
  return callbacks;
}

void DatasetPrinter::printProgress(const DatasetProgress& progress) {
  const bool isObject = progress.objects != objects_;
  objects_ = progress.objects;
  if (json_) {
    printEvent({{"event", isObject ? "object" : "fracture"},
                {"object", progress.object},
                {"objects", progress.objects},
                {"of_objects", progress.ofObjects},
                {"fractures", progress.fractures},
                {"of_fractures", progress.ofFractures},
                {"fragments", progress.fragments},
                {"seconds", progress.seconds},
                {"seconds_left", secondsLeft(progress)}});
  } else if (terminal_) {
    drawLine(progress);
  } else if (isObject && !quiet_) {
    char text[160];
    std::snprintf(text, sizeof text,
                  ": %zu of %zu objects, %zu fractures, %.1f fragments/s, %s left",
                  progress.objects, progress.ofObjects, progress.fractures,
                  fragmentsPerSecond(progress), timeText(secondsLeft(progress)).c_str());
    printMessage(progress.object + text);
  }
}

void DatasetPrinter::drawLine(const DatasetProgress& progress) {
  const auto now = std::chrono::steady_clock::now();
  if (lineIsDrawn && now - last_ < std::chrono::milliseconds(100)) return;
  const int percent = progress.ofFractures == 0
                          ? 100
                          : static_cast<int>(100 * progress.fractures / progress.ofFractures);
  std::fprintf(
      stderr,
      "\r\x1b[K%3d %%  %zu of %zu objects, %zu of %zu fractures, %.1f fragments/s, %s left  %s",
      percent, progress.objects, progress.ofObjects, progress.fractures, progress.ofFractures,
      fragmentsPerSecond(progress), timeText(secondsLeft(progress)).c_str(),
      printable(progress.object).c_str());
  std::fflush(stderr);
  last_ = now;
  lineIsDrawn = true;
}

void DatasetPrinter::printSentence(const std::string& sentence) {
  clear();
  printMessage(sentence);
}

void DatasetPrinter::clear() {
  if (lineIsDrawn.exchange(false)) std::fputs(kClearLine, stderr);
}

void DatasetPrinter::printSummary(const std::string& folder, const DatasetSummary& summary) {
  clear();
  if (json_) {
    Json seconds = Json::object();
    for (const StageTime& time : summary.times) seconds[time.stage] = time.seconds;
    return printEvent({{"event", "done"},
                       {"folder", folder},
                       {"complete", summary.complete},
                       {"objects", summary.objects},
                       {"failures", summary.failures},
                       {"skipped", summary.skipped},
                       {"fractures", summary.fractures},
                       {"fragments", summary.fragments},
                       {"bytes", summary.bytes},
                       {"seconds", seconds}});
  }
  if (quiet_) return;
  char text[200];
  if (!summary.complete) {
    std::snprintf(text, sizeof text,
                  ": %zu fractures, %zu fragments by this shard; sherd merge joins all shards\n",
                  summary.fractures, summary.fragments);
    return printResult(printable(folder) + text);
  }
  std::snprintf(text, sizeof text,
                ": %zu fractures of %zu objects, %zu fragments, %.3g GB; %zu %s failed%s",
                summary.fractures, summary.objects, summary.fragments,
                static_cast<double>(summary.bytes) * 1e-9, summary.failures,
                summary.failures == 1 ? "object" : "objects", failed_.empty() ? "" : ": ");
  const std::string skipped =
      summary.skipped == 0 ? "" : ", " + std::to_string(summary.skipped) + " paths skipped";
  printResult(printable(folder) + text + namesOf(failed_) + skipped + "\n");
}

void DatasetPrinter::printVerified(const std::string& folder, const DatasetCheck& check) {
  for (const std::string& problem : check.problems) {
    if (json_) {
      printEvent({{"event", "problem"}, {"problem", problem}});
    } else {
      printSentence("sherd: " + problem);
    }
  }
  if (!check.problems.empty()) {
    const std::size_t count = check.problems.size();
    throw Error(ErrorCode::input,
                folder + ": " +
                    (count == 1 ? "1 file is not as it was written"
                                : std::to_string(count) + " files are not as they were written"));
  }
  if (json_) {
    return printEvent({{"event", "verified"}, {"files", check.files}, {"bytes", check.bytes}});
  }
  if (!quiet_)
    printResult(printable(folder) + ": all " + std::to_string(check.files) + " files are whole\n");
}

void DatasetPrinter::printForecast(const DatasetForecast& forecast) {
  for (const std::vector<std::string>& sentences : {forecast.skipped, forecast.renamed}) {
    for (const std::string& sentence : sentences) {
      if (!json_) printSentence("sherd: warning: " + sentence);
    }
  }
  for (const std::string& object : forecast.refused) {
    if (!json_) printSentence("sherd: warning: " + object + " cannot be broken");
  }
  if (json_) {
    return printEvent({{"event", "forecast"},
                       {"objects", forecast.objects},
                       {"fractures", forecast.fractures},
                       {"fragments", forecast.fragments},
                       {"bytes", forecast.bytes},
                       {"seconds", forecast.seconds},
                       {"sampled", forecast.sampled},
                       {"refused", forecast.refused},
                       {"skipped", forecast.skipped},
                       {"renamed", forecast.renamed}});
  }
  char text[200];
  std::snprintf(
      text, sizeof text,
      "%zu fractures of %zu objects, %zu fragments; about %.3g GB in %s, estimated from %zu "
      "objects\n",
      forecast.fractures, forecast.objects, forecast.fragments, forecast.bytes * 1e-9,
      timeText(forecast.seconds).c_str(), forecast.sampled);
  printResult(text);
}

}  // namespace sherd::cli
