// Writes the files of fractures, wherever they go.
#pragma once

#include <sherd/io.h>

#include <optional>
#include <vector>

#include "appearance/transfer.h"
#include "folder/manifest.h"
#include "folder/mesh_writer.h"
#include "formats/mesh/materials.h"

namespace sherd {

/// Writes any number of fractures of one mesh; any thread may ask.  The mesh and the options are
/// kept by reference.
class FractureWriter {
 public:
  FractureWriter(const SourceMesh& source, const WriteOptions& write);

  [[nodiscard]] const SourceMesh& source() const { return source_; }
  [[nodiscard]] const WriteOptions& options() const { return options_; }
  [[nodiscard]] const MaterialTable& materials() const { return table_; }
  /// What meshes take their look from, or null where there is none or no meshes are written.
  [[nodiscard]] const LookSource* look() const { return look_ ? &*look_ : nullptr; }

  /// Write all files that are named, but no manifest.
  ///   throws  what writeFracture throws
  void write(const OutputFolder& folder, const FractureFiles& files, const FractureOptions& options,
             const FractureResult& result, const Progress* progress) const;

 private:
  const SourceMesh& source_;
  const WriteOptions& options_;
  MaterialTable table_;
  std::optional<LookSource> look_;
};

/// Writes one fracture while its fragments are made: begin, write, finish.  All it is made of is
/// kept by reference.
class FractureWriting {
 public:
  ///   result  all but its fragments' contents, of which there are the right number
  FractureWriting(const FractureWriter& writer, const OutputFolder& folder,
                  const FractureFiles& files, const FractureOptions& options,
                  const FractureResult& result);
  FractureWriting(const FractureWriting&) = delete;
  FractureWriting& operator=(const FractureWriting&) = delete;

  /// What needs no fragment.
  void begin(const Progress* progress) const;

  /// The files of fragments first..end-1 of the result, which need no others, nor contacts.
  void write(std::size_t first, std::size_t end);

  /// What needs all fragments, with what WriteOptions::needsAllMeshes and needsAllLevelSets say.
  void finish(const Progress* progress) const;

 private:
  std::span<const Fragment> kept() const;
  VdbNotes notes() const;
  void writeLevelSet(std::size_t i) const;
  void writeMeshes(std::size_t i);

  const FractureWriter& writer_;
  const OutputFolder folder_;
  const FractureFiles& files_;
  const FractureOptions& options_;
  const FractureResult& result_;
  const MeshWriter meshes_;
  // [fragments that are not withheld], or empty
  std::vector<SurfaceLook> looks_;  ///< for the scene
  std::vector<Fragment> pictured_;  ///< for the picture
};

}  // namespace sherd
