// run.json: the work, time and resources of runs.
#include "dataset/report/run_record.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/version.h"

namespace sherd {
namespace {

using Json = nlohmann::ordered_json;

// The runs in a file below the dataset's folder; empty if the file is not a run record.
Json runsIn(const std::filesystem::path& out, const std::string& name) {
  if (!isOwnFile(out, name)) return Json::array();
  std::ifstream in(out / name);
  const Json json = Json::parse(in, nullptr, false);
  if (!json.is_object() || !json.contains("runs") || !json["runs"].is_array()) return Json::array();
  return json["runs"];
}

RunStatistics runOf(const Json& json, const std::string& name) {
  RunStatistics run;
  run.name = name;
  run.seconds = json.at("seconds");
  run.device = json.at("device").at("name");
  for (const auto& [stage, seconds] : json.at("stages").items()) run.stages[stage] = seconds;
  const Json& samples = json.at("samples");
  run.sampleSeconds = samples.at("seconds").get<std::vector<double>>();
  run.cores = samples.at("cores").get<std::vector<double>>();
  run.memory = samples.at("memory").get<std::vector<double>>();
  run.deviceMemory = samples.at("device_memory").get<std::vector<double>>();
  return run;
}

Json columns(const std::vector<ResourceSample>& samples) {
  Json seconds = Json::array(), cores = seconds, memory = seconds, device = seconds;
  for (const ResourceSample& sample : samples) {
    seconds.push_back(sample.seconds);
    cores.push_back(sample.cores);
    memory.push_back(sample.memory);
    device.push_back(sample.deviceMemory);
  }
  return {{"seconds", std::move(seconds)},
          {"cores", std::move(cores)},
          {"memory", std::move(memory)},
          {"device_memory", std::move(device)}};
}

}  // namespace

void addRun(const std::filesystem::path& out, const DatasetOptions& options,
            const DeviceInfo& device, const DatasetProgress& progress,
            const DatasetSummary& summary, const std::vector<StageTime>& stages,
            const std::vector<ResourceSample>& samples) {
  const std::string name = options.shard.of == 1
                               ? "run.json"
                               : "run_" + std::to_string(options.shard.number) + "_of_" +
                                     std::to_string(options.shard.of) + ".json";
  Json seconds = Json::object();
  for (const StageTime& stage : stages) seconds[stage.stage] = stage.seconds;
  Json bytes = Json::object();
  for (const auto& [format, count] : summary.bytesByFormat) bytes[format] = count;
  std::uint64_t peak = peakMemory();
  for (const ResourceSample& sample : samples) peak = std::max(peak, sample.memory);
  Json runs = runsIn(out, name);
  runs.push_back({{"version", SHERD_VERSION},
                  {"device", {{"platform", device.platform}, {"name", device.name}}},
                  {"seconds", progress.seconds},
                  {"objects", progress.objects},
                  {"fractures", progress.fractures},
                  {"fragments", progress.fragments},
                  {"stages", std::move(seconds)},
                  {"bytes", std::move(bytes)},
                  {"peak_memory", peak},
                  {"samples", columns(samples)}});
  const Json json = {{"schema", "sherd-run/1"}, {"runs", std::move(runs)}};
  writeWhole(out / name, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::vector<RunStatistics> readRuns(const std::filesystem::path& out) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(out)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("run") && entry.path().extension() == ".json") files.push_back(entry);
  }
  std::sort(files.begin(), files.end());
  std::vector<RunStatistics> runs;
  for (const std::filesystem::path& file : files) {
    std::string name = file.stem().string();
    std::replace(name.begin(), name.end(), '_', ' ');
    for (const Json& run : runsIn(out, file.filename().string())) {
      try {
        runs.push_back(runOf(run, name));
      } catch (const Json::exception&) {
        continue;
      }
    }
  }
  return runs;
}

}  // namespace sherd
