// Dataset runs: a library of meshes, each broken many times.
#pragma once

#include <sherd/error.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>
#include <sherd/options.h>
#include <sherd/progress.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace sherd {

/// A mesh of a library, or an assemblage of several.
struct LibraryObject {
  std::string key;             ///< path relative to the library, components separated by '/'
  std::string folder;          ///< output folder, none nested in another: the key, without
                               ///< extensions where that stays unique.  runDataset renames it
                               ///< where the layout reserves the name
  std::filesystem::path file;  ///< path of the file; empty of an assemblage
  std::uintmax_t bytes = 0;    ///< of an assemblage, of all its parts
  std::vector<LibraryObject> parts{};  ///< of an assemblage: its objects, then those that intruders
                                       ///< are of, all of one split; else empty
  std::size_t intruders = 0;           ///< the last `intruders` parts
  std::string license{};               ///< as LibraryOptions::licenses has it; empty: not stated
};

/// The license of a mesh, or of those that a pattern matches.
struct MeshLicense {
  std::string mesh;  ///< its key, or a shell pattern as LibraryOptions::match
  std::string license;
};

struct LibraryOptions {
  std::string match;      ///< shell pattern that keys must match, '*' also matches '/'; empty: all
  std::size_t limit = 0;  ///< keeps only the first `limit` matches; 0: all
  std::set<std::string> keys{};         ///< keeps only these, which must all be there; empty: all
  std::vector<MeshLicense> licenses{};  ///< a mesh has the one of its key, else of the first
                                        ///< pattern that matches
};

/// Returns the meshes and volumes of a library, ascending by key.
///   library  a folder, searched recursively without hidden folders; or one mesh or volume; or a
///            list: a text file with one path per line, relative to the list's folder; '#' starts a
///            comment
///   skipped  receives one sentence for each folder that cannot be read, each link that is broken
///            or leads to a folder, and each entry with a mesh's name that is not a file
///   throws   Error(input) the library does not exist, has no meshes, or lacks one of the keys
[[nodiscard]] std::vector<LibraryObject> findObjects(const std::filesystem::path& library,
                                                     const LibraryOptions& options = {},
                                                     std::vector<std::string>* skipped = nullptr);

/// The share of a run that one of several machines does.
struct Shard {
  int number = 1;  ///< 1..of
  int of = 1;      ///< number of shards
};

/// Returns the objects of a shard.  Files are assigned from the largest down, each to the shard
/// with the fewest bytes so far, so shards take similar time.  Every object is in exactly one
/// shard.
[[nodiscard]] std::vector<LibraryObject> shardOf(const std::vector<LibraryObject>& objects,
                                                 Shard shard);

/// One fracture of each object.
struct PlannedFracture {
  int pieces = 2;
  int repeat = 0;  ///< from 0

  std::string name() const { return std::to_string(pieces) + "f_" + std::to_string(repeat); }
};

/// How many fractures each object gets, by number of pieces.
struct Schedule {
  int fewest = 2, most = 10;  ///< pieces: every number in this range is used; of the objects of
                              ///< an assemblage, each has one drawn of it
  int repeatsOfFewest = 25;   ///< fractures into `fewest` pieces
  int repeatsOfMost = 15;     ///< fractures into `most` pieces; between, the number is
                              ///< interpolated and truncated, as in the paper's program
  std::size_t maxFragments = 1000;  ///< per object: fractures beyond this sum are left out
};

/// Returns the fractures of one object, in the order in which they are made.
[[nodiscard]] std::vector<PlannedFracture> fracturesOf(const Schedule& schedule);

/// Returns the seed of a fracture.  It depends only on the arguments: `sherd fracture` with this
/// seed and the same options gives the same fragments.
///   sha256   of the object's file, hexadecimal
///   attempt  from 0; increased when a fracture was too similar to an earlier one
[[nodiscard]] std::uint64_t fractureSeed(std::uint64_t runSeed, const std::string& sha256,
                                         const PlannedFracture& fracture, int attempt = 0);

