// The objects of an assemblage: scaled, side by side, and voxelized.
#pragma once

#include <sherd/dataset.h>
#include <sherd/fracture.h>

#include <functional>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace sherd {

/// An object that is ready to be broken.
struct AssemblagePart {
  std::string key;
  std::string sha256;
  double scale = 1.0;           ///< a position is scale * original + translation
  glm::dvec3 translation{0.0};  ///< of which the first object's box begins at 0
  glm::dvec3 size{0.0};         ///< of its box, the longest side 1
  PreparedSolid ready;
  std::uint64_t memory = 0;  ///< that a fracture takes, bytes
};

/// Scales meshes to a longest side of 1 and sets them up along x, half a side or more apart.  Boxes
/// begin at y = 0 and z = 0, and at whole leaf nodes from the first along x.
///   objects  the parts of the assemblage
///   sources  of each; they are used up
///   base     of all fractures, with the most pieces
///   throws   Error(input) with the object's key: it cannot be voxelized, or they take too much
///            memory together
[[nodiscard]] std::vector<AssemblagePart> assemblageParts(const std::vector<LibraryObject>& objects,
                                                          std::vector<SourceMesh> sources,
                                                          const FractureOptions& base,
                                                          const DatasetOptions& options,
                                                          Device& device, const Progress* progress);

/// Calls `work`, whose errors name an object.
void ofObject(const std::string& key, const std::function<void()>& work);

}  // namespace sherd
