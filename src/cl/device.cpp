// Choosing and opening devices.
#include <sherd/device.h>
#include <sherd/error.h>

#include <algorithm>
#include <optional>

#include "base/text/lower_case.h"
#include "cl/builtin_device.h"
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

bool isBuiltin(const DeviceFound& device) { return device.info.platform == kBuiltin; }

// Returns the index of the chosen device.  `auto` prefers the built-in device to a GPU, which takes
// longer to open and close than it saves in all but the largest fractures, and to PoCL, which runs
// the same kernels no faster and starts later (docs/performance.md, "Devices").
std::optional<std::size_t> choose(const std::vector<DeviceFound>& all, const std::string& choice) {
  const auto first = [&](auto&& accept) -> std::optional<std::size_t> {
    const auto it = std::find_if(all.begin(), all.end(), accept);
    if (it == all.end()) return std::nullopt;
    return static_cast<std::size_t>(it - all.begin());
  };
  const auto gpu = [](const DeviceFound& c) { return c.info.gpu; };
  const auto pocl = [](const DeviceFound& c) { return c.info.platform == kPocl; };
  const auto cpu = [](const DeviceFound& c) { return !c.info.gpu && c.info.caveat.empty(); };
  if (choice == "gpu") return first(gpu);
  if (choice == "cpu" || choice == "auto") {
    std::optional<std::size_t> found = first(isBuiltin);
    if (!found && choice == "auto") found = first(gpu);
    if (!found) found = first(pocl);
    if (!found) found = first(cpu);
    return found;
  }
  return first([&](const DeviceFound& c) {
    for (const std::string& text : {c.info.platform, c.info.name, c.info.version}) {
      if (lowerCase(text).find(choice) != std::string::npos) return true;
    }
    return false;
  });
}

// Returns the built-in device if it is the choice whatever OpenCL's drivers have.
std::optional<DeviceFound> builtinFor(const std::string& choice) {
  if (choice == "gpu") return std::nullopt;
  const std::vector<DeviceFound> usable = usableDevices({builtinPlatform()});
  const std::optional<std::size_t> found = choose(usable, choice);
  return found ? std::optional(usable[*found]) : std::nullopt;
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

DeviceSupport deviceSupport() {
  DeviceSupport support{{}, {}, usesOpenCl()};
  for (const NativeKernels& kernels : nativeKernels()) {
    support.instructions.emplace_back(kernels.instructions);
    support.compiler = kernels.compiler;
  }
  return support;
}

std::vector<PlatformState> listPlatforms() {
  const std::vector<PlatformFound> platforms = findPlatforms();
  const std::optional<std::size_t> chosen = choose(usableDevices(platforms), "auto");
  std::size_t usable = 0;
  std::vector<PlatformState> states;
  for (const PlatformFound& platform : platforms) {
    states.push_back({platform.name, platform.version, platform.fault, {}});
    for (const DeviceFound& device : platform.devices) {
      states.back().devices.push_back(device);
      if (device.fault.empty()) states.back().devices.back().info.chosen = chosen == usable++;
    }
  }
  return states;
}

std::string noDeviceReason() {
  const std::string why = faultsOf(findPlatforms());
  return why.empty() ? "no driver has a platform" : why;
}

bool mayUseOpenCl(std::string_view choice) { return !builtinFor(lowerCase(std::string(choice))); }

Device::Device(std::unique_ptr<DeviceImpl> opened) : impl_(std::move(opened)) {}

Device::Device(std::string_view choice) {
  const std::string wanted = lowerCase(std::string(choice));
  if (const std::optional<DeviceFound> builtin = builtinFor(wanted)) {
    impl_ = builtin->open();
    return;
  }
  const std::vector<PlatformFound> platforms = findPlatforms();
  const std::vector<DeviceFound> all = usableDevices(platforms);
  const std::optional<std::size_t> found = choose(all, wanted);
  if (!found) {
    std::string here;
    for (const DeviceFound& c : all)
      here += (here.empty() ? "" : ", ") + c.info.platform + " / " + c.info.name;
    const std::string why = faultsOf(platforms);
    throw Error(ErrorCode::device, "no device matches '" + std::string(choice) +
                                       "'; devices here: " + (here.empty() ? "none" : here) +
                                       (why.empty() ? "" : "; of others: " + why));
  }
  impl_ = all[*found].open();
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

Device deviceOf(std::unique_ptr<DeviceImpl> opened) { return Device(std::move(opened)); }

}  // namespace sherd
