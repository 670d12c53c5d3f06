// Points and distance samples of a fracture: drawn when they are written, so that few are in memory
// at a time.
#pragma once

#include <sherd/io.h>

#include <span>
#include <string>
#include <vector>

#include "folder/manifest.h"

namespace sherd {

/// [fragments] how many of `count` points each gets, by its area.
[[nodiscard]] std::vector<std::size_t> sharedCounts(std::span<const Fragment> fragments,
                                                    std::size_t count);

/// Draw points on a fragment and write them.
///   files  [write.pointFormats] relative to the folder
///   seed   of the fracture
void writePointsOf(const OutputFolder& folder, const std::vector<std::string>& files,
                   const Fragment& fragment, std::size_t count, std::uint64_t seed,
                   const WriteOptions& write);

/// Draw and write files.solidSdf and files.sdf.
///   seed  of the fracture
void writeAllDistances(const OutputFolder& folder, const FractureFiles& files,
                       const FractureResult& result, std::uint64_t seed, DistanceOptions options,
                       const Progress* progress);

}  // namespace sherd
