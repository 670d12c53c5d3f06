// Natural order of names.
#pragma once

#include <string_view>

namespace sherd {

/// Whether a is before b, with runs of digits compared as numbers: piece_2 before piece_10.
[[nodiscard]] bool naturallyBefore(std::string_view a, std::string_view b);

}  // namespace sherd
