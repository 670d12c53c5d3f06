// The built-in device: kernels/*.cl compiled with the program, run on the threads of the host.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "cl/device_impl.h"
#include "cl/device_search.h"

namespace sherd {

/// CL_PLATFORM_NAME's counterpart of the built-in device.
inline constexpr const char* kBuiltin = "builtin";

/// Kernels compiled for one set of instructions, by cmake/CompileKernels.cmake.
struct NativeKernels {
  struct Entry {
    std::string_view name;
    KernelEntry function;
  };
  std::string_view instructions;  ///< as -march has it: "x86-64-v3"
  std::string_view compiler;      ///< "clang 14.0.6"
  std::span<const Entry> entries;
};

/// The program's kernels, once per set of instructions, the best first; empty in a build without a
/// compiler for OpenCL C.
[[nodiscard]] std::span<const NativeKernels> nativeKernels();

/// Returns why this processor cannot run such kernels; empty if it can.
[[nodiscard]] std::string instructionsFault(std::string_view instructions);

/// The device of one set of kernels.
[[nodiscard]] DeviceFound describedBuiltin(const NativeKernels& kernels);

class BuiltinDevice : public DeviceImpl {
 public:
  /// Calls `item` once for each of 0..items-1, on several threads; returns when all are done.
  using ForEachItem =
      std::function<void(std::size_t items, const std::function<void(std::size_t)>& item)>;

  /// Runs on TBB's threads.
  BuiltinDevice(DeviceInfo described, const NativeKernels& kernels);
  BuiltinDevice(DeviceInfo described, const NativeKernels& kernels, ForEachItem forEachItem);

  void launch(const KernelLaunch& launch) override;
  std::unique_ptr<Allocation> allocate(std::size_t bytes) override;
  void write(Allocation& to, const void* from, std::size_t bytes) override;
  void read(Allocation& from, std::size_t offset, std::size_t bytes, void* to) override;
  void fill(Allocation& to, const void* pattern, std::size_t patternBytes,
            std::size_t bytes) override;
  void copy(Allocation& from, Allocation& to, std::size_t toOffset, std::size_t bytes) override;
  void view(Allocation& from, std::size_t offset, std::size_t bytes,
            const std::function<void(const void*)>& use) override;

 private:
  const NativeKernels& kernels_;
  ForEachItem forEachItem_;
};

}  // namespace sherd
