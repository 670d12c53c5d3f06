// Compares the quads of near cells.
#include "interface/cells/quad_crossings.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>

#include "base/cancel_flag.h"
#include "intersect/self_crossings.h"
#include "mesh/search/boxes.h"

namespace sherd {
namespace {

// A quad is around an edge of one voxel, in the four cells beside it, so its box is at most kReach
// beyond the edge's lower end along each axis.  Two quads meet only if these ends are at most
// 2 kReach apart: two voxels.
constexpr double kReach = 1.0 + kMostOutside;
constexpr int kApart = 2;
static_assert(kApart + 1 > 2.0 * kReach);

// A triangle, with the normal of the plane that it is in up to rounding.
struct PlacedTriangle {
  glm::uvec3 vertex{0};
  bool isTested = false;
  glm::dvec3 normal{0.0};
  Box box;
};

// A quad's triangles, and the box of both.
struct PlacedQuad {
  std::array<PlacedTriangle, 2> triangle;
  Box box;

  PlacedQuad() = default;
  PlacedQuad(const QuadTriangles& quad, std::span<const glm::dvec3> vertices) {
    for (std::size_t half = 0; half < 2; ++half) {
      const glm::uvec3& t = quad.triangle[half];
      const glm::dvec3 &a = vertices[t.x], &b = vertices[t.y], &c = vertices[t.z];
      triangle[half] = {t, quad.isTested[half], glm::cross(b - a, c - a), boxOf({a, b, c})};
    }
    box = {glm::min(triangle[0].box.min, triangle[1].box.min),
           glm::max(triangle[0].box.max, triangle[1].box.max)};
  }

