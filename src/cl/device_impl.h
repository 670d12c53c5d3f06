// The open device: program, buffers and launches, for the stages that launch kernels.
#pragma once

#include <sherd/device.h>
#include <sherd/error.h>

#include <future>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cl/buffer_pool.h"
#include "cl/error_name.h"
#include "cl/open_cl.h"

namespace sherd {

struct DeviceImpl {
  DeviceInfo info;
  cl::Device device;
  cl::Context context;
  cl::CommandQueue queue;
  BufferPool pool;
  std::shared_future<cl::Program> program;  ///< contains all kernels

  /// Start building all kernels in a separate thread, once: a mesh can be voxelized meanwhile.
  void buildKernels();

  /// Return a kernel of kernels/*.cl; waits for the build.
  ///   throws  Error(device) with the build log's first lines
  cl::Kernel kernel(const char* name);

  /// Launch a grid-stride kernel over `work` elements with `group` work-items per work-group.
  void launch(cl::Kernel& kernel, std::size_t work, std::size_t group);

  /// Work-items per work-group for grid-stride kernels on this device.
  std::size_t workGroupSize() const { return info.gpu ? 64 : 16; }

  /// Work-items that saturate the device when each takes many leaves.
  std::size_t workItems() const {
    return info.computeUnits * (info.gpu ? 1024u : 8u * static_cast<unsigned>(workGroupSize()));
  }
};

/// Returns the open device behind a Device.
[[nodiscard]] DeviceImpl& implOf(Device& device);

/// Run `body`; errors of the OpenCL bindings become Error(device), with `doing` in the message.
template <class Body>
auto withDevice(DeviceImpl& device, const char* doing, Body&& body) {
  try {
    return body();
  } catch (const cl::Error& e) {
    throw Error(ErrorCode::device,
                device.info.name + ": " + doing + " failed in " + e.what() + " with OpenCL error " +
                    errorName(e.err()) + "; try another device",
                OptionNames{"device"});
  }
}

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
  return device.pool.take(device.context, bytes,
                          {device.info.largestBufferBytes, device.info.memoryBytes});
}

/// A device buffer with a copy of `data`.  (No CL_MEM_USE_HOST_PTR: oclgrind reports false errors
/// for it.)
template <class T>
DeviceBuffer uploadBuffer(DeviceImpl& device, std::span<const T> data) {
  DeviceBuffer buffer = makeBuffer<T>(device, data.size());
  if (!data.empty())
    device.queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, data.size_bytes(), data.data());
  return buffer;
}

/// Append `count` elements of a buffer, from `first` on, to `all`.  On a CPU the mapping is the
/// buffer itself, so this is one copy, into memory that is not zeroed first.
template <class T>
void append(std::vector<T>& all, DeviceImpl& device, const DeviceBuffer& buffer, std::size_t count,
            std::size_t first = 0) {
  if (count == 0) return;
  void* const mapped = device.queue.enqueueMapBuffer(buffer, CL_TRUE, CL_MAP_READ,
                                                     first * sizeof(T), count * sizeof(T));
  const auto unmap = [&](void* from) { device.queue.enqueueUnmapMemObject(buffer, from); };
  const std::unique_ptr<void, decltype(unmap)> held(mapped, unmap);
  const T* const from = static_cast<const T*>(mapped);
  all.insert(all.end(), from, from + count);
}

template <class T>
std::vector<T> downloaded(DeviceImpl& device, const DeviceBuffer& buffer, std::size_t count,
                          std::size_t first = 0) {
  std::vector<T> all;
  append(all, device, buffer, count, first);
  return all;
}

template <class T>
void readBuffer(DeviceImpl& device, const DeviceBuffer& buffer, std::span<T> out,
                std::size_t first = 0) {
  if (!out.empty()) {
    device.queue.enqueueReadBuffer(buffer, CL_TRUE, first * sizeof(T), out.size_bytes(),
                                   out.data());
  }
}

}  // namespace sherd
