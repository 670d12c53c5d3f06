// How much memory a fracture takes, told before.
#include <sherd/error.h>
#include <sherd/memory.h>
#include <sherd/solid.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

namespace sherd {
namespace {

// Rates: docs/performance.md, "Memory".
constexpr double kProgram = 190e6;          // the OpenCL device and its compiler
constexpr double kPerTriangle = 200.0;      // of the input: vertices, the tree, columns
constexpr double kPerSurfaceVoxel = 850.0;  // level sets, cells and meshes of fragments
constexpr double kPerInsideVoxel = 20.0;    // leaves, labels and growth

struct Extent {
  double area = 0.0, volume = 0.0;  // world units
};

// Parts that are turned the other way do not cancel.
Extent extentOf(const TriangleMesh& mesh) {
  const Components parts = components(mesh);
  std::vector<double> volumes(parts.count, 0.0);
  const glm::dvec3 origin = bounds(mesh).min;
  double area = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corners = mesh.triangles[t];
    const glm::dvec3 a = mesh.vertices[corners.x] - origin, b = mesh.vertices[corners.y] - origin,
                     c = mesh.vertices[corners.z] - origin;
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
    volumes[parts.ofTriangle[t]] += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  if (openEdges(mesh) > 0) area *= 2.0;  // it may become a shell, which has two sides
  double volume = 0.0;
  for (const double v : volumes) volume += std::abs(v);
  const glm::dvec3 box = bounds(mesh).max - origin;
  return {area, std::min(volume, box.x * box.y * box.z)};
}

double bytesForVoxels(double surface, double inside) {
  return kProgram + kPerSurfaceVoxel * surface + kPerInsideVoxel * inside;
}

double bytesFor(const Extent& extent, std::size_t triangles, int pieces, double voxelSize) {
  const double surface = extent.area / (voxelSize * voxelSize);
  const double inside = extent.volume / (voxelSize * voxelSize * voxelSize);
  // A cube cut into n cubes has 3 (n^(1/3) - 1) cuts across it; each is of two fragments.
  const double cuts =
      6.0 * (std::cbrt(static_cast<double>(pieces)) - 1.0) * std::cbrt(inside * inside);
  return kPerTriangle * static_cast<double>(triangles) + bytesForVoxels(surface + cuts, inside);
}

// The first number in a file of the kernel's; none where it says "max" or there is no such file.
double numberIn(const char* file) {
  std::ifstream in(file);
  double value = 0.0;
  return in >> value ? value : std::numeric_limits<double>::infinity();
}

// The number behind a name in a file of names and numbers; none as above.
double numberBehind(const char* file, const std::string& wanted) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(wanted + " ")) return std::strtod(line.c_str() + wanted.size(), nullptr);
  }
  return std::numeric_limits<double>::infinity();
}

// What the group of this process may still use; files that are only cached give way.
double freeOfGroup() {
  const double limit = numberIn("/sys/fs/cgroup/memory.max");
  if (!std::isfinite(limit)) return limit;
  const double used = numberIn("/sys/fs/cgroup/memory.current");
  const double cached = numberBehind("/sys/fs/cgroup/memory.stat", "inactive_file");
  return std::isfinite(used - cached) ? std::max(limit - used + cached, 0.0) : limit;
}

std::string gigabytes(double bytes) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g GB", bytes / 1e9);
  return text;
}

}  // namespace

std::uint64_t estimatedMemory(const TriangleMesh& mesh, const FractureOptions& options) {
  const SolidOptions solid{.resolution = options.resolution, .voxelSize = options.voxelSize};
  return static_cast<std::uint64_t>(
      bytesFor(extentOf(mesh), mesh.triangles.size(), options.pieces, voxelSizeFor(mesh, solid)));
}

std::uint64_t estimatedMemory(double surface, double inside) {
  return static_cast<std::uint64_t>(bytesForVoxels(surface, inside));
}

std::uint64_t freeMemory() {
  double free = std::min(1024.0 * numberBehind("/proc/meminfo", "MemAvailable:"), freeOfGroup());
  rlimit addresses{};
  if (::getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY) {
    free = std::min(free, static_cast<double>(addresses.rlim_cur));
  }
  return std::isfinite(free) ? static_cast<std::uint64_t>(free)
                             : std::numeric_limits<std::uint64_t>::max();
}

void requireMemory(const TriangleMesh& mesh, const FractureOptions& options, std::uint64_t limit) {
  const SolidOptions asked{.resolution = options.resolution, .voxelSize = options.voxelSize};
  const double voxelSize = voxelSizeFor(mesh, asked);
  const Extent extent = extentOf(mesh);
  const auto bytes = [&](double size) {
    return bytesFor(extent, mesh.triangles.size(), options.pieces, size);
  };
  const double wanted = bytes(voxelSize), most = static_cast<double>(limit);
  if (wanted <= most) return;
  const glm::dvec3 box = bounds(mesh).max - bounds(mesh).min;
  const double longest = std::max({box.x, box.y, box.z});
  const int resolution = static_cast<int>(std::ceil(longest / voxelSize - 1e-9));
  int fits = 0;  // the highest resolution that does
  for (int low = 8, high = resolution; low <= high;) {
    const int middle = low + (high - low) / 2;
    if (bytes(longest / middle) <= most) {
      fits = middle;
      low = middle + 1;
    } else {
      high = middle - 1;
    }
  }
  throw Error(ErrorCode::usage,
              "a resolution of " + std::to_string(resolution) + " takes up to " +
                  gigabytes(wanted) + " of memory, and " + gigabytes(most) + " may be used; " +
                  (fits > 0 ? "a --resolution of " + std::to_string(fits) + " fits"
                            : std::string("no resolution fits")) +
                  " (--max-memory sets the limit)");
}

}  // namespace sherd
