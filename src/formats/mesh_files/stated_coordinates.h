// What files say of their coordinates that Assimp leaves out.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Sets the unit and the upward axis of a mesh that Assimp read: of COLLADA meters, to which Assimp
/// converts, and its `up_axis`.
void setStatedCoordinates(const MeshFile& file, RawMesh& mesh);

}  // namespace sherd
