// What OpenCL calls its errors.
#pragma once

#include <string>

namespace sherd {

/// "-11 (CL_BUILD_PROGRAM_FAILURE)"; the number alone where it has no name in OpenCL 1.2 or in the
/// extension for drivers.
[[nodiscard]] std::string errorName(int number);

}  // namespace sherd
