// The growth rule of CONTRIBUTING.md with its test, both as written there.  Its kernel runs in the
// place of `nearest`, and so has to have the same parameters.
#include <gtest/gtest.h>
#include <sherd/labels.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "cl/builtin_device.h"
#include "cl/kernel_sources.h"
#include "cl/open_cl_device.h"
#include "device_fixture.h"
#include "voxel_shapes.h"

namespace sherd {

std::span<const NativeKernels> contributedKernels();   // cmake/CompileKernels.cmake
std::span<const std::string_view> contributedTexts();  // cmake/EmbedKernels.cmake

namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// The kernels of the program, of which `nearest` is that of the document.
NativeKernels withContributed(std::string_view instructions) {
  const auto in = [&](std::span<const NativeKernels> sets) {
    return *std::find_if(sets.begin(), sets.end(), [&](const NativeKernels& set) {
      return set.instructions == instructions;
    });
  };
  NativeKernels kernels = in(nativeKernels());
  static std::vector<NativeKernels::Entry> entries(kernels.entries.begin(), kernels.entries.end());
  const auto named = [](auto&& list, std::string_view name) {
    return std::find_if(list.begin(), list.end(), [&](const auto& e) { return e.name == name; });
  };
  const std::span<const NativeKernels::Entry> contributed = in(contributedKernels()).entries;
  auto& nearest = *named(entries, "nearest");
  nearest.function = named(contributed, "columns")->function;
  nearest.parameters = named(contributed, "columns")->parameters;
  kernels.entries = entries;
  return kernels;
}

std::unique_ptr<DeviceImpl> withContributed(const OpenClDevice& opened) {
  std::string source;
  for (const std::string_view file : kernelSources()) source += file;
  source = replaced(source, "kernel void nearest(", "kernel void nearest_itself(");
  for (const std::string_view file : contributedTexts()) source += file;
  return std::make_unique<OpenClDevice>(
      opened.info, opened.device, replaced(source, "kernel void columns(", "kernel void nearest("),
      std::span<const NativeKernels::Entry>());
}

class ContributedRule : public DeviceTest {
 protected:
  // Never freed, as DeviceTest's.
  static Device& device() {
    static Device* const changed = [] {
      DeviceImpl& usual = implOf(DeviceTest::device());
      if (const auto* opened = dynamic_cast<OpenClDevice*>(&usual))
        return new Device(deviceOf(withContributed(*opened)));
      static const NativeKernels kernels = withContributed(usual.info.name);
      return new Device(deviceOf(describedBuiltin(kernels, usual.info.memoryBytes).open()));
    }();
    return *changed;
  }
};

}  // namespace
}  // namespace sherd

#define DeviceTest ContributedRule
#define Columns ContributedColumns
#define growthNamed(name) Growth::nearest
#include "columns_test.cpp"
