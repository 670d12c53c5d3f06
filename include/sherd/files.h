// Reading and writing single files: meshes, points, voxels, grids, seeds, images.
#pragma once

#include <sherd/fragments.h>
#include <sherd/labels.h>
#include <sherd/mesh.h>
#include <sherd/points.h>
#include <sherd/progress.h>
#include <sherd/render.h>
#include <sherd/seeds.h>
#include <sherd/solid.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sherd {

struct Guide;  // fracture.h

/// Receives the bytes of a file in chunks.
using ByteSink = std::function<void(std::string_view)>;

/// Writes the bytes of a file to a sink.
using Content = std::function<void(const ByteSink&)>;

/// Receives files by name, from any thread.
class FileSink {
 public:
  virtual ~FileSink() = default;

  /// Stores a file completely, or not at all if `content` throws.
  ///   name    components separated by '/', relative unless the sink documents otherwise
  ///   throws  Error(output)
  virtual void take(const std::string& name, const Content& content) = 0;
};

/// One file: a path, written atomically, or a name in a sink.
class OutputFile {
 public:
  OutputFile(std::filesystem::path path) : name_(std::move(path)) {}
  OutputFile(const char* path) : name_(path) {}
  OutputFile(const std::string& path) : name_(path) {}
  OutputFile(FileSink& sink, std::filesystem::path name) : sink_(&sink), name_(std::move(name)) {}

  /// The name used in messages.
  std::string string() const { return name_.string(); }

  /// Writes the file.
  ///   throws  Error(output), the message starts with the name
  void write(std::string_view bytes) const;
  void write(const Content& content) const;

 private:
  FileSink* sink_ = nullptr;
  std::filesystem::path name_;
};

/// A destination for several files: a folder, or a sink.
class OutputFolder {
 public:
  OutputFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  OutputFolder(FileSink& sink) : sink_(&sink) {}

  OutputFile operator/(const std::string& name) const {
    return sink_ ? OutputFile(*sink_, name) : OutputFile(folder_ / name);
  }

 private:
  FileSink* sink_ = nullptr;
  std::filesystem::path folder_;
};

struct ReadOptions {
  std::uint64_t maxMemory =
      std::numeric_limits<std::uint64_t>::max();  ///< bytes; files that need more are refused
};

// --- Meshes --------------------------------------------------------------------------------------

/// Reads OBJ, PLY, STL, OFF, glTF, GLB, .binm, FBX, DAE or 3MF, by the file's extension, also
/// compressed as `.gz`.  Polygons are triangulated, exactly equal vertices merged.  Coordinates
/// keep the file's precision, except single precision in the last three formats, which sherd-assimp
/// reads.
///
/// Surface attributes are read too: texture coordinates (the first set; that of the base color in
/// glTF), vertex and face colors (without alpha), normals of vertices or corners, materials with
/// names, base colors and base-color textures, and the face property `neighbor` of fragments in
/// PLY.  Material libraries and textures are read only from the mesh's folder and below it, after
/// resolving symbolic links; `warnings` lists missing ones.
///   progress  only `cancelled` is called
///   throws    Error(input) absent, unreadable, truncated, malformed, unknown format, no triangle,
///             no finite vertex, more than 1e37 units long, more memory than `options` allow;
///             Error(cancelled) by `progress`, or a signal stopped sherd-assimp
[[nodiscard]] SourceMesh readMesh(const std::filesystem::path& file,
                                  const ReadOptions& options = {},
                                  const Progress* progress = nullptr);

/// Whether readMesh supports the file's extension.
[[nodiscard]] bool isMeshName(const std::filesystem::path& file);

