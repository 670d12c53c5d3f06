// Compares the quads of near cells.
#include "surface/quad_crossings.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>

#include "base/cancel_flag.h"
#include "exact/self_crossings.h"
#include "mesh/boxes.h"

namespace sherd {
namespace {

// A quad is around an edge of one voxel, in the four cells beside it, so its box is at most kReach
// beyond the edge's lower end along each axis.  Two quads meet only if these ends are at most
// 2 kReach apart: two voxels.
constexpr double kReach = 1.0 + kMostOutside;
constexpr int kApart = 2;
static_assert(kApart + 1 > 2.0 * kReach);

// The quads that may meet those of one leaf, by their edges' lower ends.
class QuadsAround {
 public:
  QuadsAround(const LeafNeighbors& neighborhood, std::span<const std::vector<QuadTriangles>> quads)
      : first_(kSide * kSide * kSide + 1, 0) {
    forEach(neighborhood, quads, [&](std::size_t at, const QuadTriangles&) { ++first_[at + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    all_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    forEach(neighborhood, quads,
            [&](std::size_t at, const QuadTriangles& quad) { all_[next[at]++] = &quad; });
  }

  // Calls visit(quad) for the quads whose boxes meet a box.
  template <class Visit>
  void forEachMeeting(const glm::dvec3& origin, const Box& box, const Visit& visit) const {
    constexpr int kHigh = kSide - kApart - 1;
    const glm::ivec3 low = glm::max(glm::ivec3(glm::ceil(box.min - origin - kReach)), -kApart),
                     high = glm::min(glm::ivec3(glm::floor(box.max - origin + kReach)), kHigh);
    for (int x = low.x; x <= high.x; ++x) {
      for (int y = low.y; y <= high.y; ++y) {
        const std::uint32_t end = first_[indexOf(x, y, high.z) + 1];
        for (std::uint32_t i = first_[indexOf(x, y, low.z)]; i < end; ++i) {
          if (meet(all_[i]->box, box)) visit(*all_[i]);
        }
      }
    }
  }

 private:
  static constexpr int kSide = 8 + 2 * kApart;

  static std::size_t indexOf(int x, int y, int z) {
    return static_cast<std::size_t>(((x + kApart) * kSide + y + kApart) * kSide + z + kApart);
  }

  template <class Visit>
  static void forEach(const LeafNeighbors& neighborhood,
                      std::span<const std::vector<QuadTriangles>> quads, const Visit& visit) {
    const auto isAround = [](int at) { return at >= -kApart && at < kSide - kApart; };
    for (int k = 0; k < 27; ++k) {
      const std::uint32_t leaf = neighborhood[static_cast<std::size_t>(k)];
      if (leaf == LeafBlocks::kNone) continue;
      for (const QuadTriangles& quad : quads[leaf]) {
        const int x = 8 * (k / 9 - 1) + (quad.offset >> 6),
                  y = 8 * (k / 3 % 3 - 1) + ((quad.offset >> 3) & 7),
                  z = 8 * (k % 3 - 1) + (quad.offset & 7);
        if (isAround(x) && isAround(y) && isAround(z)) visit(indexOf(x, y, z), quad);
      }
    }
  }

  std::vector<std::uint32_t> first_;       // [places + 1] into all_
  std::vector<const QuadTriangles*> all_;  // by place
};

bool has(const QuadTriangle& t, std::uint32_t v) {
  return v == t.vertex.x || v == t.vertex.y || v == t.vertex.z;
}

// Exceeds the rounding of a product of four lengths of a few voxels.
constexpr double kRounding = 1e-9;

// Whether all corners of a triangle but common ones are certainly on one side of another's plane.
bool isBeside(std::span<const glm::dvec3> vertices, const QuadTriangle& t,
              const QuadTriangle& plane) {
  const glm::dvec3& corner = vertices[plane.vertex.x];
  bool isAbove = true, isBelow = true;
  for (int k = 0; k < 3; ++k) {
    if (has(plane, t.vertex[k])) continue;
    const double height = glm::dot(plane.normal, vertices[t.vertex[k]] - corner);
    isAbove = isAbove && height > kRounding;
    isBelow = isBelow && height < -kRounding;
  }
  return isAbove != isBelow;  // both if all corners are common
}

// Whether all corners of a triangle but common ones are certainly beyond an edge of another, as of
// neighbors in one plane.
bool isBeyond(std::span<const glm::dvec3> vertices, const QuadTriangle& t, const QuadTriangle& of) {
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t from = of.vertex[k], to = of.vertex[(k + 1) % 3];
    const glm::dvec3 outward = glm::cross(vertices[to] - vertices[from], of.normal);
    const auto isBeyondEdge = [&](std::uint32_t v) {
      return v == from || v == to || glm::dot(outward, vertices[v] - vertices[from]) > kRounding;
    };
    if (isBeyondEdge(t.vertex.x) && isBeyondEdge(t.vertex.y) && isBeyondEdge(t.vertex.z))
      return true;
  }
  return false;
}

// Whether triangles certainly do not cross; most of the near ones.
bool areApart(std::span<const glm::dvec3> vertices, const QuadTriangle& a, const QuadTriangle& b) {
  return !meet(a.box, b.box) || isBeside(vertices, a, b) || isBeside(vertices, b, a) ||
         isBeyond(vertices, a, b) || isBeyond(vertices, b, a);
}

bool isLess(const glm::uvec3& a, const glm::uvec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

// Adds the vertices of the tested triangles of a quad that cross another's.
void addCrossings(const QuadTriangles& quad, const QuadTriangles& other,
                  std::span<const glm::dvec3> vertices, std::vector<std::uint32_t>& found) {
  for (const QuadTriangle& own : quad.triangle) {
    if (!own.isTested) continue;
    for (const QuadTriangle& theirs : other.triangle) {
      // Of two that are both tested, the later one finds the pair.
      if (&own == &theirs || (theirs.isTested && isLess(own.vertex, theirs.vertex))) continue;
      if (areApart(vertices, own, theirs) || !trianglesCross(vertices, own.vertex, theirs.vertex)) {
        continue;
      }
      for (const glm::uvec3& t : {own.vertex, theirs.vertex})
        found.insert(found.end(), {t.x, t.y, t.z});
    }
  }
}

}  // namespace

QuadTriangle::QuadTriangle(std::span<const glm::dvec3> vertices, const glm::uvec3& of, bool tested)
    : vertex(of),
      isTested(tested),
      normal(glm::cross(vertices[of.y] - vertices[of.x], vertices[of.z] - vertices[of.x])),
      box(boxOf({vertices[of.x], vertices[of.y], vertices[of.z]})) {}

std::vector<std::uint32_t> verticesOfCrossings(std::span<const openvdb::Coord> origins,
                                               std::span<const LeafNeighbors> neighborhoods,
                                               std::span<const std::vector<QuadTriangles>> quads,
                                               std::span<const glm::dvec3> vertices,
                                               const Progress* progress) {
  const auto isTested = [](const QuadTriangles& quad) {
    return quad.triangle[0].isTested || quad.triangle[1].isTested;
  };
  std::vector<std::vector<std::uint32_t>> found(quads.size());
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, quads.size(), [&](std::size_t leaf) {
    if (stop.isSet() || std::none_of(quads[leaf].begin(), quads[leaf].end(), isTested)) return;
    const QuadsAround around(neighborhoods[leaf], quads);
    const openvdb::Coord& low = origins[leaf];
    const glm::dvec3 origin(low.x(), low.y(), low.z());
    for (const QuadTriangles& quad : quads[leaf]) {
      if (!isTested(quad)) continue;
      around.forEachMeeting(origin, quad.box, [&](const QuadTriangles& other) {
        addCrossings(quad, other, vertices, found[leaf]);
      });
    }
  });
  stop.throwIfSet();
  std::vector<std::uint32_t> all;
  for (const auto& own : found) all.insert(all.end(), own.begin(), own.end());
  return all;
}

}  // namespace sherd
