// The content of a `.vdb` file, without OpenVDB's own headers.
#pragma once

#include <sherd/files.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace sherd {

struct NamedGrid {
  std::string name;
  bool isLevelSet = false;
  std::shared_ptr<openvdb::FloatGrid> grid;
};

/// Returns the float grids of a `.vdb` file, in its order.
///   throws  Error(input) as describeVdb(); there is none
[[nodiscard]] std::vector<NamedGrid> readFloatGrids(const std::filesystem::path& file);

/// Returns the float grids that are level sets.
///   throws  Error(input) as describeVdb(); there is none
[[nodiscard]] std::vector<NamedGrid> readLevelSets(const std::filesystem::path& file);

/// Returns the first float level set of a `.vdb` file.
///   throws  Error(input) as describeVdb(); there is none
[[nodiscard]] std::shared_ptr<openvdb::FloatGrid> readLevelSet(const std::filesystem::path& file);

}  // namespace sherd
