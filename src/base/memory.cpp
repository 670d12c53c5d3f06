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
#include "base/memory_budget.h"

namespace sherd {
namespace {

// Returns the first number in a file of the kernel; infinity for "max" and for absent files.
double numberIn(const std::filesystem::path& file) {
  std::ifstream in(file);
  double value = 0.0;
  return in >> value ? value : std::numeric_limits<double>::infinity();
}

// Returns the number after a line's prefix; infinity if there is none.
double numberBehind(const std::filesystem::path& file, std::string_view beginning) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(beginning)) return std::strtod(line.c_str() + beginning.size(), nullptr);
  }
  return std::numeric_limits<double>::infinity();
}

// The names of a version's files.
struct GroupFiles {
  const char *folder, *limit, *used, *cached;
};
constexpr GroupFiles kVersion1{"sys/fs/cgroup/memory", "memory.limit_in_bytes",
                               "memory.usage_in_bytes", "total_inactive_file "};
constexpr GroupFiles kVersion2{"sys/fs/cgroup", "memory.max", "memory.current", "inactive_file "};

// Version 1 writes a number of about 2^63 where there is no limit.
constexpr double kNoLimit = 0x1p62;

double finiteOr0(double value) { return std::isfinite(value) ? value : 0.0; }

// Returns what a group and those that it is in leave.  In a container the path may be the host's,
// of which only the root exists.
double leftBy(const std::filesystem::path& root, const std::string& group,
              const GroupFiles& files) {
  double left = std::numeric_limits<double>::infinity();
  for (std::filesystem::path at = group; !at.empty(); at = at.parent_path()) {
    const std::filesystem::path folder = root / files.folder / at.relative_path();
    const double limit = numberIn(folder / files.limit);
    if (limit < kNoLimit) {
      const double used = finiteOr0(numberIn(folder / files.used));
      const double cached = finiteOr0(numberBehind(folder / "memory.stat", files.cached));
      left = std::min(left, std::max(limit - used + cached, 0.0));
    }
    if (at == at.root_path()) break;
  }
  return left;
}

// Whether a list "cpu,memory" has a name.
bool hasName(std::string_view list, std::string_view name) {
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    if (list.substr(0, comma) == name) return true;
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return false;
}

}  // namespace

double leftByGroups(const std::filesystem::path& root) {
  double left = std::numeric_limits<double>::infinity();
  std::ifstream in(root / "proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {  // "number:controllers:path"
    const std::size_t first = line.find(':');
    const std::size_t second = first == line.npos ? line.npos : line.find(':', first + 1);
    if (second == line.npos) continue;
    const std::string group = line.substr(second + 1);
    const std::string_view controllers =
        std::string_view(line).substr(first + 1, second - first - 1);
    if (line.starts_with("0::")) left = std::min(left, leftBy(root, group, kVersion2));
    if (hasName(controllers, "memory")) left = std::min(left, leftBy(root, group, kVersion1));
  }
  return left;
}

MemoryBounds memoryBounds() {
  MemoryBounds bounds{1024.0 * numberBehind("/proc/meminfo", "MemAvailable:"), leftByGroups("/"),
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

void requireMemoryOfFile(const std::string& what, std::uint64_t bytes, std::uint64_t limit) {
  limit = std::min(limit, freeMemory());
  if (bytes <= limit) return;
  const Error error = memoryError(what, bytes, limit, OptionNames{"max-memory"});
  throw Error(ErrorCode::input, error.what(), error.options());
}

}  // namespace sherd
