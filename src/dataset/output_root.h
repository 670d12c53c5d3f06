// The folder that a dataset goes into.
#pragma once

#include <sherd/dataset.h>

#include <filesystem>
#include <vector>

#include "dataset/plan.h"
#include "folder/partial_folder.h"

namespace sherd {

/// What is written must not be taken for an object by the next run, and no object overwritten.
///   throws  Error(usage) one lies within the other
void requireApart(const std::filesystem::path& library, const std::vector<LibraryObject>& objects,
                  const std::filesystem::path& out);

/// Before the first object is broken, and not when its turn comes: see that no link leads from the
/// places of the objects to elsewhere.
///   throws  Error(output)
void requireOwnPlaces(const std::filesystem::path& out, const DatasetPlan& plan);

/// Held by every process that writes into a dataset's folder, shards among them.  One that finds
/// itself alone removes the temporary files that killed runs left beside the dataset's own files;
/// those below an object's folder go when the object is made.  On a file system that cannot lock
/// folders (NFS) they stay.
class OutputLock {
 public:
  /// Take it alone, or else wait until it can be shared.
  ///   out  is there
  explicit OutputLock(const std::filesystem::path& out);

  /// This is a dataset's folder: remove what is left, if alone, and let others in.
  void share();

 private:
  std::filesystem::path out_;
  FolderLock lock_;
  bool isAlone_ = false;
};

}  // namespace sherd
