// Which files below a folder are a dataset's, so that they can be removed and all others kept.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "dataset/journal/plan.h"

namespace sherd {

/// Returns the entries of a dataset's folder that hold its files: names of files and folders.
///   throws  Error(output) one of them is a symbolic link or no file and no folder
[[nodiscard]] std::set<std::string> entriesOfDataset(const std::filesystem::path& folder,
                                                     const DatasetPlan& plan);

/// Returns the entries of a dataset's folder that an object's files lie in.
[[nodiscard]] std::set<std::string> entriesOfObject(const DatasetPlan& plan,
                                                    const LibraryObject& object);

/// Returns what an unfinished dataset holds that another run of it does not make: the folders of
/// objects that are not in its plan, and records of runs in another number of shards.
struct Leftovers {
  std::vector<LibraryObject> objects;
  std::vector<std::string> records;  ///< names of files
  [[nodiscard]] bool isEmpty() const { return objects.empty() && records.empty(); }
};
[[nodiscard]] Leftovers leftoversOf(const std::filesystem::path& folder, const DatasetPlan& plan,
                                    int shards);

/// Removes them, with the journals.
///   throws  Error(output)
void removeLeftovers(const std::filesystem::path& folder, const DatasetPlan& plan,
                     const Leftovers& leftovers);

/// Removes the files of a dataset, and moves all others to the same path below another folder,
/// or below its subfolder "kept" where that path is taken.  May be called again after it was
/// stopped at any point.  A relative link in "kept" leads where it did.  Files of the dataset are
/// those that the journals list; of an unfinished object all that is below its folder, as when the
/// run is resumed.
///   folder   with the dataset; removed at the end
///   return   a sentence for each file in "kept"
///   throws   Error(output)
std::vector<std::string> removeDataset(const std::filesystem::path& folder,
                                       const std::filesystem::path& others);

}  // namespace sherd
