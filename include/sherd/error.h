// The one exception type of Sherd.
#pragma once

#include <stdexcept>
#include <string>

namespace sherd {

/// What went wrong; the value is the exit status of the program.
enum class ErrorCode {
  internal = 1,     ///< a mistake of ours
  usage = 2,        ///< an option or argument that cannot be
  input = 3,        ///< a file that cannot be read or broken
  device = 4,       ///< no OpenCL device, or it failed
  output = 5,       ///< something could not be written
  cancelled = 130,  ///< the caller asked to stop
};

/// Thrown by every function of the library.  what() is one sentence to the user: what, where,
/// found, expected, what to try; no final full stop.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& sentence) : std::runtime_error(sentence), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace sherd
