// Reads 3MF files.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Returns the triangles of every item of the build, components and their transforms included, also
/// those in other models of the package (production extension).  Colors of `colorgroup` are colors
/// of corners, those of `basematerials` materials; what other groups of properties hold is left out
/// with a warning.
///   source  3MF Core Specification 1.3; Materials and Properties Extension 1.2; Production
///           Extension 1.1
///   throws  Error(input) no ZIP file, damaged, a reference to what is absent; Error(cancelled)
[[nodiscard]] RawMesh read3mf(const MeshFile& file);

}  // namespace sherd
