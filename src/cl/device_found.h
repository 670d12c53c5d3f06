// Devices that were found.
#pragma once

#include <sherd/device.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cl/device_impl.h"

namespace sherd {

/// A device that can be opened.
struct DeviceFound : DeviceState {
  std::function<std::unique_ptr<DeviceImpl>()> open;
};

struct PlatformFound {
  std::string name;
  std::string version;
  std::string fault;  ///< why it has no device
  std::vector<DeviceFound> devices;
};

}  // namespace sherd
