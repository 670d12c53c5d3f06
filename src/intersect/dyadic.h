// Exact numbers: integers times powers of two.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>

namespace sherd {

/// An exact number, integer * 2^exponent.  Sums and products of doubles are of this form; without
/// common divisors to find they take about a tenth of a rational number's time.
class Dyadic {
 public:
  explicit Dyadic(double value);  ///< finite

  // Copied, never moved: short integers have nothing to move, and GCC 12 warns about boost's move.
  Dyadic(const Dyadic&) = default;
  Dyadic& operator=(const Dyadic&) = default;

  static Dyadic difference(double a, double b) { return Dyadic(a) - Dyadic(b); }

  [[nodiscard]] int sign() const { return integer_.sign(); }

  friend Dyadic operator+(const Dyadic& a, const Dyadic& b);
  friend Dyadic operator-(const Dyadic& a, const Dyadic& b);
  friend Dyadic operator*(const Dyadic& a, const Dyadic& b) {
    return {Integer(a.integer_ * b.integer_), a.exponent_ + b.exponent_};
  }

  /// Returns a / b, rounded to nearest; b is not zero.
  friend double quotient(const Dyadic& a, const Dyadic& b);

 private:
  // 512 bits without an allocation.
  using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<512>,
                                                boost::multiprecision::et_off>;

  Dyadic(const Integer& integer, int exponent) : integer_(integer), exponent_(exponent) {}

  Integer integer_;
  int exponent_;
};

Dyadic operator+(const Dyadic& a, const Dyadic& b);
Dyadic operator-(const Dyadic& a, const Dyadic& b);
double quotient(const Dyadic& a, const Dyadic& b);

}  // namespace sherd
