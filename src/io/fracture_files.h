// Writes the files of fractures, wherever they go.
#pragma once

#include <sherd/io.h>

#include <optional>

#include "appearance/transfer.h"
#include "io/manifest.h"
#include "io/materials.h"

namespace sherd {

/// Writes any number of fractures of one mesh; any thread may ask.  The mesh and the options are
/// kept by reference.
class FractureWriter {
 public:
  FractureWriter(const SourceMesh& source, const WriteOptions& write);

  [[nodiscard]] const MaterialTable& materials() const { return table_; }

  /// Write all files that are named, but no manifest.
  ///   throws  what writeFracture throws
  void write(const OutputFolder& folder, const FractureFiles& files, const FractureOptions& options,
             const FractureResult& result, const Progress* progress) const;

 private:
  const SourceMesh& source_;
  const WriteOptions& options_;
  MaterialTable table_;
  std::optional<LookSource> look_;  ///< where the mesh has a look and meshes are written
};

}  // namespace sherd
