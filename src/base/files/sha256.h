// SHA-256 checksums.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace sherd {

/// Computes the checksum of bytes that are added in chunks.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::string_view bytes);

  /// Returns 64 hexadecimal digits.  Call it once, after the last add().
  [[nodiscard]] std::string text();

 private:
  evp_md_ctx_st* context_;
};

/// Returns 64 hexadecimal digits.
[[nodiscard]] std::string sha256(std::string_view bytes);

/// Returns the first 64 bits of it as a number: the same on every machine.
[[nodiscard]] std::uint64_t sha256Number(std::string_view bytes);

/// Returns the checksum of a file, read in blocks of 1 MiB.
///   throws  Error(input) it cannot be read
[[nodiscard]] std::string sha256OfFile(const std::filesystem::path& file);

}  // namespace sherd
