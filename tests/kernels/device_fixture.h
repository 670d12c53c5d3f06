// The device for kernel tests: SHERD_TEST_DEVICE, else auto.
#pragma once

#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/error.h>

#include <cstdlib>

namespace sherd {

/// One device for all tests of a program, as in the product.  It is never freed, so that no driver
/// is unloaded while others still use it.  Where there is no such device the tests are skipped,
/// unless SHERD_REQUIRE_OPENCL=1.
class DeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    const char* required = std::getenv("SHERD_REQUIRE_OPENCL");
    try {
      (void)device();
    } catch (const Error& e) {
      if (required && *required == '1') throw;
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
