// Pictures of fragments, ray-traced.
#pragma once

#include <sherd/fragments.h>
#include <sherd/progress.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace sherd {

/// An 8-bit sRGB picture, rows from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< [height * width * 3]
};

struct RenderOptions {
  int width = 1280;       ///< pixels, 16..16384
  int height = 720;       ///< pixels, 16..16384
  double explode = 0.25;  ///< how far pieces move from the whole's centre, as a share of their own
                          ///< distance to it, 0..100
  double azimuth = 35.0;  ///< degrees about the up axis
  double elevation = 20.0;  ///< degrees above the horizon, -90..90
  char up = 'y';            ///< the mesh's axis that points up: 'x', 'y' or 'z'
};

/// An exploded view of the fragments on a plain ground, each in its colour, inner faces told from
/// outer ones. Equal input gives equal bytes, whatever the number of threads.  Without fragments,
/// the bare backdrop.
///   throws  Error(usage) an option out of range; Error(output) no memory for the picture;
///   Error(cancelled)
[[nodiscard]] Image renderFragments(std::span<const Fragment> fragments,
                                    const RenderOptions& options = {},
                                    const Progress* progress = nullptr);

/// Write an 8-bit RGB PNG.
///   throws  Error(output)
void writePng(const std::filesystem::path& file, const Image& image);

}  // namespace sherd
