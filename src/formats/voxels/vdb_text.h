// Names and types in `.vdb` files, which may be any bytes.
#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "base/safe_name.h"

namespace sherd {

/// Returns text of a file for messages and JSON: printable ASCII as it is, other text by
/// safeName().
[[nodiscard]] inline std::string vdbText(std::string text) {
  constexpr std::size_t kLongest = 200;
  const bool isPlain = text.size() <= kLongest && std::all_of(text.begin(), text.end(), [](char c) {
                         return c >= ' ' && c <= '~';
                       });
  return isPlain ? text : safeName(std::move(text), "");
}

}  // namespace sherd
