// Faces that single precision spoils.
#include "clean/rounded_faults.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "base/cancel_flag.h"
#include "intersect/crossing_point.h"
#include "intersect/self_crossings.h"

namespace sherd {
namespace {

constexpr std::size_t kBlock = 1024;  // vertices that a task processes

// A face around a vertex, seen from there.
struct Wedge {
  std::uint32_t face = 0;
  glm::uvec3 corner{0};       // the vertex first
  glm::dvec3 a{0.0}, b{0.0};  // the others
  glm::dvec3 normal{0.0};     // unit
  double height = 0.0;        // the least
};

Wedge wedgeOf(std::uint32_t face, glm::uvec3 corner, std::uint32_t vertex,
              const std::vector<glm::dvec3>& at) {
  while (corner.x != vertex) corner = {corner.y, corner.z, corner.x};
  Wedge wedge{face, corner, at[corner.y] - at[vertex], at[corner.z] - at[vertex]};
  const glm::dvec3 normal = glm::cross(wedge.a, wedge.b);
  const double twice = glm::length(normal);
  const double longest =
      std::max({glm::length(wedge.a), glm::length(wedge.b), glm::distance(wedge.a, wedge.b)});
  if (twice > 0.0) {
    wedge.normal = normal / twice;
    wedge.height = twice / longest;
  }
  return wedge;
}

// Whether a plane through the vertex that nearly has the edges of one wedge is beside the other, by
// more than its corners and the plane may move.
//   lever  the other's length divided by the plane's
bool isBeside(double ofA, double ofB, double lever, double moved) {
  const double margin = moved * (2.0 + 2.0 * lever);
  return (ofA > margin && ofB > margin) || (ofA < -margin && ofB < -margin);
}

double lengthOf(const Wedge& w) { return std::max(glm::length(w.a), glm::length(w.b)); }

// Whether a plane through an edge of one, across its plane, has the other beyond it.
bool isBeyondEdge(const Wedge& own, const Wedge& other, double moved) {
  const double length = lengthOf(other);
  const auto beyond = [&](const glm::dvec3& edge, double side) {
    const double size = glm::length(edge);
    const glm::dvec3 away = side * glm::cross(edge / size, own.normal);
    const double margin = moved * (2.0 + 2.0 * length / std::min(size, own.height));
    return glm::dot(away, other.a) > margin && glm::dot(away, other.b) > margin;
  };
  return beyond(own.a, 1.0) || beyond(own.b, -1.0);
}

// Whether two wedges with one common vertex stay apart however they are rounded.
bool areFarApart(const Wedge& s, const Wedge& t, double moved) {
  if (s.height < 4.0 * moved || t.height < 4.0 * moved) return false;
  return isBeside(glm::dot(s.normal, t.a), glm::dot(s.normal, t.b), lengthOf(t) / s.height,
                  moved) ||
         isBeside(glm::dot(t.normal, s.a), glm::dot(t.normal, s.b), lengthOf(s) / t.height,
                  moved) ||
         isBeyondEdge(s, t, moved) || isBeyondEdge(t, s, moved);
}

// Of wedges with a common edge: whether they are not folded onto each other.
bool areUnfolded(const Wedge& s, const Wedge& t, double moved) {
  constexpr double kFolded = 0.9;  // cosine
  if (s.height < 16.0 * moved || t.height < 16.0 * moved) return false;
  // Faces of different pieces may have any orientation: the common edge lies at opposite ends.
  const bool isAlike = s.corner.y == t.corner.y || s.corner.z == t.corner.z;
  return glm::dot(s.normal, t.normal) * (isAlike ? -1.0 : 1.0) > -kFolded;
}

class Faults {
 public:
  Faults(const Stars& stars, const CleanPositions& positions, const std::vector<bool>& isFixed)
      : stars_(stars), positions_(positions), isFixed_(isFixed), moved_(2.0 * positions.spacing) {}

  // Adds the faults around a vertex.
  void addAt(std::uint32_t vertex, std::vector<std::uint32_t>& found) const {
    std::vector<Wedge> wedges;
    for (const std::uint32_t f : stars_.around(vertex)) {
      const CleanFace& face = stars_.face(f);
      if (face.isPrimary()) wedges.push_back(wedgeOf(f, face.corner, vertex, positions_.exact));
    }
    const std::vector<glm::dvec3>& at = positions_.rounded;
    for (std::size_t i = 0; i < wedges.size(); ++i) {
      const Wedge& own = wedges[i];
      const glm::uvec3& c = own.corner;
      const bool isOwn = isFixed_[c.x] && isFixed_[c.y] && isFixed_[c.z];
      if (own.height < 4.0 * moved_ && !isOwn && areCollinear({at[c.x], at[c.y], at[c.z]})) {
        found.push_back(own.face);
      }
      for (std::size_t k = 0; k < i; ++k) {
        const glm::uvec3& d = wedges[k].corner;
        if (isOwn && isFixed_[d.x] && isFixed_[d.y] && isFixed_[d.z]) continue;
        if (isApart(own, wedges[k]) || !trianglesCross(at, c, wedges[k].corner)) continue;
        found.insert(found.end(), {own.face, wedges[k].face});
      }
    }
  }

 private:
  bool isApart(const Wedge& s, const Wedge& t) const {
    const int common = (s.corner.y == t.corner.y || s.corner.y == t.corner.z ? 1 : 0) +
                       (s.corner.z == t.corner.y || s.corner.z == t.corner.z ? 1 : 0);
    return common == 0 ? areFarApart(s, t, moved_) : common == 1 && areUnfolded(s, t, moved_);
  }

  const Stars& stars_;
  const CleanPositions& positions_;
  const std::vector<bool>& isFixed_;
  const double moved_;  // exceeds what two points move apart
};

}  // namespace

std::vector<std::uint32_t> roundedFaults(const Stars& stars, const CleanPositions& positions,
                                         const std::vector<bool>& isFixed,
                                         std::span<const std::uint32_t> vertices,
                                         const Progress* progress) {
  const Faults faults(stars, positions, isFixed);
  const std::size_t blocks = (vertices.size() + kBlock - 1) / kBlock;
  std::vector<std::vector<std::uint32_t>> found(blocks);
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    if (stop.isSet()) return;
    const std::size_t end = std::min(vertices.size(), (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; ++i) faults.addAt(vertices[i], found[block]);
  });
  stop.throwIfSet();
  std::vector<std::uint32_t> all;
  for (const auto& own : found) all.insert(all.end(), own.begin(), own.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace sherd
