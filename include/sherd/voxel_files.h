// Voxel labels, and the files that hold them: run-length, dense, quad-stack and MagicaVoxel.
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

/// One run of equal labels.
struct Run {
  std::uint16_t label = 0;
  std::uint32_t length = 0;
  bool operator==(const Run&) const = default;
};

/// A box of labels as runs: adjacent runs differ, but where a run would pass 2^32 - 1 voxels and
/// goes on in the next; lengths add up to the box.
struct RunLengthVoxels {
  openvdb::Coord dims{0, 0, 0};
  std::vector<Run> runs;  ///< x slowest, z fastest; runs go on across rows and planes
};

/// Every voxel of `voxels`.
///   throws  Error(input) when the box holds more than 2^31 voxels
[[nodiscard]] VoxelLabels expand(const RunLengthVoxels& voxels);

/// Where a box of voxels lies.
struct VoxelPlace {
  GridFrame frame;                   ///< of the box: frame.origin is the centre of its first voxel
  openvdb::Coord indexMin{0, 0, 0};  ///< the first voxel's index in the fracture's `.vdb` files
};

/// What a voxel file holds.
struct PlacedVoxels {
  RunLengthVoxels voxels;
  std::optional<VoxelPlace> place{};  ///< only `.npz` files tell it
};

/// How a box is made a cube of its longest side; new voxels are 0.
enum class Padding {
  atEnd,    ///< behind the last voxels, as the readers of the paper's data set do
  centred,  ///< on both sides, the odd voxel behind: as `.bing` files are
};

/// The box as a cube; its place is kept.
///   name    for messages
///   throws  Error(input) the cube has more than 2^34 voxels
[[nodiscard]] PlacedVoxels padded(const PlacedVoxels& voxels, Padding padding,
                                  const std::string& name);

/// The kinds of voxel files, named as their extensions are.  docs/formats.md has their bytes.
enum class VoxelFormat {
  rle,     ///< the paper's run-length file
  npy,     ///< NumPy's dense uint16 [nx, ny, nz]
  npz,     ///< the same deflated, with origin, voxel_size and index_min
  vox,     ///< MagicaVoxel, a colour for each fragment
  qstack,  ///< the paper's quad-stack
  bing,    ///< the paper's raw cube
};

/// The format of a file by its extension, whatever its case.  An `.npz` may hold something else.
[[nodiscard]] std::optional<VoxelFormat> voxelFormatOf(const std::filesystem::path& file);

/// Read a voxel file, by its extension.
///   throws  Error(input) absent, unreadable, another kind of file, cut, contradicting itself, or
///           of more memory than `options` allow
[[nodiscard]] PlacedVoxels readVoxels(const std::filesystem::path& file,
                                      const ReadOptions& options = {});

// The readers: whole files in memory.  `name` is for messages.  A box takes nothing, runs do: a
// packed file of a megabyte may hold a thousand million.  An `.npy` in Fortran's order takes 128
// MiB more.
//   throws  Error(input), also for more memory than `options` allow beside `bytes`
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

/// The bytes of a voxel file.
///   throws  Error(output) what the format cannot hold: sides above 65535 or 2^25 columns in
///   `.qstack`, 2^29 voxels or more than 255 colours in `.vox`, nothing at all in it, 2^34 voxels
///   in dense formats
void encodeVoxels(const PlacedVoxels& voxels, VoxelFormat format, const ByteSink& sink);

/// Write a voxel file, by the format and not by the name.
///   throws  Error(output)
void writeVoxels(const OutputFile& file, const PlacedVoxels& voxels, VoxelFormat format);

/// What reading the file back would not give, a sentence for each thing: the place, labels that
/// share a colour, an empty margin.
[[nodiscard]] std::vector<std::string> lossesOf(const PlacedVoxels& voxels, VoxelFormat format);

/// Read and write `.rle`.
[[nodiscard]] RunLengthVoxels readRle(const std::filesystem::path& file);
void writeRle(const OutputFile& file, const RunLengthVoxels& voxels);

/// The runs of a labelled solid over its tight box.  What is worn off, and ids above `fragments`
/// (withheld ones), are solid without a fragment.
[[nodiscard]] RunLengthVoxels encodeRuns(const Solid& solid, const Labels& labels,
                                         int fragments = kMaxFragments);

}  // namespace sherd
