// OpenCL platforms, devices and drivers of this machine, with the reasons why some cannot be used.
#pragma once

#include <sherd/device.h>

#include <filesystem>
#include <string>
#include <vector>

struct _cl_device_id;

namespace sherd {

/// A driver file of OpenCL's loader: one line that names a library.
struct DriverFile {
  std::filesystem::path file;  ///< empty where the environment names the library itself
  std::string library;
  std::string fault;  ///< why it cannot be loaded; empty if it can
};

struct DeviceFound {
  _cl_device_id* id = nullptr;
  DeviceInfo info;
  std::string driver;  ///< the driver's version
  std::string fault;   ///< why kernels cannot run on it; empty if they can
};

struct PlatformFound {
  std::string name;
  std::string version;
  std::string fault;  ///< why it has no device
  std::vector<DeviceFound> devices;
};

/// The folder or file that lists drivers: OCL_ICD_VENDORS or OPENCL_VENDOR_PATH if set, else
/// /etc/OpenCL/vendors.
[[nodiscard]] std::filesystem::path driverFolder();

/// The drivers of driverFolder(), sorted by name.
[[nodiscard]] std::vector<DriverFile> findDrivers();

/// Every platform with its devices.
[[nodiscard]] std::vector<PlatformFound> findPlatforms();

/// The reasons why no device can be used, and what to do, as the second half of a sentence.
///   platforms  without a usable device
[[nodiscard]] std::string noDeviceReason(const std::vector<PlatformFound>& platforms);

}  // namespace sherd
