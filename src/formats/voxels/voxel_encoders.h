// The writers of voxel files, one for each format.
#pragma once

#include <sherd/files.h>

namespace sherd {

void encodeRle(const RunLengthVoxels& voxels, const ByteSink& sink);
void encodeNpyLabels(const RunLengthVoxels& voxels, const ByteSink& sink);
void encodeNpzLabels(const PlacedVoxels& voxels, const ByteSink& sink);
void encodeMagicaVoxel(const RunLengthVoxels& voxels, const ByteSink& sink);
void encodeQuadStack(const RunLengthVoxels& voxels, const ByteSink& sink);
void encodeBing(const RunLengthVoxels& voxels, const ByteSink& sink);

/// Returns whether fragments have to share colors in a `.vox` file.
[[nodiscard]] bool sharesColors(const RunLengthVoxels& voxels);

}  // namespace sherd
