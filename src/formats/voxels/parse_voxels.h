// Parsers of voxel files in memory.
#pragma once

#include <sherd/files.h>

#include <string>
#include <string_view>

namespace sherd {

// Parsers of whole files in memory.  Memory grows with the number of runs, not with the box; a
// compressed file of a megabyte may hold 10^9 runs.  An `.npy` in Fortran order takes 128 MiB more.
//   name    used in messages
//   throws  Error(input), also for more memory than `options` allow, `bytes` not counted
[[nodiscard]] RunLengthVoxels parseRle(std::string_view bytes, const std::string& name,
                                       const ReadOptions& options = {});
[[nodiscard]] RunLengthVoxels parseNpyLabels(std::string_view bytes, const std::string& name,
                                             const ReadOptions& options = {});
[[nodiscard]] PlacedVoxels parseNpzLabels(std::string_view bytes, const std::string& name,
                                          const ReadOptions& options = {});
[[nodiscard]] RunLengthVoxels parseMagicaVoxel(std::string_view bytes, const std::string& name,
                                               const ReadOptions& options = {});
[[nodiscard]] RunLengthVoxels parseQuadStack(std::string_view bytes, const std::string& name,
                                             const ReadOptions& options = {});
[[nodiscard]] RunLengthVoxels parseBing(std::string_view bytes, const std::string& name,
                                        const ReadOptions& options = {});

}  // namespace sherd
