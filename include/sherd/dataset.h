// Dataset runs: a whole library of meshes, each broken many times.
#pragma once

#include <sherd/fracture.h>
#include <sherd/io.h>
#include <sherd/progress.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace sherd {

/// A mesh of a library.
struct LibraryObject {
  std::string key;             ///< its path relative to the library, parts separated by '/'
  std::string folder;          ///< the same as the name of a folder, of which none lies within
                               ///< another: without extensions where that gives no other's.  A
                               ///< dataset changes it where it keeps the name for itself
  std::filesystem::path file;  ///< where it is
  std::uintmax_t bytes = 0;
};

struct LibraryOptions {
  std::string match;      ///< shell pattern that keys have to match, '*' also '/'; empty: all
  std::size_t limit = 0;  ///< the first so many of them; 0: all
};

/// The meshes and volumes of a library, ascending by key.
///   library  a folder, looked through with all folders below it, hidden ones aside; or a list: a
///            text file with a path a line, relative to its own folder; '#' begins a comment
///   skipped  takes a sentence for each folder that cannot be looked through, link that leads
///            nowhere or to a folder, and anything else named like a mesh that is no file
///   throws   Error(input) it is absent or has none
[[nodiscard]] std::vector<LibraryObject> findObjects(const std::filesystem::path& library,
                                                     const LibraryOptions& options = {},
                                                     std::vector<std::string>* skipped = nullptr);

/// A part of the work that is done by one of several machines, from 1.
struct Shard {
  int number = 1;
  int of = 1;
};

/// The objects of a shard.  The largest files are dealt out first, each to the shard that has the
/// fewest bytes by then, so shards take about as long; every object is in one.
[[nodiscard]] std::vector<LibraryObject> shardOf(const std::vector<LibraryObject>& objects,
                                                 Shard shard);

/// One fracture of each object.
struct PlannedFracture {
  int pieces = 2;
  int repeat = 0;  ///< from 0

  std::string name() const { return std::to_string(pieces) + "f_" + std::to_string(repeat); }
};

/// How often objects are broken into how many pieces.
struct Schedule {
  int fewest = 2, most = 10;        ///< pieces, every number from one to the other
  int repeatsOfFewest = 25;         ///< fractures into `fewest` pieces; in between the number is
  int repeatsOfMost = 15;           ///< interpolated, and truncated as the paper's program does
  std::size_t maxFragments = 1000;  ///< of an object, after which there are no more fractures
};

[[nodiscard]] std::vector<PlannedFracture> fracturesOf(const Schedule& schedule);

/// The seed of a fracture: of the run's seed, the object's content and the fracture, and of nothing
/// else.  `sherd fracture` with it, and with the same options, gives the same fragments.
///   sha256   of the object's file, hexadecimal
///   attempt  from 0; the next where a fracture was too much like an earlier one
[[nodiscard]] std::uint64_t fractureSeed(std::uint64_t runSeed, const std::string& sha256,
                                         const PlannedFracture& fracture, int attempt = 0);

/// Where files lie, see docs/formats.md.
enum class DatasetLayout {
  sherd,   ///< a folder for each object, and in it one for each fracture
  packed,  ///< a ZIP file for each object, and in it the same
  paper,   ///< the paper's names, in a folder for each object
  bb,      ///< Breaking Bad's tree: pieces in a unit box
};

/// How each file is packed.
enum class FileCompression { none, zip, zstd };

/// Options that were drawn for one fracture, by name.
using DrawnOptions = std::vector<std::pair<std::string, std::string>>;

struct DatasetOptions {
  Schedule schedule{};
  std::uint64_t seed = 0;
  FractureOptions fracture{};  ///< of every fracture; its `pieces` and `seed` are not used
  WriteOptions write{};
  std::function<DrawnOptions(std::uint64_t seed, FractureOptions& options)>
      draw{};             ///< changes the options of one fracture; empty: none
  std::string plan{};     ///< text that tells these options: only a run of the same is resumed
  double distinct = 0.0;  ///< share of voxels by which fractures of an object differ, 0..1; at
                          ///< most 131,072 voxels, evenly spread, are looked at
  int tries = 20;         ///< of each fracture, for `distinct`
  bool poses = false;     ///< a random pose for each fragment, into the index
  std::array<int, 3> split{80, 10, 10};  ///< shares of objects for training, validation and test
  DatasetLayout layout = DatasetLayout::sherd;
  FileCompression compression = FileCompression::none;
  LibraryOptions library{};
  Shard shard{};
  bool resume = false;
  double objectTimeout = std::numeric_limits<double>::infinity();  ///< seconds
  std::uint64_t maxMemory = std::numeric_limits<std::uint64_t>::max();
};

