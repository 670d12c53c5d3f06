// Base64.
#include "base/text/base64.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "base/random.h"

namespace sherd {
namespace {

// RFC 4648, bit by bit.
std::string slowBase64(const std::string& bytes) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); bit += 6) {
    unsigned index = 0;
    for (std::size_t i = bit; i < bit + 6; ++i) {
      const unsigned byte = i / 8 < bytes.size() ? static_cast<unsigned char>(bytes[i / 8]) : 0U;
      index = index << 1 | (byte >> (7 - i % 8) & 1U);
    }
    text += letters[index];
  }
  return text.append((4 - text.size() % 4) % 4, '=');
}

// OpenSSL counts in ints, so long texts are encoded in parts; these lengths cross the parts.
TEST(Base64, IsThatOfTheWholeWhateverItsLength) {
  std::string bytes;
  for (std::uint64_t i = 0; i < 150'002; ++i) bytes += static_cast<char>(randomBits(1, Stage{}, i));
  for (const std::size_t length : {0, 1, 2, 3, 4, 49151, 49152, 49153, 98304, 98305, 150'002}) {
    EXPECT_EQ(base64(std::string_view(bytes).substr(0, length)),
              slowBase64(bytes.substr(0, length)))
        << length;
  }
}

}  // namespace
}  // namespace sherd