/// Formats of fragments' meshes.  If the input has surface attributes, the first three hold them:
/// on the original surface those of the closest point of the input; fracture surfaces have
/// kInsideColor and the material "inside".
enum class MeshFileFormat {
  ply,      ///< as writePly, with vertex colors, and texture coordinates and material of faces
  obj,      ///< with normals and materials; one material library for all, in the same folder
  glb,      ///< binary glTF 2.0 with embedded textures, a primitive for each material
  stl,      ///< binary; triangles only
  stlText,  ///< the same as text, with the same file names
  binm,     ///< the paper's: positions and faces only
};

/// Writes a mesh as binary little-endian PLY: vertices float x, y, z; triangles.  Where its
/// neighbors are known, faces have `int neighbor`, and vertices have float nx, ny, nz and `int
/// neighbor`: normals are angle-weighted means over the faces at the vertex; a vertex's neighbor is
/// 0 if these faces are all on the original surface, else the id above 0 with the largest sum of
/// angles. Surface attributes are not written.
///   throws  Error(output)
void writePly(const OutputFile& file, const TriangleMesh& mesh);

/// Writes a mesh. A library of materials, named like the file, and textures are written beside
/// `.obj` and `.ply` files.  These and text STL have double precision where single moves vertices
/// by more than a hundredth of a voxel at kMostAutoResolution voxels along the longest side.
///   files   receives the files by path
///   throws  Error(output), also if a library or texture exists with other content
void writeMeshFile(FileSink& files, const std::filesystem::path& file, const SourceMesh& source,
                   MeshFileFormat format);

/// Returns what is lost if the file is read back, one sentence per loss.
[[nodiscard]] std::vector<std::string> lossesOf(const SourceMesh& source, MeshFileFormat format);

/// The path of `sherd-assimp` (src/assimp_program/): the value of the environment variable
/// SHERD_ASSIMP, else beside the running program, where it is installed, or in a wheel.
struct AssimpProgram {
  std::optional<std::filesystem::path> found;
  std::vector<std::filesystem::path> tried;
};
[[nodiscard]] AssimpProgram findAssimp();

/// Reads a triangle by sherd-assimp.
///   return  why that fails; empty if it works
///   throws  Error(cancelled)
[[nodiscard]] std::string assimpFault(const Progress* progress = nullptr);

// --- Points --------------------------------------------------------------------------------------

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

/// Writes distance samples as NumPy's `.npz`: positions [n, 3] and sdf [n], of type samples.type.
///   throws  Error(output)
void writeDistances(const OutputFile& file, const DistanceSamples& samples);

/// Writes correspondences as NumPy's `.npz`: fragments int32 [n, 2], positions float32 [n, 3],
/// normals float32 [n, 3].
///   throws  Error(output)
void writeCorrespondences(const OutputFile& file, const Correspondences& points);

/// Returns one sentence for each kind of data that the format cannot hold.
[[nodiscard]] std::vector<std::string> lossesOf(const SurfacePoints& points, PointFormat format);

// --- Voxels --------------------------------------------------------------------------------------

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

// --- OpenVDB -------------------------------------------------------------------------------------

