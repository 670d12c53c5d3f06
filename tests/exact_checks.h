// What must hold of exact surfaces, checked without the code that makes them.
#pragma once

#include <sherd/fragments.h>
#include <sherd/mesh.h>

#include <cstddef>
#include <span>
#include <string>

namespace sherd {

/// Faults of the meshes of all fragments; all are 0 where the meshes are exact.
struct ExactFaults {
  std::size_t openEdges = 0;
  std::size_t nonManifoldEdges = 0;
  std::size_t selfCrossings = 0;  ///< pairs of triangles of one fragment, those of the input's own
                                  ///< triangles left out
  std::size_t unlikeInput = 0;    ///< input triangles whose faces' area is another, or that are
                                  ///< whole but not the input's bit for bit
  std::size_t unmatchedCracks = 0;  ///< fracture faces without a reversed one in the neighbor
  double outerArea = 0.0;           ///< relative difference to the input's area
  double volume = 0.0;              ///< relative difference to the input's volume

  [[nodiscard]] bool any() const;
  [[nodiscard]] std::string text() const;
};

///   input     closed
///   isWorn    whether cracks were eroded: they need not match then, nor does the volume, and
///             parts of the input may be missing
[[nodiscard]] ExactFaults exactFaults(const TriangleMesh& input,
                                      std::span<const Fragment> fragments, bool isWorn = false);

}  // namespace sherd
