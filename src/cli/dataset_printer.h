// Prints the progress and results of a dataset run.
#pragma once

#include <sherd/dataset.h>

#include <chrono>
#include <string>
#include <vector>

namespace sherd::cli {

/// Prints a progress line on a terminal, else a line for each object, or JSON with an event a line.
class DatasetPrinter {
 public:
  DatasetPrinter(bool json, bool quiet);
  DatasetPrinter(const DatasetPrinter&) = delete;
  DatasetPrinter& operator=(const DatasetPrinter&) = delete;

  /// Returns callbacks that refer to this object.
  [[nodiscard]] DatasetCallbacks callbacks();

  void printSummary(const std::string& folder, const DatasetSummary& summary);

  void printForecast(const DatasetForecast& forecast);

  /// Prints each problem, or the number of files verified.
  ///   throws  Error(input) there are problems
  void printVerified(const std::string& folder, const DatasetCheck& check);

  /// Clears the progress line after an error.
  void stopped() { clear(); }

 private:
  void printProgress(const DatasetProgress& progress);
  void drawLine(const DatasetProgress& progress);
  void printSentence(const std::string& sentence);
  void clear();

  bool json_, terminal_, quiet_;
  std::size_t objects_ = 0;            // done at the last report
  std::vector<std::string> failed_{};  // objects of this run
  std::chrono::steady_clock::time_point last_;
};

}  // namespace sherd::cli
