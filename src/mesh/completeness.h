// Whether a mesh file is whole: a cut or inconsistent file is refused, not read in half.
#pragma once

#include <optional>

#include "mesh/mesh_reader.h"

namespace sherd {

/// What a file says it holds, where its format says so.
struct FileCounts {
  std::optional<std::size_t> vertices;
  std::optional<std::size_t> polygons;
  bool look = false;  ///< an OBJ or PLY with texture coordinates, colours or materials
};

/// Compare what a file announces with what it holds, and every index with what it points to.
///   throws  Error(input) cut short, malformed, an index out of range, a variant that is not
///   supported
[[nodiscard]] FileCounts checkComplete(const MeshFile& file);

// The parts of checkComplete(), one per format.
[[nodiscard]] FileCounts checkObj(const MeshFile& file);
[[nodiscard]] FileCounts checkPly(const MeshFile& file);
[[nodiscard]] FileCounts checkStl(const MeshFile& file);
[[nodiscard]] FileCounts checkOff(const MeshFile& file);
[[nodiscard]] FileCounts checkGltf(const MeshFile& file);

}  // namespace sherd
