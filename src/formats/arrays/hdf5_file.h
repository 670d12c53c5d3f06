// Writes and reads HDF5 files of compressed arrays.
//
// The HDF5 library is opened at run time, as OpenCL's loader is: a program that writes no such file
// neither needs it nor starts later for it (Debian's has 35 dependencies).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// Types of numbers, little-endian.  `boolean` is h5py's: an enumeration {FALSE, TRUE} of int8.
enum class Hdf5Type { float32, int32, int16, int64, boolean, text };

/// An array as it is stored: one chunk, its bytes shuffled (all but text) and deflated.  It can be
/// copied from file to file without packing it again.
struct Hdf5Array {
  Hdf5Type type = Hdf5Type::float32;
  std::size_t itemBytes = 4;         ///< of text its length, with zero bytes behind shorter items
  std::vector<std::uint64_t> shape;  ///< one to kMostHdf5Axes axes
  std::string packed;                ///< empty if the array is
};

inline constexpr std::size_t kMostHdf5Axes = 3;

/// Packs an array.  Needs no HDF5 library; any number of threads may pack.
///   bytes   the numbers in C order, under 4 GiB
///   throws  Error(output) too large
[[nodiscard]] Hdf5Array packedHdf5(Hdf5Type type, std::vector<std::uint64_t> shape,
                                   std::string_view bytes);

/// Packs texts of UTF-8, one axis or, with `columns` above 0, rows of so many.
[[nodiscard]] Hdf5Array packedHdf5(const std::vector<std::string>& texts, std::size_t columns = 0);

/// Returns why HDF5 files can be neither written nor read here; empty if they can.
[[nodiscard]] std::string hdf5Fault();

/// A new HDF5 file.  Equal calls give equal bytes with one version of the library: no times are
/// stored.  Memory does not grow with the file.
class Hdf5Writer {
 public:
  /// Replaces the file's content.
  ///   name    of the file in messages
  ///   throws  Error(output)
  Hdf5Writer(const std::filesystem::path& file, std::string name);
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  /// Adds an array, and the groups on its path.
  ///   path    "a/b/name", new in this file
  ///   throws  Error(output) the disk is full, the path exists
  void add(const std::string& path, const Hdf5Array& array);

  /// Ends the file.
  ///   throws  Error(output)
  void close();

 private:
  void addGroups(const std::string& path);
  [[noreturn]] void fail() const;

  std::string name_;
  std::string groups_;                       // of the array added last: "a/b/"
  [[maybe_unused]] std::int64_t file_ = -1;  // not in a build without HDF5
};

/// An existing HDF5 file.
class Hdf5Reader {
 public:
  ///   throws  Error(input) it is none, or cut
  explicit Hdf5Reader(const std::filesystem::path& file);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  /// Returns an array as Hdf5Writer stored it; nothing if there is no such path.
  ///   throws  Error(input) it is stored in another way, or damaged
  [[nodiscard]] std::optional<Hdf5Array> read(const std::string& path) const;

 private:
  std::filesystem::path name_;
  [[maybe_unused]] std::int64_t file_ = -1;  // not in a build without HDF5
};

}  // namespace sherd
