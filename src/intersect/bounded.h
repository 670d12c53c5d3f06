// Numbers of about 106 bits with a bound of their error.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

namespace sherd {

inline constexpr double kUnitRoundoff = 0x1p-53;
/// Covers underflow in a product, in bounds of errors of doubles.
inline constexpr double kUnderflow = 1e-290;

/// A number within `error` of high + low, where `low` is at most half a unit in the last place of
/// `high`.  The error is infinite or NaN after an overflow, and then no sign is known.
///   source  Joldes, Muller, Popescu: Tight and Rigorous Error Bounds for Basic Building Blocks of
///           Double-Word Arithmetic, 2017; Dekker, A Floating-Point Technique for Extending the
///           Available Precision, 1971
struct Bounded {
  double high = 0.0, low = 0.0, error = 0.0;

  Bounded(double value) : high(value) {}  // NOLINT: an exact conversion
  Bounded(double h, double l, double e) : high(h), low(l), error(e) {}

  /// Returns a - b, exactly.
  static Bounded difference(double a, double b);
};

namespace bounded {

// The error of one operation, relative to its result: at most 15 * 2^-106 (division).
constexpr double kOperation = 0x1p-100;
// Covers the rounding of the error bounds themselves.
constexpr double kWidened = 1.0 + 0x1p-45;
// Covers underflow in a product.
constexpr double kTiny = 1e-300;

/// Returns a + b as the rounded sum and the rest.
inline Bounded sum(double a, double b) {
  const double s = a + b, t = s - a;
  return {s, (a - (s - t)) + (b - t), 0.0};
}

/// The same where |a| >= |b| or a = 0.
inline Bounded orderedSum(double a, double b) {
  const double s = a + b;
  return {s, b - (s - a), 0.0};
}

/// Returns a * b as the rounded product and the rest, without a fused operation.
inline Bounded product(double a, double b) {
  constexpr double kSplit = 0x1p27 + 1.0;
  const double p = a * b, ta = kSplit * a, tb = kSplit * b;
  const double ah = ta - (ta - a), al = a - ah, bh = tb - (tb - b), bl = b - bh;
  return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl, 0.0};
}

}  // namespace bounded

inline Bounded Bounded::difference(double a, double b) { return bounded::sum(a, -b); }

inline Bounded operator-(const Bounded& a) { return {-a.high, -a.low, a.error}; }

inline Bounded operator+(const Bounded& a, const Bounded& b) {
  const Bounded s = bounded::sum(a.high, b.high), t = bounded::sum(a.low, b.low);
  const Bounded v = bounded::orderedSum(s.high, s.low + t.high);
  const Bounded z = bounded::orderedSum(v.high, t.low + v.low);
  return {z.high, z.low,
          (a.error + b.error + bounded::kOperation * std::abs(z.high)) * bounded::kWidened};
}

inline Bounded operator-(const Bounded& a, const Bounded& b) { return a + (-b); }

inline Bounded operator*(const Bounded& a, const Bounded& b) {
  const Bounded p = bounded::product(a.high, b.high);
  const Bounded z = bounded::orderedSum(p.high, p.low + (a.high * b.low + a.low * b.high));
  const double error = (std::abs(a.high) + a.error) * b.error + std::abs(b.high) * a.error +
                       bounded::kOperation * std::abs(z.high) + bounded::kTiny;
  return {z.high, z.low, error * bounded::kWidened};
}

inline Bounded operator/(const Bounded& a, const Bounded& b) {
  const double q = a.high / b.high;
  const Bounded rest = Bounded(a.high, a.low, 0.0) - Bounded(q) * Bounded(b.high, b.low, 0.0);
  const Bounded z = bounded::orderedSum(q, rest.high / b.high);
  const double divisor = std::abs(b.high) * (1.0 - 0x1p-50) - b.error;
  const double error = divisor > 0.0 ? (a.error + std::abs(z.high) * b.error) / divisor +
                                           bounded::kOperation * std::abs(z.high) + bounded::kTiny
                                     : std::numeric_limits<double>::infinity();
  return {z.high, z.low, error * bounded::kWidened};
}

/// Returns the sign of a number, or nothing if its error leaves it open.
inline std::optional<int> signOf(const Bounded& a) {
  const double uncertain = (std::abs(a.low) + a.error) * bounded::kWidened;
  if (a.high > uncertain) return 1;
  if (a.high < -uncertain) return -1;
  return std::nullopt;
}

}  // namespace sherd
