// The structure of a `.vdb` file, checked before OpenVDB reads it.
//
// OpenVDB trusts what it reads: masks, counts, lengths of strings and of compressed blocks, and the
// origins of nodes.  The check walks a file exactly as OpenVDB's reader does, so that whatever
// passes is read without leaving a buffer, into a tree that OpenVDB's functions may be used on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// What can be read of a grid.
enum class VdbContent {
  all,
  topology,  ///< grids of points: which voxels are active, and no values
  none,      ///< types that OpenVDB does not know
};

struct VdbEntry {
  std::string name;       ///< unique in the file: duplicates have OpenVDB's suffix
  std::string type;       ///< OpenVDB's, without the suffix for half floats: Tree_float_5_4_3
  std::string parent;     ///< unique name of the grid whose tree it shares, or empty
  std::size_t begin = 0;  ///< byte of the descriptor
  std::size_t end = 0;    ///< byte behind the grid
  VdbContent content = VdbContent::all;
  std::uint64_t memory = 0;  ///< bytes that OpenVDB allocates for the grid, an upper bound
};

struct VdbStructure {
  std::uint64_t memory = 0;  ///< bytes for the metadata of the file, an upper bound
  std::vector<VdbEntry> grids;
};

/// Checks a file of the versions 220 to 225.
///   file   name for messages
///   bytes  Two things are changed that OpenVDB would stumble over: the type names of tables for
///          delayed loading, whose parser does not know where its input ends, so that they are
///          skipped; and version 225, which differs by one type of grid, to 224.
///   throws Error(input)
[[nodiscard]] VdbStructure checkedVdb(const std::filesystem::path& file, std::span<char> bytes);

}  // namespace sherd
