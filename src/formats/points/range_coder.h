// The static range coder of the Point Cloud Library: bytes coded by their frequencies.
//
// source  Martin, Range encoding, 1979; D. Subbotin's carry-less variant;
// pcl/compression/entropy_range_coder
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sherd {

/// Cumulative frequencies: the bytes below s have frequencies[s] of frequencies[256] parts.
using Frequencies = std::array<std::uint32_t, 257>;

/// Returns the frequencies of bytes, each at least 1, scaled to a sum below 65536.
[[nodiscard]] Frequencies frequenciesOf(std::string_view bytes);

/// Returns the bytes, coded.
[[nodiscard]] std::string rangeEncoded(std::string_view bytes, const Frequencies& frequencies);

/// Decodes bytes one by one.
class RangeDecoder {
 public:
  ///   frequencies  ascending from 0 to at most 65536
  RangeDecoder(std::string_view code, const Frequencies& frequencies);

  /// Returns the next byte; nothing at the end of the code or if it is malformed.
  [[nodiscard]] std::optional<std::uint8_t> next();

  /// Whether the code has been read to its end.
  [[nodiscard]] bool done() const { return rest_.empty() && !beyond_; }

 private:
  void shift();

  std::string_view rest_;
  const Frequencies& frequencies_;
  std::uint32_t low_ = 0, range_ = 0xffffffffu, code_ = 0;
  bool beyond_ = false;  // a read went past the end
};

}  // namespace sherd
