// Names of OpenCL errors.
#pragma once

#include <string>

namespace sherd {

/// Returns number and name, "-11 (CL_BUILD_PROGRAM_FAILURE)"; the number alone for errors outside
/// OpenCL 1.2 and its ICD extension.
[[nodiscard]] std::string errorName(int number);

}  // namespace sherd
