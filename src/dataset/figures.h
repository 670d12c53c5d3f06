// The figures of a dataset: what its journals tell together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "dataset/journal.h"

namespace sherd {

/// Fragments that were made by fractures into one number of pieces.
struct PieceFigures {
  std::size_t fractures = 0;
  std::vector<float> faces, vertices, share;  ///< [fragments]
};

struct FileFigures {
  std::size_t files = 0;
  std::uint64_t bytes = 0;

  void add(const FileFigures& more) {
    files += more.files;
    bytes += more.bytes;
  }
};

/// A picture for the report.
struct Pictured {
  std::string caption;
  std::filesystem::path file;
};

struct DatasetFigures {
  std::map<int, PieceFigures> byPieces;
  FileFigures voxels, meshes, points;           ///< the files of Table 3
  std::map<std::string, FileFigures> byFormat;  ///< "ply", "rle.zip"
  std::size_t objects = 0, fractures = 0, fragments = 0;
  std::vector<std::pair<std::string, std::string>> failures;  ///< object, reason
  std::vector<Pictured> pictures;

  /// Add a fracture, or the unbroken object, by its line in the journal.
  void add(const Json& line);
};

}  // namespace sherd
