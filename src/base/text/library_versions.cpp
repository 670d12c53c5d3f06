// Versions of the linked libraries.
#include "base/text/library_versions.h"

#include <draco/core/draco_version.h>
#include <embree3/rtcore_config.h>
#include <openvdb/version.h>
#include <tbb/version.h>
#include <zlib.h>

#include "base/version.h"

namespace sherd {

const char* version() { return SHERD_VERSION; }

std::vector<std::pair<std::string, std::string>> libraryVersions() {
  return {{"openvdb", OPENVDB_LIBRARY_VERSION_STRING},
          {"tbb", TBB_runtime_version()},
          {"embree", RTC_VERSION_STRING},
          {"draco", draco::kDracoVersion},
          {"zlib", zlibVersion()}};
}

}  // namespace sherd
