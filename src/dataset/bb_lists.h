// The list files that loaders of Breaking Bad read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sherd {

/// An object in those lists.
struct BbObject {
  std::string folder;  ///< below the root: subset/category/object, or subset/object
  std::string split;   ///< "train", "val" or "test"
  std::vector<std::size_t> fragmentCounts;  ///< of fractured_0, fractured_1, ...
};

/// Writes SUBSET.SPLIT.txt with one folder per line, both at the root, for loaders, and below
/// data_split/, as in the archive and for converters; and data_list/SUBSET_SPLIT.txt with the
/// number of fragments and the folder of each fracture, for PMTR and CMNet.
///   throws  Error(output)
void writeBbLists(const std::filesystem::path& out, const std::vector<BbObject>& objects);

}  // namespace sherd