/// Metadata of the grids in a `.vdb` file.
struct GridMetadata {
  std::string source;  ///< the input's file name
  std::uint64_t seed = 0;
  double density = 1.0;        ///< kilograms per cubic unit of the coordinates
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
///   fragments  [>= 1] with level sets, ids from 1 without gaps
///   labels     of the solid that they are fragments of
///   throws     Error(output)
void writeVdbOfAll(const OutputFile& file, std::span<const Fragment> fragments,
                   const Labels& labels, const GridMetadata& metadata,
                   const VdbOptions& options = {});

/// Writes the intact solid's level set as grid "surface", with source, seed and tool_version.
///   throws  Error(output)
void writeVdbOfSolid(const OutputFile& file, const Solid& solid, const GridMetadata& metadata,
                     const VdbOptions& options = {});

/// Writes the arrival costs of a solid's inside voxels as Int32 grid "cost", compressed as in
/// writeVdb; the background is -1.
///   labels  of this solid, with costs
///   throws  Error(usage) other labels; Error(output)
void writeCost(const OutputFile& file, const Solid& solid, const Labels& labels);

/// Metadata as text, ascending by key.
using VdbMetadata = std::vector<std::pair<std::string, std::string>>;

struct VdbGrid {
  std::string name;
  std::string type;       ///< OpenVDB's: Tree_float_5_4_3
  std::string gridClass;  ///< "level set", "fog volume", "unknown", ...
  glm::dvec3 voxelSize{0.0};
  std::string background;  ///< empty where the grid has none
  std::uint64_t activeVoxels = 0;
  VoxelBox activeBox;
  VdbMetadata metadata;
};

struct VdbFile {
  VdbMetadata metadata;
  std::vector<VdbGrid> grids;
};

/// Reads a whole `.vdb` file, after a check of its structure, and describes its content. Of grids
/// of points it reads the topology, of types that OpenVDB 10 does not know the name.
///   throws  Error(input) absent, cut, damaged, no file of OpenVDB or of a version that is not
///           supported; takes more memory than options.maxMemory, or than is free
[[nodiscard]] VdbFile describeVdb(const std::filesystem::path& file,
                                  const ReadOptions& options = {});

// --- Volumes in place of a mesh ------------------------------------------------------------------

struct VolumeOptions {
  std::string grid;       ///< of a `.vdb` file; empty: the union of its level sets, or if it has
                          ///< none, its only float grid
  double isovalue = 0.5;  ///< grids that are not level sets are solid above this value
  bool ownVoxels = true;  ///< uses a level set's voxels as the solid's where that is possible
  std::uint64_t maxMemory =
      std::numeric_limits<std::uint64_t>::max();  ///< bytes for breaking the solid
};

/// A volume read from a file.
struct Volume {
  SourceMesh source;           ///< name and checksum; the surface's mesh if there is no `solid`
  double voxelSize = 0.0;      ///< of the file, world units; 1 where the file has none
  std::optional<Solid> solid;  ///< on the file's own voxels
  bool isLevelSet = false;     ///< only level sets were read, so no isovalue was used
};

/// Whether readVolume supports the file's extension: `.vdb` or a voxel file.
[[nodiscard]] bool isVolumeName(const std::filesystem::path& file);

/// Reads a volume.
///
/// A level set's voxels become the solid's, with the same indices, if its transform is a uniform
/// scale and translation and its band is at least three voxels wide.  All others become a mesh to
/// be voxelized: level sets and fog volumes by OpenVDB's mesher, voxel files by the faces between
/// labeled and unlabeled voxels, which reproduces the same voxels at the same voxel size.
///   throws  Error(input) absent, damaged, no solid voxel, no such grid, several grids without
///           options.grid; Error(usage) more voxels or faces than `maxMemory` holds;
///           Error(cancelled)
[[nodiscard]] Volume readVolume(const std::filesystem::path& file,
                                const VolumeOptions& options = {},
                                const Progress* progress = nullptr);

// --- Densities and guides ------------------------------------------------------------------------

/// Reads where pieces are small.
///   source  name of an attribute of the mesh's vertices, or "FILE.vdb" or "FILE.vdb:GRID" for a
///           grid of floats in the mesh's space.  An attribute is a property of PLY, a channel of
///           colors (`red`, `green`, `blue`; in glTF also `alpha`), or one of glTF that begins with
///           an underscore; inside, the value is that of the closest point of the surface
///   mesh    the file of the mesh that is broken
///   throws  Error(input) no such attribute or grid, several grids without a name, a value that is
///           negative or not finite, all are 0; what readMesh throws; Error(usage) an attribute of
///           a file that is no mesh
[[nodiscard]] Density readDensity(const std::string& source, const std::filesystem::path& mesh,
                                  const ReadOptions& options = {},
                                  const Progress* progress = nullptr);

/// Reads cracks that are given, of any mesh format.  The lines of OBJ (`l`) and PLY (element `edge`
/// with `vertex1` and `vertex2`) are joined where two meet.
///   throws  Error(input) as readMesh, of a file without lines and triangles
[[nodiscard]] Guide readGuide(const std::filesystem::path& file, const ReadOptions& options = {},
                              const Progress* progress = nullptr);

// --- Seeds, contacts, convex hulls, images -------------------------------------------------------

/// Reads and writes seeds as JSON.  Positions are voxel centers in world units and round-trip
/// exactly. Unknown members of objects are ignored.
///
///     {"schema": "sherd-seeds/1", "seeds": [{"fragment": 1, "position": [x, y, z]}, ...]}
///
/// Seeds with a weight have a member "weight", in squared world units: it is subtracted from the
/// squared distance to the seed, so that the cells of drawn sizes can be computed.  It is not read.
///
/// A member "offset": [x, y, z] beside "seeds" is added to all positions when they are read.
///
///   throws  Error(input) with the file's name: absent, larger than 64 MiB, not JSON, another
///           schema, an invalid entry; Error(output)
[[nodiscard]] std::vector<SeedPoint> readSeedPoints(const std::filesystem::path& file);
void writeSeeds(const OutputFile& file, std::span<const Seed> seeds, const Solid& solid,
                const std::optional<glm::dvec3>& offset = {});

/// Writes the boundaries of all contacts (see boundaryLoops) as closed polylines in OBJ: an object
/// boundary_<id>_<id> for each pair of touching fragments, the lower id first.
///   isDouble  vertices have double precision, else single
///   throws    Error(output)
void writeBoundaries(const OutputFile& file, std::span<const Fragment> fragments,
                     bool isDouble = false);

/// Writes the contact graph for simulations as JSON in the schema of NVIDIA Blast: chunks (the
/// whole first, the fragments as its children) and bonds between fragments, each with area, normal
/// and centroid.
///   splits  if any, the pieces that were split are chunks between, after those of the fragments
///   throws  Error(output)
void writeGraph(const OutputFile& file, std::span<const Fragment> fragments,
                const GridMetadata& metadata, std::span<const Split> splits = {});

/// Writes the contact graph as a constraint network in Houdini's geometry, JSON `.geo`: a point at
/// each fragment's center of mass, with `name`, and a polyline for each contact, with
/// constraint_name, constraint_type, area, restlength and strength.
///   strength  per unit of a contact's area
///   splits    if any, contacts are in the groups level1, level2, ...: those between what the
///             intact object was divided into, and so on
///   throws    Error(output); Error(cancelled)
void writeConstraints(const OutputFile& file, std::span<const Fragment> fragments,
                      double strength = 1.0, std::span<const Split> splits = {},
                      const Progress* progress = nullptr);

/// Writes the convex hull of a fragment's mesh as OBJ.
///   gap       distance between the hulls of two convex neighbors, world units
///   isDouble  vertices have double precision, else single
///   throws    Error(output); Error(input) the mesh is flat
void writeProxy(const OutputFile& file, const Fragment& fragment, const std::string& name,
                double gap, bool isDouble = false);

/// Writes an 8-bit RGB PNG.
///   throws  Error(output)
void writePng(const OutputFile& file, const Image& image);

/// Writes AOVs as OpenEXR, ZIP-compressed scan lines: R, G, B, A of 16 bits; Z, N.X, N.Y, N.Z,
/// P.X, P.Y, P.Z of 32 bits; id and neighbor as unsigned integers.
///   throws  Error(output)
void writeExr(const OutputFile& file, const Aovs& aovs);

/// An array in an `.npz` file.
struct ArrayEntry {
  std::string name;  ///< with its extension: "labels.npy"
  std::uint64_t bytes = 0;
};

/// Returns the arrays of an `.npz` file, in its order.
///   throws  Error(input) absent, unreadable or damaged
[[nodiscard]] std::vector<ArrayEntry> arraysOf(const std::filesystem::path& file);

}  // namespace sherd
