// Stores the fractures of one object in a dataset's layout, and records them in its journal.
#pragma once

#include <sherd/dataset.h>
#include <sherd/fracture.h>

#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dataset/dataset_run.h"
#include "dataset/journal/journal.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/layouts/layout.h"
#include "folder/files/fracture_writer.h"

namespace sherd {

/// What a fracture of an object is made from.
struct OutputOf {
  const LibraryObject& object;
  const SourceMesh& source;  ///< of an assemblage without a mesh
  int longestSide = 0;       ///< of the solid, voxels
  UnitBox unitBox{};         ///< of the layouts that have one
};

/// A fracture whose files are made.
struct MadeFracture {
  std::shared_ptr<StagedFiles> files;
  Json line;
  std::size_t fragments = 0;
  std::string surfaceWarning, crossingsWarning, aloneWarning;  ///< a clause, or empty
};

/// How a fracture came about.
struct FractureOrigin {
  PlannedFracture planned;
  std::size_t number = 0;  ///< in the schedule
  int attempt = 0;
  DrawnValues drawn;
  Json objects{};  ///< of an assemblage, one for each; else null
};

/// Makes and stores fractures, from any thread.  Holds references to the arguments of its
/// constructor.
class FractureOutput {
 public:
  ///   options  of the run, with the offset of an object that was recentered
  FractureOutput(OutputOf of, Journal& journal, const DatasetRun& run,
                 const DatasetOptions& options, ObjectStore& store, const Progress& progress);

  /// Writes the intact object, a fracture of one fragment, and records it.
  void writeWhole(FractureResult whole, const FractureOptions& options);

  /// Makes the files of a fracture.
  ///   result  in world space
  [[nodiscard]] MadeFracture made(FractureResult result, const FractureOptions& options,
                                  const FractureOrigin& origin);

  /// Records the fracture in the journal once its files are stored.
  void keep(std::shared_ptr<StagedFiles> files, Json line);

  /// Renders a fracture if it gets a thumbnail.
  void renderThumbnail(const std::string& name, const FractureResult& result) const;

 private:
  [[nodiscard]] NamedObject named(const FractureOptions& options) const;
  [[nodiscard]] bool isInWorld() const;
  [[nodiscard]] std::optional<UnitBox> frameOfPoses() const;
  void record(MadeFracture& made, const FractureResult& result, const FractureOptions& options,
              const NamedFiles& names, const Json& objects) const;
  void keepDecimated(FractureResult& result) const;
  void writeFiles(StagedFiles& files, const FractureFiles& names, const FractureOptions& options,
                  std::size_t number, FractureResult& result) const;
  void warnOnce(const std::string& warning) const;
  void writePage(const std::string& name, const FractureResult& result) const;
  void intoUnitBox(FractureResult& result) const;

  const OutputOf of_;
  Journal& journal_;
  const DatasetRun& run_;
  const DatasetOptions& options_;
  ObjectStore& store_;
  const Progress& progress_;
  const FractureWriter writer_;
  mutable std::mutex warnedMutex_;
  mutable std::set<std::string> warned_;
};

/// Returns an intact object as a fracture of one fragment.
///   options  those of `each`; pieces and meshes are set here
[[nodiscard]] FractureResult wholeResult(const PreparedSolid& ready, const FractureOptions& options,
                                         const Progress* progress);

}  // namespace sherd
