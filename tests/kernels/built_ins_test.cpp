// The built-in functions that kernels use against OpenCL's definitions, on every device that is
// here: kernels/built_ins.h has our own.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "device_fixture.h"
#include "devices_here.h"

namespace sherd {

std::span<const NativeKernels> builtInKernels();   // cmake/CompileKernels.cmake
std::span<const std::string_view> builtInTexts();  // cmake/EmbedKernels.cmake

namespace {

// Numbers at the ends of the range, around zero, and at random.
template <class T>
std::vector<T> numbers(std::uint64_t seed) {
  using Limits = std::numeric_limits<T>;
  std::vector<T> all{Limits::min(),
                     Limits::max(),
                     T(0),
                     T(1),
                     T(2),
                     static_cast<T>(-1),
                     static_cast<T>(-2),
                     static_cast<T>(Limits::min() + 1),
                     static_cast<T>(Limits::max() - 1)};
  std::mt19937_64 random(seed);
  while (all.size() < 256) {
    const std::uint64_t bits = random() >> (random() % 64);
    all.push_back(static_cast<T>(random() % 2 ? bits : ~bits));
  }
  std::shuffle(all.begin(), all.end(), random);
  return all;
}

class BuiltIns : public testing::Test {
 protected:
  static constexpr std::size_t kCount = 256;

  // Runs `check` on each device.
  template <class Check>
  void onEach(Check&& check) {
    static const auto* const devices = new std::vector(devicesWith(
        builtInKernels(), std::string(builtInTexts().front())));  // drivers may crash at exit
    if (devices->empty() && deviceRequired()) FAIL() << "no device here";
    if (devices->empty()) GTEST_SKIP() << "no device here";
    for (const auto& device : *devices) {
      SCOPED_TRACE(device->info.platform + " / " + device->info.name);
      check(*device);
    }
  }

  template <class T>
  static DeviceBuffer up(DeviceImpl& device, const std::vector<T>& data) {
    return uploadBuffer<T>(device, data);
  }

  template <class... Arguments>
  static void run(DeviceImpl& device, const char* kernel, std::size_t work,
                  const Arguments&... arguments) {
    launchKernel(device, kernel, work, 16, arguments...);
  }

