// OpenVDB `.vdb` files of fragments, solids and costs.
#pragma once

#include <sherd/fragments.h>
#include <sherd/labels.h>
#include <sherd/output_file.h>
#include <sherd/solid.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// Metadata of the grids in a `.vdb` file.
struct GridMetadata {
  std::string source;  ///< the input's file name
  std::uint64_t seed = 0;
  double density = 1.0;        ///< mass per unit of volume
  std::vector<int> parents{};  ///< [fragments] as FractureResult::parents, or empty
};

/// Lossless compression of `.vdb` files.
enum class VdbCompression {
  blosc,  ///< smallest and fast; some third-party readers do not support it
  zip,    ///< a tenth larger, slow to write
  none,   ///< inactive values are still left out
};

struct VdbOptions {
  bool fog = false;   ///< also a grid "density", class fog volume: 0 outside, 1 inside, a ramp over
                      ///< three voxels below the surface, or over the depth of a thinner fragment
  bool half = false;  ///< 16-bit values, read as 32-bit: error about 0.0008 voxel, a third smaller
  VdbCompression compression = VdbCompression::blosc;
};

/// Writes a fragment's level set as grid "surface", class level set, with metadata: piece,
/// fragment_id, pivot, volume, density, mass, inertia, inertia_orient, area_inside, area_outside,
/// seed, source, tool_version, and parent_id where there are parents.  The file's unique id is a
/// hash of its content, so equal fragments give equal bytes.
///   throws  Error(output)
void writeVdb(const OutputFile& file, const Fragment& fragment, const GridMetadata& metadata,
              const VdbOptions& options = {});

/// Writes fragments into one file: grids surface_1, surface_2, ... by id, with the metadata of
/// writeVdb; density_1, ... with VdbOptions::fog; and an Int32 grid "fragment_id", in which every
/// voxel of the solid is active with its fragment's id, or 0 if it is in none of `fragments`.
///   throws  Error(output)
void writeVdbOfAll(const OutputFile& file, std::span<const Fragment> fragments, const Solid& solid,
                   const Labels& labels, const GridMetadata& metadata,
                   const VdbOptions& options = {});

/// Writes the intact solid's level set as grid "surface", with source, seed and tool_version.
///   throws  Error(output)
void writeVdbOfSolid(const OutputFile& file, const Solid& solid, const GridMetadata& metadata,
                     const VdbOptions& options = {});

/// Writes the arrival costs of a solid's inside voxels as Int32 grid "cost", compressed as in
/// writeVdb; the background is -1.
///   labels  with costs
///   throws  Error(output)
void writeCost(const OutputFile& file, const Solid& solid, const Labels& labels);

}  // namespace sherd
