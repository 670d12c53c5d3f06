// Text that a terminal shows as it is.
#include "base/text/printable.h"

#include <array>
#include <cstddef>
#include <cstdio>

namespace sherd {
namespace {

using Byte = unsigned char;

Byte byteAt(std::string_view text, std::size_t i) {
  return i < text.size() ? static_cast<Byte>(text[i]) : Byte{0};
}

bool isBetween(Byte byte, int low, int high) { return low <= byte && byte <= high; }

// Returns the bytes of the character that begins the text; 0 if it is not well-formed UTF-8.  The
// second byte's range excludes longer forms than needed, surrogates and what is above U+10FFFF.
std::size_t characterBytes(std::string_view text) {
  const Byte first = byteAt(text, 0);
  if (first < 0x80) return 1;
  const std::size_t bytes = isBetween(first, 0xc2, 0xdf)   ? 2
                            : isBetween(first, 0xe0, 0xef) ? 3
                            : isBetween(first, 0xf0, 0xf4) ? 4
                                                           : 0;
  const int low = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
  const int high = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
  if (bytes == 0 || !isBetween(byteAt(text, 1), low, high)) return 0;
  for (std::size_t i = 2; i < bytes; ++i) {
    if (!isBetween(byteAt(text, i), 0x80, 0xbf)) return 0;
  }
  return bytes;
}

void appendEscape(std::string& out, const char* format, unsigned number) {
  std::array<char, 16> escape{};
  std::snprintf(escape.data(), escape.size(), format, number);
  out += escape.data();
}

}  // namespace

std::string printable(std::string_view text, LineBreaks breaks) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t bytes = characterBytes(text);
    const Byte first = byteAt(text, 0), second = byteAt(text, 1);
    const bool isKeptBreak = first == '\n' && breaks == LineBreaks::kept;
    if (bytes == 0) {
      appendEscape(out, "\\x%02x", first);
    } else if (bytes == 1 && (first < 0x20 || first == 0x7f) && !isKeptBreak) {
      appendEscape(out, "\\u%04x", first);
    } else if (bytes == 2 && first == 0xc2 && second < 0xa0) {
      appendEscape(out, "\\u%04x", second);
    } else {
      out += text.substr(0, bytes);
    }
    text.remove_prefix(bytes == 0 ? 1 : bytes);
  }
  return out;
}

}  // namespace sherd
