// The output folder of a dataset.
#pragma once

#include <sherd/dataset.h>

#include <filesystem>
#include <vector>

#include "dataset/journal/plan.h"
#include "folder/manifest/partial_folder.h"

namespace sherd {

/// Requires that neither folder lies within the other: the next run must not read outputs as
/// objects, and no object may be overwritten.
///   throws  Error(usage)
void requireApart(const std::filesystem::path& library, const std::vector<LibraryObject>& objects,
                  const std::filesystem::path& out);

/// Requires, before the first object is broken, that no symbolic link leads from the folders of
/// objects to elsewhere.
///   throws  Error(output)
void requireNoLinks(const std::filesystem::path& out, const DatasetPlan& plan);

/// Held by every process that writes into a dataset's folder, shards included.  A process that
/// holds it alone removes the temporary files that killed runs left beside the dataset's own files;
/// those below an object's folder are removed when the object is broken.  On a file system that
/// cannot lock folders (NFS) they stay.
class OutputLock {
 public:
  /// Locks exclusively, or else waits for a shared lock.
  ///   out  an existing folder
  explicit OutputLock(const std::filesystem::path& out);

  /// Removes leftover temporaries if the lock is exclusive, then shares it.  Call it once the
  /// folder is known to be a dataset's.
  void share();

 private:
  std::filesystem::path out_;
  FolderLock lock_;
  bool isAlone_ = false;
};

}  // namespace sherd
