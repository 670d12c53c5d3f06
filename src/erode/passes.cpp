// Rounds lengths of an erosion to voxels.
#include "erode/passes.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/text/formatted.h"
#include "erode/shape.h"

namespace sherd {
namespace {

constexpr double kMostPasses = 1000.0, kLeastSize = 3.0, kMostSize = 2.0 * kLargestReach + 1.0;

// False for NaN.
bool isWithin(double low, double x, double high) { return x >= low && x <= high; }

bool isWhole(double x) { return x == std::floor(x); }

[[noreturn]] void refuseOption(const char* option, const std::string& what) {
  throw Error(ErrorCode::usage, "erode: " + what, OptionNames{option});
}

// The nearest odd number; a relative size is at least the smallest shape.
double oddSize(const Length& size, double longestSide) {
  if (size.percent == 0.0) return size.voxels;
  return std::max(2.0 * std::round((size.over(longestSide) - 1.0) / 2.0) + 1.0, kLeastSize);
}

}  // namespace

ErosionPasses passesOf(const ErodeOptions& options, double longestSide) {
  const Length &size = options.size, &iterations = options.iterations;
  const double across = oddSize(size, longestSide);
  if (!isWithin(kLeastSize, across, kMostSize) || std::fmod(across, 2.0) != 1.0) {
    refuseOption("erode-size", "the size is " + formatted("%.4g", size.over(longestSide)) +
                                   " voxels; expected an odd size from 3 to 13");
  }
  double count = iterations.over(longestSide);
  if (iterations.percent > 0.0) count = std::round(count);
  if (!isWithin(0.0, count, kMostPasses) || !isWhole(count)) {
    refuseOption("erode-iterations", "the number of iterations is " + formatted("%.4g", count) +
                                         "; expected a whole number from 0 to 1000");
  }
  return {static_cast<int>(count), static_cast<int>(across)};
}

}  // namespace sherd
