// Reads glTF files.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Every triangle that the default scene of a glTF 2 or GLB file shows, in its place: meshes once
/// for each node and each instance (EXT_mesh_gpu_instancing), lists, strips and fans, quantised or
/// packed by Draco, sparse or not, with their looks.  A node is an object.  Skins and morph targets
/// are left out, and so are points and lines, with a warning.
///   throws  Error(input) cut short, malformed, an index out of range, a buffer that is missing, an
///   extension that is needed and not known
[[nodiscard]] RawMesh readGltf(const MeshFile& file);

}  // namespace sherd
