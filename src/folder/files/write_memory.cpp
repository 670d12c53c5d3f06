// The memory that samples take while they are written.
//
// Samples are made in blocks.  Beyond these only some samplers and formats hold something for each
// point: docs/performance.md, "Memory".
#include "folder/files/write_memory.h"

#include <sherd/folder.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <string>
#include <utility>

#include "base/memory.h"
#include "folder/files/write_points.h"
#include "pipeline/memory_estimate.h"
#include "points/blocks.h"

namespace sherd {
namespace {

std::uint64_t blockOf(std::uint64_t count, std::uint64_t bytes) {
  return std::min<std::uint64_t>(count, kSamplesPerBlock) * bytes;
}

// Points of several fragments are sampled at once as far as samplingMemory allows.
std::uint64_t ofPoints(const WriteOptions& write, int pieces, std::uint64_t held) {
  const bool isText = std::ranges::count(write.pointFormats, PointFormat::xyz) > 0;
  const std::uint64_t one =
      pointMemory(write, write.points.count) + held * (isText ? 80 : 28) * write.points.count;
  const auto threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
  const std::uint64_t tasks = std::min(threads, static_cast<std::uint64_t>(std::max(pieces, 1)));
  return std::max(one, std::min(one * tasks, write.samplingMemory));
}

// Distances are held as they are stored; one mesh is sampled after another.
std::uint64_t ofDistances(const WriteOptions& write, std::uint64_t held) {
  const std::uint64_t count = write.distances.count;
  const std::uint64_t number = write.distances.type == SampleType::float16 ? 2 : 4;
  return count * number * (1 + 4 * held) + blockOf(count, 80);
}

std::uint64_t ofCorrespondences(const WriteOptions& write, int pieces, std::uint64_t held) {
  if (write.correspondences == 0) return 0;
  const auto contacts = 8 * static_cast<std::uint64_t>(std::max(pieces, 1));
  const std::uint64_t all = write.correspondences * contacts;
  return blockOf(all, 160) + held * 32 * all;
}

}  // namespace

// They are written one after another.
std::uint64_t sampleMemory(const WriteOptions& write, int pieces, std::uint64_t held) {
  return std::max({ofPoints(write, pieces, held), ofDistances(write, held),
                   ofCorrespondences(write, pieces, held)});
}

void requireSampleMemory(const WriteOptions& write, int pieces, std::uint64_t limit,
                         const std::function<std::uint64_t(std::uint64_t enough)>& fracture,
                         std::uint64_t held) {
  const std::uint64_t samples = sampleMemory(write, pieces, held);
  if (samples == 0) return;
  const std::uint64_t rest = fracture(limit - std::min(limit, samples));
  if (rest + samples <= limit) return;
  const bool isOfPoints = samples == ofPoints(write, pieces, held);
  const bool isOfDistances = !isOfPoints && samples == ofDistances(write, held);
  WriteOptions fewer;  // without what others take
  fewer.points = write.points;
  fewer.points.count = 0;
  fewer.pointFormats = write.pointFormats;
  fewer.samplingMemory = write.samplingMemory;
  fewer.distances.type = write.distances.type;
  const std::size_t asked = isOfPoints      ? write.points.count
                            : isOfDistances ? write.distances.count
                                            : write.correspondences;
  std::size_t& count = isOfPoints      ? fewer.points.count
                       : isOfDistances ? fewer.distances.count
                                       : fewer.correspondences;
  std::size_t fits = 0;
  for (std::size_t low = 1, high = asked; low <= high;) {
    count = low + (high - low) / 2;
    if (rest + sampleMemory(fewer, pieces, held) <= limit) {
      fits = count;
      low = count + 1;
    } else {
      high = count - 1;
    }
  }
  const char* const what = isOfPoints      ? "points on a fragment"
                           : isOfDistances ? "distance samples of a fragment"
                                           : "points on a contact";
  throw memoryError((fits > 0 ? std::to_string(fits) : std::string("no")) + " " + what +
                        " fit beside the fracture; one with " + std::to_string(asked),
                    rest + samples, limit,
                    OptionNames{isOfPoints      ? "points"
                                : isOfDistances ? "sdf-samples"
                                                : "correspondences",
                                "max-memory"});
}

// Volumes are read within the limit.
void requireMemory(const FractureInput& input, const FractureOptions& options,
                   const WriteOptions& write, std::uint64_t limit) {
  const MeshesHeld held = write.needsAllMeshes() ? MeshesHeld::all
                          : write.preview        ? MeshesHeld::preview
                                                 : MeshesHeld::some;
  const Solid* const solid = input.finished ? &input.finished->solid
                             : input.solid  ? &*input.solid
                                            : nullptr;
  if (solid == nullptr) requireMemory(input.source.mesh, options, limit, held);
  requireSampleMemory(write, options.pieces, limit, [&](std::uint64_t enough) {
    return solid == nullptr ? estimatedMemoryWithin(input.source.mesh, options, held, enough)
                            : estimatedMemory(*solid);
  });
}

}  // namespace sherd
