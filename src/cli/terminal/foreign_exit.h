// Handles drivers that call exit().
#pragma once

namespace sherd::cli {

/// Treats exit() as a driver failure during its lifetime: LLVM, PoCL's compiler, calls it when it
/// cannot write a file.  Then temporaries are removed, and the program ends with a message and
/// status 4.  Create it after the device is open, so that it runs before the drivers' handlers.
class ForeignExit {
 public:
  ForeignExit();
  ~ForeignExit();
  ForeignExit(const ForeignExit&) = delete;
  ForeignExit& operator=(const ForeignExit&) = delete;
};

}  // namespace sherd::cli