  template <class T, class Function>
  static void expect(DeviceImpl& device, const DeviceBuffer& result, const char* what,
                     Function&& definition) {
    const std::vector<T> found = downloaded<T>(device, result, kCount);
    for (std::size_t i = 0; i < kCount; ++i)
      ASSERT_EQ(found[i], definition(i)) << what << " at " << i;
  }
};

// The high half of the product.
int highHalf(int a, int b) { return static_cast<int>((std::int64_t{a} * std::int64_t{b}) >> 32); }

TEST_F(BuiltIns, OfInt) {
  const auto a = numbers<std::int32_t>(1), b = numbers<std::int32_t>(2);
  onEach([&](DeviceImpl& device) {
    const auto least = makeBuffer<int>(device, kCount), most = makeBuffer<int>(device, kCount),
               high = makeBuffer<int>(device, kCount), absolute = makeBuffer<int>(device, kCount);
    run(device, "of_int", kCount, up(device, a), up(device, b), std::uint32_t{kCount}, least, most,
        high, absolute);
    expect<int>(device, least, "min", [&](auto i) { return b[i] < a[i] ? b[i] : a[i]; });
    expect<int>(device, most, "max", [&](auto i) { return a[i] < b[i] ? b[i] : a[i]; });
    expect<int>(device, high, "mul_hi", [&](auto i) { return highHalf(a[i], b[i]); });
    expect<std::uint32_t>(device, absolute, "abs", [&](auto i) {  // |x| without overflow
      return static_cast<std::uint32_t>(std::abs(std::int64_t{a[i]}));
    });
  });
}

TEST_F(BuiltIns, OfUint) {
  const auto a = numbers<std::uint32_t>(3), b = numbers<std::uint32_t>(4);
  onEach([&](DeviceImpl& device) {
    const auto least = makeBuffer<int>(device, kCount), most = makeBuffer<int>(device, kCount);
    run(device, "of_uint", kCount, up(device, a), up(device, b), std::uint32_t{kCount}, least,
        most);
    expect<std::uint32_t>(device, least, "min", [&](auto i) { return std::min(a[i], b[i]); });
    expect<std::uint32_t>(device, most, "max", [&](auto i) { return std::max(a[i], b[i]); });
  });
}

TEST_F(BuiltIns, OfLong) {
  const auto a = numbers<std::int64_t>(5), b = numbers<std::int64_t>(6);
  onEach([&](DeviceImpl& device) {
    const auto least = makeBuffer<std::int64_t>(device, kCount),
               most = makeBuffer<std::int64_t>(device, kCount),
               absolute = makeBuffer<std::int64_t>(device, kCount);
    run(device, "of_long", kCount, up(device, a), up(device, b), std::uint32_t{kCount}, least, most,
        absolute);
    expect<std::int64_t>(device, least, "min", [&](auto i) { return std::min(a[i], b[i]); });
    expect<std::int64_t>(device, most, "max", [&](auto i) { return std::max(a[i], b[i]); });
    expect<std::uint64_t>(device, absolute, "abs", [&](auto i) {
      return a[i] < 0 ? ~static_cast<std::uint64_t>(a[i]) + 1 : static_cast<std::uint64_t>(a[i]);
    });
  });
}

TEST_F(BuiltIns, OfUlong) {
  const auto a = numbers<std::uint64_t>(7), b = numbers<std::uint64_t>(8);
  onEach([&](DeviceImpl& device) {
    const auto make = [&] { return makeBuffer<std::uint64_t>(device, kCount); };
    const DeviceBuffer least = make(), most = make(), zeros = make(), ones = make();
    run(device, "of_ulong", kCount, up(device, a), up(device, b), std::uint32_t{kCount}, least,
        most, zeros, ones);
    expect<std::uint64_t>(device, least, "min", [&](auto i) { return std::min(a[i], b[i]); });
    expect<std::uint64_t>(device, most, "max", [&](auto i) { return std::max(a[i], b[i]); });
    expect<std::uint64_t>(device, zeros, "clz", [&](auto i) {
      return static_cast<std::uint64_t>(std::countl_zero(a[i]));
    });
    expect<std::uint64_t>(device, ones, "popcount",
                          [&](auto i) { return static_cast<std::uint64_t>(std::popcount(a[i])); });
  });
}

TEST_F(BuiltIns, OfIntVectors) {
  constexpr std::size_t kVectors = kCount / 8;
  auto a = numbers<std::int32_t>(9);
  const auto b = numbers<std::int32_t>(10);
  for (std::size_t i = 0; i < 8; ++i)
    a[i] &= std::numeric_limits<std::int32_t>::max();  // no sign set
  onEach([&](DeviceImpl& device) {
    const auto make = [&] { return makeBuffer<std::int32_t>(device, kCount); };
    const DeviceBuffer least = make(), most = make(), sign = make(), high4 = make(), high = make();
    run(device, "of_int_vectors", kVectors, up(device, a), up(device, b), std::uint32_t{kVectors},
        least, most, sign, high4, up(device, a), up(device, b), high);
    const auto found = [&](const DeviceBuffer& buffer, std::size_t count) {
      return downloaded<std::int32_t>(device, buffer, count);
    };
    const auto leastFound = found(least, 4 * kVectors), mostFound = found(most, 4 * kVectors),
               signFound = found(sign, kVectors), high4Found = found(high4, 4 * kVectors),
               highFound = found(high, 8 * kVectors);
    for (std::size_t i = 0; i < 4 * kVectors; ++i) {
      EXPECT_EQ(leastFound[i], std::min(a[i], b[i]));
      EXPECT_EQ(mostFound[i], std::max(a[i], b[i]));
      EXPECT_EQ(high4Found[i], highHalf(a[i], b[i]));
    }
    int signs = 0;
    for (std::size_t i = 0; i < kVectors; ++i) {
      const auto* const vector = a.data() + 4 * i;
      const bool isSet = std::any_of(vector, vector + 4, [](int n) { return n < 0; });
      EXPECT_EQ(signFound[i], isSet ? 1 : 0);
      signs += isSet;
    }
    EXPECT_TRUE(0 < signs && signs < static_cast<int>(kVectors));  // both cases were tried
    for (std::size_t i = 0; i < 8 * kVectors; ++i) EXPECT_EQ(highFound[i], highHalf(a[i], b[i]));
  });
}

TEST_F(BuiltIns, OfUshortVectors) {
  const auto a = numbers<std::uint16_t>(11), b = numbers<std::uint16_t>(12);
  const auto c = numbers<std::int16_t>(13);
  onEach([&](DeviceImpl& device) {
    const auto make = [&] { return makeBuffer<std::uint16_t>(device, kCount); };
    const DeviceBuffer least = make(), most = make(), converted = make();
    run(device, "of_ushort_vectors", kCount / 8, up(device, a), up(device, b),
        std::uint32_t{kCount / 8}, least, most, up(device, c), converted);
    expect<std::uint16_t>(device, least, "min", [&](auto i) { return std::min(a[i], b[i]); });
    expect<std::uint16_t>(device, most, "max", [&](auto i) { return std::max(a[i], b[i]); });
    expect<std::uint16_t>(device, converted, "convert_ushort8",
                          [&](auto i) { return static_cast<std::uint16_t>(c[i]); });
  });
}

TEST_F(BuiltIns, RowsNeedNoAlignment) {
  constexpr std::size_t kRows = 31, kElements = 1 + 8 * kRows;
  const auto u = numbers<std::uint16_t>(14);
  const auto n = numbers<std::int32_t>(15);
  const auto l = numbers<std::uint64_t>(16);
  onEach([&](DeviceImpl& device) {
    const DeviceBuffer uOut = makeBuffer<std::uint16_t>(device, kElements),
                       nOut = makeBuffer<std::int32_t>(device, kElements),
                       lOut = makeBuffer<std::uint64_t>(device, kElements);
    run(device, "of_rows", kRows, up(device, u), up(device, n), up(device, l), std::uint32_t{kRows},
        uOut, nOut, lOut);
    const auto same = [&]<class T>(const DeviceBuffer& out, const std::vector<T>& in) {
      const std::vector<T> found = downloaded<T>(device, out, kElements - 1, 1);
      EXPECT_TRUE(std::equal(found.begin(), found.end(), in.begin() + 1)) << sizeof(T);
    };
    same(uOut, u);
    same(nOut, n);
    same(lOut, l);
  });
}

TEST_F(BuiltIns, AtomicsReturnTheValueBefore) {
  constexpr std::uint32_t kMany = 20'000;
  onEach([&](DeviceImpl& device) {
    std::vector<std::uint32_t> start(20, 0);
    start[2] = ~0u;
    const DeviceBuffer cells = up(device, start);
    const auto make = [&] { return makeBuffer<std::uint32_t>(device, kMany); };
    const DeviceBuffer sum = make(), count = make(), last = make(), compared = make();
    run(device, "of_atomics", kMany, cells, kMany, sum, count, last, compared);
    const auto found = [&](const DeviceBuffer& buffer) {
      return downloaded<std::uint32_t>(device, buffer, kMany);
    };
    const std::vector<std::uint32_t> end = downloaded<std::uint32_t>(device, cells, 20);

    EXPECT_EQ(end[0], kMany * (kMany + 1) / 2);
    std::vector<std::uint32_t> order(kMany),
        sums = found(sum);  // by the sum before: each adds its own to it
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return sums[a] < sums[b]; });
    std::uint32_t expected = 0;
    for (const std::uint32_t i : order) {
      ASSERT_EQ(sums[i], expected);
      expected += i + 1;
    }
    std::vector<std::uint32_t> counts = found(count);
    std::sort(counts.begin(), counts.end());
    for (std::uint32_t i = 0; i < kMany; ++i) ASSERT_EQ(counts[i], i);
    EXPECT_EQ(end[1], kMany);
    EXPECT_EQ(end[2], 1u);
    std::vector<std::uint32_t> lasts =
        found(last);  // every value was put in once, and taken out or left
    lasts.push_back(end[3]);
    std::sort(lasts.begin(), lasts.end());
    for (std::uint32_t i = 0; i <= kMany; ++i) ASSERT_EQ(lasts[i], i);
    const std::vector<std::uint32_t> before =
        found(compared);  // the first of each cell finds 0, the others find it
    for (std::uint32_t cell = 0; cell < 16; ++cell) {
      ASSERT_EQ((end[4 + cell] - 1) % 16, cell);
      for (std::uint32_t i = cell; i < kMany; i += 16)
        ASSERT_EQ(before[i], i + 1 == end[4 + cell] ? 0u : end[4 + cell]);
    }
  });
}

