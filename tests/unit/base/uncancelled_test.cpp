// Work that an error elsewhere does not cut off.
#include "base/uncancelled.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <stdexcept>

namespace sherd {
namespace {

constexpr int kWithin = 1000;

// How much of a loop is done whose surroundings are cancelled before it begins.
template <class Around>
int doneWithin(const Around& around) {
  std::atomic<int> done = 0;
  tbb::task_group_context context;
  const auto body = [&](int) {
    around([&] {
      context.cancel_group_execution();
      tbb::parallel_for(0, kWithin, [&](int) { ++done; });
    });
  };
  tbb::parallel_for(0, 1, body, tbb::simple_partitioner(), context);
  return done;
}

TEST(Uncancelled, ALoopWithinIsDoneAlthoughTheOneAroundItIsCancelled) {
  EXPECT_LT(doneWithin([](const auto& work) { work(); }), kWithin);
  EXPECT_EQ(doneWithin([](const auto& work) { uncancelled(work); }), kWithin);
}

TEST(Uncancelled, ItsOwnErrorGoesToTheCaller) {
  EXPECT_THROW(uncancelled([] { throw std::runtime_error("full"); }), std::runtime_error);
}

}  // namespace
}  // namespace sherd
