// Statistics of a dataset, from all its journals.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "dataset/journal/journal.h"

namespace sherd {

/// The fragments of all fractures into one number of pieces.
struct FragmentStatistics {
  std::size_t fractures = 0;
  std::vector<float> faces, vertices, share;  ///< [fragments]
};

struct FileStatistics {
  std::size_t files = 0;
  std::uint64_t bytes = 0;

  void add(const FileStatistics& more) {
    files += more.files;
    bytes += more.bytes;
  }
};

/// An image for the report.
struct Thumbnail {
  std::string caption;
  std::filesystem::path file;
  std::string viewer{};  ///< its page, below the dataset's folder; empty: none
};

struct DatasetStatistics {
  std::map<int, FragmentStatistics> byPieces;
  FileStatistics voxels, meshes, points;           ///< the files of Table 3
  std::map<std::string, FileStatistics> byFormat;  ///< "ply", "rle.zip"
  std::size_t objects = 0, fractures = 0, fragments = 0;
  std::vector<std::pair<std::string, std::string>> failures;  ///< object, reason
  std::vector<Thumbnail> thumbnails;

  /// Adds a fracture, or the intact object, by its line in the journal.
  void add(const Json& line);
};

}  // namespace sherd
