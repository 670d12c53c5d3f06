// In place of CGAL, in a build without it.
#include <sherd/error.h>

#include "cgal/cgal_checks.h"

namespace sherd {

bool hasCgal() { return false; }

CgalVerdict askCgal(const TriangleMesh&, std::size_t, std::uint64_t) {
  throw Error(ErrorCode::internal, "this build has no CGAL");
}

}  // namespace sherd
