// One launch of a kernel, for any device.
#pragma once

#include <sherd/error.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "cl/buffer_pool.h"

namespace sherd {

/// What a parameter of a kernel takes, or an argument is: numbers of `sherd_parameter` in
/// kernels/built_ins.h.
enum class ArgumentKind : std::uint32_t {
  unknown = 0,
  buffer = 1,
  integer = 2,
  real = 3,
  structure = 4,
  vector = 5,  ///< which no argument is: registers for it differ between compilers
};

struct ArgumentType {
  ArgumentKind kind = ArgumentKind::unknown;
  std::uint32_t bytes = 0;  ///< of the value, sizeof(void*) of a buffer; 0 if unknown
};

/// An argument of a kernel: a buffer, or a value of the kernel's own type.
struct KernelArgument {
  Allocation* buffer = nullptr;
  const void* value = nullptr;
  ArgumentType type;
};

inline KernelArgument argumentOf(const DeviceBuffer& buffer) {
  return {&*buffer, nullptr, {ArgumentKind::buffer, sizeof(void*)}};
}
template <class T>
KernelArgument argumentOf(const T& value) {
  constexpr ArgumentKind kKind = std::is_integral_v<T> || std::is_enum_v<T> ? ArgumentKind::integer
                                 : std::is_floating_point_v<T>              ? ArgumentKind::real
                                                               : ArgumentKind::structure;
  return {nullptr, &value, {kKind, sizeof value}};
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

/// Checks that a launch has the arguments that its kernel takes.  A kernel called with others would
/// read memory that is not its own.
///   parameters  of the kernel; their kinds and sizes may be unknown
///   throws      Error(internal) another number, kind or size, which names the kernel and both
void checkArguments(const KernelLaunch& launch, std::span<const ArgumentType> parameters);

/// The error of a launch whose argument differs from the kernel's parameter.
///   index   from 0
///   reason  "is a buffer, its argument an integer of 4 bytes"
[[nodiscard]] Error argumentError(const KernelLaunch& launch, std::size_t index,
                                  const std::string& reason);

/// Returns "an integer of 4 bytes", "a buffer".
[[nodiscard]] std::string nameOf(const ArgumentType& type);

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
