// Files that are put in place together.
#pragma once

#include <sherd/output_file.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/atomic_file.h"

namespace sherd {

/// Files of any folders, each written beside its name, which is a path.  What is not kept goes with
/// this, and all is as it was.
class HeldFiles : public FileSink {
 public:
  HeldFiles() = default;
  ~HeldFiles() override;
  HeldFiles(const HeldFiles&) = delete;
  HeldFiles& operator=(const HeldFiles&) = delete;

  void take(const std::string& name, const Content& content) override;

  /// Nothing but renames, which are undone unless kept.  To be within an Uncut until then.
  ///   throws  Error(output)
  void putInPlace();
  void keep();

  /// Undo that, and forget the files.
  ///   return  what cannot be undone, in the middle of a sentence; else nothing
  std::string drop();

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<AtomicFile>> files_;
};

}  // namespace sherd
