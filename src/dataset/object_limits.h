// Reading the objects of a run within its limits of time and memory.
#pragma once

#include <sherd/dataset.h>

#include <cstddef>
#include <cstdint>
#include <functional>

#include "dataset/dataset_run.h"

namespace sherd {

/// Reads a mesh, or the surface of a volume.
///   throws  what readMesh and readVolume throw
[[nodiscard]] SourceMesh readObject(const LibraryObject& object, const DatasetOptions& options,
                                    const Progress* progress);

/// Calls `work`, whose cancellation is a failure of the object unless the run was cancelled.
///   throws  Error(input) it took longer than options.objectTimeout; what `work` throws
void limitedInTime(const DatasetRun& run, const std::function<void()>& work);

/// Returns the bytes in memory for each byte of a fragment's file: loose files are compressed
/// whole, and pfpp has the points of up to kPfppParts fragments in one file.
[[nodiscard]] std::uint64_t heldBytes(const DatasetOptions& options);

/// Returns the bytes that may wait for the disk: they bridge its stalls, and are few beside the
/// memory of fractures.
[[nodiscard]] std::size_t maxQueuedBytes(const DatasetOptions& options);

/// Returns how many fractures are made at once.  One more than the threads keeps them busy while a
/// fracture is recorded.
///   memory  that one takes, bytes
[[nodiscard]] std::size_t maxInFlight(const DatasetOptions& options, std::uint64_t memory);

}  // namespace sherd
