// The device for kernel tests: SHERD_TEST_DEVICE, else auto.
#pragma once

#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/error.h>

#include <cstdlib>

namespace sherd {

/// Whether a missing device is a failure: SHERD_REQUIRE_OPENCL=1.
inline bool deviceRequired() {
  const char* const required = std::getenv("SHERD_REQUIRE_OPENCL");
  return required != nullptr && *required == '1';
}

/// One device for all tests of a program, as in the product.  It is never freed, so that no driver
/// is unloaded while others still use it.  Where there is no such device the tests are skipped,
/// unless it is required.
class DeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    try {
      (void)device();
    } catch (const Error& e) {
      if (deviceRequired()) throw;
      GTEST_SKIP() << e.what();
    }
  }

  static Device& device() {
    static Device* const opened = [] {
      const char* choice = std::getenv("SHERD_TEST_DEVICE");
      return new Device(choice ? choice : "auto");
    }();
    return *opened;
  }
};

}  // namespace sherd
