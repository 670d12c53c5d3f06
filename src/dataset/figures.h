// The figures of a dataset: what its journals and records of runs tell together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "dataset/index.h"

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

/// One run, as run_record.h has it.
struct RunFigures {
  std::string name;  ///< "run", "shard 2 of 4"
  double seconds = 0.0;
  std::string device;
  std::map<std::string, double> stages;                 ///< seconds
  std::vector<double> at, cores, memory, deviceMemory;  ///< by sample; bytes
};

struct DatasetFigures {
  std::map<int, PieceFigures> byPieces;
  FileFigures voxels, meshes, points;  ///< the files of Table 3
  std::map<std::string, FileFigures> byFormat;
  std::size_t objects = 0, fractures = 0, fragments = 0;
  std::vector<std::pair<std::string, std::string>> failures;  ///< object, reason
  std::vector<RunFigures> runs;

  [[nodiscard]] double seconds() const;  ///< of all runs
};

///   throws  Error(input) a journal is damaged
[[nodiscard]] DatasetFigures figuresOf(const std::filesystem::path& out, const DatasetPlan& plan);

}  // namespace sherd
