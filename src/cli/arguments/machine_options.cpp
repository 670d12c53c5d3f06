// Options for device, threads and memory.
#include "cli/arguments/machine_options.h"

#include <malloc.h>

#include "base/memory.h"
#include "cli/arguments/option_text.h"

namespace sherd::cli {

std::uint64_t MachineOptions::memory() const { return maxMemory.value_or(freeMemory()); }

void addMachineOptions(CLI::App& command, MachineOptions& options) {
  command
      .add_option("--device", options.device,
                  "Device: auto, gpu, cpu, builtin or a part of its name (see sherd devices)")
      ->capture_default_str();
  command
      .add_option("--threads", options.threads,
                  "Threads of the host and the built-in device; default all cores (PoCL's own: "
                  "POCL_MAX_PTHREAD_COUNT)")
      ->transform(wholeNumber(1, 4096));
  command
      .add_option(
          "--max-memory", options.maxMemory,
          "Refuse work that needs more memory, such as 8G or 1.5G (powers of 1024); default "
          "all free memory")
      ->transform(size())
      ->type_name("SIZE");
}

void prepareDevice(const MachineOptions& options) {
  if (mayUseOpenCl(options.device)) provideKernelCache();
}

void warnOfCaveat(const Device& device) {
  if (!device.info().caveat.empty()) printMessage("sherd: warning: " + device.info().caveat);
}

std::unique_ptr<tbb::global_control> limitedThreads(const MachineOptions& options) {
  if (options.threads == 0) return nullptr;
  return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                               static_cast<std::size_t>(options.threads));
}

void keepFreedMemory() {
  constexpr int kMost = 1 << 26;
  ::mallopt(M_MMAP_THRESHOLD, kMost);
  ::mallopt(M_TRIM_THRESHOLD, 4 * kMost);
}

}  // namespace sherd::cli
