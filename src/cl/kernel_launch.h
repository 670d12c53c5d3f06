// One launch of a kernel, for any device.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "cl/buffer_pool.h"

namespace sherd {

/// An argument of a kernel: a buffer, or a value of the kernel's own type.
struct KernelArgument {
  Allocation* buffer = nullptr;
  const void* value = nullptr;
  std::size_t bytes = 0;  ///< of the value
};

inline KernelArgument argumentOf(const DeviceBuffer& buffer) { return {&*buffer, nullptr, 0}; }
template <class T>
KernelArgument argumentOf(const T& value) {
  return {nullptr, &value, sizeof value};
}

/// Where a kernel that is compiled into the program starts.
using KernelEntry = void (*)();

/// Calls such a kernel.
///   arguments  [parameters] a buffer's memory, or a pointer to a value
using KernelCall = void (*)(KernelEntry kernel, void* const* arguments);

/// One launch over a range of work-items; every kernel strides over its work by the number of them.
struct KernelLaunch {
  const char* kernel = "";
  std::size_t work = 0;   ///< elements
  std::size_t group = 0;  ///< work-items per work-group
  std::span<const KernelArgument> arguments;
  KernelCall call = nullptr;
};

// What a kernel has as parameter, and its value.
template <class T>
struct KernelParameter {
  using Type = T;
  static T of(void* argument) { return *static_cast<const T*>(argument); }
};
template <>
struct KernelParameter<DeviceBuffer> {
  using Type = void*;
  static void* of(void* argument) { return argument; }
};

/// KernelCall for arguments of these types.  A kernel's function takes a pointer for each buffer
/// and values as they are.
template <class... Arguments>
void callKernel(KernelEntry kernel, void* const* arguments) {
  const auto call = [&]<std::size_t... I>(std::index_sequence<I...>) {
    reinterpret_cast<void (*)(typename KernelParameter<Arguments>::Type...)>(kernel)(
        KernelParameter<Arguments>::of(arguments[I])...);
  };
  call(std::index_sequence_for<Arguments...>());
}

}  // namespace sherd
