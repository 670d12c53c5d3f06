// Pictures of fragments, ray-traced.
#pragma once

#include <sherd/fragments.h>
#include <sherd/output_file.h>
#include <sherd/progress.h>
#include <sherd/read_options.h>

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

/// What a picture is made of, for compositing.  Rows from the top; where no fragment is seen, 0 in
/// every layer but depth.
struct Layers {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;  ///< [height * width * 4] linear light of the fragments, not toned
                            ///< down, times alpha; alpha is the share of the pixel they cover
  // At pixels' centres:
  std::vector<float> depth;             ///< [height * width] along the view, world units; infinite
                                        ///< where nothing is seen
  std::vector<glm::vec3> normal;        ///< unit, world axes, towards the camera
  std::vector<glm::vec3> position;      ///< world, of the exploded fragment
  std::vector<std::uint32_t> fragment;  ///< id
  std::vector<std::uint32_t> facing;    ///< 0 original surface, else the fragment that was beyond
};

/// The layers of renderFragments' picture, without its ground and backdrop.
///   throws  as renderFragments
[[nodiscard]] Layers renderLayers(std::span<const Fragment> fragments,
                                  const RenderOptions& options = {},
                                  const Progress* progress = nullptr);

/// Write layers as OpenEXR, ZIP-compressed scan lines: R, G, B, A of 16 bits; Z, N.X, N.Y, N.Z,
/// P.X, P.Y, P.Z of 32 bits; id and facing as unsigned integers.
///   throws  Error(output)
void writeExr(const OutputFile& file, const Layers& layers);

/// The fragments of a fracture's folder, of its manifest, or of a folder of meshes as
/// readFragments has it; else the one mesh of a file, or the level sets of a `.vdb` file.  A
/// fracture's fragments without meshes are meshed from their level sets.
///   return  id, mesh, facing where it is known, and mass of each
///   throws  Error(input) nothing there can be drawn, it is damaged, or its meshes take more memory
///           than `options` allow
[[nodiscard]] std::vector<Fragment> readPieces(const std::filesystem::path& path,
                                               const ReadOptions& options = {});

/// Write an 8-bit RGB PNG.
///   throws  Error(output)
void writePng(const OutputFile& file, const Image& image);

}  // namespace sherd
