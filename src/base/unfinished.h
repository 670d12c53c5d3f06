// What is on the disk only while it is worked on, for whoever ends the process in the middle.
#pragma once

#include <sys/types.h>

#include <filesystem>

namespace sherd {

/// Steps that are done whole or not at all, even where the process is ended: making a temporary and
/// registering it, or renames.  They are short and wait for nobody, or ask meanwhile whether to
/// stop, as what prints a result does.  From endAllWork() on, whoever begins such steps waits for
/// the end of the process.  One within another is the outer one.
class Uncut {
 public:
  Uncut();
  ~Uncut();
  Uncut(const Uncut&) = delete;
  Uncut& operator=(const Uncut&) = delete;
};

/// A temporary, registered while this lives.  It is taken away by whoever made it, as ever; this is
/// for the case that the process ends without that.  Make both, the temporary and this, within one
/// Uncut.
class Unfinished {
 public:
  enum class Kind {
    file,
    folder,      ///< with all that is in it
    madeFolder,  ///< where nothing is in it
  };

  Unfinished() = default;
  Unfinished(std::filesystem::path path, Kind kind);
  /// A process, which is killed.  To be ended before it is waited for.
  explicit Unfinished(pid_t process);
  ~Unfinished() { end(); }
  Unfinished(Unfinished&& other) noexcept;
  Unfinished& operator=(Unfinished&& other) noexcept;

  /// It is gone, or is to stay.
  void end();

 private:
  unsigned long number_ = 0;  // 0: none
};

/// Wait for steps that are under way, and let no others begin, nor temporaries be made.  Other
/// threads may go on otherwise; the caller ends the process soon.
void endAllWork();

/// Take away all that is registered, later ones first, though threads may still write into it.
/// After endAllWork().
void removeUnfinished();

}  // namespace sherd
