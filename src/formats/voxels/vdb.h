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
[[nodiscard]] std::vector<NamedGrid> readFloatGrids(const std::filesystem::path& file,
                                                    const ReadOptions& options = {});

/// Returns the float grids that are level sets.
///   throws  Error(input) as describeVdb(); there is none; a value is not finite
[[nodiscard]] std::vector<NamedGrid> readLevelSets(const std::filesystem::path& file,
                                                   const ReadOptions& options = {});

/// Returns the first float level set of a `.vdb` file.
///   throws  Error(input) as readLevelSets()
[[nodiscard]] std::shared_ptr<openvdb::FloatGrid> readLevelSet(const std::filesystem::path& file,
                                                               const ReadOptions& options = {});

///   throws  Error(input) a value of the grid is not finite
void requireFinite(const std::filesystem::path& file, const NamedGrid& grid);

/// Refuses voxels that lie too far apart: files of labels hold the box of the solid, most of which
/// may be empty, and two voxels at its ends would take hours.
///   throws  Error(input) it has more than 1e12 voxels
void requireBox(const std::filesystem::path& file, const Solid& solid);

/// Returns the float grids in the bytes of a file, an empty list if there is none.
///   file       name for messages
///   maxMemory  bytes
///   throws     Error(input)
[[nodiscard]] std::vector<NamedGrid> floatGridsOf(const std::filesystem::path& file,
                                                  std::string bytes, std::uint64_t maxMemory);

/// Describes the bytes of a file.
///   throws  Error(input)
[[nodiscard]] VdbFile describeVdbOf(const std::filesystem::path& file, std::string bytes,
                                    std::uint64_t maxMemory);

}  // namespace sherd
