// Exact numbers: integers times powers of two.
#include "intersect/dyadic.h"

#include <cassert>
#include <cmath>
#include <cstdint>

namespace sherd {

Dyadic::Dyadic(double value) : exponent_(0) {
  assert(std::isfinite(value));
  if (value == 0.0) return;
  constexpr int kBits = 53;
  const double fraction = std::frexp(value, &exponent_);
  auto bits = static_cast<std::int64_t>(std::ldexp(fraction, kBits));
  exponent_ -= kBits;
  // Short integers stay short in products: many coordinates come from single precision.
  const int zeros = __builtin_ctzll(static_cast<std::uint64_t>(bits));
  integer_ = bits / (std::int64_t{1} << zeros);
  exponent_ += zeros;
}

Dyadic operator+(const Dyadic& a, const Dyadic& b) {
  if (a.sign() == 0) return b;
  if (b.sign() == 0) return a;
  const Dyadic &coarse = a.exponent_ > b.exponent_ ? a : b, &fine = &coarse == &a ? b : a;
  Dyadic sum = coarse;
  sum.integer_ <<= coarse.exponent_ - fine.exponent_;
  sum.exponent_ = fine.exponent_;
  sum.integer_ += fine.integer_;
  return sum;
}

Dyadic operator-(const Dyadic& a, const Dyadic& b) {
  return a + Dyadic(Dyadic::Integer(-b.integer_), b.exponent_);
}

double quotient(const Dyadic& a, const Dyadic& b) {
  using Integer = Dyadic::Integer;
  assert(b.sign() != 0);
  if (a.sign() == 0) return 0.0;
  Integer numerator = abs(a.integer_), denominator = abs(b.integer_);
  // A quotient of 63 or 64 bits; its last bit also records that there is a rest, so that rounding
  // to 53 bits is right.
  const int shift = 63 + static_cast<int>(msb(denominator)) - static_cast<int>(msb(numerator));
  if (shift > 0) {
    numerator <<= shift;
  } else {
    denominator <<= -shift;
  }
  Integer whole, rest;
  divide_qr(numerator, denominator, whole, rest);
  std::uint64_t bits = whole.convert_to<std::uint64_t>();
  if (rest.sign() != 0) bits |= 1u;
  const double size = std::ldexp(static_cast<double>(bits), a.exponent_ - b.exponent_ - shift);
  return a.sign() == b.sign() ? size : -size;
}

}  // namespace sherd
