// Base64 by OpenSSL.
#include "base/text/base64.h"

#include <openssl/evp.h>

#include <algorithm>
#include <cstddef>

namespace sherd {

std::string base64(std::string_view bytes) {
  // OpenSSL counts in ints; whole groups of three bytes are encoded one after another.
  constexpr std::size_t kAtOnce = 3 << 14;
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // and a terminating zero
  char* at = text.data();
  for (; !bytes.empty(); bytes.remove_prefix(std::min(bytes.size(), kAtOnce))) {
    const std::string_view some = bytes.substr(0, kAtOnce);
    at += EVP_EncodeBlock(reinterpret_cast<unsigned char*>(at),
                          reinterpret_cast<const unsigned char*>(some.data()),
                          static_cast<int>(some.size()));
  }
  text.pop_back();
  return text;
}

}  // namespace sherd
