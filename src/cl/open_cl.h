// OpenCL's C++ bindings with their warnings kept out of ours.
#pragma once

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wignored-attributes"
#include <CL/opencl.hpp>
#pragma GCC diagnostic pop

#include <string>

namespace sherd {

/// Returns why OpenCL's loader, libOpenCL, cannot be used; empty if it can.  Its functions must not
/// be called then.
[[nodiscard]] std::string loaderFault();

}  // namespace sherd
