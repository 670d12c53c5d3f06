// Files that are renamed to their targets together.
#pragma once

#include <sherd/files.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/files/atomic_file.h"

namespace sherd {

/// Files in any folders, written as AtomicFiles; names are paths.  The destructor undoes everything
/// that is not kept.
class HeldFiles : public FileSink {
 public:
  HeldFiles() = default;
  ~HeldFiles() override;
  HeldFiles(const HeldFiles&) = delete;
  HeldFiles& operator=(const HeldFiles&) = delete;

  void take(const std::string& name, const Content& content) override;

  /// Only renames, which are undone unless keep() is called.  Call both within one Uncut.
  ///   throws  Error(output)
  void putInPlace();
  void keep();

  /// Undoes putInPlace() and drops the files.
  ///   return  if that fails, the resulting state as a clause of a sentence; else empty
  std::string drop();

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<AtomicFile>> files_;
};

}  // namespace sherd