/// Assemblages: collections of fragments of several objects of the library, which take the place of
/// its objects in a dataset.  Each object is scaled to a longest side of 1, with
/// SolidOptions::resolution voxels, broken for itself, and set up beside the others along x; ids go
/// through the fragments of all in a random order.  The first object is drawn among all of the
/// library, the others among those of its split, none twice.
struct AssemblageOptions {
  int fewest = 1, most = 1;  ///< objects of an assemblage, 1..kMostObjects, drawn for each; `most`
                             ///< 1: none, the library's objects are broken one by one
  std::size_t items = 0;     ///< number of assemblages; 0: as many as the library has objects
  double intruders = 0.0;    ///< fragments of further objects, one of each: a number if >= 1, below
                             ///< 1 a share of the pieces asked for
};

inline constexpr int kMostObjects = 1000;

/// The folder structure of a dataset, see docs/formats.md.
enum class DatasetLayout {
  sherd,   ///< a folder for each object, with a folder for each fracture
  packed,  ///< a ZIP file for each object, with the same content
  paper,   ///< the paper's file names, in a folder for each object
  bb,      ///< the tree of the Breaking Bad dataset: fragments scaled to a unit box
  hdf5,    ///< one HDF5 file, which GARF, Rectified Point Flow and TORA read: likewise scaled
  pfpp,    ///< PuzzleFusion++'s points and matches, likewise scaled
};

/// How each file is compressed.
enum class FileCompression { none, zip, zstd };

/// Names and values of the options that were drawn for one fracture.
using DrawnValues = std::vector<std::pair<std::string, std::string>>;

inline constexpr std::size_t kMaxRedundantPieces = 64;

struct DatasetOptions {
  Schedule schedule{};
  std::uint64_t seed = 0;
  /// For every fracture.  Pieces and seeds are the schedule's: where `pieces`, `seed` or given
  /// seeds are set, they are refused.
  RunOptions each{.write = {.vdb = false, .preview = false}};
  AssemblageOptions assemblage{};
  std::vector<DrawnOption> drawn{};  ///< options whose values are drawn for each fracture
  double distinct = 0.0;  ///< least share of voxels in which two fractures of an object differ,
                          ///< 0..1, measured on at most 131,072 evenly spaced voxels
  int tries = 20;         ///< attempts per fracture to reach `distinct`
  bool poses = false;     ///< adds a random pose of each fragment to the index
  std::array<int, 3> split{80, 10, 10};  ///< ratio of training, validation and test objects
  DatasetLayout layout = DatasetLayout::sherd;
  FileCompression compression = FileCompression::none;
  bool removal = false;             ///< hdf5: an order in which fragments may be removed
  std::size_t redundantPieces = 0;  ///< hdf5: foreign fragments listed for each fracture,
                                    ///< 0..kMaxRedundantPieces
  LibraryOptions library{};
  Shard shard{};
  bool resume = false;
  bool replace = false;  ///< a dataset that is there, once the new one is complete
  bool strict = false;   ///< with `replace`: a dataset without some object replaces none
  bool viewers = false;  ///< a page of the viewer for each fracture that the report shows
  double objectTimeout = std::numeric_limits<double>::infinity();  ///< seconds
  std::uint64_t maxMemory = std::numeric_limits<std::uint64_t>::max();
};

using DatasetOptionRow = OptionRow<DatasetOptions>;

/// Returns the options of a dataset beyond those of its fractures (fractureOptionTable).  Rows with
/// a key shape the dataset; the others only its run.
[[nodiscard]] std::span<const DatasetOptionRow> datasetOptionTable();

/// Returns what shapes a dataset, as text: all options that have other values than their defaults,
/// by name.  Only a run with the same identity is resumed.
[[nodiscard]] std::string datasetIdentity(const DatasetOptions& options);

/// Draws the assemblages of a library: a function of the options, the seed and the keys of its
/// objects.
///   objects  of the library, of findObjects
///   throws   Error(input) no split has as many objects as an assemblage needs
[[nodiscard]] std::vector<LibraryObject> drawnAssemblages(const std::vector<LibraryObject>& objects,
                                                          const DatasetOptions& options);