TEST_F(BuiltIns, EachWorkItemIsThereOnce) {
  constexpr std::size_t kWork = 64;
  onEach([&](DeviceImpl& device) {
    const DeviceBuffer visits = up(device, std::vector<std::uint32_t>(kWork, 0));
    const DeviceBuffer sizes = up(device, std::vector<std::uint64_t>(kWork, 0));
    run(device, "of_items", kWork, visits, sizes);
    const auto found = downloaded<std::uint64_t>(device, sizes, kWork);
    const std::size_t size = found[0];
    ASSERT_TRUE(0 < size && size <= kWork) << size;
    const auto times = downloaded<std::uint32_t>(device, visits, kWork);
    for (std::size_t i = 0; i < kWork; ++i) {
      EXPECT_EQ(times[i], i < size ? 1u : 0u);
      EXPECT_EQ(found[i], i < size ? size : 0u);
    }
  });
}

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
// Buffers of the pool are larger than what is asked for; the sanitizer sees the end of that.
TEST(Sanitizer, ReportsAKernelThatWritesBehindABuffer) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const NativeKernels& kernels : builtInKernels()) {
    const DeviceFound found = describedBuiltin(kernels, std::uint64_t{1} << 32);
    if (!found.fault.empty()) continue;
    const auto fails = [&] {
      const auto device = found.open();
      const DeviceBuffer numbers = makeBuffer<std::uint32_t>(*device, 1000);
      launchKernel(*device, "of_fault", 1, 1, numbers, std::uint32_t{1000});
    };
    EXPECT_DEATH(fails(), "use-after-poison");
  }
}
#endif
#endif

}  // namespace
}  // namespace sherd
