// What a dataset run tells.
#pragma once

#include <sherd/dataset.h>

#include <chrono>
#include <string>

namespace sherd::cli {

/// A line that is redrawn on a terminal, a line for each object elsewhere, or an event a line of
/// JSON.
class DatasetTelling {
 public:
  DatasetTelling(bool json, bool quiet);
  DatasetTelling(const DatasetTelling&) = delete;
  DatasetTelling& operator=(const DatasetTelling&) = delete;

  /// Refers to this.
  [[nodiscard]] DatasetWatch watch();

  void done(const std::string& folder, const DatasetSummary& summary);

  void forecast(const DatasetForecast& forecast);

  ///   throws  Error(input) there are problems
  void verified(const std::string& folder, const DatasetCheck& check);

  /// The run ended otherwise.
  void stopped() { clear(); }

 private:
  void progress(const DatasetProgress& told);
  void line(const DatasetProgress& told);
  void say(const std::string& sentence);
  void clear();

  bool json_, terminal_, quiet_;
  std::size_t objects_ = 0;  // that were told to be done
  std::chrono::steady_clock::time_point last_;
};

}  // namespace sherd::cli