  [[nodiscard]] bool isTested() const { return triangle[0].isTested || triangle[1].isTested; }
};

// The quads of one leaf and those that may meet them, by their edges' lower ends.
class QuadsAround {
 public:
  QuadsAround(const LeafNeighbors& neighborhood, std::span<const std::vector<QuadTriangles>> quads,
              std::span<const glm::dvec3> vertices)
      : first_(kSide * kSide * kSide + 1, 0) {
    forEach(neighborhood, quads, [&](std::size_t at, const QuadTriangles&) { ++first_[at + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    all_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    forEach(neighborhood, quads, [&](std::size_t at, const QuadTriangles& quad) {
      all_[next[at]++] = PlacedQuad(quad, vertices);
    });
  }

  // Calls visit(quad) for the quads of the leaf itself.
  template <class Visit>
  void forEachOwn(const Visit& visit) const {
    forEachIn(glm::ivec3(0), glm::ivec3(7), visit);
  }

  // Calls visit(quad) for the quads whose boxes meet a box.
  //   origin  of the leaf
  template <class Visit>
  void forEachMeeting(const glm::dvec3& origin, const Box& box, const Visit& visit) const {
    forEachIn(glm::max(glm::ivec3(glm::ceil(box.min - origin - kReach)), -kApart),
              glm::min(glm::ivec3(glm::floor(box.max - origin + kReach)), kSide - kApart - 1),
              [&](const PlacedQuad& quad) {
                if (meet(quad.box, box)) visit(quad);
              });
  }

 private:
  static constexpr int kSide = 8 + 2 * kApart;

  static std::size_t indexOf(int x, int y, int z) {
    return static_cast<std::size_t>(((x + kApart) * kSide + y + kApart) * kSide + z + kApart);
  }

  template <class Visit>
  void forEachIn(const glm::ivec3& low, const glm::ivec3& high, const Visit& visit) const {
    for (int x = low.x; x <= high.x; ++x) {
      for (int y = low.y; y <= high.y; ++y) {
        const std::uint32_t end = first_[indexOf(x, y, high.z) + 1];
        for (std::uint32_t i = first_[indexOf(x, y, low.z)]; i < end; ++i) visit(all_[i]);
      }
    }
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

  std::vector<std::uint32_t> first_;  // [places + 1] into all_
  std::vector<PlacedQuad> all_;       // by place
};

bool hasVertex(const PlacedTriangle& t, std::uint32_t v) {
  return v == t.vertex.x || v == t.vertex.y || v == t.vertex.z;
}

// Exceeds the rounding of a product of four lengths of a few voxels.
constexpr double kHeightRounding = 1e-9;

// Whether all corners of a triangle but common ones are certainly on one side of another's plane.
bool isBeside(std::span<const glm::dvec3> vertices, const PlacedTriangle& t,
              const PlacedTriangle& plane) {
  const glm::dvec3& corner = vertices[plane.vertex.x];
  bool isAbove = true, isBelow = true;
  for (int k = 0; k < 3; ++k) {
    if (hasVertex(plane, t.vertex[k])) continue;
    const double height = glm::dot(plane.normal, vertices[t.vertex[k]] - corner);
    isAbove = isAbove && height > kHeightRounding;
    isBelow = isBelow && height < -kHeightRounding;
  }
  return isAbove != isBelow;  // both if all corners are common
}

// Whether all corners of a triangle but common ones are certainly beyond an edge of another, as of
// neighbors in one plane.
bool isBeyond(std::span<const glm::dvec3> vertices, const PlacedTriangle& t,
              const PlacedTriangle& of) {
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t from = of.vertex[k], to = of.vertex[(k + 1) % 3];
    const glm::dvec3 outward = glm::cross(vertices[to] - vertices[from], of.normal);
    const auto isBeyondEdge = [&](std::uint32_t v) {
      return v == from || v == to ||
             glm::dot(outward, vertices[v] - vertices[from]) > kHeightRounding;
    };
    if (isBeyondEdge(t.vertex.x) && isBeyondEdge(t.vertex.y) && isBeyondEdge(t.vertex.z))
      return true;
  }
  return false;
}

// Whether triangles certainly do not cross; most of the near ones.
bool areApart(std::span<const glm::dvec3> vertices, const PlacedTriangle& a,
              const PlacedTriangle& b) {
  return !meet(a.box, b.box) || isBeside(vertices, a, b) || isBeside(vertices, b, a) ||
         isBeyond(vertices, a, b) || isBeyond(vertices, b, a);
}

bool isLess(const glm::uvec3& a, const glm::uvec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

// Adds the vertices of the tested triangles of a quad that cross another's.
void addCrossings(const PlacedQuad& quad, const PlacedQuad& other,
                  std::span<const glm::dvec3> vertices, std::vector<std::uint32_t>& found) {
  for (const PlacedTriangle& own : quad.triangle) {
    if (!own.isTested) continue;
    for (const PlacedTriangle& theirs : other.triangle) {
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

std::vector<std::uint32_t> verticesOfCrossings(std::span<const openvdb::Coord> origins,
                                               std::span<const LeafNeighbors> neighborhoods,
                                               std::span<const std::vector<QuadTriangles>> quads,
                                               std::span<const glm::dvec3> vertices,
                                               const Progress* progress) {
  const auto isTested = [](const QuadTriangles& quad) {
    return quad.isTested[0] || quad.isTested[1];
  };
  std::vector<std::vector<std::uint32_t>> found(quads.size());
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, quads.size(), [&](std::size_t leaf) {
    if (stop.isSet() || std::none_of(quads[leaf].begin(), quads[leaf].end(), isTested)) return;
    const QuadsAround around(neighborhoods[leaf], quads, vertices);
    const openvdb::Coord& low = origins[leaf];
    around.forEachOwn([&](const PlacedQuad& quad) {
      if (!quad.isTested()) return;
      around.forEachMeeting({low.x(), low.y(), low.z()}, quad.box, [&](const PlacedQuad& other) {
        addCrossings(quad, other, vertices, found[leaf]);
      });
    });
  });
  stop.throwIfSet();
  std::vector<std::uint32_t> all;
  for (const auto& own : found) all.insert(all.end(), own.begin(), own.end());
  return all;
}

}  // namespace sherd
