// Base64 encoding.
#pragma once

#include <string>
#include <string_view>

namespace sherd {

/// Encodes bytes in base64 (RFC 4648), padded, without line breaks.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace sherd
