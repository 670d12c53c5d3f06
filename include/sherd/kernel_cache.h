// The folder where PoCL, the OpenCL driver for CPUs, caches compiled kernels.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sherd {

/// A candidate for the cache folder.
struct KernelCache {
  std::filesystem::path folder;
  std::string source;  ///< the environment variable that names it, or "temporary folder"
  std::string fault;   ///< why it cannot be used; empty if it can
};

/// Sets the environment so that PoCL has a cache folder, without which it lists no device or ends
/// the process.  PoCL uses $POCL_CACHE_DIR, else $XDG_CACHE_HOME, else $HOME/.cache.  If that
/// folder cannot be used, POCL_CACHE_DIR is set to one that can: the next of these, or a private
/// folder of the user in $TMPDIR, /tmp, /var/tmp or /dev/shm, which later runs reuse.  If no folder
/// of PATH has ld, with which PoCL links kernels, /usr/bin and /bin are appended.  Programs call
/// this before the first thread starts and before OpenCL is used.  No other function of the library
/// changes the environment.
///   return  the folders tried; the last is in use unless it has a fault.  If POCL_CACHE_DIR is
///           set, no other folder is tried
std::vector<KernelCache> provideKernelCache();

}  // namespace sherd
