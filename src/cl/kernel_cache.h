// The folder where PoCL, the OpenCL driver for CPUs, stores compiled kernels.
#pragma once

#include <sherd/device.h>

namespace sherd {

/// CL_PLATFORM_NAME of PoCL.
inline constexpr const char* kPocl = "Portable Computing Language";

/// The folder that PoCL uses in this environment, created if absent; `fault` is the reason why it
/// cannot be used, or empty.
[[nodiscard]] KernelCache poclCache();

/// "PoCL cannot keep compiled kernels in FOLDER (VARIABLE): FAULT; set ...", for the middle of a
/// sentence.
[[nodiscard]] std::string cacheFaultMessage(const KernelCache& cache);

/// A sentence on why PoCL cannot link kernels, in which case it ends the process; empty if it can.
[[nodiscard]] std::string linkerFault();

}  // namespace sherd
