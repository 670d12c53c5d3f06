// Voxel labels and their file formats: run-length, dense, quad-stack and MagicaVoxel.
#pragma once

#include <sherd/coords.h>
#include <sherd/grid_fwd.h>
#include <sherd/labels.h>
#include <sherd/output_file.h>
#include <sherd/read_options.h>
#include <sherd/solid.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// A dense box of 16-bit labels, z fastest: 0 outside, 1 solid without a fragment, fragment id k as
/// k + 1.
struct VoxelLabels {
  openvdb::Coord dims{0, 0, 0};
  std::vector<std::uint16_t> labels;  ///< [dims.x * dims.y * dims.z], index (x * ny + y) * nz + z
};

/// A run of equal labels.
struct Run {
  std::uint16_t label = 0;
  std::uint32_t length = 0;
  bool operator==(const Run&) const = default;
};

/// A box of run-length encoded labels.  Adjacent runs differ, except that runs above 2^32 - 1
/// voxels are split; lengths add up to the box.
struct RunLengthVoxels {
  openvdb::Coord dims{0, 0, 0};
  std::vector<Run> runs;  ///< x slowest, z fastest; runs continue across rows and planes
};

/// Decodes the runs.
///   throws  Error(input) the box has more than 2^31 voxels
[[nodiscard]] VoxelLabels expand(const RunLengthVoxels& voxels);

/// The position of a box of voxels.
struct VoxelTransform {
  GridFrame frame;                   ///< of the box: frame.origin is the center of its first voxel
  openvdb::Coord indexMin{0, 0, 0};  ///< the first voxel's index in the fracture's `.vdb` files
};

/// The content of a voxel file.
struct PlacedVoxels {
  RunLengthVoxels voxels;
  std::optional<VoxelTransform> transform{};  ///< only of `.npz` files
};

/// How a box is padded to a cube of its longest side; new voxels are 0.
enum class Padding {
  atEnd,     ///< after the last voxels, as readers of the paper's data set do
  centered,  ///< on both sides, an odd voxel at the end, as in `.bing` files
};

/// Pads a box to a cube; the voxels keep their world positions.
///   name    used in messages
///   throws  Error(input) the cube has more than 2^34 voxels
[[nodiscard]] PlacedVoxels padded(const PlacedVoxels& voxels, Padding padding,
                                  const std::string& name);

/// Voxel file formats, named like their extensions; docs/formats.md specifies them.
enum class VoxelFormat {
  rle,     ///< the paper's run-length file
  npy,     ///< NumPy's dense uint16 [nx, ny, nz]
  npz,     ///< the same compressed, with origin, voxel_size and index_min
  vox,     ///< MagicaVoxel, a color for each fragment
  qstack,  ///< the paper's quad-stack
  bing,    ///< the paper's raw cube
};

/// Returns the format of a file by its extension, ignoring case.  An `.npz` may hold something
/// else.
[[nodiscard]] std::optional<VoxelFormat> voxelFormatOf(const std::filesystem::path& file);

/// Reads a voxel file, by its extension.
///   throws  Error(input) absent, unreadable, another kind of file, truncated, inconsistent, or
///           more memory than `options` allow
[[nodiscard]] PlacedVoxels readVoxels(const std::filesystem::path& file,
                                      const ReadOptions& options = {});

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

/// Encodes a voxel file.
///   throws  Error(output) the format cannot hold the voxels: `.qstack` with a side above 65535 or
///           2^25 columns, `.vox` with 2^29 voxels, more than 255 colors or no voxels, dense
///           formats with 2^34 voxels
void encodeVoxels(const PlacedVoxels& voxels, VoxelFormat format, const ByteSink& sink);

/// Writes a voxel file in a format, whatever the file's name.
///   throws  Error(output)
void writeVoxels(const OutputFile& file, const PlacedVoxels& voxels, VoxelFormat format);

/// Returns one sentence for each kind of data that the format cannot hold: the transform, labels
/// that share a color, an empty margin.
[[nodiscard]] std::vector<std::string> lossesOf(const PlacedVoxels& voxels, VoxelFormat format);

/// Reads and writes `.rle`.
[[nodiscard]] RunLengthVoxels readRle(const std::filesystem::path& file);
void writeRle(const OutputFile& file, const RunLengthVoxels& voxels);

/// Encodes the labels of a solid over its tight box.  Eroded voxels and ids above `fragments`
/// (withheld ones) are encoded as solid without a fragment.
[[nodiscard]] RunLengthVoxels encodeRuns(const Solid& solid, const Labels& labels,
                                         int fragments = kMaxFragments);

}  // namespace sherd
