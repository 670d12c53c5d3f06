// What reading a file may take.
#pragma once

#include <cstdint>
#include <limits>

namespace sherd {

struct ReadOptions {
  std::uint64_t maxMemory =
      std::numeric_limits<std::uint64_t>::max();  ///< bytes: a file that would
                                                  ///< take more is refused
};

}  // namespace sherd
