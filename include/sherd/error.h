// The exception type of Sherd.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sherd {

/// The kind of an error; the value is the program's exit status.
enum class ErrorCode {
  internal = 1,     ///< a bug in Sherd
  usage = 2,        ///< an invalid option or argument
  input = 3,        ///< a file that cannot be read, or an object that cannot be broken
  device = 4,       ///< no device, or a device failure
  output = 5,       ///< a file that cannot be written
  cancelled = 130,  ///< stopped by the caller
};

/// Names of options as in their tables (sherd/options.h) and on the command line, without dashes;
/// also "device" and "max-memory", which only the command line has.
using OptionNames = std::vector<std::string>;

/// Every error that the library throws.  what() is one sentence for the user without a final full
/// stop: what, where, found, expected, what to try.  It names no flag of the command line.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& sentence, OptionNames options = {})
      : std::runtime_error(sentence), code_(code), options_(std::move(options)) {}
  ErrorCode code() const { return code_; }

  /// The options whose values decide here, such as "resolution"; often none.
  const OptionNames& options() const { return options_; }

 private:
  ErrorCode code_;
  OptionNames options_;
};

}  // namespace sherd
