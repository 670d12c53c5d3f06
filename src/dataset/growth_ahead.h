// Grows the fractures of one object in order, in batches.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dataset/dataset_run.h"
#include "dataset/distinct.h"
#include "pipeline/fracture_stages.h"

namespace sherd {

/// A grown fracture whose fragments are not extracted yet.
struct PlannedGrowth {
  PlannedFracture planned;
  std::size_t number = 0;  ///< in the schedule
  int attempt = 0;
  FractureOptions options;
  DrawnValues drawn;
  GrownFracture grown;
};

/// Returns the options of a fracture, with the values that are drawn by its seed.
///   offset  of an object that was recentered
///   drawn   receives these values
[[nodiscard]] FractureOptions optionsOfFracture(const DatasetOptions& options, int pieces,
                                                std::uint64_t seed,
                                                const std::optional<glm::dvec3>& offset,
                                                DrawnValues& drawn);

/// Iterates over the planned fractures of an object and grows them a batch ahead.
class GrowthAhead {
 public:
  ///   sha256  of the object's file
  ///   done    attempts of finished fractures, by name.  With options.distinct these are grown
  ///           again, to compare others with them
  ///   offset  of an object that was recentered
  GrowthAhead(const PreparedSolid& ready, std::string sha256, std::map<std::string, int> done,
              const DatasetRun& run, const std::optional<glm::dvec3>& offset,
              const Progress& progress);

  /// Returns the next fracture; null at the end.
  ///   throws  Error(input) none differs enough from the others; errors of grow()
  std::unique_ptr<PlannedGrowth> next();

 private:
  [[nodiscard]] std::size_t batchSize() const;
  void growBatch();
  void growDistinct();
  std::unique_ptr<PlannedGrowth> planOf(std::size_t number, int attempt);

  const PreparedSolid& ready_;
  const DatasetRun& run_;
  const DatasetOptions& options_;
  const std::string sha256_;
  const std::map<std::string, int> done_;
  const std::optional<glm::dvec3> offset_;
  const Progress& progress_;
  const std::vector<PlannedFracture> planned_;
  std::size_t next_ = 0;                              // index into planned_
  std::deque<std::unique_ptr<PlannedGrowth>> ahead_;  // grown, not yet returned
  Distinct distinct_;
  bool warmedUp_ = false;
};

}  // namespace sherd
