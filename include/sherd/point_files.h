// Points on surfaces as files.
#pragma once

#include <sherd/output_file.h>
#include <sherd/points.h>
#include <sherd/read_options.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// How surface points are written.
enum class PointFormat {
  ply,   ///< binary little-endian: float x, y, z, nx, ny, nz, int facing
  xyz,   ///< text, a line "x y z nx ny nz" for each point
  npz,   ///< NumPy: positions float32 [n, 3], normals float32 [n, 3], facing int32 [n]
  binp,  ///< the paper's: an octree of the Point Cloud Library, compressed; positions only
};

/// Write surface points.  What is written has single precision, and reads back as it was; but
/// `.binp` has one point in each of its voxels, at its centre.  Normals and facing are left out
/// where `points` has none.
///   throws  Error(output); Error(input) no points, or not finite ones, for `.binp`
void writePoints(const OutputFile& file, const SurfacePoints& points, PointFormat format);

/// The format of a file by its extension, whatever its case.  A `.ply` may be a mesh, an `.npz`
/// something else.
[[nodiscard]] std::optional<PointFormat> pointFormatOf(const std::filesystem::path& file);

/// Read points, by the file's extension.
///   return  finite positions; normals and facing are empty where the file has none
///   throws  Error(input) absent, unreadable, another kind of file, cut, contradicting itself, or
///           of more memory than `options` allow
[[nodiscard]] SurfacePoints readPoints(const std::filesystem::path& file,
                                       const ReadOptions& options = {});

// The readers: whole files in memory.  `name` is for messages.
//   throws  Error(input), also for more memory than `options` allow beside `bytes`
[[nodiscard]] SurfacePoints parsePlyPoints(std::string_view bytes, const std::string& name,
                                           const ReadOptions& options = {});
[[nodiscard]] SurfacePoints parseXyz(std::string_view bytes, const std::string& name,
                                     const ReadOptions& options = {});
[[nodiscard]] SurfacePoints parseNpzPoints(std::string_view bytes, const std::string& name,
                                           const ReadOptions& options = {});
[[nodiscard]] SurfacePoints parseBinp(std::string_view bytes, const std::string& name,
                                      const ReadOptions& options = {});

/// Write distance samples as NumPy's `.npz`: positions [n, 3] and sdf [n], of samples.type.
///   throws  Error(output)
void writeDistances(const OutputFile& file, const DistanceSamples& samples);

/// Write correspondences as NumPy's `.npz`: fragments int32 [n, 2], positions float32 [n, 3],
/// normals float32 [n, 3].
///   throws  Error(output)
void writeCorrespondences(const OutputFile& file, const Correspondences& points);

/// What reading the file back would not give, a sentence for each thing.
[[nodiscard]] std::vector<std::string> lossesOf(const SurfacePoints& points, PointFormat format);

}  // namespace sherd
