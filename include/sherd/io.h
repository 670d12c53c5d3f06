// Files: what a fracture writes, and how it is read back.
#pragma once

#include <sherd/fracture.h>
#include <sherd/grid_fwd.h>
#include <sherd/leaf_blocks.h>
#include <sherd/output_file.h>
#include <sherd/point_files.h>
#include <sherd/points.h>
#include <sherd/voxel_files.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// The runs of a labelled solid over its tight box.  What is worn off, and ids above `fragments`
/// (withheld ones), are solid without a fragment.
[[nodiscard]] RunLengthVoxels encodeRuns(const Solid& solid, const Labels& labels,
                                         int fragments = kMaxFragments);

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

/// Write a mesh as binary little-endian PLY: float x, y, z; faces of three.  Where `facing` is
/// given, faces have `int facing`, and vertices have it behind their normals, float nx, ny, nz:
/// normals are the mean of the faces round a vertex, weighted by their angles there; a vertex's
/// facing is 0 where all of these are of the original surface, else the id that they face most, by
/// the same angles, of those that are not 0.
void writePly(const OutputFile& file, const TriangleMesh& mesh,
              const std::vector<std::uint16_t>& facing = {});

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

/// Write distance samples as NumPy's `.npz`: positions [n, 3] and sdf [n], of samples.type.
///   throws  Error(output)
void writeDistances(const OutputFile& file, const DistanceSamples& samples);

/// Write correspondences as NumPy's `.npz`: fragments int32 [n, 2], positions float32 [n, 3],
/// normals float32 [n, 3].
///   throws  Error(output)
void writeCorrespondences(const OutputFile& file, const Correspondences& points);

/// How fragments' meshes are written.  Where the mesh that was broken has a look, the first three
/// hold it: the original surface's is that of the nearest part of it; what the fracture laid bare
/// has kInsideColour and a material "inside".
enum class MeshFileFormat {
  ply,      ///< as writePly, and colours of vertices, texture coordinates and material of faces
  obj,      ///< with normals and materials; the library of materials, one for all, lies beside it
  glb,      ///< binary glTF 2.0 with its textures in it; a primitive for each material
  stl,      ///< binary; the triangles alone
  stlText,  ///< the same as text, into files of the same name
  binm,     ///< the paper's: positions and faces alone
};

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
