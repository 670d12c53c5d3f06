// Where PoCL, the OpenCL driver of CPUs, keeps the kernels that it compiles.
#pragma once

#include <sherd/kernel_cache.h>

namespace sherd {

/// CL_PLATFORM_NAME of PoCL.
inline constexpr const char* kPocl = "Portable Computing Language";

/// The folder that PoCL uses in this environment, created if it is absent; `fault` says why it
/// cannot be used.
[[nodiscard]] KernelCache poclCache();

/// "PoCL cannot keep compiled kernels in FOLDER (VARIABLE): FAULT; set ...", for the middle of a
/// sentence.
[[nodiscard]] std::string cacheSentence(const KernelCache& cache);

/// A sentence about what PoCL lacks to link kernels, without which it ends the process; empty where
/// it lacks nothing.
[[nodiscard]] std::string linkerFault();

}  // namespace sherd
