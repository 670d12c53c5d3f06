// In place of the OpenCL files, in a build without OpenCL.
#include "cl/device_search.h"

namespace sherd {

std::vector<PlatformFound> openClPlatforms() { return {}; }

bool usesOpenCl() { return false; }

}  // namespace sherd