/// The progress of a run.
struct DatasetProgress {
  std::string object;           ///< the object being broken
  std::size_t objects = 0;      ///< finished, failed ones included
  std::size_t ofObjects = 0;    ///< total
  std::size_t fractures = 0;    ///< finished by this process
  std::size_t ofFractures = 0;  ///< total over the objects that have not failed
  std::size_t fragments = 0;
  double seconds = 0.0;
};

/// What a run reports; each member may be empty.
struct DatasetCallbacks {
  std::function<void(const DatasetProgress&)> fractured{};  ///< after each fracture, in order
  std::function<void(const std::string& object, const Error& reason)> failed{};
  std::function<void(const std::string& sentence)> warning{};
  /// With `replace`, called with the folder of the complete new dataset, but not for a shard: what
  /// it throws leaves the old one in its place.
  std::function<void(const std::filesystem::path& made)> beforeReplacing{};
  const Progress* progress = nullptr;  ///< only `cancelled` is called; true stops the run
};

/// The contents of a finished dataset; for a shard that is not merged yet, those of this run.
struct DatasetSummary {
  std::filesystem::path folder{};  ///< of runDataset: where the files are, beside the dataset of
                                   ///< `out` while a shard replaces it
  std::size_t objects = 0;
  std::size_t failures = 0;
  std::size_t skipped = 0;  ///< entries of the library that findObjects skipped
  std::size_t fractures = 0;
  std::size_t fragments = 0;
  std::uintmax_t bytes = 0;
  std::map<std::string, std::uintmax_t> bytesByFormat;  ///< by extension: "rle", "ply.zip"
  bool complete = true;  ///< false: one of several shards, not merged into an index yet
  std::vector<StageTime> times;
  std::vector<std::string> warnings;  ///< what would mislead a loader of the dataset: a split
                                      ///< without objects.  A run reports them itself, too
};

/// Breaks a library.  Objects are read in order and voxelized once; fractures are grown on the
/// device in order, and the other stages run for several fractures in parallel.  Each finished
/// fracture is recorded, so the same call with `resume` continues a run that ended for any reason
/// and produces the same files.
/// With `replace` the dataset in `out` is made anew: beside it, in out/.sherd-replacing, which is
/// renamed into its place when it is complete, by the merge where there are shards.  Then the files
/// of the old one are removed, and no others.  The same call continues a replacement that ended for
/// any reason; until it is complete the old dataset is as it was.
///   out      absent, empty, with `replace` any dataset, or with `resume` a run with the same
///            identity (datasetIdentity);
///            neither inside the library nor a parent of it.  Nothing outside it is changed:
///            symbolic links in it are refused
///   throws   Error(usage) another identity, an option out of range; Error(input) no library;
///            Error(output) disk full, `out` holds something else; Error(cancelled); Error(device)
DatasetSummary runDataset(const std::filesystem::path& library, const std::filesystem::path& out,
                          const DatasetOptions& options, Device& device,
                          const DatasetCallbacks& callbacks = {});

/// An estimate of a run's output, time and size.
struct DatasetForecast {
  std::size_t objects = 0;  ///< of the shard
  std::size_t fractures = 0;
  std::size_t fragments = 0;         ///< if every object is connected and no fragment is withheld
  double bytes = 0.0;                ///< approximate
  double seconds = 0.0;              ///< approximate, on this machine
  std::size_t sampled = 0;           ///< objects that were broken for the estimate
  std::vector<std::string> refused;  ///< sampled objects that could not be broken
  std::vector<std::string> skipped;  ///< as reported by findObjects
  std::vector<std::string> renamed;  ///< a sentence for each folder that gets another name
};

/// Estimates the result of runDataset from a small, a medium and a large object: each is broken a
/// few times into the fewest and the most pieces, in a temporary folder.
///   out       the output folder of the run; nothing is written to it
///   progress  here and below, only `cancelled` is called
///   throws    as runDataset
DatasetForecast forecastDataset(const std::filesystem::path& library,
                                const std::filesystem::path& out, const DatasetOptions& options,
                                Device& device, const Progress* progress = nullptr);

