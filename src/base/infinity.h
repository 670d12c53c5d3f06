// The distance of what is nowhere.
#pragma once

#include <limits>

namespace sherd {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace sherd
