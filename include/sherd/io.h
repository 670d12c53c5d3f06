// Files: what a fracture writes, and how it is read back.
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

/// Write the rims of all contacts (see rimCurves) as closed polylines in OBJ, an object
/// rim_<id>_<id> for each two fragments that touch, the lower id first.
///   throws  Error(output)
void writeRims(const OutputFile& file, std::span<const Fragment> fragments);

/// Write what touches what, for simulations, as JSON by the schema of NVIDIA Blast: chunks, the
/// whole first and the fragments below it, and bonds between fragments, each with area, normal
/// and centroid.
///   throws  Error(output)
void writeGraph(const OutputFile& file, std::span<const Fragment> fragments, const VdbNotes& notes);

/// The same as Houdini's constraint network, in its ASCII format `.geo`: a point at each fragment's
/// centre of mass, with `name`, and an open polygon between two that touch, with constraint_name,
/// constraint_type, restlength and strength, which is the contact's area.
void writeConstraints(const OutputFile& file, std::span<const Fragment> fragments);

/// Write the convex hull of a fragment's mesh as OBJ.
///   gap     what is left between the hulls of two neighbours that are convex; world units
///   throws  Error(output); Error(input) the mesh is flat
void writeProxy(const OutputFile& file, const Fragment& fragment, const std::string& name,
                double gap);

/// Into which `.vdb` files fragments go.
enum class VdbFiles {
  files,   ///< one each
  single,  ///< fragments.vdb
  both,
};

/// Which files a fracture writes beside `manifest.json`.
struct WriteOptions {
  bool labels = true;   ///< labels.rle, or as voxelFormats says
  bool vdb = true;      ///< as vdbFiles says
  bool mesh = true;     ///< meshes/<stem>_001.ply, and textures where the input has some
  bool preview = true;  ///< preview.png; of large solids as coarse as its pixels
  bool seeds = false;   ///< seeds.json
  bool rims = false;    ///< rims.obj
  bool cost = false;    ///< cost.vdb, when the labels hold costs
  bool solid = false;   ///< the unbroken solid too: fragments/<stem>.vdb where vdb is written, and
                        ///< meshes/<stem>.ply and so on where mesh is
  bool scene = false;   ///< scene.glb: a node for each fragment, its origin the centre of mass
  bool graph = false;   ///< graph.json and graph.geo
  bool plainMeshes = false;  ///< vertices and triangles alone in `.ply` and `.obj`
  bool proxy = false;        ///< proxies/<stem>_001.obj, convex hulls

  VdbFiles vdbFiles = VdbFiles::files;  ///< fragments/<stem>_001.vdb, fragments.vdb, or both
  VdbOptions vdbOptions{};
  double density = 1.0;   ///< mass of a unit of volume, above 0
  double proxyGap = 0.0;  ///< as writeProxy's; at least 0

  std::vector<VoxelFormat> voxelFormats{VoxelFormat::rle};       ///< not empty, each once
  std::vector<MeshFileFormat> meshFormats{MeshFileFormat::ply};  ///< not empty, each once

  PointOptions points{};     ///< points/<stem>_001.ply where count is above 0; its `seed` is made
                             ///< from the fracture's, for each fragment
  bool sharePoints = false;  ///< points.count is of all fragments, shared out by their area
  std::vector<PointFormat> pointFormats{PointFormat::ply};
  DistanceOptions distances{};  ///< sdf/<stem>_001.npz, and sdf/<stem>.npz of the unbroken solid,
                                ///< where count is above 0; `spread` is the voxel size where it is
                                ///< 0, its `seed` is made as that of points
  std::size_t correspondences = 0;  ///< correspondences.npz: points for each contact, where above 0

  char up = 'y';  ///< the mesh's axis that points up in the picture: 'x', 'y' or 'z'

  bool needsLevelSets() const { return vdb || vdbOptions.fog; }  ///< Fragment::surface

  /// Is there a file of all fragments that is made of their meshes, of their level sets?
  bool needsAllMeshes() const {
    return rims || scene || distances.count > 0 || correspondences > 0 ||
           (points.count > 0 && sharePoints);
  }
  bool needsAllLevelSets() const { return vdb && vdbFiles != VdbFiles::files; }
};

/// The options, with what the files need of a fracture made too, and not what they do not: costs
/// and level sets.
[[nodiscard]] FractureOptions optionsFor(FractureOptions options, const WriteOptions& write);

/// See whether what is to be written can be had.  To be asked before long work.
///   throws  Error(usage) correspondences of fragments that do not share their surfaces; STL both
///           binary and as text
void checkWriteOptions(const WriteOptions& write, const FractureOptions& options);

/// See whether writeFracture may write into a folder: absent, empty or an earlier fracture's, and
/// writable.  To be called before long work; nothing is left behind.  Where a killed run left a
/// fracture half replaced, the earlier one is put back.
///   throws  Error(output) it holds something else, or cannot be written
void checkFractureFolder(const std::filesystem::path& folder);

/// A fracture's folder, written.
struct WrittenFolder {
  std::filesystem::path manifest;
  std::vector<std::string> warnings;  ///< a sentence on files that the earlier manifest lists and
                                      ///< that stay, as no fracture's file is named so
};

/// Write a fracture into a folder that checkFractureFolder accepts.  What the earlier manifest
/// lists is replaced, where it is named as this function names files; all else stays.  Everything
/// is written beside and renamed, `manifest.json` last: without it the folder is unfinished.  On
/// failure the folder is as it was before; so it is after a kill, once checkFractureFolder or
/// whatever reads a fracture has opened it.
///   throws  Error(usage) correspondences of fragments that do not share their surfaces; what
///   samplePoints and sampleDistances throw; Error(output) the folder holds something else, cannot
///   be written, or the disk is full
WrittenFolder writeFracture(const std::filesystem::path& folder, const SourceMesh& source,
                            const FractureOptions& options, const FractureResult& result,
                            const WriteOptions& write = {}, const Progress* progress = nullptr);

/// A fracture that is in a folder.
struct WrittenFracture {
  FractureResult result;  ///< its fragments as fractureInto says
  WrittenFolder folder;
};

/// Break a mesh into a folder: `fracture` and then `writeFracture`, and the same files, but
/// fragments are written some at a time while they are made.  Their level sets go then, and their
/// meshes, but for WriteOptions::needsAllLevelSets and needsAllMeshes.  Without either, large
/// solids take a quarter to a third less memory (docs/performance.md).
///   return  all but what went: Fragment::surface; mesh and facing
///   throws  what fracture and writeFracture throw
[[nodiscard]] WrittenFracture fractureInto(const std::filesystem::path& folder,
                                           const SourceMesh& source, const FractureOptions& options,
                                           Device& device, const WriteOptions& write = {},
                                           const Progress* progress = nullptr);

}  // namespace sherd
