// Reads the lines of a mesh file.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Lines of a file, and whether it has faces besides.
struct FileLines {
  std::vector<std::vector<glm::dvec3>> polylines;  ///< each of two points or more, finite
  bool hasFaces = false;
};

/// Reads the elements `l` of an OBJ file.
///   throws  Error(input) malformed, an index out of range, a coordinate that is not finite or
///           above 1e37; more memory than allowed
[[nodiscard]] FileLines readObjLines(const MeshFile& file);

/// Reads the elements `edge` of a PLY file, by `vertex1` and `vertex2`.
///   throws  the same; cut short
[[nodiscard]] FileLines readPlyLines(const MeshFile& file);

}  // namespace sherd
