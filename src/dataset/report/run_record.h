// run.json: the work, time and resources of runs.
#pragma once

#include <sherd/dataset.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "dataset/report/resources.h"

namespace sherd {

/// Appends a run to run.json, or to run_i_of_N.json for shard i/N.
///   progress  the work of this run alone
///   summary   of the whole dataset; empty after an error
///   throws    Error(output)
void addRun(const std::filesystem::path& out, const DatasetOptions& options,
            const DeviceInfo& device, const DatasetProgress& progress,
            const DatasetSummary& summary, const std::vector<StageTime>& stages,
            const std::vector<ResourceSample>& samples);

/// A recorded run.
struct RunStatistics {
  std::string name;  ///< "run", "run 2 of 4"
  double seconds = 0.0;
  std::string device;
  std::map<std::string, double> stages;             ///< seconds
  std::vector<double> sampleSeconds;                ///< [samples] since the beginning
  std::vector<double> cores, memory, deviceMemory;  ///< [samples] busy cores, bytes, bytes
};

/// Returns all recorded runs, those of run.json first.  Skips damaged records.
[[nodiscard]] std::vector<RunStatistics> readRuns(const std::filesystem::path& out);

}  // namespace sherd
