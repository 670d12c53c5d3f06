// Options of file readers.
#pragma once

#include <cstdint>
#include <limits>

namespace sherd {

struct ReadOptions {
  std::uint64_t maxMemory =
      std::numeric_limits<std::uint64_t>::max();  ///< bytes; files that need more are refused
};

}  // namespace sherd
