// A mesh with the data that several steps share.
#include "voxelize/fill/searched_mesh.h"

#include <utility>

#include "voxelize/fill/caps.h"

namespace sherd {

SearchedMesh searched(TriangleMesh mesh) {
  SearchedMesh out{std::move(mesh), {}, nullptr};
  out.caps = loopCaps(out.mesh);
  out.tree = std::make_shared<TriangleTree>(out.mesh);
  return out;
}

}  // namespace sherd