/// What a run tells while it goes.
struct DatasetProgress {
  std::string object;       ///< being broken
  std::size_t objects = 0;  ///< done, failed ones too
  std::size_t ofObjects = 0;
  std::size_t fractures = 0;    ///< done, in this process
  std::size_t ofFractures = 0;  ///< of the objects that have not failed
  std::size_t fragments = 0;
  double seconds = 0.0;
};

struct DatasetWatch {
  std::function<void(const DatasetProgress&)> progress{};  ///< after each fracture, in order
  std::function<void(const std::string& object, const std::string& reason)> failed{};
  std::function<void(const std::string& sentence)> warning{};
  std::function<bool()> cancelled{};  ///< asked from any thread
};

/// What there is at the end; of a shard that is not merged yet, what this run has done.
struct DatasetSummary {
  std::size_t objects = 0;
  std::size_t failures = 0;
  std::size_t skipped = 0;  ///< folders and files of the library that could not be looked at
  std::size_t fractures = 0;
  std::size_t fragments = 0;
  std::uintmax_t bytes = 0;
  std::map<std::string, std::uintmax_t> bytesByFormat;  ///< by extension: "rle", "ply.zip"
  bool complete = true;  ///< false: one of several shards, of which there is no index yet
  std::vector<StageTime> times;
};

/// Break a library.  Objects are read one after another; of each, the solid is made once, fractures
/// are grown on the device in order, and the rest is done for several at a time.  What is done is
/// noted fracture by fracture, so a run that ends in whatever way is taken up again by the same
/// call with `resume`, and leaves the same files.
///   out      absent, empty or of the same plan and `resume`; neither in the library nor round it.
///            Nothing outside it is touched: a symbolic link in it is refused
///   throws   Error(usage) another plan, out of range; Error(input) no library; Error(output) the
///            disk is full, out is something else; Error(cancelled); Error(device)
DatasetSummary runDataset(const std::filesystem::path& library, const std::filesystem::path& out,
                          const DatasetOptions& options, Device& device,
                          const DatasetWatch& watch = {});

/// What a run would make.
struct DatasetForecast {
  std::size_t objects = 0;  ///< of the shard
  std::size_t fractures = 0;
  std::size_t fragments = 0;         ///< where every object is in one part, and nothing is withheld
  double bytes = 0.0;                ///< about
  double seconds = 0.0;              ///< about, on this machine
  std::size_t sampled = 0;           ///< objects that it was told from
  std::vector<std::string> refused;  ///< objects that were to be sampled and cannot be broken
  std::vector<std::string> skipped;  ///< as findObjects has them
  std::vector<std::string> renamed;  ///< a sentence for each folder that gets another name
};

/// Tell what runDataset would make from a small, a middling and a large object, of which each is
/// broken a few times into the fewest and the most pieces, in a folder for temporary files.
///   out     where it would go; nothing is written there
///   throws  as runDataset
DatasetForecast forecastDataset(const std::filesystem::path& library,
                                const std::filesystem::path& out, const DatasetOptions& options,
                                Device& device, const std::function<bool()>& cancelled = {});

/// What is wrong with a finished dataset.
struct DatasetCheck {
  std::size_t files = 0;  ///< that were read
  std::uintmax_t bytes = 0;
  std::vector<std::string> problems;  ///< a sentence each
};

/// Read everything again that the journals list: sizes and checksums, voxels of each fragment in
/// `.rle` files, faces of each `.ply`, `.obj` and `.binm` mesh.
///   throws  Error(input) it is no dataset; Error(cancelled)
DatasetCheck verifyDataset(const std::filesystem::path& out,
                           const std::function<bool()>& cancelled = {});

/// Join what shards have written below one folder: index, failures and splits.
///   throws  Error(input) it is no dataset, or objects of it are neither done nor failed
DatasetSummary mergeDataset(const std::filesystem::path& out,
                            const std::function<bool()>& cancelled = {});

}  // namespace sherd
