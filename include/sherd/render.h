// Ray-traced images of fragments.
#pragma once

#include <sherd/fragments.h>
#include <sherd/progress.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace sherd {

/// An 8-bit sRGB image, rows from top to bottom.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< [height * width * 3]
};

struct RenderOptions {
  int width = 1280;       ///< pixels, 16..16384
  int height = 720;       ///< pixels, 16..16384
  double explode = 0.25;  ///< displacement of fragments from the whole's center, relative to their
                          ///< distance from it, 0..100
  double azimuth = 35.0;  ///< degrees around the up axis
  double elevation = 20.0;  ///< degrees above the horizon, -90..90
  char up = 'y';            ///< the mesh's axis that points up: 'x', 'y' or 'z'
  /// The image is the middle of a larger one, this many times as wide and as high, 0.01..1000.
  double zoom = 1.0;
  /// Ids of fragments in the middle of the image, as large as it holds, before `zoom`; the camera
  /// stays where it is for the whole, and other fragments are shown, too.  Empty: all.
  std::vector<int> focus{};
};

/// Renders an exploded view of the fragments on a plain ground, each in its own color, fracture
/// surfaces shaded differently from the original surface.  The image does not depend on the number
/// of threads.  Without fragments it shows only the backdrop.
///   throws  Error(usage) an option out of range; Error(output) no memory for the image;
///           Error(cancelled)
[[nodiscard]] Image renderFragments(std::span<const Fragment> fragments,
                                    const RenderOptions& options = {},
                                    const Progress* progress = nullptr);

/// Arbitrary output variables (AOVs) for compositing, rows from top to bottom.  All but depth are 0
/// where no fragment is visible.
struct Aovs {
  int width = 0;
  int height = 0;
  /// [height * width * 4] linear radiance of the fragments without tone mapping, premultiplied;
  /// alpha is the covered share of the pixel
  std::vector<float> rgba;
  // At pixel centers:
  std::vector<float> depth;             ///< [height * width] along the view, world units; infinite
                                        ///< where no fragment is visible
  std::vector<glm::vec3> normal;        ///< unit, world axes, towards the camera
  std::vector<glm::vec3> position;      ///< world, of the exploded fragment
  std::vector<std::uint32_t> fragment;  ///< id
  std::vector<std::uint32_t> neighbor;  ///< id on the other side, 0: original surface
};

/// Renders the AOVs of renderFragments' image, without ground and backdrop.
///   throws  as renderFragments
[[nodiscard]] Aovs renderAovs(std::span<const Fragment> fragments,
                              const RenderOptions& options = {},
                              const Progress* progress = nullptr);

}  // namespace sherd
