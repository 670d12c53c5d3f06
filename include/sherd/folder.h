// A fracture's folder: writing it, and reading it back.
#pragma once

#include <sherd/evaluate.h>
#include <sherd/files.h>
#include <sherd/fracture.h>
#include <sherd/options.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sherd {

/// Returns the options with GrowOptions::keepCost, SurfaceOptions::levelSets and meshes set exactly
/// if the files need costs, level sets and meshes, or the surfaces are made from meshes.
[[nodiscard]] FractureOptions optionsFor(FractureOptions options, const WriteOptions& write);

/// Checks the options.  Call this before long work.
///   throws  Error(usage) correspondences of fragments that do not share their surfaces; STL both
///           binary and as text; a seed of points or distances; what checkSurfaceOptions throws
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
                                      ///< but that are kept, as no fracture's file has such a name;
                                      ///< and for each thing that viewer.html leaves out
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

/// What is broken into a folder.
struct FractureInput {
  const SourceMesh& source;      ///< the mesh that is broken; its name is used for files.  It must
                                 ///< outlive the call
  std::optional<Solid> solid{};  ///< if set, it is broken instead of the mesh
  const FinishedFracture* finished = nullptr;  ///< if set, its fragments in `only` are broken again
  std::vector<int> only{};                     ///< ids, as in refracture
};

/// Refuses to break and write what would not fit: the mesh, as requireMemory of it does, and
/// points, distance samples and correspondences, by the name of their option.  These are made in
/// blocks; only PointSampler::poisson, PointRule::perTriangle, `.binp` and distances take memory
/// for each.
///   throws  Error(usage) with the resolution, or the number, that fits
void requireMemory(const FractureInput& input, const FractureOptions& options,
                   const WriteOptions& write, std::uint64_t limit);

/// The result of fractureInto.
struct WrittenFracture {
  FractureResult result;  ///< fragments without the members that fractureInto frees
  WrittenFolder folder;
};

/// Breaks a mesh, a solid or fragments into a folder.  The files are those of `fracture` or
/// `refracture` followed by `writeFracture`, but fragments are written in batches while they are
/// made, and their level sets and meshes are freed then unless WriteOptions::needsAllLevelSets or
/// needsAllMeshes keeps them.  Where both are freed, large solids take a quarter to a third less
/// memory (docs/performance.md).
///   options  completed by optionsFor, as those of `fracture` and `refracture` must be for files
///            equal to the last bit
///   return   the result without what was freed: Fragment::surface; mesh and neighbor
///   throws   Error(usage) both a solid and a finished fracture, `only` without one, costs of one;
///            what fracture, refracture and writeFracture throw
[[nodiscard]] WrittenFracture fractureInto(const std::filesystem::path& folder, FractureInput input,
                                           const FractureOptions& options, Device& device,
                                           const WriteOptions& write = {},
                                           const Progress* progress = nullptr);

/// Replaces the fracture in a folder as documented at writeFracture.  The destructor restores the
/// folder unless keep() was called.
class FractureReplacement {
 public:
  ///   fresh   the new files without the manifest, relative to the folder
  ///   throws  Error(output)
  FractureReplacement(std::filesystem::path folder, std::vector<std::string> fresh);
  ~FractureReplacement();
  FractureReplacement(FractureReplacement&& other) noexcept;

  /// Writes the files and the manifest to a hidden folder: `write` gets a folder with all
  /// subfolders.
  ///   throws  Error(output); what `write` throws
  void write(const std::function<void(const std::filesystem::path&)>& write);

  /// Adds a sentence to warnings().
  void warn(std::string sentence);

  /// Sentences as those of WrittenFolder::warnings.
  [[nodiscard]] const std::vector<std::string>& warnings() const;

  /// Only renames, which are undone unless keep() is called.
  ///   throws  Error(output); the folder is restored, now or when it is opened again
  void putInPlace();

  /// Undoes putInPlace().
  ///   return  if that fails, a sentence about it; else empty
  [[nodiscard]] std::string takeBack();

