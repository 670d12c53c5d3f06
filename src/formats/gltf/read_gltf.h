// Reads glTF files.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Reads every triangle of the default scene of a glTF 2 or GLB file, node transforms applied: a
/// mesh once for each node and instance (EXT_mesh_gpu_instancing); lists, strips and fans;
/// quantized, compressed by Draco or sparse; with attributes. A node is an object. Skins and morph
/// targets, points and lines are left out, with a warning.
///   throws  Error(input) cut short, malformed, an index out of range, a buffer that is missing, a
///           required extension that is not supported
[[nodiscard]] RawMesh readGltf(const MeshFile& file);

}  // namespace sherd
