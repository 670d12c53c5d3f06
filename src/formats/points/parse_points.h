// Parsers of point files in memory.
#pragma once

#include <sherd/files.h>

#include <string>
#include <string_view>

namespace sherd {

// Parsers of whole files in memory.
//   name    used in messages
//   throws  Error(input), also for more memory than `options` allow, `bytes` not counted
[[nodiscard]] SurfacePoints parsePlyPoints(std::string_view bytes, const std::string& name,
                                           const ReadOptions& options = {});
[[nodiscard]] SurfacePoints parseXyz(std::string_view bytes, const std::string& name,
                                     const ReadOptions& options = {});
[[nodiscard]] SurfacePoints parseNpzPoints(std::string_view bytes, const std::string& name,
                                           const ReadOptions& options = {});
[[nodiscard]] SurfacePoints parseBinp(std::string_view bytes, const std::string& name,
                                      const ReadOptions& options = {});

}  // namespace sherd
