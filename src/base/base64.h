// Bytes as text.
#pragma once

#include <string>
#include <string_view>

namespace sherd {

/// In base64 (RFC 4648), padded, on one line.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace sherd
