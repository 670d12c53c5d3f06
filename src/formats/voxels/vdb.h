// The content of a `.vdb` file, without OpenVDB's own headers.
#pragma once

#include <sherd/solid.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace sherd {

/// Metadata as text, ascending by key.
using VdbMetadata = std::vector<std::pair<std::string, std::string>>;

struct VdbGrid {
  std::string name;
  std::string type;       ///< OpenVDB's: Tree_float_5_4_3
  std::string gridClass;  ///< "level set", "fog volume", "unknown", ...
  glm::dvec3 voxelSize{0.0};
  std::string background;  ///< empty where the grid has none
  std::uint64_t activeVoxels = 0;
  VoxelBox activeBox;
  VdbMetadata metadata;
};

struct VdbFile {
  VdbMetadata metadata;
  std::vector<VdbGrid> grids;
};

/// Reads a whole `.vdb` file and describes its content.
///   throws  Error(input) absent, cut, or not OpenVDB's
[[nodiscard]] VdbFile describeVdb(const std::filesystem::path& file);

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
