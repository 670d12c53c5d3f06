// Safe file names from untrusted text.
#include "base/text/safe_name.h"

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

namespace sherd {
namespace {

constexpr std::size_t kLongestName = 200;  // bytes; names of 255 fit on every file system

bool isUtf8(const std::string& text) {
  try {
    (void)nlohmann::json(text).dump();
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

}  // namespace

std::string withoutBlanks(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

std::string safeName(std::string name, const std::string& otherwise) {
  const bool utf8 = isUtf8(name);
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f || byte == '/' || (byte >= 0x80 && !utf8)) c = '_';
  }
  if (name.starts_with('.')) name.front() = '_';
  if (name.size() > kLongestName) {
    std::size_t end = kLongestName;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;
    name.resize(end);
  }
  return name.empty() ? otherwise : name;
}

}  // namespace sherd
