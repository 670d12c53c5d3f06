// Free memory, and refusing work that would not fit.
#include "base/memory.h"

#include <sherd/error.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "base/memory_bounds.h"

namespace sherd {
namespace {

// Returns the first number in a file of the kernel; infinity for "max" and for absent files.
double numberIn(const std::string& file) {
  std::ifstream in(file);
  double value = 0.0;
  return in >> value ? value : std::numeric_limits<double>::infinity();
}

// Returns the number after a line's prefix; infinity if there is none.
double numberBehind(const std::string& file, std::string_view beginning) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(beginning)) return std::strtod(line.c_str() + beginning.size(), nullptr);
  }
  return std::numeric_limits<double>::infinity();
}

// Returns what the nested cgroups of this process may still use; cached file pages count as free.
double freeOfGroups() {
  std::string group;
  std::ifstream in("/proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("0::")) group = line.substr(3);
  }
  double free = std::numeric_limits<double>::infinity();
  for (std::filesystem::path at = group; !at.empty(); at = at.parent_path()) {
    const std::string folder = "/sys/fs/cgroup" + at.string();
    const double used = numberIn(folder + "/memory.current"),
                 limit = numberIn(folder + "/memory.max"),
                 cached = numberBehind(folder + "/memory.stat", "inactive_file ");
    const double left = limit - used + cached;
    if (std::isfinite(left)) free = std::min(free, std::max(left, 0.0));
    if (at == at.root_path()) break;
  }
  return free;
}

std::string gigabytes(std::uint64_t bytes) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g GB", static_cast<double>(bytes) / 1e9);
  return text;
}

}  // namespace

MemoryBounds memoryBounds() {
  MemoryBounds bounds{1024.0 * numberBehind("/proc/meminfo", "MemAvailable:"), freeOfGroups(),
                      std::numeric_limits<double>::infinity()};
  rlimit addresses{};
  if (::getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY) {
    const double used = 1024.0 * numberBehind("/proc/self/status", "VmSize:");
    bounds.addresses = std::max(static_cast<double>(addresses.rlim_cur) - used, 0.0);
  }
  return bounds;
}

std::uint64_t freeMemory() {
  const MemoryBounds bounds = memoryBounds();
  const double free = std::min({bounds.machine, bounds.groups, bounds.addresses});
  return std::isfinite(free) ? static_cast<std::uint64_t>(free)
                             : std::numeric_limits<std::uint64_t>::max();
}

Error memoryError(const std::string& what, std::uint64_t bytes, std::uint64_t limit,
                  OptionNames options) {
  return Error(ErrorCode::usage,
               what + " takes up to " + gigabytes(bytes) + " of memory, and " + gigabytes(limit) +
                   " may be used",
               std::move(options));
}

void requireMemory(const std::string& what, std::uint64_t bytes, std::uint64_t limit) {
  if (bytes > limit) throw memoryError(what, bytes, limit, OptionNames{"max-memory"});
}

}  // namespace sherd
