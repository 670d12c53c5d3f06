// The devices of this machine, with the reasons why some cannot be used.
#pragma once

#include <sherd/device.h>

#include <string>
#include <vector>

#include "cl/device_found.h"

namespace sherd {

/// The built-in device, once per set of instructions that kernels are compiled for, the best first.
[[nodiscard]] PlatformFound builtinPlatform();

/// OpenCL's platforms; where its loader cannot be opened, one that says so.  None in a build
/// without OpenCL (SHERD_OPENCL=OFF).
[[nodiscard]] std::vector<PlatformFound> openClPlatforms();

/// Returns whether this build can use OpenCL.
[[nodiscard]] bool usesOpenCl();

/// Every platform, the built-in one first.
[[nodiscard]] std::vector<PlatformFound> findPlatforms();

/// Returns the reasons why devices and drivers cannot be used, and what to do, as the second half
/// of a sentence; empty if all can.
[[nodiscard]] std::string faultsOf(const std::vector<PlatformFound>& platforms);

}  // namespace sherd
