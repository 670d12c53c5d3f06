// A registry of temporary files and processes, which are removed when a signal ends the process.
#pragma once

#include <sys/types.h>

#include <filesystem>

namespace sherd {

/// A scope that runs completely or not at all, even if a signal ends the process: for creating a
/// temporary and registering it, or for renames.  Code in it is short and does not block, or polls
/// for cancellation, as printing a result does.  After endAllWork() the constructor blocks until
/// the process ends.  Nested scopes have no effect.
class Uncut {
 public:
  Uncut();
  ~Uncut();
  Uncut(const Uncut&) = delete;
  Uncut& operator=(const Uncut&) = delete;
};

/// Registers a temporary for removeUnfinished() while this object lives.  The creator of the
/// temporary still removes it on the usual ways out.  Create the temporary and this object within
/// one Uncut.
class Unfinished {
 public:
  enum class Kind {
    file,
    folder,      ///< with its content
    madeFolder,  ///< removed only if it is empty
  };

  Unfinished() = default;
  Unfinished(std::filesystem::path path, Kind kind);
  /// A process, which is killed.  Call end() before waiting for it.
  explicit Unfinished(pid_t process);
  ~Unfinished() { end(); }
  Unfinished(Unfinished&& other) noexcept;
  Unfinished& operator=(Unfinished&& other) noexcept;

  /// Unregisters the temporary.
  void end();

 private:
  unsigned long number_ = 0;  // 0: none
};

/// Waits until no thread is within an Uncut, and lets none enter one, so no new temporaries are
/// created.  Other work of threads continues; the caller soon ends the process.
void endAllWork();

/// Removes all that is registered, in reverse order, although threads may still write to it.  Call
/// this after endAllWork().
void removeUnfinished();

}  // namespace sherd
