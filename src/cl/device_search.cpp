// Discovery of devices: the built-in one and those of OpenCL drivers.
#include "cl/device_search.h"

#include "base/memory.h"
#include "cl/builtin_device.h"

namespace sherd {

PlatformFound builtinPlatform() {
  PlatformFound found{kBuiltin, "", "this build has no compiled kernels", {}};
  const std::uint64_t memory = freeMemory();
  for (const NativeKernels& kernels : nativeKernels()) {
    found.fault.clear();
    found.devices.push_back(describedBuiltin(kernels, memory));
  }
  return found;
}

std::vector<PlatformFound> findPlatforms() {
  std::vector<PlatformFound> found = openClPlatforms();
  found.insert(found.begin(), builtinPlatform());
  return found;
}

std::string faultsOf(const std::vector<PlatformFound>& platforms) {
  std::string why;
  const auto add = [&](const std::string& more) { why += (why.empty() ? "" : "; ") + more; };
  for (const PlatformFound& platform : platforms) {
    if (platform.devices.empty()) add(platform.name + ": " + platform.fault);
    for (const DeviceFound& device : platform.devices) {
      if (!device.fault.empty())
        add(platform.name + " / " + device.info.name + ": " + device.fault);
    }
  }
  if (!usesOpenCl()) {
    add("this build is without OpenCL");
    return why;
  }
  const std::vector<DriverFile> drivers = listDrivers();
  for (const DriverFile& driver : drivers) {
    if (!driver.fault.empty()) add(driver.file.string() + ": " + driver.fault);
  }
  if (drivers.empty())
    add("no driver is installed in " + driverFolder().string() +
        " (Debian's pocl-opencl-icd runs on any CPU)");
  return why;
}

}  // namespace sherd
