// Where PoCL, the OpenCL driver of CPUs, keeps the kernels that it compiles.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sherd {

/// A folder where compiled kernels may be kept.
struct KernelCache {
  std::filesystem::path folder;
  std::string source;  ///< the environment variable that names it, or "temporary folder"
  std::string fault;   ///< why it cannot be used; empty: it can
};

/// Find PoCL a folder for its kernels, without which it has no device or ends the process.  It
/// takes $POCL_CACHE_DIR, else $XDG_CACHE_HOME, else $HOME/.cache.  Where the first of these cannot
/// be used, this sets POCL_CACHE_DIR to what can: the next of these, or a private folder of this
/// user's in $TMPDIR, /tmp, /var/tmp or /dev/shm, which later runs use again.  Where no folder of
/// PATH has ld, by which PoCL links kernels, /usr/bin and /bin are added to it.  For programs: call
/// this before the first thread is started and before OpenCL is used.  The rest of the library
/// changes no variable.
///   return  what was tried; the last is in use unless it has a fault.  What POCL_CACHE_DIR names
///           is the user's word: nothing else is tried then
std::vector<KernelCache> provideKernelCache();

}  // namespace sherd
