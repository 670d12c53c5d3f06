// Choosing and opening OpenCL devices.
#include <sherd/device.h>
#include <sherd/error.h>

#include <algorithm>
#include <optional>

#include "base/lower_case.h"
#include "cl/device_impl.h"
#include "cl/device_search.h"
#include "cl/kernel_cache.h"

namespace sherd {
namespace {

std::vector<DeviceFound> usableDevices(const std::vector<PlatformFound>& platforms) {
  std::vector<DeviceFound> usable;
  for (const PlatformFound& platform : platforms) {
    for (const DeviceFound& device : platform.devices) {
      if (device.fault.empty()) usable.push_back(device);
    }
  }
  return usable;
}

std::optional<std::size_t> choose(const std::vector<DeviceFound>& all, const std::string& choice) {
  const auto first = [&](auto&& accept) -> std::optional<std::size_t> {
    const auto it = std::find_if(all.begin(), all.end(), accept);
    if (it == all.end()) return std::nullopt;
    return static_cast<std::size_t>(it - all.begin());
  };
  const auto gpu = [](const DeviceFound& c) { return c.info.gpu; };
  // Other CPU drivers (llvmpipe's) run far slower than PoCL.
  const auto pocl = [](const DeviceFound& c) { return c.info.platform == kPocl; };
  const auto cpu = [](const DeviceFound& c) { return !c.info.gpu; };
  if (choice == "gpu") return first(gpu);
  if (choice == "cpu" || choice == "auto") {
    std::optional<std::size_t> found;
    if (choice == "auto") found = first(gpu);
    if (!found) found = first(pocl);
    if (!found) found = first(cpu);
    return found;
  }
  return first([&](const DeviceFound& c) {
    return lowerCase(c.info.platform).find(choice) != std::string::npos ||
           lowerCase(c.info.name).find(choice) != std::string::npos;
  });
}

}  // namespace

std::vector<DeviceInfo> listDevices() {
  const std::vector<DeviceFound> all = usableDevices(findPlatforms());
  const std::optional<std::size_t> chosen = choose(all, "auto");
  std::vector<DeviceInfo> infos;
  for (std::size_t i = 0; i < all.size(); ++i) {
    infos.push_back(all[i].info);
    infos.back().chosen = chosen == i;
  }
  return infos;
}

std::vector<PlatformState> listPlatforms() {
  const std::vector<PlatformFound> platforms = findPlatforms();
  const std::vector<DeviceFound> usable = usableDevices(platforms);
  const std::optional<std::size_t> chosen = choose(usable, "auto");
  std::vector<PlatformState> states;
  for (const PlatformFound& platform : platforms) {
    states.push_back({platform.name, platform.version, platform.fault, {}});
    for (const DeviceFound& device : platform.devices) {
      states.back().devices.push_back(device);
      states.back().devices.back().info.chosen = chosen && usable[*chosen].id == device.id;
    }
  }
  return states;
}

std::string noDeviceReason() { return noDeviceReason(findPlatforms()); }

Device::Device(std::string_view choice) : impl_(std::make_unique<DeviceImpl>()) {
  const std::vector<PlatformFound> platforms = findPlatforms();
  const std::vector<DeviceFound> all = usableDevices(platforms);
  const std::optional<std::size_t> found = choose(all, lowerCase(std::string(choice)));
  if (!found && all.empty())
    throw Error(ErrorCode::device, "no OpenCL device can be used: " + noDeviceReason(platforms));
  if (!found) {
    std::string here;
    for (const DeviceFound& c : all)
      here += (here.empty() ? "" : ", ") + c.info.platform + " / " + c.info.name;
    throw Error(ErrorCode::device,
                "no OpenCL device matches '" + std::string(choice) + "'; devices here: " + here);
  }
  impl_->info = all[*found].info;
  impl_->device = cl::Device(all[*found].id, /*retainObject=*/true);
  if (impl_->info.platform == kPocl) {  // its compiler ends the process if it cannot write
    const KernelCache cache = poclCache();
    if (!cache.fault.empty()) throw Error(ErrorCode::device, cacheFaultMessage(cache));
    if (const std::string fault = linkerFault(); !fault.empty())
      throw Error(ErrorCode::device, fault);
  }
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

DeviceImpl& implOf(Device& device) { return *device.impl_; }

}  // namespace sherd
