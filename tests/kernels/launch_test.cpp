// A launch whose arguments are not its kernel's parameters is an error on every device that is
// here; without a check the built-in device would read memory that is not its own.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cl/int4.h"
#include "cl/kernel_launch.h"
#include "device_fixture.h"
#include "devices_here.h"

namespace sherd {

std::span<const NativeKernels> launchedKernels();   // cmake/CompileKernels.cmake
std::span<const std::string_view> launchedTexts();  // cmake/EmbedKernels.cmake

namespace {

struct PlantedValues {
  std::uint64_t most = 0;
  std::int32_t least[4]{};
};

class Launch : public testing::Test {
 protected:
  // Every device that is here; OpenCL's also as in a build without clang, where parameters are what
  // the driver reports.  Drivers may crash at exit.
  static const std::vector<std::shared_ptr<DeviceImpl>>& devices(bool withClang) {
    static const std::string source(launchedTexts().front());
    static const auto* const with = new std::vector(devicesWith(launchedKernels(), source));
    static const auto* const without = new std::vector(devicesWith({}, source));
    return withClang ? *with : *without;
  }

  // Runs `check` on each device, with two buffers of 64 elements of up to eight bytes.
  template <class Check>
  void onEach(Check&& check, std::initializer_list<bool> builds = {true, false}) {
    if (devices(true).empty() && deviceRequired()) FAIL() << "no device here";
    if (devices(true).empty()) GTEST_SKIP() << "no device here";
    for (const bool withClang : builds) {
      for (const auto& device : devices(withClang)) {
        SCOPED_TRACE(device->info.platform + " / " + device->info.name);
        check(*device, makeBuffer<std::uint64_t>(*device, 64),
              makeBuffer<std::uint64_t>(*device, 64));
      }
    }
  }

  // Returns the sentence of the internal error.
  template <class... Arguments>
  static std::string refusal(DeviceImpl& device, const char* kernel,
                             const Arguments&... arguments) {
    try {
      launchKernel(device, kernel, 64, 16, arguments...);
      device.finish();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::internal) << e.what();
      return e.what();
    }
    return "none";
  }
};

constexpr std::uint32_t kCount = 64;
constexpr std::uint64_t kFirst = 1000;

TEST_F(Launch, WithTheParametersOfItsKernelRunsIt) {
  onEach([](DeviceImpl& device, const DeviceBuffer& out, const DeviceBuffer& in) {
    fillBuffer(device, in, kCount, std::uint16_t{7});
    EXPECT_EQ(refusal(device, "planted_mixed", out, in, kCount, kFirst, 2.0f,
                      PlantedValues{30, {0, 0, 5, 0}}),
              "none");
    EXPECT_EQ(downloaded<std::uint32_t>(device, out, kCount),
              std::vector<std::uint32_t>(kCount, 2 * (1000 + 7 + 5 + 30)));
    EXPECT_EQ(refusal(device, "planted_empty"), "none");
  });
}

TEST_F(Launch, OfAnotherNumberOfArgumentsNamesBoth) {
  onEach([](DeviceImpl& device, const DeviceBuffer& out, const DeviceBuffer& in) {
    const std::string rest = "; declare in kernels/ what the launch in src/ gives";
    EXPECT_EQ(refusal(device, "planted_mixed", out, in, kCount),
              "the kernel planted_mixed has 6 parameters, its launch 3 arguments" + rest);
    EXPECT_EQ(refusal(device, "planted_mixed", out, in, kCount, kFirst, 2.0f, PlantedValues{}, in),
              "the kernel planted_mixed has 6 parameters, its launch 7 arguments" + rest);
    EXPECT_EQ(refusal(device, "planted_mixed"),
              "the kernel planted_mixed has 6 parameters, its launch 0 arguments" + rest);
    EXPECT_EQ(refusal(device, "planted_empty", out),
              "the kernel planted_empty has 0 parameters, its launch 1 argument" + rest);
  });
}

TEST_F(Launch, OfAnotherSizeOrKindNamesParameterAndBoth) {
  onEach([](DeviceImpl& device, const DeviceBuffer& out, const DeviceBuffer& in) {
    const PlantedValues values{};
    const auto expect = [](const std::string& sentence, const std::string& parameter,
                           const std::string& takes, const std::string& argument) {
      EXPECT_EQ(sentence.find("parameter " + parameter + " of the kernel planted_"), 0u)
          << sentence;
      EXPECT_NE(sentence.find(" is " + takes + ", its argument " + argument + ";"),
                std::string::npos)
          << sentence;
    };
    expect(refusal(device, "planted_mixed", out, in, kFirst, kFirst, 2.0f, values), "3",
           "an integer of 4 bytes", "an integer of 8 bytes");
    expect(refusal(device, "planted_mixed", out, in, kCount, kCount, 2.0f, values), "4",
           "an integer of 8 bytes", "an integer of 4 bytes");
    expect(refusal(device, "planted_mixed", out, in, kCount, kFirst, kCount, values), "5",
           "a floating-point number of 4 bytes", "an integer of 4 bytes");
    expect(refusal(device, "planted_mixed", out, in, kCount, kFirst, 2.0, values), "5",
           "a floating-point number of 4 bytes", "a floating-point number of 8 bytes");
    // A buffer's address has the size of a ulong.
    expect(refusal(device, "planted_mixed", out, in, kCount, in, 2.0f, values), "4",
           "an integer of 8 bytes", "a buffer");
    expect(refusal(device, "planted_mixed", out, kFirst, kCount, kFirst, 2.0f, values), "2",
           "a buffer", "an integer of 8 bytes");
  });
}

// Drivers report no size of a structure, and PoCL compares none.
TEST_F(Launch, OfAnotherStructureNamesBothSizes) {
  if (launchedKernels().empty()) GTEST_SKIP() << "a build without clang";
  onEach(
      [](DeviceImpl& device, const DeviceBuffer& out, const DeviceBuffer& in) {
        const std::string sentence = refusal(device, "planted_mixed", out, in, kCount, kFirst, 2.0f,
                                             std::array<std::int32_t, 5>{});
        EXPECT_EQ(
            sentence.find("parameter 6 of the kernel planted_mixed is a structure of 24 bytes, "
                          "its argument a structure of 20 bytes;"),
            0u)
            << sentence;
      },
      {true});
}

// A vector that is passed by value changes its registers with the compiler.
TEST_F(Launch, WithAVectorByValueIsRefused) {
  onEach([](DeviceImpl& device, const DeviceBuffer& out, const DeviceBuffer&) {
    const std::string sentence = refusal(device, "planted_vector", out, Int4{});
    EXPECT_EQ(sentence.find("parameter 2 of the kernel planted_vector is a vector"), 0u)
        << sentence;
  });
}

TEST_F(Launch, OfAKernelThatIsNotThereIsAnError) {
  onEach([](DeviceImpl& device, const DeviceBuffer&, const DeviceBuffer&) {
    EXPECT_EQ(refusal(device, "no_such_kernel"), "there is no kernel no_such_kernel");
  });
}

}  // namespace
}  // namespace sherd
