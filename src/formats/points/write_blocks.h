// Writes samples that are made while they are written; see sherd/files.h.
#pragma once

#include <sherd/files.h>

#include "points/blocks.h"

namespace sherd {

/// Holds no more than a block, except for `.binp`: kBinpPerPoint bytes a point.
void writePoints(const OutputFile& file, const Blocks<SurfacePoints>& points, PointFormat format);

inline constexpr std::uint64_t kBinpPerPoint = 40;

void writeCorrespondences(const OutputFile& file, const Blocks<Correspondences>& points);

/// Holds the distances as they are stored: 4 or 2 bytes a sample.
void writeDistances(const OutputFile& file, const DistanceBlocks& samples);

}  // namespace sherd
