// The static range coder of the Point Cloud Library.
#include "formats/points/range_coder.h"

#include <algorithm>

namespace sherd {
namespace {

constexpr std::uint32_t kTop = 1u << 24, kBottom = 1u << 16;

// Returns whether the highest byte of `low` is settled. A range that has become too small is cut,
// which settles it.
bool isSettled(std::uint32_t low, std::uint32_t& range) {
  if ((low ^ (low + range)) < kTop) return true;
  if (range >= kBottom) return false;
  range = (0u - low) & (kBottom - 1);
  return true;
}

}  // namespace

Frequencies frequenciesOf(std::string_view bytes) {
  std::array<std::uint64_t, 256> count{};
  for (const char byte : bytes) ++count[static_cast<unsigned char>(byte)];
  std::array<std::uint64_t, 257> sums{};
  for (std::size_t s = 0; s < 256; ++s)
    sums[s + 1] = sums[s] + std::max<std::uint64_t>(count[s], 1);
  while (sums[256] >= kBottom) {
    for (std::size_t s = 1; s <= 256; ++s) sums[s] = std::max(sums[s] / 2, sums[s - 1] + 1);
  }
  Frequencies frequencies{};
  std::transform(sums.begin(), sums.end(), frequencies.begin(),
                 [](std::uint64_t sum) { return static_cast<std::uint32_t>(sum); });
  return frequencies;
}

std::string rangeEncoded(std::string_view bytes, const Frequencies& frequencies) {
  std::string code;
  std::uint32_t low = 0, range = 0xffffffffu;
  const auto emit = [&] {
    code.push_back(static_cast<char>(low >> 24));
    low <<= 8;
  };
  for (const char byte : bytes) {
    const std::size_t s = static_cast<unsigned char>(byte);
    range /= frequencies[256];
    low += frequencies[s] * range;
    range *= frequencies[s + 1] - frequencies[s];
    while (isSettled(low, range)) {
      emit();
      range <<= 8;
    }
  }
  for (int i = 0; i < 4; ++i) emit();
  return code;
}

RangeDecoder::RangeDecoder(std::string_view code, const Frequencies& frequencies)
    : rest_(code), frequencies_(frequencies) {
  for (int i = 0; i < 4; ++i) shift();
}

void RangeDecoder::shift() {
  beyond_ |= rest_.empty();
  code_ = code_ << 8 | (rest_.empty() ? 0u : static_cast<unsigned char>(rest_.front()));
  if (!rest_.empty()) rest_.remove_prefix(1);
}

std::optional<std::uint8_t> RangeDecoder::next() {
  range_ /= frequencies_[256];
  if (beyond_ || range_ == 0) return {};
  const std::uint32_t part = (code_ - low_) / range_;
  if (part >= frequencies_[256]) return {};
  const auto above = std::upper_bound(frequencies_.begin(), frequencies_.end(), part);
  const auto s = static_cast<std::size_t>(above - frequencies_.begin()) - 1;
  low_ += frequencies_[s] * range_;
  range_ *= frequencies_[s + 1] - frequencies_[s];
  while (isSettled(low_, range_)) {
    shift();
    range_ <<= 8;
    low_ <<= 8;
    if (range_ == 0) return {};  // no encoder produces this
  }
  return static_cast<std::uint8_t>(s);
}

}  // namespace sherd