/// The result of verifyDataset.
struct DatasetCheck {
  std::size_t files = 0;  ///< files read
  std::uintmax_t bytes = 0;
  std::vector<std::string> problems;  ///< one sentence each
};

/// Verifies every file that the journals list: size and checksum, voxels per fragment in `.rle`
/// files, face counts of `.ply`, `.obj` and `.binm` meshes; and the dataset's own files, see
/// changedOwnFiles.
///   shard   whose objects are read
///   throws  Error(input) `out` is not a dataset; Error(cancelled)
DatasetCheck verifyDataset(const std::filesystem::path& out, const Progress* progress = nullptr,
                           Shard shard = {});

/// Returns a sentence for each of the dataset's own files (plan, index, lists, report, journals)
/// that is not as its checksum in journal/SHA256SUMS, or not listed there; nothing where there are
/// no checksums.  A run writes most of them anew: call it before.
///   absentToo  also for those that are listed and absent
[[nodiscard]] std::vector<std::string> changedOwnFiles(const std::filesystem::path& out,
                                                       bool absentToo);

/// Merges the shards below one folder: writes index, failures and splits.
///   throws  Error(input) `out` is not a dataset, or has objects that are neither done nor failed
DatasetSummary mergeDataset(const std::filesystem::path& out, const Progress* progress = nullptr);

// Recipes: recipe.json, from which a dataset can be made again, and compared.

/// A mesh that a dataset was made of.
struct RecipeMesh {
  std::string key;      ///< LibraryObject::key
  std::string sha256;   ///< of its file; empty where that could not be read
  std::string license;  ///< LibraryObject::license
};

/// What came out of a mesh.
struct RecipeObject {
  std::string key;
  std::string sha256;  ///< of a line "SHA-256  name" for each file of all its fractures, in the
                       ///< order of the schedule and by name
  std::vector<std::string> fractures;  ///< the intact object, then each fracture: the first eight
                                       ///< digits of the same of its files alone
};

/// The content of recipe.json: about 150 bytes a mesh and 11 a fracture.
struct DatasetRecipe {
  std::string program;                ///< version that made the dataset
  std::string options;                ///< datasetIdentity
  std::vector<std::string> drawn;     ///< names of DatasetOptions::drawn in their order
  std::vector<RecipeMesh> meshes;     ///< ascending by key, those that could not be broken too
  std::vector<RecipeObject> objects;  ///< those that could be broken
};

/// Reads a recipe.
///   throws  Error(input) with the file's name: not a recipe, above 1 GiB; a field is missing, or
///           of another kind
[[nodiscard]] DatasetRecipe readRecipe(const std::filesystem::path& file);

/// Returns the options of the recipe's dataset, for its meshes alone.  Options that name other
/// files, such as guides, need those at the same paths.
///   throws  Error(input) an option that this version does not have
[[nodiscard]] DatasetOptions optionsOfRecipe(const DatasetRecipe& recipe);

/// Checks that a library has all meshes of a recipe, as they were.
///   progress  only `cancelled` is called, before each mesh is read
///   throws    Error(input) one is missing, or is another file than that of the recipe;
///             Error(cancelled)
void requireMeshes(const std::filesystem::path& library, const DatasetRecipe& recipe,
                   const Progress* progress = nullptr);

/// Returns a sentence for each object that differs between two recipes, with its fractures.
[[nodiscard]] std::vector<std::string> differences(const DatasetRecipe& asked,
                                                   const DatasetRecipe& made);

/// Reads licenses of meshes: a line for each, a key or a shell pattern, a tab, and the license; '#'
/// starts a comment.
///   return  in the order of the file
///   throws  Error(input) with the file's name: above 16 MiB, a line without a tab, a key or a
///           pattern twice
[[nodiscard]] std::vector<MeshLicense> readLicenses(const std::filesystem::path& file);

/// Returns the keys and patterns of licenses that match no mesh of a library.
///   throws  Error(input) as findObjects
[[nodiscard]] std::vector<std::string> idleLicenses(const std::filesystem::path& library,
                                                    const std::vector<MeshLicense>& licenses);

}  // namespace sherd
