// In place of the checks by CGAL, in a build that links nothing under the GPL.
#include <sherd/error.h>

#include "cgal/cgal_checks.h"

namespace sherd {

bool hasCgalChecks() { return false; }

CgalVerdict askCgal(const TriangleMesh&, std::size_t, std::uint64_t) {
  throw Error(ErrorCode::internal, "this build has no checks by CGAL");
}

}  // namespace sherd
