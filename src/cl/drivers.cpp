// The driver files of OpenCL's loader.
#include <dlfcn.h>
#include <sherd/device.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "base/text/text_scan.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVendors = "/etc/OpenCL/vendors";

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
  return in.is_open() ? loaded(file, std::string(trimmed(line)))
                      : DriverFile{file, {}, "it cannot be read"};
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

}  // namespace sherd
