// Which of a mesh's surfaces bound its solid.
#include "voxelize/exposed.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "cancel_flag.h"

namespace sherd {
namespace {

using Corners = std::array<glm::dvec3, 3>;

// How far beside a surface its two sides are looked at, in voxels.
constexpr double kBeside = 1e-3;

// Triangles are looked at in four places, small ones in their middle only; and cut no farther than
// to the smallest pieces.
constexpr double kLargestPiece = 1.0;
constexpr double kSmall = 0.5;
constexpr double kSmallestPiece = 0.25;

enum class Verdict { no, yes, mixed };

bool isExposed(const glm::dvec3& point, const glm::dvec3& normal,
               const GeneralisedWinding& winding) {
  const glm::dvec3 behind = point - kBeside * normal, before = point + kBeside * normal;
  const double first = winding.near(behind);
  return (first >= 0.5) != (winding.afterStep(behind, first, before) >= 0.5);
}

double longestEdge(const Corners& t) {
  return std::max(
      {glm::distance(t[0], t[1]), glm::distance(t[1], t[2]), glm::distance(t[2], t[0])});
}

Verdict look(const Corners& t, double size, double smallest, const GeneralisedWinding& winding) {
  if (size > kLargestPiece) return Verdict::mixed;
  const glm::dvec3 cross = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double length = glm::length(cross);
  if (length == 0.0) return Verdict::no;
  const glm::dvec3 normal = cross / length, middle = (t[0] + t[1] + t[2]) / 3.0;
  const bool first = isExposed(middle, normal, winding);
  if (size > smallest) {
    for (const glm::dvec3& corner : t) {
      if (isExposed(middle + 0.9 * (corner - middle), normal, winding) != first)
        return Verdict::mixed;
    }
  }
  return first ? Verdict::yes : Verdict::no;
}

void keepExposed(const Corners& t, double smallest, const GeneralisedWinding& winding,
                 std::vector<Corners>& kept) {
  const double size = longestEdge(t);
  const Box box{glm::min(t[0], glm::min(t[1], t[2])), glm::max(t[0], glm::max(t[1], t[2]))};
  const Verdict verdict = winding.isPlain(box) ? Verdict::yes : look(t, size, smallest, winding);
  if (verdict == Verdict::yes) kept.push_back(t);
  if (verdict != Verdict::mixed) return;
  // Halve the longest edge: a needle becomes short pieces, not thinner needles.
  int from = 0;
  for (int k = 1; k < 3; ++k) {
    const auto a = static_cast<std::size_t>(k), b = static_cast<std::size_t>((k + 1) % 3);
    const auto c = static_cast<std::size_t>(from), d = static_cast<std::size_t>((from + 1) % 3);
    if (glm::distance(t[a], t[b]) > glm::distance(t[c], t[d])) from = k;
  }
  const glm::dvec3 a = t[static_cast<std::size_t>(from)];
  const glm::dvec3 b = t[static_cast<std::size_t>((from + 1) % 3)];
  const glm::dvec3 c = t[static_cast<std::size_t>((from + 2) % 3)];
  const glm::dvec3 half = 0.5 * (a + b);
  keepExposed({a, half, c}, kSmallestPiece, winding, kept);
  keepExposed({half, b, c}, kSmallestPiece, winding, kept);
}

}  // namespace

TriangleMesh exposedSurface(const TriangleMesh& mesh, const GeneralisedWinding& winding,
                            const Progress* progress) {
  constexpr std::size_t kGrain = 256;
  const std::size_t chunks = (mesh.triangles.size() + kGrain - 1) / kGrain;
  std::vector<std::vector<Corners>> kept(chunks);  // joined in the triangles' order
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    if (stop.isSet()) return;
    const std::size_t end = std::min(mesh.triangles.size(), (chunk + 1) * kGrain);
    for (std::size_t i = chunk * kGrain; i < end; ++i) {
      const glm::uvec3& t = mesh.triangles[i];
      keepExposed({mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]}, kSmall, winding,
                  kept[chunk]);
    }
  });
  stop.throwIfSet();
  TriangleMesh out;
  for (const std::vector<Corners>& pieces : kept) {
    for (const Corners& piece : pieces) {
      const auto first = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.insert(out.vertices.end(), piece.begin(), piece.end());
      out.triangles.emplace_back(first, first + 1, first + 2);
    }
  }
  return out;
}

}  // namespace sherd
