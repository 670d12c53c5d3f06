// Point files: surface points, distance samples, correspondences.
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

/// Formats of surface points.
enum class PointFormat {
  ply,   ///< binary little-endian: float x, y, z, nx, ny, nz, int neighbor
  xyz,   ///< text, a line "x y z nx ny nz" for each point
  npz,   ///< NumPy: positions float32 [n, 3], normals float32 [n, 3], neighbor int32 [n]
  binp,  ///< the paper's: a compressed octree of the Point Cloud Library; positions only
};

/// Writes surface points in single precision.  `.binp` stores one point per octree voxel, at the
/// voxel's center.  Normals and neighbors are left out where `points` has none.
///   throws  Error(output); Error(input) for `.binp`: no points, or a coordinate that is not finite
void writePoints(const OutputFile& file, const SurfacePoints& points, PointFormat format);

/// Returns the format of a file by its extension, ignoring case.  A `.ply` may also be a mesh, an
/// `.npz` something else.
[[nodiscard]] std::optional<PointFormat> pointFormatOf(const std::filesystem::path& file);

/// Reads points, by the file's extension.
///   return  finite positions; `normals` and `neighbor` are empty where the file has none
///   throws  Error(input) absent, unreadable, another kind of file, truncated, inconsistent, or
///           more memory than `options` allow
[[nodiscard]] SurfacePoints readPoints(const std::filesystem::path& file,
                                       const ReadOptions& options = {});

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

/// Writes distance samples as NumPy's `.npz`: positions [n, 3] and sdf [n], of type samples.type.
///   throws  Error(output)
void writeDistances(const OutputFile& file, const DistanceSamples& samples);

/// Writes correspondences as NumPy's `.npz`: fragments int32 [n, 2], positions float32 [n, 3],
/// normals float32 [n, 3].
///   throws  Error(output)
void writeCorrespondences(const OutputFile& file, const Correspondences& points);

/// Returns one sentence for each kind of data that the format cannot hold.
[[nodiscard]] std::vector<std::string> lossesOf(const SurfacePoints& points, PointFormat format);

}  // namespace sherd
