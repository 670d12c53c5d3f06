// Devices that run the kernels: listing and opening them.
//
// The built-in device needs no driver: the kernels compiled with the library by clang for x86-64,
// on the threads of the host (TBB's).  OpenCL devices come from the drivers of the machine, which
// compile the same kernels at run time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// One device of this machine.
struct DeviceInfo {
  std::string platform;  ///< "builtin", or OpenCL's platform
  std::string name;      ///< of the built-in device the instructions, such as x86-64-v3
  std::string version;   ///< OpenCL version of the device, or the compiler of its kernels
  bool gpu = false;
  unsigned computeUnits = 0;
  std::size_t memoryBytes = 0;
  std::size_t largestBufferBytes = 0;
  std::string caveat;   ///< why results can be wrong, as a clause; empty if they cannot
  bool chosen = false;  ///< selected by Device("auto")
};

/// Returns every usable device; empty if there is none.  Platforms without devices are skipped.
[[nodiscard]] std::vector<DeviceInfo> listDevices();

/// What this build can run kernels on.
struct DeviceSupport {
  std::vector<std::string> instructions;  ///< of the built-in device, the best first: "x86-64-v4"
  std::string compiler;                   ///< of its kernels: "clang 14.0.6"; empty without it
  bool openCl = false;                    ///< devices of OpenCL's drivers
};
[[nodiscard]] DeviceSupport deviceSupport();

/// A driver file of OpenCL's loader: one line that names a library.
struct DriverFile {
  std::filesystem::path file;  ///< empty where the environment names the library itself
  std::string library;
  std::string fault;  ///< why it cannot be loaded; empty if it can
};

/// A device, usable or not.
struct DeviceState {
  DeviceInfo info;
  std::string driver;  ///< the driver's version; empty without one
  std::string fault;   ///< why kernels cannot run on it; empty if they can
};

/// A platform with its devices: the built-in one, or of an OpenCL driver.
struct PlatformState {
  std::string name;
  std::string version;
  std::string fault;  ///< why it has no device
  std::vector<DeviceState> devices;
};

/// Returns every platform with its devices, usable or not; `chosen` is as in listDevices.
[[nodiscard]] std::vector<PlatformState> listPlatforms();

/// Returns the folder or file that lists drivers: OCL_ICD_VENDORS or OPENCL_VENDOR_PATH if set,
/// else /etc/OpenCL/vendors.
[[nodiscard]] std::filesystem::path driverFolder();

/// Returns the drivers of driverFolder(), sorted by name.
[[nodiscard]] std::vector<DriverFile> listDrivers();

/// Returns why no device can be used, and what to do, as the second half of a sentence.
[[nodiscard]] std::string noDeviceReason();

/// Device memory that an open device has allocated.
struct DeviceMemory {
  std::size_t buffersCreated = 0;  ///< since it was opened; a reused buffer counts once
  std::size_t bytes = 0;           ///< in buffers now, those kept for reuse included
  std::size_t peakBytes = 0;
};

class DeviceImpl;

/// Returns whether Device(choice) would load OpenCL's drivers: provideKernelCache() is needed
/// before.
[[nodiscard]] bool mayUseOpenCl(std::string_view choice);

/// An open device.  OpenCL's drivers build the kernels once, on first use or while a mesh is
/// voxelized.  Use a device from one thread at a time.
class Device {
 public:
  /// Opens a device.
  ///   choice  "auto": the built-in device, which needs none of OpenCL's drivers; in a build
  ///           without it a GPU, else as "cpu"
  ///           "gpu": the first one, worth its start at 2048 voxels, and from 512 with roughness
  ///           on few cores
  ///           "cpu": the built-in device, else PoCL, else any other without a caveat
  ///           "builtin", or a part of a platform's or device's name or version, ignoring case
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

 private:
  friend DeviceImpl& implOf(Device& device);  // of the stages that launch kernels
  friend Device deviceOf(std::unique_ptr<DeviceImpl> opened);
  explicit Device(std::unique_ptr<DeviceImpl> opened);

  std::unique_ptr<DeviceImpl> impl_;
};

/// A candidate for the cache folder.
struct KernelCache {
  std::filesystem::path folder;
  std::string source;  ///< the environment variable that names it, or "temporary folder"
  std::string fault;   ///< why it cannot be used; empty if it can
};

/// Sets the environment so that PoCL has a cache folder, without which it lists no device or ends
/// the process.  PoCL uses $POCL_CACHE_DIR, else $XDG_CACHE_HOME, else $HOME/.cache.  If that
/// folder cannot be used, POCL_CACHE_DIR is set to one that can: the next of these, or a private
/// folder of the user in $TMPDIR, /tmp, /var/tmp or /dev/shm, which later runs reuse.  If no folder
/// of PATH has ld, with which PoCL links kernels, /usr/bin and /bin are appended.  Programs call
/// this before the first thread starts and before OpenCL is used.  No other function of the library
/// changes the environment.
///   return  the folders tried; the last is in use unless it has a fault.  If POCL_CACHE_DIR is
///           set, no other folder is tried
std::vector<KernelCache> provideKernelCache();

}  // namespace sherd
