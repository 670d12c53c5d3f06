// Fragments, solids and costs as OpenVDB's `.vdb` files.
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

/// What the grids of a `.vdb` file tell beside their values.
struct VdbNotes {
  std::string source;  ///< the input's file name
  std::uint64_t seed = 0;
  double density = 1.0;        ///< mass of a unit of volume
  std::vector<int> parents{};  ///< [fragments] as FractureResult::parents, or empty
};

/// How the values of `.vdb` files are packed; nothing is lost by any.
enum class VdbCompression {
  blosc,  ///< smallest and fast; a few home-made readers lack it
  zip,    ///< a tenth larger, slow to write
  none,   ///< inactive values are left out all the same
};

struct VdbOptions {
  bool fog = false;   ///< also a grid "density", class fog volume: 0 outside, 1 inside, rising over
                      ///< the three voxels below the surface, or as deep as a thin fragment is
  bool half = false;  ///< values of 16 bits, read back as 32: some 0.0008 voxel off, a third less
  VdbCompression compression = VdbCompression::blosc;
};

/// Write a fragment's level set as grid "surface", class level set, with its metadata: piece,
/// fragment_id, pivot, volume, density, mass, inertia, inertia_orient, area_inside, area_outside,
/// seed, source, tool_version, and parent_id where there are parents.  The file's unique id is made
/// from its content, so equal fragments give equal bytes.
///   throws  Error(output)
void writeVdb(const OutputFile& file, const Fragment& fragment, const VdbNotes& notes,
              const VdbOptions& options = {});

/// Write fragments into one file: grids surface_1, surface_2, ... by id, with the metadata of
/// writeVdb, density_1, ... where asked for, and Int32 grid "fragment_id": each voxel of the solid
/// is active and has its fragment's id, or 0 where it is of none of these.
void writeVdbOfAll(const OutputFile& file, std::span<const Fragment> fragments, const Solid& solid,
                   const Labels& labels, const VdbNotes& notes, const VdbOptions& options = {});

/// Write the unbroken solid's level set as grid "surface", with source, seed and tool_version.
void writeVdbOfSolid(const OutputFile& file, const Solid& solid, const VdbNotes& notes,
                     const VdbOptions& options = {});

/// Write the arrival costs of a solid's inside voxels as Int32 grid "cost", compressed and named as
/// writeVdb does it; the background is -1.
///   labels  with costs
void writeCost(const OutputFile& file, const Solid& solid, const Labels& labels);

}  // namespace sherd