  /// Makes putInPlace() final.
  ///   return  the manifest's path
  std::filesystem::path keep();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A fracture whose files are written but not yet moved to their folder.
struct StagedFracture {
  FractureResult result;  ///< as returned by fractureInto
  FractureReplacement replacement;
};

/// As fractureInto, without the final renames, so that several folders can be replaced together.
[[nodiscard]] StagedFracture stageFracture(const std::filesystem::path& folder, FractureInput input,
                                           const FractureOptions& options, Device& device,
                                           const WriteOptions& write = {},
                                           const Progress* progress = nullptr);

/// Reports a mesh's defects and repairs, and the solid made of it, as lines of text.
[[nodiscard]] std::string meshReport(const SourceMesh& source, const FractureResult& result);

/// Returns the same as a JSON object, `source.report` in a manifest.
[[nodiscard]] std::string meshReportJson(const SourceMesh& source, const FractureResult& result);

/// Returns the height of a box in words: "495 mm high".
[[nodiscard]] std::string heightText(const CoordinateSystem& coordinates, const Box& box);

/// Returns `unit` and `up` of a mesh's coordinates, with where they are from, as a JSON object:
/// those of `source` in a manifest.
[[nodiscard]] std::string coordinatesJson(const CoordinateSystem& coordinates);

/// Returns what may be lost of a mesh: volume, or walls thinner than a voxel.  One sentence each.
[[nodiscard]] std::vector<std::string> meshWarnings(const SourceMesh& source,
                                                    const FractureResult& result);

/// Returns how many kept fragments lack a neighbor because of FractureOptions::missing, as a
/// clause; empty if none does.
///   alone  FractureResult::alone
[[nodiscard]] std::string aloneText(std::size_t alone);

/// The name of the manifest in a fracture's folder.
inline constexpr const char* kManifestName = "manifest.json";

/// Returns a fragment's name: the stem and the id, with leading zeros to three digits or to the
/// number of digits of `fragments`.
[[nodiscard]] std::string fragmentName(const std::string& stem, std::size_t id,
                                       std::size_t fragments);

/// A fragment in a manifest.
struct ManifestFragment {
  int id = 0;  ///< position in the list, from 1
  std::uint64_t voxels = 0;
  double share = 0.0;   ///< of all voxels, 0..1
  double volume = 0.0;  ///< finite, like all numbers here
  double area = 0.0;
  double fractureArea = 0.0;
  std::size_t contacts = 0;
  std::vector<std::string> meshes;                  ///< [formats]; empty if none was written
  std::vector<std::vector<std::string>> decimated;  ///< [SurfaceOptions::triangles][formats]
  std::string vdb;                                  ///< empty if none was written
  bool isOfVoxelFaces = false;                      ///< the meshes are those of Surface::labels
  bool isExact = false;                             ///< the meshes are those of Surface::exact
  int split = 0;                                    ///< that it comes from, 1..splits; 0: none
  std::vector<int> bodies;  ///< of the input, of which it has triangles, ascending
};

/// The fields of a manifest that are read.  Every file named by a field is in `files`.
struct Manifest {
  std::string source;            ///< the mesh's file name
  CoordinateSystem coordinates;  ///< of all positions; meters and y up where it records neither
  std::uint64_t seed = 0;
  int resolution = 0;      ///< above 0
  bool automatic = false;  ///< the resolution was chosen automatically
  double voxelSize = 0.0;  ///< above 0
  glm::dvec3 origin{0.0};  ///< world position of the first voxel's center
  openvdb::Coord dims;     ///< each above 0
  openvdb::Coord indexMin;
  std::uint64_t solidVoxels = 0;
  std::uint64_t components = 0;
  std::optional<glm::dvec3> offset;         ///< WriteOptions::offset
  int bodies = 0;                           ///< of the input; 0: one, or not recorded
  std::vector<std::string> files;           ///< relative, below the manifest's folder
  std::string allVdb;                       ///< all fragments in one; empty if not written
  std::vector<ManifestFragment> fragments;  ///< [1..kMaxFragments], without withheld ones
  std::vector<int> splitParents;            ///< [splits] as FragmentSet::splitParents
};

/// Reads a manifest, after restoring a fracture that a killed run left half replaced.
///   throws  Error(input) absent, larger than 1 GiB, not JSON, another schema, a field that is
///           missing, of another type or out of range, ids that are not 1, 2, 3, ..., a file
///           outside the folder; what requireSettled throws
[[nodiscard]] Manifest readManifest(const std::filesystem::path& file);

/// Returns the manifest that lists a file, in its folder or one above, or nothing.
[[nodiscard]] std::optional<std::filesystem::path> manifestListing(
    const std::filesystem::path& file);

/// Restores a fracture that a killed run left half replaced; called before a fracture is read.  A
/// folder with a manifest is not changed.
///   path    the fracture's folder, one of its subfolders, or its manifest; other paths are ignored
///   throws  Error(input) restoring fails, another process writes there, or the fracture was never
///           finished
void requireSettled(const std::filesystem::path& path);

/// Returns the manifest of a fracture's folder; another path as it is.
///   throws  Error(input) the path cannot be read
[[nodiscard]] std::filesystem::path manifestIn(const std::filesystem::path& path);

/// Returns the options for breaking fragments of a fracture again as it was broken: those that its
/// manifest records, and the files that it has.  Options of the whole solid and of places in it
/// (resolution, impacts, given seeds, a density, guides, erosion, withheld fragments) and the
/// number of pieces have their defaults, and the surface is automatic unless it is that of labels.
/// The seed is the recorded one plus 1.
///   path    of a fracture's folder, or its manifest
///   throws  Error(input) what readManifest throws; an option that is damaged
[[nodiscard]] RunOptions inheritedOptions(const std::filesystem::path& path);

/// The same of a fracture in memory.
///   options  of the fracture
[[nodiscard]] RunOptions inheritedOptions(RunOptions options);

/// The names of the options that hold for the whole solid: nothing is broken again by them.
inline constexpr const char* kOptionsOfWhole[] = {
    "resolution",      "voxel-size", "seeds", "missing",  "drop-share", "erode-iterations", "fill",
    "shell-thickness", "bodies",     "grid",  "isovalue", "recenter",   "source-faces"};

/// Returns a fracture in memory as it is broken again: the labeled voxels of fragments that are not
/// withheld, and their meshes.  It is what readFracture and readFragmentMeshes return of its
/// folder, but has the whole mesh that was broken as its source.
///   source, options, write  as of writeFracture
///   result   with meshes and level sets of its fragments
[[nodiscard]] FinishedFracture finishedFracture(const SourceMesh& source,
                                                const FractureOptions& options,
                                                const FractureResult& result,
                                                const WriteOptions& write);

/// Reads a fracture from its `manifest.json`, its labels and the fragments' `.vdb` files.  Where it
/// was written without one of these, voxels are made again from the fragments' meshes: each belongs
/// to the fragment that has its center inside.
///   throws  Error(input) not a fracture's manifest, a fracture written with neither, a file that
///   is
///           absent, damaged or inconsistent with the others, a fragment without any voxel
///   path    of a fracture's folder, or its manifest
[[nodiscard]] FinishedFracture readFracture(const std::filesystem::path& path,
                                            const ReadOptions& options = {});

/// Reads the meshes of a fracture's fragments from their `.ply` files, and sets the solid's region:
/// its surface keeps the edges of theirs, and its flat parts are merged, when it is broken again.
/// Voxel faces have no edges of the original surface, so they set no region.  Without such files,
/// or with plain ones, which have no neighbors, the fracture stays without meshes.
///   throws  Error(input) a file that is absent, damaged or larger than `maxMemory`
///   path    as of readFracture
void readFragmentMeshes(const std::filesystem::path& path, FinishedFracture& finished,
                        std::uint64_t maxMemory);

/// Reads the fragments of a folder: those that its manifest.json lists, else every file with an
/// extension of readMesh, numbered from 1 in natural order: piece_2 before piece_10.  Neighbors
/// that all of these files record are kept if both sides of their contacts agree, within a fifth of
/// the area; ids are then the numbers at the ends of the names, if those are what neighbors refer
/// to.
///   throws  Error(input) `folder` is not a folder, or has neither; the manifest is damaged; a mesh
///           cannot be read, or all meshes together take more memory than `options` allow;
///           Error(cancelled)
[[nodiscard]] FragmentSet readFragments(const std::filesystem::path& folder,
                                        const ReadOptions& options = {},
                                        const Progress* progress = nullptr);

/// What readPieces returns.
struct Pieces {
  std::vector<Fragment> fragments;
  CoordinateSystem coordinates;  ///< from the manifest of the folder or listing the file, else of
                                 ///< the first mesh
};

/// Reads fragments from a fracture's folder or manifest, or from a folder of meshes as
/// readFragments does; else the mesh of a file, or the level sets of a `.vdb` file.  Fragments of a
/// fracture without mesh files are meshed from their level sets.
///   return  id, mesh, mass, and neighbor where it is known
///   throws  Error(input) nothing can be rendered, a file is damaged, or the meshes take more
///   memory
///           than `options` allow
[[nodiscard]] Pieces readPieces(const std::filesystem::path& path, const ReadOptions& options = {});

/// Returns what the coordinates of a file mean where neither it nor the user says so: of one that a
/// fracture's manifest lists what the manifest says.
///   read  from the file, or assumed
[[nodiscard]] CoordinateSystem coordinatesOfFile(const std::filesystem::path& file,
                                                 const CoordinateSystem& read);

struct ViewerOptions {
  std::uint64_t maxBytes = std::uint64_t{64}
                           << 20;  ///< of the page's meshes and textures; those that are
                                   ///< larger are simplified or left out, see `warnings`
  std::string unit;  ///< of the mesh's lengths, shown beside them; empty: the fracture's
  char up = '\0';    ///< the mesh's axis that points up: 'x', 'y', 'z'; 0: the fracture's
};

/// A self-contained HTML page that shows a fracture (docs/viewer.md).
struct Viewer {
  std::string html;
  std::vector<std::string> warnings;  ///< a sentence for each thing that is left out
};

/// Makes the page of a fracture in a folder.  Fragments without mesh files are meshed from their
/// level sets.  The same files give the same bytes.
///   folder  of a fracture, or its manifest
///   throws  Error(input) what readManifest throws; the fracture has neither meshes nor level sets;
///           a file is damaged, or all take more memory than `options` allow; Error(cancelled)
[[nodiscard]] Viewer viewerOf(const std::filesystem::path& folder, const ViewerOptions& viewer = {},
                              const ReadOptions& options = {}, const Progress* progress = nullptr);

/// What a file holds.
enum class FileKind { voxels, mesh, points, other };

/// Returns the kind of a file by its extension.  A `.ply` with faces is a mesh, else points; the
/// kind of an `.npz` is determined by the names of its arrays.
///   throws  Error(input) a `.ply` or `.npz` cannot be read, or is larger than `options` allow
[[nodiscard]] FileKind kindOf(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace sherd
