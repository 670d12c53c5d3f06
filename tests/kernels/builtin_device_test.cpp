// The built-in device in other work of TBB, and what it refuses.
#include "cl/builtin_device.h"

#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/labels.h>
#include <tbb/task_group.h>

#include <limits>
#include <new>
#include <string>

#include "device_fixture.h"
#include "voxel_shapes.h"

namespace sherd {
namespace {

class BuiltinDeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    if (nativeKernels().empty() && deviceRequired()) FAIL() << "a build without clang";
    if (nativeKernels().empty()) GTEST_SKIP() << "a build without clang";
  }
};

// Without a group of its own a launch would do nothing here, and a growth never end.
TEST_F(BuiltinDeviceTest, GrowsInWorkThatIsCancelled) {
  const auto blocks = voxel_shapes::blocksOf(voxel_shapes::ball(9));
  const std::vector<std::vector<Seed>> sets{{{{-3, 0, 0}, 1}, {{3, 1, 0}, 2}}};
  Device device("builtin");
  const std::vector<Labels> expected = grow(blocks, sets, device);
  std::vector<Labels> grown;
  tbb::task_group_context others;
  tbb::task_group group(others);
  group.run_and_wait([&] {
    others.cancel_group_execution();
    grown = grow(blocks, sets, device);
  });
  ASSERT_EQ(grown.size(), 1u);
  EXPECT_EQ(grown.front().fragment, expected.front().fragment);
}

TEST_F(BuiltinDeviceTest, TheBestInstructionsComeFirst) {
  std::string before = "x86-64-v9";
  for (const NativeKernels& kernels : nativeKernels()) {
    EXPECT_LT(kernels.instructions, before);
    before = kernels.instructions;
  }
  EXPECT_EQ(instructionsFault("x86-64-v2"), "");  // every processor of the last ten years
  EXPECT_NE(instructionsFault("x86-64-v5"), "");  // none has those
}

TEST_F(BuiltinDeviceTest, ABufferThatDoesNotFitIsAnError) {
  Device device("builtin");
  DeviceImpl& impl = implOf(device);
  EXPECT_THROW((void)makeBuffer<std::uint64_t>(impl, impl.info.largestBufferBytes / 8 + 1), Error);
}

#if !defined(__has_feature)
#define __has_feature(feature) 0
#endif
#if !__has_feature(address_sanitizer)  // which ends the process at such a size
TEST_F(BuiltinDeviceTest, MissingMemoryIsTheHosts) {
  Device device("builtin");
  DeviceImpl& impl = implOf(device);
  impl.info.largestBufferBytes = impl.info.memoryBytes = std::numeric_limits<std::size_t>::max();
  EXPECT_THROW((void)makeBuffer<std::uint8_t>(impl, std::size_t{1} << 62), std::bad_alloc);
}
#endif

TEST_F(BuiltinDeviceTest, AKernelThatIsNotThereIsAnError) {
  Device device("builtin");
  EXPECT_THROW(launchKernel(implOf(device), "no_such_kernel", 1, 1), Error);
}

}  // namespace
}  // namespace sherd
