// All devices of this machine, with kernels of a test.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cl/builtin_device.h"
#include "cl/device_search.h"
#include "cl/open_cl_device.h"

namespace sherd {

/// Opens every device that is here.  Keep them to the end: some drivers crash at exit.
///   compiled  kernels for the built-in device; they stay where they are
///   source    of the kernels for OpenCL's
inline std::vector<std::shared_ptr<DeviceImpl>> devicesWith(std::span<const NativeKernels> compiled,
                                                            const std::string& source) {
  std::vector<std::shared_ptr<DeviceImpl>> devices;
  for (const NativeKernels& kernels : compiled) {
    const DeviceFound found = describedBuiltin(kernels, std::uint64_t{1} << 32);
    if (found.fault.empty()) devices.push_back(found.open());
  }
  for (const PlatformFound& platform : openClPlatforms()) {
    for (const DeviceFound& found : platform.devices) {
      if (!found.fault.empty()) continue;
      const auto open = found.open();
      const auto& opened = dynamic_cast<OpenClDevice&>(*open);
      devices.push_back(std::make_shared<OpenClDevice>(
          found.info, opened.device, source,
          compiled.empty() ? std::span<const NativeKernels::Entry>() : compiled.front().entries));
    }
  }
  return devices;
}

}  // namespace sherd
