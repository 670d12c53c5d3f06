// What a dataset run tells.
#include "cli/dataset_telling.h"

#include <sherd/error.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/progress_line.h"

namespace sherd::cli {
namespace {

using Json = nlohmann::ordered_json;

void event(const Json& json) {
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

double leftOf(const DatasetProgress& told) {
  if (told.fractures == 0) return 0.0;
  const double rest = static_cast<double>(told.ofFractures) - static_cast<double>(told.fractures);
  return std::max(0.0, rest) * told.seconds / static_cast<double>(told.fractures);
}

double rateOf(const DatasetProgress& told) {
  return told.seconds > 0.0 ? static_cast<double>(told.fragments) / told.seconds : 0.0;
}

}  // namespace

DatasetTelling::DatasetTelling(bool json, bool quiet)
    : json_(json), terminal_(!json && !quiet && ::isatty(STDERR_FILENO) == 1), quiet_(quiet) {}

DatasetWatch DatasetTelling::watch() {
  DatasetWatch watch;
  watch.progress = [this](const DatasetProgress& told) { progress(told); };
  watch.failed = [this](const std::string& object, const std::string& reason) {
    if (json_) return event({{"event", "failed"}, {"object", object}, {"reason", reason}});
    say("sherd: " + object + " failed: " + reason);
  };
  watch.warning = [this](const std::string& sentence) {
    if (json_) return event({{"event", "warning"}, {"warning", sentence}});
    say("sherd: warning: " + sentence);
  };
  return watch;
}

void DatasetTelling::progress(const DatasetProgress& told) {
  const bool isObject = told.objects != objects_;
  objects_ = told.objects;
  if (json_) {
    event({{"event", isObject ? "object" : "fracture"},
           {"object", told.object},
           {"objects", told.objects},
           {"of_objects", told.ofObjects},
           {"fractures", told.fractures},
           {"of_fractures", told.ofFractures},
           {"fragments", told.fragments},
           {"seconds", told.seconds},
           {"seconds_left", leftOf(told)}});
  } else if (terminal_) {
    line(told);
  } else if (isObject && !quiet_) {
    char text[160];
    std::snprintf(text, sizeof text,
                  ": %zu of %zu objects, %zu fractures, %.1f fragments/s, %s left", told.objects,
                  told.ofObjects, told.fractures, rateOf(told), timeText(leftOf(told)).c_str());
    printMessage(told.object + text);
  }
}

void DatasetTelling::line(const DatasetProgress& told) {
  const auto now = std::chrono::steady_clock::now();
  if (lineIsDrawn && now - last_ < std::chrono::milliseconds(100)) return;
  const int percent =
      told.ofFractures == 0 ? 100 : static_cast<int>(100 * told.fractures / told.ofFractures);
  std::fprintf(
      stderr,
      "\r\x1b[K%3d %%  %zu of %zu objects, %zu of %zu fractures, %.1f fragments/s, %s left  %s",
      percent, told.objects, told.ofObjects, told.fractures, told.ofFractures, rateOf(told),
      timeText(leftOf(told)).c_str(), told.object.c_str());
  std::fflush(stderr);
  last_ = now;
  lineIsDrawn = true;
}

void DatasetTelling::say(const std::string& sentence) {
  clear();
  printMessage(sentence);
}

void DatasetTelling::clear() {
  if (lineIsDrawn.exchange(false)) std::fputs(kClearLine, stderr);
}

void DatasetTelling::done(const std::string& folder, const DatasetSummary& summary) {
  clear();
  if (json_) {
    Json seconds = Json::object();
    for (const StageTime& time : summary.times) seconds[time.stage] = time.seconds;
    return event({{"event", "done"},
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
    return printResult(folder + text);
  }
  std::snprintf(text, sizeof text,
                ": %zu fractures of %zu objects, %zu fragments, %.3g GB; %zu objects failed",
                summary.fractures, summary.objects, summary.fragments,
                static_cast<double>(summary.bytes) * 1e-9, summary.failures);
  const std::string skipped =
      summary.skipped == 0 ? "" : ", " + std::to_string(summary.skipped) + " paths skipped";
  printResult(folder + text + skipped + "\n");
}

void DatasetTelling::verified(const std::string& folder, const DatasetCheck& check) {
  for (const std::string& problem : check.problems) {
    if (json_) {
      event({{"event", "problem"}, {"problem", problem}});
    } else {
      say("sherd: " + problem);
    }
  }
  if (!check.problems.empty()) {
    throw Error(ErrorCode::input, folder + ": " + std::to_string(check.problems.size()) +
                                      " files are not as they were written");
  }
  if (json_) {
    return event({{"event", "verified"}, {"files", check.files}, {"bytes", check.bytes}});
  }
  if (!quiet_) printResult(folder + ": all " + std::to_string(check.files) + " files are whole\n");
}

void DatasetTelling::forecast(const DatasetForecast& forecast) {
  for (const std::vector<std::string>& sentences : {forecast.skipped, forecast.renamed}) {
    for (const std::string& sentence : sentences) {
      if (!json_) say("sherd: warning: " + sentence);
    }
  }
  for (const std::string& object : forecast.refused) {
    if (!json_) say("sherd: warning: " + object + " cannot be broken");
  }
  if (json_) {
    return event({{"event", "forecast"},
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
  std::snprintf(text, sizeof text,
                "%zu fractures of %zu objects, %zu fragments; about %.3g GB in %s, told from %zu "
                "objects\n",
                forecast.fractures, forecast.objects, forecast.fragments, forecast.bytes * 1e-9,
                timeText(forecast.seconds).c_str(), forecast.sampled);
  printResult(text);
}

}  // namespace sherd::cli
