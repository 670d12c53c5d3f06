// The open device: buffers and launches, for the stages that launch kernels.  An OpenCL device
// (open_cl_device.h) and the built-in one (builtin_device.h) implement it.
#pragma once

#include <sherd/device.h>
#include <sherd/error.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cl/buffer_pool.h"
#include "cl/kernel_launch.h"

namespace sherd {

/// What DeviceImpl::view calls.
using ViewedBytes = std::function<void(std::span<const std::byte>)>;
constexpr std::size_t kViewedBytes = std::size_t{1} << 20;

/// Commands run in the order in which they are given.  Every function throws Error(device) where
/// the device fails, and std::bad_alloc where the host has no memory.
class DeviceImpl {
 public:
  virtual ~DeviceImpl() = default;

  DeviceInfo info;
  BufferPool pool;

  /// Starts to build the kernels, where they are built at run time: a mesh can be voxelized
  /// meanwhile.
  virtual void buildKernels() {}

  /// Launches a kernel of kernels/*.cl; waits until the kernels are built.
  virtual void launch(const KernelLaunch& launch) = 0;

  [[nodiscard]] virtual std::unique_ptr<Allocation> allocate(std::size_t bytes) = 0;

  /// Limits a buffer, which the pool may have made larger, to its user's bytes: a sanitizer
  /// reports what lies beyond.
  virtual void bound(Allocation& memory, std::size_t bytes) {
    static_cast<void>(memory), static_cast<void>(bytes);
  }

  virtual void write(Allocation& to, const void* from, std::size_t bytes) = 0;
  virtual void read(Allocation& from, std::size_t offset, std::size_t bytes, void* to) = 0;

  /// Repeats a pattern over the first `bytes`.
  virtual void fill(Allocation& to, const void* pattern, std::size_t patternBytes,
                    std::size_t bytes) = 0;
  virtual void copy(Allocation& from, Allocation& to, std::size_t toOffset, std::size_t bytes) = 0;

  /// Passes memory to `use` that holds the same bytes: all at once, where it is the buffer itself,
  /// as on a CPU, or kViewedBytes at a time.
  virtual void view(Allocation& from, std::size_t offset, std::size_t bytes,
                    const ViewedBytes& use) = 0;

  /// Waits until all commands are done.
  virtual void finish() {}

  /// Work-items per work-group on this device.
  [[nodiscard]] std::size_t workGroupSize() const { return info.gpu ? 64 : 16; }
};

/// Returns the open device behind a Device.
[[nodiscard]] DeviceImpl& implOf(Device& device);

/// Returns a Device that is not one of the machine's list, for tests.
[[nodiscard]] Device deviceOf(std::unique_ptr<DeviceImpl> opened);

/// A device buffer of `count` T.
///   throws  Error(device) with the size when it exceeds the device's largest allocation
template <class T>
DeviceBuffer makeBuffer(DeviceImpl& device, std::size_t count) {
  const std::size_t bytes = std::max<std::size_t>(count, 1) * sizeof(T);
  if (bytes > device.info.largestBufferBytes) {
    throw Error(ErrorCode::device,
                device.info.name + ": a buffer of " + std::to_string(bytes >> 20) +
                    " MiB is needed, the device allows " +
                    std::to_string(device.info.largestBufferBytes >> 20) +
                    " MiB; try a lower resolution or another device",
                OptionNames{"resolution", "device"});
  }
  DeviceBuffer buffer =
      device.pool.take([&](std::size_t size) { return device.allocate(size); }, bytes,
                       {device.info.largestBufferBytes, device.info.memoryBytes});
  device.bound(*buffer, bytes);
  return buffer;
}

/// A device buffer with a copy of `data`.
template <class T>
DeviceBuffer uploadBuffer(DeviceImpl& device, std::span<const T> data) {
  DeviceBuffer buffer = makeBuffer<T>(device, data.size());
  if (!data.empty()) device.write(*buffer, data.data(), data.size_bytes());
  return buffer;
}

/// Appends `count` elements of a buffer, from `first` on, to `all`: one copy, into memory that is
/// not zeroed first.
template <class T>
void appendDownloaded(std::vector<T>& all, DeviceImpl& device, const DeviceBuffer& buffer,
                      std::size_t count, std::size_t first = 0) {
  static_assert(kViewedBytes % sizeof(T) == 0);
  if (count == 0) return;
  device.view(*buffer, first * sizeof(T), count * sizeof(T), [&](std::span<const std::byte> part) {
    const T* const from = reinterpret_cast<const T*>(part.data());
    all.insert(all.end(), from, from + part.size() / sizeof(T));
  });
}

template <class T>
std::vector<T> downloaded(DeviceImpl& device, const DeviceBuffer& buffer, std::size_t count,
                          std::size_t first = 0) {
  std::vector<T> all;
  all.reserve(count);
  appendDownloaded(all, device, buffer, count, first);
  return all;
}

template <class T>
void readBuffer(DeviceImpl& device, const DeviceBuffer& buffer, std::span<T> out,
                std::size_t first = 0) {
  if (!out.empty()) device.read(*buffer, first * sizeof(T), out.size_bytes(), out.data());
}

/// Fills the first `count` elements of a buffer, at least one.
template <class T>
void fillBuffer(DeviceImpl& device, const DeviceBuffer& buffer, std::size_t count, T value) {
  device.fill(*buffer, &value, sizeof value, std::max<std::size_t>(count, 1) * sizeof value);
}

/// Launches the kernel `name` over `work` elements.
template <class... Arguments>
void launchKernel(DeviceImpl& device, const char* name, std::size_t work, std::size_t group,
                  const Arguments&... arguments) {
  const std::array<KernelArgument, sizeof...(Arguments)> list{argumentOf(arguments)...};
  device.launch({name, work, group, list, &callKernel<Arguments...>});
}

}  // namespace sherd
