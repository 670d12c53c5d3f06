// Reading the objects of a run within its limits of time and memory.
#include "dataset/object_limits.h"

#include <sherd/error.h>
#include <sherd/files.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <utility>

#include "dataset/layouts/pfpp.h"

namespace sherd {

SourceMesh readObject(const LibraryObject& object, const DatasetOptions& options,
                      const Progress* progress) {
  if (!isVolumeName(object.file)) {
    return readMesh(object.file, {.maxMemory = options.maxMemory}, progress);
  }
  VolumeOptions volume;
  volume.maxMemory = options.maxMemory;
  volume.ownVoxels = false;  // all objects of a library have one resolution
  return std::move(readVolume(object.file, volume, progress).source);
}

void limitedInTime(const DatasetRun& run, const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::cancelled || run.cancelled()) throw;
    std::array<char, 32> seconds{};
    std::snprintf(seconds.data(), seconds.size(), "%g", run.options.objectTimeout);
    throw Error(
        ErrorCode::input,
        std::string("took longer than the ") + seconds.data() + " s that an object may take",
        OptionNames{"object-timeout"});
  }
}

std::uint64_t heldBytes(const DatasetOptions& options) {
  if (options.layout == DatasetLayout::pfpp) return kPfppParts + 1;
  const bool isLoose = options.layout != DatasetLayout::packed;
  return isLoose && options.compression != FileCompression::none ? 2 : 0;
}

std::size_t maxQueuedBytes(const DatasetOptions& options) {
  constexpr std::uint64_t kMost = std::uint64_t{64} << 20;
  return static_cast<std::size_t>(std::min(kMost, options.maxMemory / 8));
}

std::size_t maxInFlight(const DatasetOptions& options, std::uint64_t memory) {
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const std::size_t fit = memory > 0 ? options.maxMemory / memory : threads;
  return std::clamp<std::size_t>(fit, 1, threads + 1);
}

}  // namespace sherd
