// A dataset that takes the place of another in the same folder.
//
//     OUT/.sherd-replacing/new/...      the new dataset, until it is complete
//     OUT/.sherd-replacing/ready/...    the complete new one, while the old one is moved away
//     OUT/.sherd-replacing/placing/...  what of it is not moved into OUT yet
//     OUT/.sherd-replacing/old/...      the old one, while it is moved away and removed
//
// Each step is a rename, so that the folders that exist say how far a killed process came: what
// begins with ready/ is carried on by the next process, whatever its options.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "dataset/journal/plan.h"
#include "folder/manifest/partial_folder.h"

namespace sherd {

class Replacement {
 public:
  /// Makes OUT/.sherd-replacing, and locks it.
  ///   isShared  with other shards
  ///   throws    Error(output) it cannot be made, or another process holds the lock
  Replacement(std::filesystem::path out, bool isShared);
  ~Replacement();  ///< removes what is empty
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;

  /// The folder for the new dataset.
  [[nodiscard]] std::filesystem::path fresh() const;

  /// Removes a new dataset with other options that an earlier process left; of one with the same
  /// options the objects that are not in the plan, journals of those whose files have changed
  /// since, and records of runs in another number of shards; keeps all else.
  ///   throws  Error(output) another process works on it
  void prepare(const DatasetPlan& plan, const std::string& identity, int shards);

  /// Removes the new dataset.
  ///   throws  Error(output)
  void discard();

  /// Requires that nothing in OUT but the old dataset is in the way of the new one's entries.
  ///   throws  Error(output)
  void requireFree(const std::set<std::string>& entries) const;

  /// Puts the complete new dataset in place of the old one, whose files are removed.
  ///   return  a sentence for each file that could not keep its path
  ///   throws  Error(output); the same call on the next process carries on
  std::vector<std::string> putInPlace();

 private:
  friend bool finishReplacement(const std::filesystem::path& out,
                                std::vector<std::string>& sentences);
  [[nodiscard]] bool isPending() const;
  void lock(bool isShared);
  void advance(std::vector<std::string>& sentences);

  std::filesystem::path out_, path_;
  bool isShared_ = false;
  int descriptor_ = -1;
  FolderLock lock_;
};

/// Whether a new dataset of `replace` is being made in a folder, and not complete.
[[nodiscard]] bool hasReplacement(const std::filesystem::path& out);

/// Carries on what a process was killed in while it put a complete dataset in place.
///   return  whether there was any such
///   throws  Error(output), also where another process does just that
bool finishReplacement(const std::filesystem::path& out, std::vector<std::string>& sentences);

}  // namespace sherd
