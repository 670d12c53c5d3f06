// Files that are put in place together.
#pragma once

#include <sherd/output_file.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "io/atomic_file.h"

namespace sherd {

/// Files of any folders, each written beside its name, which is a path.  What is not put in place
/// goes with this.
class HeldFiles : public FileSink {
 public:
  void take(const std::string& name, const Content& content) override;

  /// Nothing but renames.
  ///   throws  Error(output)
  void putInPlace();

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<AtomicFile>> files_;
};

}  // namespace sherd
