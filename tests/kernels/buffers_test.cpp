// Reading of buffers on every device that is here, and on OpenCL's as if their memory were not the
// host's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <numeric>
#include <span>
#include <vector>

#include "cl/device_search.h"
#include "cl/open_cl_device.h"
#include "device_fixture.h"

namespace sherd {
namespace {

// They are never freed, as some drivers crash then.
const std::vector<DeviceImpl*>& openedDevices() {
  static const std::vector<DeviceImpl*> all = [] {
    std::vector<DeviceImpl*> devices;
    for (const PlatformFound& platform : findPlatforms()) {
      for (const DeviceFound& found : platform.devices) {
        if (!found.fault.empty()) continue;
        devices.push_back(found.open().release());
        if (dynamic_cast<OpenClDevice*>(devices.back()) == nullptr) continue;
        devices.push_back(found.open().release());
        dynamic_cast<OpenClDevice&>(*devices.back()).hasHostMemory = false;
      }
    }
    return devices;
  }();
  return all;
}

// There is a device that is read in parts.
class Buffers : public testing::Test {
 protected:
  void SetUp() override {
    for (DeviceImpl* const device : openedDevices()) {
      const auto* const driven = dynamic_cast<OpenClDevice*>(device);
      if (driven != nullptr && !driven->hasHostMemory) return;
    }
    if (deviceRequired()) FAIL() << "there is no OpenCL device";
    GTEST_SKIP() << "there is no OpenCL device";
  }
};

TEST_F(Buffers, AreReadWholeWhereverTheirMemoryIs) {
  std::vector<std::uint32_t> numbers(900'000);  // 3.4 MiB
  std::iota(numbers.begin(), numbers.end(), 7u);
  const std::span<const std::uint32_t> all(numbers);
  constexpr std::size_t kMebibyte = (std::size_t{1} << 20) / sizeof(std::uint32_t);
  for (DeviceImpl* const device : openedDevices()) {
    SCOPED_TRACE(device->info.name);
    const DeviceBuffer buffer = uploadBuffer(*device, all);
    for (const std::size_t count :
         {std::size_t{1}, kMebibyte - 1, kMebibyte, kMebibyte + 1, 2 * kMebibyte, all.size() - 5}) {
      const auto part = all.subspan(5, count);
      const auto read = downloaded<std::uint32_t>(*device, buffer, count, 5);
      EXPECT_TRUE(std::equal(read.begin(), read.end(), part.begin(), part.end())) << count;
    }
    EXPECT_TRUE(downloaded<std::uint32_t>(*device, buffer, 0).empty());
  }
}

// Memory that cannot be had while a part is used leaves the device as it was.
TEST_F(Buffers, CanBeReadAgainAfterAFault) {
  std::vector<std::uint32_t> numbers(600'000);  // 2.3 MiB
  std::iota(numbers.begin(), numbers.end(), 7u);
  for (DeviceImpl* const device : openedDevices()) {
    SCOPED_TRACE(device->info.name);
    const DeviceBuffer buffer = uploadBuffer<std::uint32_t>(*device, numbers);
    EXPECT_THROW(device->view(*buffer, 0, numbers.size() * sizeof(std::uint32_t),
                              [](std::span<const std::byte>) { throw std::bad_alloc(); }),
                 std::bad_alloc);
    EXPECT_EQ(downloaded<std::uint32_t>(*device, buffer, numbers.size()), numbers);
  }
}

}  // namespace
}  // namespace sherd
