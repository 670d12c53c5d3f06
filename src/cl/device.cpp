// Finding and opening OpenCL devices.  Everything that differs from one driver to another is in
// this file.
#include <sherd/device.h>
#include <sherd/error.h>

#include <algorithm>
#include <optional>

#include "cl/device_impl.h"
#include "lower_case.h"

namespace sherd {
namespace {

struct Candidate {
  cl::Device device;
  DeviceInfo info;
};

std::string trimmed(std::string s) {
  while (!s.empty() && (s.back() == '\0' || std::isspace(static_cast<unsigned char>(s.back()))))
    s.pop_back();
  return s;
}

// Kernels need OpenCL C 1.2: 32-bit atomics on global memory are core there.
bool usable(const cl::Device& device) {
  const std::string version = device.getInfo<CL_DEVICE_VERSION>();  // "OpenCL <major>.<minor> ..."
  return device.getInfo<CL_DEVICE_AVAILABLE>() && device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>() &&
         device.getInfo<CL_DEVICE_ENDIAN_LITTLE>() && version.size() > 9 &&
         (version[7] > '1' || version[9] >= '2');
}

// A platform without devices makes the bindings throw: pass it over.
std::vector<Candidate> candidates() {
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {
    return {};
  }
  std::vector<Candidate> found;
  for (const cl::Platform& platform : platforms) {
    try {
      std::vector<cl::Device> devices;
      platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
      for (const cl::Device& device : devices) {
        if (!usable(device)) continue;
        DeviceInfo info;
        info.platform = trimmed(platform.getInfo<CL_PLATFORM_NAME>());
        info.name = trimmed(device.getInfo<CL_DEVICE_NAME>());
        info.version = trimmed(device.getInfo<CL_DEVICE_VERSION>());
        info.gpu = (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_GPU) != 0;
        info.computeUnits = std::max(1u, device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>());
        info.memoryBytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
        info.largestBufferBytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
        found.push_back({device, std::move(info)});
      }
    } catch (const cl::Error&) {
    }
  }
  return found;
}

std::optional<std::size_t> choose(const std::vector<Candidate>& all, const std::string& choice) {
  const auto first = [&](auto&& accept) -> std::optional<std::size_t> {
    const auto it = std::find_if(all.begin(), all.end(), accept);
    if (it == all.end()) return std::nullopt;
    return static_cast<std::size_t>(it - all.begin());
  };
  const auto gpu = [](const Candidate& c) { return c.info.gpu; };
  // Other CPU drivers (llvmpipe's) run far slower than PoCL.
  const auto pocl = [](const Candidate& c) {
    return c.info.platform == "Portable Computing Language";
  };
  const auto cpu = [](const Candidate& c) { return !c.info.gpu; };
  if (choice == "gpu") return first(gpu);
  if (choice == "cpu" || choice == "auto") {
    std::optional<std::size_t> found;
    if (choice == "auto") found = first(gpu);
    if (!found) found = first(pocl);
    if (!found) found = first(cpu);
    return found;
  }
  return first([&](const Candidate& c) {
    return lowerCase(c.info.platform).find(choice) != std::string::npos ||
           lowerCase(c.info.name).find(choice) != std::string::npos;
  });
}

}  // namespace

std::vector<DeviceInfo> listDevices() {
  const std::vector<Candidate> all = candidates();
  const std::optional<std::size_t> chosen = choose(all, "auto");
  std::vector<DeviceInfo> infos;
  for (std::size_t i = 0; i < all.size(); ++i) {
    infos.push_back(all[i].info);
    infos.back().chosen = chosen == i;
  }
  return infos;
}

Device::Device(std::string_view choice) : impl_(std::make_unique<Impl>()) {
  const std::vector<Candidate> all = candidates();
  const std::optional<std::size_t> found = choose(all, lowerCase(std::string(choice)));
  if (!found) {
    std::string here;
    for (const Candidate& c : all)
      here += (here.empty() ? "" : ", ") + c.info.platform + " / " + c.info.name;
    throw Error(ErrorCode::device,
                "no OpenCL device matches '" + std::string(choice) + "'; devices here: " +
                    (here.empty() ? "none (Debian's pocl-opencl-icd runs on any CPU)" : here));
  }
  impl_->info = all[*found].info;
  impl_->device = all[*found].device;
  withDevice(*impl_, "opening the device", [&] {
    impl_->context = cl::Context(impl_->device);
    impl_->queue = cl::CommandQueue(impl_->context, impl_->device);
  });
}

Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;

const DeviceInfo& Device::info() const { return impl_->info; }

DeviceMemory Device::memory() const {
  const BufferPool& pool = impl_->pool;
  return {pool.created(), pool.bytes(), pool.peakBytes()};
}

void Device::freeBuffers() { impl_->pool.clear(); }

}  // namespace sherd
