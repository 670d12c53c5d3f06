// OpenCL devices: listing and opening them.
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
  bool chosen = false;  ///< selected by Device("auto")
};

/// Returns every usable device; empty if there is none.  Platforms without devices are skipped.
[[nodiscard]] std::vector<DeviceInfo> listDevices();

/// Device memory that an open device has allocated.
struct DeviceMemory {
  std::size_t buffersCreated = 0;  ///< since it was opened; a reused buffer counts once
  std::size_t bytes = 0;           ///< in buffers now, those kept for reuse included
  std::size_t peakBytes = 0;
};

/// An open device: context, queue and kernels.  Kernels are built once, on first use or while a
/// mesh is voxelized.  Use a device from one thread at a time.
class Device {
 public:
  /// Opens a device.
  ///   choice  "auto" (a GPU, else a CPU), "gpu", "cpu", or a part of a platform's or device's
  ///           name, ignoring case
  ///   throws  Error(device) nothing matches, or the device cannot be opened
  explicit Device(std::string_view choice = "auto");
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;

  const DeviceInfo& info() const;

  /// Callable from any thread.
  DeviceMemory memory() const;

  /// Frees the buffers that are kept for reuse.
  void freeBuffers();

  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace sherd
