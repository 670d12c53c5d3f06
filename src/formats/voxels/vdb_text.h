// Names and types in `.vdb` files, which may be any bytes.
#pragma once

#include <string>
#include <string_view>

#include "base/text/printable.h"

namespace sherd {

/// Returns text of a file for messages, JSON and `--grid`: as printable() has it, of at most 200
/// bytes.
[[nodiscard]] inline std::string vdbText(std::string_view text) {
  constexpr std::size_t kLongest = 200;
  return printable(text.substr(0, kLongest));
}

}  // namespace sherd
