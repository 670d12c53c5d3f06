// run.json: what a run did, how long it took, and what it took of the machine.
#pragma once

#include <sherd/dataset.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "dataset/resources.h"

namespace sherd {

/// Add a run to run.json; of shard i/N to run_i_of_N.json.
///   told     what it did by itself, beside what was there before
///   summary  of all there is; empty where it ended too early
///   throws   Error(output)
void addRun(const std::filesystem::path& out, const DatasetOptions& options,
            const DeviceInfo& device, const DatasetProgress& told, const DatasetSummary& summary,
            const std::vector<StageTime>& stages, const std::vector<ResourceSample>& samples);

/// A run as its record tells it.
struct RunFigures {
  std::string name;  ///< "run", "run 2 of 4"
  double seconds = 0.0;
  std::string device;
  std::map<std::string, double> stages;                 ///< seconds
  std::vector<double> at, cores, memory, deviceMemory;  ///< by sample; seconds, bytes
};

/// All runs that have left a record, of run.json first.  A record that is damaged is left out.
[[nodiscard]] std::vector<RunFigures> readRuns(const std::filesystem::path& out);

}  // namespace sherd
