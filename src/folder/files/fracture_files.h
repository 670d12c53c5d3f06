// Writes the files of fractures to folders and sinks.
#pragma once

#include <sherd/folder.h>

#include <optional>
#include <vector>

#include "appearance/transfer.h"
#include "base/memory_gate.h"
#include "folder/files/copied_files.h"
#include "folder/files/fracture_writer.h"
#include "folder/files/mesh_writer.h"
#include "folder/manifest/manifest.h"
#include "folder/manifest/rounding.h"
#include "formats/mesh/materials.h"

namespace sherd {

/// Writes one fracture while its fragments are made: begin, write, finish.  Holds references to the
/// arguments of its constructor.
class FractureWriting {
 public:
  ///   result  complete except for the fragments, which are set before they are written; the number
  ///           of fragments is final
  ///   kept    files of an earlier fracture that are copied; null: there are none
  FractureWriting(const FractureWriter& writer, const OutputFolder& folder,
                  const FractureFiles& files, const FractureOptions& options,
                  const FractureResult& result, const CopiedFiles* kept = nullptr);
  FractureWriting(const FractureWriting&) = delete;
  FractureWriting& operator=(const FractureWriting&) = delete;

  /// Writes the files that do not depend on fragments.
  void begin(const Progress* progress) const;

  /// Writes the files of fragments first..end-1, which need neither contacts nor other fragments.
  void write(std::size_t first, std::size_t end);

  /// `begin`, and `write` of all fragments.
  void writeAll(const Progress* progress);

  /// Writes the files of all fragments; see WriteOptions::needsAllMeshes and needsAllLevelSets.
  ///   return  sentences about what they leave out
  std::vector<std::string> finish(const Progress* progress) const;

 private:
  std::span<const Fragment> kept() const;
  GridMetadata metadata() const;
  bool isDouble() const { return writer_.isDouble(isExact(options_, result_), result_.solid); }
  void writeLevelSet(std::size_t i) const;
  void writePoints(std::size_t i) const;
  void writeMeshes(std::size_t i);

  const FractureWriter& writer_;
  const OutputFolder folder_;
  const FractureFiles& files_;
  const FractureOptions& options_;
  const FractureResult& result_;
  const CopiedFiles kept_;
  const MeshWriter meshes_;
  // [fragments that are not withheld], or empty
  std::vector<SurfaceAttributes> attributes_;  ///< for the scene and the viewer
  std::vector<Fragment> previews_;             ///< coarse, for the preview
};

}  // namespace sherd
