// Discovery of OpenCL platforms and devices.  All driver differences are handled here.
#include <algorithm>

#include "base/text/text_scan.h"
#include "cl/device_search.h"
#include "cl/error_name.h"
#include "cl/kernel_cache.h"
#include "cl/open_cl_device.h"

namespace sherd {
namespace {

// Drivers pad their texts, by blanks or by null characters.
std::string text(const std::string& padded) { return std::string(trimmed(padded.c_str())); }

// Returns why kernels cannot run on a device; empty if they can.  They need OpenCL C 1.2, which
// has 32-bit atomics on global memory.
std::string faultOf(const cl::Device& device) {
  if (!device.getInfo<CL_DEVICE_AVAILABLE>()) return "it is not available";
  if (!device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>()) return "it has no compiler";
  if (!device.getInfo<CL_DEVICE_ENDIAN_LITTLE>()) return "it is big-endian";
  const std::string version = device.getInfo<CL_DEVICE_VERSION>();  // "OpenCL <major>.<minor> ..."
  if (version.size() <= 9 || (version[7] <= '1' && version[9] < '2')) return "OpenCL 1.2 is needed";
  return {};
}

// Mesa's llvmpipe counts the iterations of all loops of a work-item, and leaves its loops after
// 65,535 (LP_MAX_TGSI_LOOP_ITERATIONS).
std::string caveatOf(const std::string& name) {
  if (name.find("llvmpipe") == std::string::npos) return {};
  return "llvmpipe ends long loops early, so voxels of fractures in many pieces can have the wrong "
         "label";
}

DeviceFound described(const cl::Device& device, const std::string& platform) {
  DeviceFound found;
  found.info.platform = platform;
  found.info.name = text(device.getInfo<CL_DEVICE_NAME>());
  found.info.version = text(device.getInfo<CL_DEVICE_VERSION>());
  found.info.gpu = (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_GPU) != 0;
  found.info.computeUnits = std::max(1u, device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>());
  found.info.memoryBytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  found.info.largestBufferBytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  found.info.caveat = caveatOf(found.info.name);
  found.driver = text(device.getInfo<CL_DRIVER_VERSION>());
  found.fault = faultOf(device);
  found.open = [info = found.info, device] {
    const std::span<const NativeKernels> compiled = nativeKernels();
    return std::make_unique<OpenClDevice>(
        info, device, std::string(),
        compiled.empty() ? std::span<const NativeKernels::Entry>() : compiled.front().entries);
  };
  return found;
}

PlatformFound examined(const cl::Platform& platform) {
  PlatformFound found;
  try {
    found.name = text(platform.getInfo<CL_PLATFORM_NAME>());
    found.version = text(platform.getInfo<CL_PLATFORM_VERSION>());
    std::vector<cl::Device> devices;
    platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
    for (const cl::Device& device : devices) {
      found.devices.push_back(described(device, found.name));
    }
  } catch (const cl::Error& e) {
    found.fault = std::string(e.what()) + " fails with OpenCL error " + errorName(e.err());
  }
  if (found.devices.empty() && found.fault.empty()) found.fault = "it has no device";
  if (found.devices.empty() && found.name == kPocl) {  // reports no reason itself
    const KernelCache cache = poclCache();
    if (!cache.fault.empty()) found.fault = cacheFaultMessage(cache);
  }
  return found;
}

}  // namespace

std::vector<PlatformFound> openClPlatforms() {
  if (const std::string fault = loaderFault(); !fault.empty()) return {{"OpenCL", "", fault, {}}};
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {  // there is none
  }
  std::vector<PlatformFound> found;
  for (const cl::Platform& platform : platforms) found.push_back(examined(platform));
  return found;
}

bool usesOpenCl() { return true; }

}  // namespace sherd
