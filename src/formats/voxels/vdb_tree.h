// The tree of a grid in a `.vdb` file.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "formats/voxels/vdb_cursor.h"

namespace sherd {

/// How a tree stores its values.
struct VdbValues {
  std::string_view treeType;  ///< OpenVDB's: Tree_float_5_4_3
  unsigned bytes = 0;         ///< per value
  unsigned halfBytes = 0;     ///< per value saved as half floats; 0: never
  bool hasBits = false;       ///< leaves hold a bit for each voxel
  bool hasPoints = false;     ///< leaves hold points, which are not read
};

/// Returns how a type of tree is stored; none for types that OpenVDB 10 does not know.
[[nodiscard]] std::optional<VdbValues> vdbValuesOf(std::string_view treeType);

struct VdbTreeFormat {
  VdbValues values;
  std::uint32_t version = 0;      ///< of the file, 220 or later
  std::uint32_t compression = 0;  ///< flags of OpenVDB
  bool isHalf = false;            ///< values are saved as half floats
};

/// Checks a tree, and moves behind it; behind its topology if its leaves hold points.
///   return  bytes that OpenVDB allocates for it, an upper bound
///   throws  Error(input)
std::uint64_t checkVdbTree(VdbCursor& in, const VdbTreeFormat& format);

}  // namespace sherd
