// 16-bit floating-point numbers (IEEE 754 binary16).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace sherd {

inline constexpr double kLargestHalf = 65504.0;

/// Returns the nearest 16-bit number, ties to even.
///   value  at most kLargestHalf in magnitude
inline double roundedToHalf(double value) {
  // Numbers of 11 significant bits; below 2^-14 they are 2^-24 apart.
  const int exponent = value == 0.0 ? -14 : std::max(std::ilogb(value), -14);
  return std::ldexp(std::nearbyint(std::ldexp(value, 10 - exponent)), exponent - 10);
}

/// Returns the bits of a 16-bit number.
///   value  as returned by roundedToHalf
inline std::uint16_t halfBits(double value) {
  const std::uint16_t sign = std::signbit(value) ? 0x8000u : 0u;
  const double size = std::abs(value);
  if (size < 0x1p-14) {
    return static_cast<std::uint16_t>(sign | static_cast<std::uint16_t>(std::ldexp(size, 24)));
  }
  const int exponent = std::ilogb(size);
  const auto digits = static_cast<std::uint32_t>(std::ldexp(size, 10 - exponent));  // 1024..2047
  return static_cast<std::uint16_t>(sign + ((static_cast<std::uint32_t>(exponent) + 14u) << 10) +
                                    digits);
}

/// Returns the value of a 16-bit number.
inline double halfValue(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31, digits = bits & 1023;
  double size = exponent == 0 ? std::ldexp(digits, -24) : std::ldexp(1024 + digits, exponent - 25);
  if (exponent == 31) {
    size = digits == 0 ? std::numeric_limits<double>::infinity()
                       : std::numeric_limits<double>::quiet_NaN();
  }
  return (bits & 0x8000) != 0 ? -size : size;
}

}  // namespace sherd
