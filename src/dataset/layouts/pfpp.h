// The layout pfpp: points, the graph of contacts, and matches, as PuzzleFusion++ reads them.
#pragma once

#include <sherd/dataset.h>

#include <cstdint>
#include <string>
#include <vector>

#include "folder/manifest/manifest.h"

namespace sherd {

inline constexpr std::size_t kPfppParts = 20;         ///< the most fragments its arrays hold
inline constexpr std::size_t kPfppFractures = 8192;   ///< the most of an object
inline constexpr std::size_t kPfppPointsEach = 1000;  ///< of a fragment, by default
inline constexpr std::size_t kPfppPointsShared = 5000;

/// Returns the number that names a fracture: of the object's folder and the fracture's place in its
/// schedule, so it stays when objects are added; below 2^63.
[[nodiscard]] std::uint64_t pfppId(const LibraryObject& object, std::size_t fracture);

/// The two files of a fracture, below the dataset's folder.
struct PfppNames {
  std::string points;   ///< pc_data/SUBSET/SPLIT/ID.npz
  std::string matches;  ///< matching_data/SUBSET/ID.npz
};

[[nodiscard]] PfppNames pfppNames(const LibraryObject& object, const std::string& split,
                                  std::size_t fracture);

/// Returns all names that an object may have.
[[nodiscard]] std::vector<std::string> pfppFilesOf(const LibraryObject& object,
                                                   const std::string& split, std::size_t fractures);

/// Requires that no two objects have the same numbers.
///   throws  Error(input)
void requirePfppIds(const std::vector<LibraryObject>& objects);

/// What is written of a fracture beside its result.
struct PfppFracture {
  std::uint64_t id = 0;
  std::string path;        ///< SUBSET/CATEGORY/OBJECT/fractured_0
  std::uint64_t seed = 0;  ///< of the fracture
  PointOptions points{};   ///< how points are sampled; `count` of each fragment
  glm::dvec3 center{0.0};  ///< points are moved by its negative,
  double scale = 1.0;      ///< then scaled
};

/// Writes both files.
///   result  with surfaces or meshes
///   throws  Error(input) more than kPfppParts fragments; Error(output)
void writePfpp(FileSink& sink, const PfppNames& names, const PfppFracture& fracture,
               const FractureResult& result);

}  // namespace sherd
