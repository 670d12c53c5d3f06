// What a fracture tells when it is done.
#pragma once

#include <sherd/device.h>
#include <sherd/fracture.h>
#include <sherd/io.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sherd::cli {

/// One fracture, written.
struct FractureTelling {
  std::string mesh;    ///< what was broken, as the caller calls it
  std::string folder;  ///< where it is
  const SourceMesh& source;
  const FractureOptions& options;
  const WriteOptions& write;
  const FractureResult& result;
  const DeviceInfo& device;
  std::filesystem::path manifest;
  const std::vector<std::string>& ofFolder;  ///< warnings about the folder
  std::vector<StageTime> times;              ///< of all, "total" last
};

/// What the caller should know, a sentence each.
[[nodiscard]] std::vector<std::string> warningsOf(const FractureTelling& told);

/// The report on the mesh, and one line: where, how many, how long.
[[nodiscard]] std::string textOf(const FractureTelling& told);

/// The same and more, as --json prints it.
[[nodiscard]] nlohmann::ordered_json jsonOf(const FractureTelling& told);

}  // namespace sherd::cli
