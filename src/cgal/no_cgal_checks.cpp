// Replaces the CGAL checks in a build without GPL packages.
#include <sherd/error.h>

#include "cli/evaluate/cgal_checks.h"

namespace sherd {

bool hasCgalChecks() { return false; }

CgalVerdict checkWithCgal(const TriangleMesh&, std::size_t, std::uint64_t) {
  throw Error(ErrorCode::internal, "this build has no CGAL checks");
}

}  // namespace sherd
