// The static range coder of the Point Cloud Library: bytes by how often each occurs.
//
// source  Martin, Range encoding, 1979; D. Subbotin's carry-less way;
// pcl/compression/entropy_range_coder
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sherd {

/// How often bytes occur: those below s take frequencies[s] out of frequencies[256] parts.
using Frequencies = std::array<std::uint32_t, 257>;

/// Of all bytes, each at least once, in less than 65536 parts.
[[nodiscard]] Frequencies frequenciesOf(std::string_view bytes);

/// The bytes, coded.
[[nodiscard]] std::string rangeEncoded(std::string_view bytes, const Frequencies& frequencies);

/// Gives coded bytes back, one by one.
class RangeDecoder {
 public:
  ///   frequencies  from 0 to at most 65536, each above the one before
  RangeDecoder(std::string_view code, const Frequencies& frequencies);

  /// The next byte, or nothing: the code has ended, or is none.
  [[nodiscard]] std::optional<std::uint8_t> next();

  /// Whether the code has been read to its end.
  [[nodiscard]] bool done() const { return rest_.empty() && !beyond_; }

 private:
  void shift();

  std::string_view rest_;
  const Frequencies& frequencies_;
  std::uint32_t low_ = 0, range_ = 0xffffffffu, code_ = 0;
  bool beyond_ = false;  // bytes were asked for that are not there
};

}  // namespace sherd
