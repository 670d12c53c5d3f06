// Grows the fractures of one object, in order and several at a time.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "dataset/distinct.h"
#include "dataset/object_run.h"
#include "pipeline/fracture_stages.h"

namespace sherd {

/// A fracture whose fragments have yet to be cut out.
struct PlannedGrowth {
  PlannedFracture planned;
  std::size_t number = 0;  ///< in the schedule
  int attempt = 0;
  FractureOptions options;
  DrawnOptions drawn;
  GrownFracture grown;
};

class GrowthAhead {
 public:
  ///   sha256  of the object's file
  ///   done    names of fractures that are there already, with their tries; with options.distinct
  ///           they are grown again, to compare others with them
  GrowthAhead(const PreparedSolid& ready, std::string sha256, std::map<std::string, int> done,
              const DatasetRun& run, const Progress& progress);

  /// The next fracture; null at the end.
  ///   throws  Error(input) none differs enough from the others; as grow
  std::unique_ptr<PlannedGrowth> next();

 private:
  [[nodiscard]] std::size_t together() const;
  void growSome();
  void growApart();
  std::unique_ptr<PlannedGrowth> planOf(std::size_t number, int attempt);

  const PreparedSolid& ready_;
  const DatasetRun& run_;
  const DatasetOptions& options_;
  const std::string sha256_;
  const std::map<std::string, int> done_;
  const Progress& progress_;
  const std::vector<PlannedFracture> planned_;
  std::size_t next_ = 0;                              // of planned_
  std::deque<std::unique_ptr<PlannedGrowth>> ahead_;  // grown, and not yet given out
  Distinct distinct_;
  bool rehearsed_ = false;
};

}  // namespace sherd
