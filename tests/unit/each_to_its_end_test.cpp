// Parallel loops that an error does not cut off.
#include "each_to_its_end.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>

namespace sherd {
namespace {

TEST(EachToItsEnd, LoopsWithinGoOnWhenOneFailsAndTheLowestErrorIsThrown) {
  constexpr std::size_t kBegin = 3, kEnd = 103, kWithin = 1000;
  std::atomic<std::size_t> done = 0;
  try {
    eachToItsEnd(kBegin, kEnd, [&](std::size_t i) {
      if (i % 10 == 7) throw std::runtime_error(std::to_string(i));
      tbb::parallel_for(std::size_t{0}, kWithin, [&](std::size_t) { ++done; });
    });
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_STREQ(e.what(), "7");
  }
  EXPECT_EQ(done, 90 * kWithin);
}

}  // namespace
}  // namespace sherd
