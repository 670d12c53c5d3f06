// SHA-256 as text.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace sherd {

/// A checksum of bytes that come piece by piece.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::string_view bytes);

  /// 64 hexadecimal digits; nothing may be added after.
  [[nodiscard]] std::string text();

 private:
  evp_md_ctx_st* context_;
};

/// 64 hexadecimal digits.
[[nodiscard]] std::string sha256(std::string_view bytes);

/// Of a file, of which little is in memory at a time.
///   throws  Error(input) it cannot be read
[[nodiscard]] std::string sha256OfFile(const std::filesystem::path& file);

}  // namespace sherd
