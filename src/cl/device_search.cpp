// Discovery of OpenCL platforms, devices and drivers.  All driver differences are handled here.
#include "cl/device_search.h"

#include <dlfcn.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>

#include "cl/error_name.h"
#include "cl/kernel_cache.h"
#include "cl/open_cl.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVendors = "/etc/OpenCL/vendors";

std::string trimmed(std::string s) {
  while (!s.empty() && (s.back() == '\0' || std::isspace(static_cast<unsigned char>(s.back()))))
    s.pop_back();
  return s;
}

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

DeviceFound described(const cl::Device& device, const std::string& platform) {
  DeviceFound found;
  found.id = device();
  found.info.platform = platform;
  found.info.name = trimmed(device.getInfo<CL_DEVICE_NAME>());
  found.info.version = trimmed(device.getInfo<CL_DEVICE_VERSION>());
  found.info.gpu = (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_GPU) != 0;
  found.info.computeUnits = std::max(1u, device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>());
  found.info.memoryBytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  found.info.largestBufferBytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  found.driver = trimmed(device.getInfo<CL_DRIVER_VERSION>());
  found.fault = faultOf(device);
  return found;
}

PlatformFound examined(const cl::Platform& platform) {
  PlatformFound found;
  try {
    found.name = trimmed(platform.getInfo<CL_PLATFORM_NAME>());
    found.version = trimmed(platform.getInfo<CL_PLATFORM_VERSION>());
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

// Loads the library that a driver's file names, as OpenCL's loader does.
DriverFile loaded(fs::path file, std::string library) {
  DriverFile driver{std::move(file), std::move(library), {}};
  if (driver.library.empty()) {
    driver.fault = "it names no library";
  } else if (void* const handle = ::dlopen(driver.library.c_str(), RTLD_LAZY | RTLD_LOCAL)) {
    if (::dlsym(handle, "clGetExtensionFunctionAddress") == nullptr)
      driver.fault = driver.library + " is no OpenCL driver";
  } else {
    driver.fault = ::dlerror();
  }
  return driver;  // never unloaded: drivers start threads
}

DriverFile read(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return in.is_open() ? loaded(file, trimmed(line)) : DriverFile{file, {}, "it cannot be read"};
}

}  // namespace

fs::path driverFolder() {
  for (const char* const name : {"OCL_ICD_VENDORS", "OPENCL_VENDOR_PATH"}) {
    const char* const value = std::getenv(name);
    if (value != nullptr && *value != '\0') return value;
  }
  return kVendors;
}

std::vector<DriverFile> listDrivers() {
  const fs::path folder = driverFolder();
  std::error_code error;
  std::vector<DriverFile> found;
  if (fs::is_directory(folder, error)) {
    std::vector<fs::path> files;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
      if (at->path().extension() == ".icd") files.push_back(at->path());
    }
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) found.push_back(read(file));
  } else if (folder.extension() == ".icd") {
    const bool isNameOnly = !folder.has_parent_path();
    found.push_back(read(isNameOnly ? kVendors / folder : folder));
  } else if (folder != kVendors) {  // a library, then
    found.push_back(loaded({}, folder.string()));
  }
  return found;
}

std::vector<PlatformFound> findPlatforms() {
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {  // there is none
  }
  std::vector<PlatformFound> found;
  for (const cl::Platform& platform : platforms) found.push_back(examined(platform));
  return found;
}

std::string noDeviceReason(const std::vector<PlatformFound>& platforms) {
  std::string why;
  const auto add = [&](const std::string& more) { why += (why.empty() ? "" : "; ") + more; };
  for (const PlatformFound& platform : platforms) {
    if (platform.devices.empty()) add(platform.name + ": " + platform.fault);
    for (const DeviceFound& device : platform.devices) {
      if (!device.fault.empty())
        add(platform.name + " / " + device.info.name + ": " + device.fault);
    }
  }
  const std::vector<DriverFile> drivers = listDrivers();
  for (const DriverFile& driver : drivers) {
    if (!driver.fault.empty()) add(driver.file.string() + ": " + driver.fault);
  }
  if (drivers.empty())
    add("no driver is installed in " + driverFolder().string() +
        " (Debian's pocl-opencl-icd runs on any CPU)");
  return why.empty() ? "no driver has a platform" : why;
}

}  // namespace sherd
