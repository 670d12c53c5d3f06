// SHA-256 as text.
#pragma once

#include <filesystem>
#include <string>

namespace sherd {

/// 64 hexadecimal digits.
[[nodiscard]] std::string sha256(const std::string& bytes);

}  // namespace sherd
