// OpenCL devices: which there are, and the one that works.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// One OpenCL device of this machine.
struct DeviceInfo {
  std::string platform;
  std::string name;
  std::string version;  ///< OpenCL version of the device
  bool gpu = false;
  unsigned computeUnits = 0;
  std::size_t memoryBytes = 0;
  std::size_t largestBufferBytes = 0;
  bool chosen = false;  ///< what --device auto picks
};

/// Every usable device; platforms without devices are passed over.  Empty when there is none.
[[nodiscard]] std::vector<DeviceInfo> listDevices();

/// What an open device holds of the device's memory.
struct DeviceMemory {
  std::size_t buffersCreated = 0;  ///< since it was opened; buffers are used again
  std::size_t bytes = 0;           ///< in buffers now, also those kept for the next fracture
  std::size_t peakBytes = 0;
};

/// An open device: context, queue, and the kernels, built once, when they are first needed or a
/// mesh is voxelized for them.  Opened once, used by one thread at a time.
class Device {
 public:
  /// Open a device.
  ///   choice  "auto" (a GPU, else a CPU), "gpu", "cpu", or a part of a platform's or device's
  ///           name, any case
  ///   throws  Error(device) nothing matches, or the device cannot be opened
  explicit Device(std::string_view choice = "auto");
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;

  const DeviceInfo& info() const;

  /// Any thread may ask.
  DeviceMemory memory() const;

  /// Free the buffers that were kept for the next fracture.
  void freeBuffers();

  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace sherd
