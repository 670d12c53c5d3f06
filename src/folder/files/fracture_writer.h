// Writes fractures to folders and sinks.
#pragma once

#include <sherd/folder.h>

#include <optional>
#include <vector>

#include "appearance/transfer.h"
#include "base/memory_gate.h"
#include "folder/files/copied_files.h"
#include "folder/files/mesh_writer.h"
#include "folder/manifest/manifest.h"
#include "folder/manifest/rounding.h"
#include "formats/mesh/materials.h"

namespace sherd {

/// Writes any number of fractures of one mesh, from any thread.  Holds references to the mesh and
/// the options.
class FractureWriter {
 public:
  ///   isInUnitBox  meshes are moved into a box of side 1 around the origin before they are written
  FractureWriter(const SourceMesh& source, const WriteOptions& write, bool isInUnitBox = false);

  [[nodiscard]] const SourceMesh& source() const { return source_; }
  [[nodiscard]] const WriteOptions& options() const { return options_; }
  [[nodiscard]] const MaterialTable& materials() const { return table_; }
  /// What the source's coordinates mean, with what the options say of it.
  [[nodiscard]] CoordinateSystem coordinates() const {
    return coordinatesOf(source_.coordinates, options_);
  }
  /// The same of the coordinates in files: a unit box has no size in space, and stays as it is.
  [[nodiscard]] CoordinateSystem coordinatesWritten() const {
    return isInUnitBox_ ? CoordinateSystem() : coordinates();
  }
  /// The source of the meshes' surface attributes and source faces; null if there are neither.
  [[nodiscard]] const AttributeSource* attributes() const {
    return attributes_ ? &*attributes_ : nullptr;
  }

  /// Returns whether vertices have double precision, in formats that hold it.
  ///   isExact  they have exact surfaces
  ///   solid    that is broken
  [[nodiscard]] bool isDouble(bool isExact, const Solid& solid) const;

  /// Returns roundingWarning of the files.
  [[nodiscard]] std::string roundingWarning(const Solid& solid) const {
    return isInUnitBox_ ? std::string() : sherd::roundingWarning(options_, solid);
  }

  /// Of points of all fragments and fractures that are written at once.
  [[nodiscard]] MemoryGate& memory() const { return memory_; }

  /// Writes the files with a name in `files`, without the manifest.
  ///   return  sentences about what they leave out
  ///   throws  what writeFracture throws
  std::vector<std::string> write(const OutputFolder& folder, const FractureFiles& files,
                                 const FractureOptions& options, const FractureResult& result,
                                 const Progress* progress) const;

 private:
  const SourceMesh& source_;
  const WriteOptions& options_;
  bool isInUnitBox_;
  MaterialTable table_;
  std::optional<AttributeSource> attributes_;
  mutable MemoryGate memory_;
};

}  // namespace sherd
