// The lists that loaders of Breaking Bad read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sherd {

/// An object as those lists have it.
struct BbObject {
  std::string folder;              ///< below the root: subset/category/object, or subset/object
  std::string split;               ///< "train", "val" or "test"
  std::vector<std::size_t> parts;  ///< of fractured_0, fractured_1, ...
};

/// Write SUBSET.SPLIT.txt with a folder a line, beside the subsets, where loaders look, and below
/// data_split/, where the archive and converters have it; and data_list/SUBSET_SPLIT.txt with the
/// number of parts and the folder of each fracture, for PMTR and CMNet.
///   throws  Error(output)
void writeBbLists(const std::filesystem::path& out, const std::vector<BbObject>& objects);

}  // namespace sherd
