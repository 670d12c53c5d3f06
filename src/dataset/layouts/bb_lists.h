// The list files that loaders of Breaking Bad read.
#pragma once

#include <array>
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
/// data_split/, as in the archive and for converters; data_split/SPLIT.txt with the folder of each
/// fracture, for Rectified Point Flow; and data_list/SUBSET_SPLIT.txt with the number of fragments
/// and the folder of each fracture, for PMTR and CMNet.  The lists of the subsets everyday and
/// artifact are there even if empty: the converter of GARF opens them.
///   return  sentences about lists that a loader keeps of what was there before: it would read
///           those without an error
///   throws  Error(output)
[[nodiscard]] std::vector<std::string> writeBbLists(const std::filesystem::path& out,
                                                    const std::vector<BbObject>& objects);

/// Returns the names of those lists.
///   folders  of objects, as BbObject has them
[[nodiscard]] std::vector<std::string> bbListNames(const std::vector<std::string>& folders);

/// Returns a sentence if splits have fewer than three objects; else nothing.
///   shares  of train, val and test; splits of no share do not count
[[nodiscard]] std::vector<std::string> fewObjects(const std::vector<BbObject>& objects,
                                                  const std::array<int, 3>& shares);

}  // namespace sherd
