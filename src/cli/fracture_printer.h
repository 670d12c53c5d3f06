// Text, warnings and JSON about a written fracture.
#pragma once

#include <sherd/device.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sherd::cli {

/// A fracture whose files are written.
struct FractureSummary {
  std::string mesh;    ///< name of what was broken, for messages
  std::string folder;  ///< output folder
  const SourceMesh& source;
  const FractureOptions& options;
  const WriteOptions& write;
  const FractureResult& result;
  const DeviceInfo& device;
  std::filesystem::path manifest;
  const std::vector<std::string>& ofFolder;  ///< warnings about the folder
  std::vector<StageTime> times;              ///< of all stages, "total" last
};

/// Returns the warnings, a sentence each.
[[nodiscard]] std::vector<std::string> warningsOf(const FractureSummary& summary);

/// Returns the mesh report and one line with the folder, the number of fragments and the time.
[[nodiscard]] std::string textOf(const FractureSummary& summary);

/// Returns the object that --json prints.
[[nodiscard]] nlohmann::ordered_json jsonOf(const FractureSummary& summary);

}  // namespace sherd::cli
