// SHA-256 by OpenSSL.
#include "base/files/sha256.h"

#include <openssl/evp.h>
#include <sherd/error.h>

#include <array>
#include <charconv>
#include <fstream>
#include <new>

#include "base/input_error.h"

namespace sherd {
namespace {

void require(int done) {
  if (done != 1) throw Error(ErrorCode::internal, "OpenSSL cannot compute SHA-256");
}

}  // namespace

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  if (!context_) throw std::bad_alloc();
  require(EVP_DigestInit_ex(context_, EVP_sha256(), nullptr));
}

Sha256::~Sha256() { EVP_MD_CTX_free(context_); }

void Sha256::add(std::string_view bytes) {
  require(EVP_DigestUpdate(context_, bytes.data(), bytes.size()));
}

std::string Sha256::text() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  require(EVP_DigestFinal_ex(context_, digest.data(), &size));
  std::string text;
  for (unsigned i = 0; i < size; ++i) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    text += kDigits[digest[i] >> 4];
    text += kDigits[digest[i] & 15];
  }
  return text;
}

std::string sha256(std::string_view bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.text();
}

std::uint64_t sha256Number(std::string_view bytes) {
  std::uint64_t number = 0;
  const std::string text = sha256(bytes);
  std::from_chars(text.data(), text.data() + 16, number, 16);
  return number;
}

std::string sha256OfFile(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) inputError(file, "cannot be opened for reading");
  Sha256 sum;
  std::string block(std::size_t{1} << 20, '\0');
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    sum.add(std::string_view(block).substr(0, static_cast<std::size_t>(in.gcount())));
  }
  if (in.bad()) inputError(file, "cannot be read to its end");
  return sum.text();
}

}  // namespace sherd
