// Names in the order that people put them in.
#pragma once

#include <string_view>

namespace sherd {

/// Whether a comes before b, runs of digits compared as numbers: piece_2 before piece_10.
[[nodiscard]] bool naturallyBefore(std::string_view a, std::string_view b);

}  // namespace sherd
