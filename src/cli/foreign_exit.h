// Drivers that end the program.
#pragma once

namespace sherd::cli {

/// While this lives, exit() is called by drivers only: LLVM, by which PoCL compiles, calls it where
/// it cannot write a file.  Temporaries are removed then, and the program ends with a sentence and
/// status 4.  To be made once the device is open, so that it runs before the drivers' own handlers.
class ForeignExit {
 public:
  ForeignExit();
  ~ForeignExit();
  ForeignExit(const ForeignExit&) = delete;
  ForeignExit& operator=(const ForeignExit&) = delete;
};

}  // namespace sherd::cli
