// The lists of fractures in the HDF5 file of the layout hdf5.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dataset/journal/journal.h"
#include "formats/arrays/hdf5_file.h"

namespace sherd {

/// Returns the name of a fracture's group below its object's: "fractured_0"; of the intact object
/// "complete".
///   throws  Error(input) the line has no such file
[[nodiscard]] std::string hdf5Name(const Json& line);

/// Returns the number of a line's fragments that are not withheld.
[[nodiscard]] std::size_t hdf5Kept(const Json& line);

/// The fractures of a file by split.
class Hdf5Lists {
 public:
  ///   redundant  foreign fragments for each fracture
  Hdf5Lists(std::uint64_t seed, std::size_t redundant) : seed_(seed), redundant_(redundant) {}

  /// Adds the fractures of an object.
  ///   group      of the object, new
  ///   fractures  [n] names, and numbers of fragments
  void add(const std::string& group, const std::string& split,
           const std::vector<std::pair<std::string, std::size_t>>& fractures);

  /// Returns fragments of other objects of the same split, [redundant, 2] text: the path of a
  /// fracture, and a key in its "pieces".  Nothing if none are asked for, or the split has no other
  /// object.
  [[nodiscard]] std::optional<Hdf5Array> redundantPieces(const std::string& group,
                                                         const std::string& fracture) const;

  /// Adds the lists: data_split/SUBSET/SPLIT with the paths of fractures, which GARF reads, and
  /// data_split/STEM/SPLIT with those of their "pieces", which RPF and TORA read by the file's
  /// name.
  void writeSplits(const std::string& stem, Hdf5Writer& writer) const;

 private:
  struct Fracture {
    std::string path;
    std::size_t fragments = 0;
  };
  struct Range {
    std::string split;
    std::size_t begin = 0, end = 0;  // in fractures_[split]
  };

  std::uint64_t seed_;
  std::size_t redundant_;
  std::map<std::string, std::vector<Fracture>> fractures_;  // by split
  std::map<std::string, Range> objects_;                    // by group
};

}  // namespace sherd
