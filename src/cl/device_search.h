// OpenCL platforms, devices and drivers of this machine, with the reasons why some cannot be used.
#pragma once

#include <sherd/device.h>

#include <filesystem>
#include <string>
#include <vector>

struct _cl_device_id;

namespace sherd {

/// A device with OpenCL's handle of it.
struct DeviceFound : DeviceState {
  _cl_device_id* id = nullptr;
};

struct PlatformFound {
  std::string name;
  std::string version;
  std::string fault;  ///< why it has no device
  std::vector<DeviceFound> devices;
};

/// Every platform with its devices.
[[nodiscard]] std::vector<PlatformFound> findPlatforms();

/// The reasons why no device can be used, and what to do, as the second half of a sentence.
///   platforms  without a usable device
[[nodiscard]] std::string noDeviceReason(const std::vector<PlatformFound>& platforms);

}  // namespace sherd
