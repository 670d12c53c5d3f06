// Writing a fracture's files.
#pragma once

#include <sherd/fracture.h>
#include <sherd/mesh_files.h>
#include <sherd/output_file.h>
#include <sherd/point_files.h>
#include <sherd/points.h>
#include <sherd/vdb_files.h>
#include <sherd/voxel_files.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// Writes the boundaries of all contacts (see boundaryLoops) as closed polylines in OBJ: an object
/// boundary_<id>_<id> for each pair of touching fragments, the lower id first.
///   throws  Error(output)
void writeBoundaries(const OutputFile& file, std::span<const Fragment> fragments);

/// Writes the contact graph for simulations as JSON in the schema of NVIDIA Blast: chunks (the
/// whole first, the fragments as its children) and bonds between fragments, each with area, normal
/// and centroid.
///   throws  Error(output)
void writeGraph(const OutputFile& file, std::span<const Fragment> fragments,
                const GridMetadata& metadata);

/// Writes the contact graph as a Houdini constraint network in the ASCII format `.geo`: a point at
/// each fragment's center of mass, with `name`, and an open polygon for each contact, with
/// constraint_name, constraint_type, restlength and strength (the contact's area).
///   throws  Error(output)
void writeConstraints(const OutputFile& file, std::span<const Fragment> fragments);

/// Writes the convex hull of a fragment's mesh as OBJ.
///   gap     distance between the hulls of two convex neighbors, world units
///   throws  Error(output); Error(input) the mesh is flat
void writeProxy(const OutputFile& file, const Fragment& fragment, const std::string& name,
                double gap);

/// The `.vdb` files that hold the fragments.
enum class VdbFiles {
  files,   ///< one per fragment
  single,  ///< fragments.vdb
  both,
};

/// The files that a fracture writes in addition to `manifest.json`.
struct WriteOptions {
  bool labels = true;        ///< labels.rle, or other formats by voxelFormats
  bool vdb = true;           ///< level sets, by vdbFiles
  bool mesh = true;          ///< meshes/<stem>_001.ply, and the input's textures
  bool preview = true;       ///< preview.png; of large solids from meshes no finer than its pixels
  bool seeds = false;        ///< seeds.json
  bool boundaries = false;   ///< boundaries.obj
  bool cost = false;         ///< cost.vdb, if the labels have costs
  bool solid = false;        ///< also the intact solid: fragments/<stem>.vdb with `vdb`, and
                             ///< meshes/<stem>.ply etc. with `mesh`
  bool scene = false;        ///< scene.glb: a node for each fragment, its origin the center of mass
  bool graph = false;        ///< graph.json and graph.geo
  bool plainMeshes = false;  ///< only vertices and triangles in `.ply` and `.obj`
  bool proxy = false;        ///< proxies/<stem>_001.obj, convex hulls

  VdbFiles vdbFiles = VdbFiles::files;  ///< fragments/<stem>_001.vdb, fragments.vdb, or both
  VdbOptions vdbOptions{};
  double density = 1.0;   ///< mass per unit of volume, above 0
  double proxyGap = 0.0;  ///< `gap` of writeProxy, at least 0

  std::vector<VoxelFormat> voxelFormats{VoxelFormat::rle};       ///< not empty, no duplicates
  std::vector<MeshFileFormat> meshFormats{MeshFileFormat::ply};  ///< not empty, no duplicates

  PointOptions points{};     ///< points/<stem>_001.ply if count > 0; `seed` is derived from the
                             ///< fracture's, per fragment
  bool sharePoints = false;  ///< points.count is the total, distributed by the fragments' areas
  std::vector<PointFormat> pointFormats{PointFormat::ply};
  DistanceOptions distances{};  ///< sdf/<stem>_001.npz, and sdf/<stem>.npz of the intact solid, if
                                ///< count > 0; a `sigma` of 0 is the voxel size; `seed` is derived
                                ///< as for points
  std::size_t correspondences = 0;  ///< correspondences.npz: points per contact; 0: no file

  char up = 'y';  ///< the mesh's axis that points up in the preview: 'x', 'y' or 'z'

  bool needsLevelSets() const { return vdb || vdbOptions.fog; }  ///< Fragment::surface

  /// Whether a file is written that needs the meshes, or the level sets, of all fragments at once.
  bool needsAllMeshes() const {
    return boundaries || scene || distances.count > 0 || correspondences > 0 ||
           (points.count > 0 && sharePoints);
  }
  bool needsAllLevelSets() const { return vdb && vdbFiles != VdbFiles::files; }
};

/// Returns the options, with arrival costs and level sets enabled exactly if the files need them.
[[nodiscard]] FractureOptions optionsFor(FractureOptions options, const WriteOptions& write);

/// Checks the options.  Call this before long work.
///   throws  Error(usage) correspondences of fragments that do not share their surfaces; STL both
///           binary and as text
void checkWriteOptions(const WriteOptions& write, const FractureOptions& options);

/// Checks that writeFracture can write into a folder: it must be writable, and absent, empty or an
/// earlier fracture's.  Call this before long work.  The only change it makes: a fracture that a
/// killed run left half replaced is restored to the earlier one.
///   throws  Error(output) the folder holds something else, or cannot be written
void checkFractureFolder(const std::filesystem::path& folder);

/// The result of writeFracture.
struct WrittenFolder {
  std::filesystem::path manifest;
  std::vector<std::string> warnings;  ///< a sentence about files that the earlier manifest lists
                                      ///< but that are kept, as no fracture's file has such a name
};

/// Writes a fracture into a folder that checkFractureFolder accepts.  Files that the earlier
/// manifest lists are replaced if they have names that this function uses; all others stay.  Files
/// are written to a hidden folder and renamed, `manifest.json` last: without it the folder is
/// unfinished.  On failure the folder is as before; after a kill it is restored when
/// checkFractureFolder or a reader of fractures opens it.
///   throws  Error(usage) correspondences of fragments that do not share their surfaces; what
///           samplePoints and sampleDistances throw; Error(output) the folder holds something else,
///           cannot be written, or the disk is full
WrittenFolder writeFracture(const std::filesystem::path& folder, const SourceMesh& source,
                            const FractureOptions& options, const FractureResult& result,
                            const WriteOptions& write = {}, const Progress* progress = nullptr);

/// The result of fractureInto.
struct WrittenFracture {
  FractureResult result;  ///< fragments without the members that fractureInto frees
  WrittenFolder folder;
};

/// Breaks a mesh into a folder.  The files are those of `fracture` followed by `writeFracture`, but
/// fragments are written in batches while they are made, and their level sets and meshes are freed
/// then unless WriteOptions::needsAllLevelSets or needsAllMeshes keeps them.  Where both are freed,
/// large solids take a quarter to a third less memory (docs/performance.md).
///   return  the result without what was freed: Fragment::surface; mesh and neighbor
///   throws  what fracture and writeFracture throw
[[nodiscard]] WrittenFracture fractureInto(const std::filesystem::path& folder,
                                           const SourceMesh& source, const FractureOptions& options,
                                           Device& device, const WriteOptions& write = {},
                                           const Progress* progress = nullptr);

}  // namespace sherd
