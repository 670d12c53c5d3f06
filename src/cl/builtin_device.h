// The built-in device: kernels/*.cl compiled with the program, run on the threads of the host.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "cl/device_found.h"
#include "cl/device_impl.h"

namespace sherd {

/// CL_PLATFORM_NAME's counterpart of the built-in device.
inline constexpr const char* kBuiltin = "builtin";

/// Kernels compiled for one set of instructions, by cmake/CompileKernels.cmake.
struct NativeKernels {
  struct Entry {
    std::string_view name;
    KernelEntry function;
    std::span<const ArgumentType> parameters;  ///< as the compiler has them
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

/// The device of one set of kernels, on TBB's threads.
///   memory  bytes that its buffers may take
[[nodiscard]] DeviceFound describedBuiltin(const NativeKernels& kernels, std::uint64_t memory);

/// Calls `item` once for each of 0..items-1, on several threads; returns when all are done.
using ForEachItem =
    std::function<void(std::size_t items, const std::function<void(std::size_t)>& item)>;

/// Opens such a device on other threads, for tests.
[[nodiscard]] std::unique_ptr<DeviceImpl> builtinDevice(DeviceInfo described,
                                                        const NativeKernels& kernels,
                                                        ForEachItem forEachItem);

}  // namespace sherd
