// What OpenCL finds on this machine, with what cannot be used and why.
#pragma once

#include <sherd/device.h>

#include <filesystem>
#include <string>
#include <vector>

struct _cl_device_id;

namespace sherd {

/// A driver as OpenCL's loader finds it: a file of one line that names a library.
struct DriverFile {
  std::filesystem::path file;  ///< empty where the environment names the library itself
  std::string library;
  std::string fault;  ///< why it cannot be loaded; empty: it can
};

struct DeviceFound {
  _cl_device_id* id = nullptr;
  DeviceInfo info;
  std::string driver;  ///< the driver's version
  std::string fault;   ///< why kernels cannot run there; empty: they can
};

struct PlatformFound {
  std::string name;
  std::string version;
  std::string fault;  ///< why it has no device
  std::vector<DeviceFound> devices;
};

/// Where the loader looks for drivers: /etc/OpenCL/vendors, or what OCL_ICD_VENDORS or
/// OPENCL_VENDOR_PATH name.
[[nodiscard]] std::filesystem::path driverFolder();

/// The drivers there, by name.
[[nodiscard]] std::vector<DriverFile> findDrivers();

/// Every platform with its devices.
[[nodiscard]] std::vector<PlatformFound> findPlatforms();

/// Half a sentence on why nothing that was found can be used, and what to do; for a machine where
/// no device of any platform can.
[[nodiscard]] std::string whyNoDevice(const std::vector<PlatformFound>& platforms);

}  // namespace sherd
