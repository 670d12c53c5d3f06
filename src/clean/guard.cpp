// Decides which changes are allowed.
#include "clean/guard.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "clean/star_fans.h"
#include "intersect/crossing_point.h"
#include "intersect/self_crossings.h"
#include "mesh/largest_axis.h"
#include "mesh/search/boxes.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

using Corners = std::array<glm::dvec3, 3>;

// The exact sign of a triangle's area seen along an axis.
int sideOf(const Corners& t, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double left = (t[1][u] - t[0][u]) * (t[2][v] - t[0][v]);
  const double right = (t[1][v] - t[0][v]) * (t[2][u] - t[0][u]);
  // Exceeds the error of the difference: Shewchuk 1997, ccwerrboundA.
  const double error =
      4.0 * std::numeric_limits<double>::epsilon() * (std::abs(left) + std::abs(right));
  if (left - right > error) return 1;
  if (right - left > error) return -1;
  return orientation(ExactPoint(t[0]), ExactPoint(t[1]), ExactPoint(t[2]), axis);
}

std::vector<std::uint32_t> primaryFaces(const Stars& stars) {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t f = 0; f < stars.count(); ++f) {
    if (stars.face(f).isPrimary()) numbers.push_back(f);
  }
  return numbers;
}

std::vector<Box> boxesOf(const Stars& stars, const std::vector<std::uint32_t>& faces,
                         const std::vector<glm::dvec3>& at) {
  std::vector<Box> boxes;
  boxes.reserve(faces.size());
  for (const std::uint32_t f : faces) boxes.push_back(boxOf(positionsOf(at, stars.face(f).corner)));
  return boxes;
}

}  // namespace

Guard::Guard(const Stars& stars, CleanPositions& positions, const TriangleMesh& mesh, double reach)
    : stars_(stars),
      positions_(positions),
      mesh_(mesh),
      reach_(reach),
      primary_(primaryFaces(stars)),
      tree_(boxesOf(stars, primary_, positions.exact)),
      home_(stars.count()),
      distance_(stars.count(), 0.0),
      stamp_(stars.count(), 0) {
  for (std::uint32_t f = 0; f < home_.size(); ++f) home_[f] = f;
}

void Guard::addPart(std::uint32_t number, std::uint32_t of) {
  home_.push_back(home_[of]);
  parts_[home_[of]].push_back(number);
  distance_.push_back(distance_[of]);
  stamp_.push_back(0);
}

bool Guard::allows(const Change& change, double reach) {
  return keepsFans(stars_, change) && keepsFaces(change, reach);
}

bool Guard::keepsFaces(const Change& change, double reach) {
  faces_.clear();
  for (const auto* faces : {&change.moved, &change.added}) {
    for (const Change::Face& f : *faces) {
      faces_.push_back({f.number, f.corner, stars_.face(f.number).isPrimary()});
    }
  }
  for (const Change::Patch& patch : change.patches) {
    faces_.push_back({patch.beside, patch.face.corner, patch.face.isPrimary(), true});
  }
  for (const NewFace& f : faces_) {
    if (distance_[f.number] + change.distance > reach) return false;
  }
  mark(change);
  Positions& at = positions_.exact;
  const glm::dvec3 before = std::exchange(at[change.at], change.position);
  bool isAllowed = true;
  for (const NewFace& face : faces_) {
    isAllowed = isAllowed && keepsShape(face, at, change, before);
  }
  isAllowed = isAllowed && keepsApart(at, change, before);
  at[change.at] = before;
  return isAllowed;
}

bool Guard::mends(const Change& change) {
  std::vector<glm::uvec3> old, fresh;
  const auto add = [&](std::uint32_t f) {
    if (stars_.face(f).isPrimary()) old.push_back(stars_.face(f).corner);
  };
  for (const std::uint32_t f : change.removed) add(f);
  for (const Change::Face& f : change.moved) add(f.number);
  for (const NewFace& f : faces_) {
    if (f.isPrimary) fresh.push_back(f.corner);
  }
  const std::size_t now = faultsOf(old);
  if (now == 0) return false;
  glm::dvec3& at = positions_.rounded[change.at];
  const glm::dvec3 before = std::exchange(at, glm::dvec3(glm::vec3(change.position)));
  const std::size_t then = faultsOf(fresh);
  at = before;
  return then < now;
}

// Counts faces without area and pairs that cross, in single precision.
std::size_t Guard::faultsOf(const std::vector<glm::uvec3>& faces) const {
  const Positions& at = positions_.rounded;
  std::size_t count = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Corners own = positionsOf(at, faces[i]);
    count += areCollinear(own) ? 1u : 0u;
    for (const std::uint32_t other : near(widened(boxOf(own), reach_))) {
      count += trianglesCross(at, faces[i], stars_.face(other).corner) ? 1u : 0u;
    }
    for (std::size_t k = 0; k < i; ++k) {
      count += trianglesCross(at, faces[i], faces[k]) ? 1u : 0u;
    }
  }
  return count;
}

// Marks the faces that are removed or moved.
void Guard::mark(const Change& change) {
  ++now_;
  for (const std::uint32_t f : change.removed) stamp_[f] = now_;
  for (const Change::Face& f : change.moved) stamp_[f.number] = now_;
}

// Whether a face keeps its side.  The parts of a mesh's triangle are in its plane, so that they
// cover it as long as none is flipped; a crack's face that is as thin as points move has no side.
bool Guard::keepsShape(const NewFace& face, const Positions& at, const Change& change,
                       const glm::dvec3& before) const {
  const Corners own = positionsOf(at, face.corner);
  if (face.isPatch) return !areCollinear(own);
  const CleanFace& old = stars_.face(face.number);
  if (old.isOutside()) {
    const glm::dvec3 normal = areaNormal(positionsOf(mesh_.vertices, mesh_.triangles[old.source]));
    const int axis = largestAxis(normal);
    return sideOf(own, axis) == (normal[axis] > 0.0 ? 1 : -1);
  }
  if (areCollinear(own)) return false;
  Corners was = positionsOf(at, old.corner);
  for (int k = 0; k < 3; ++k) {
    if (old.corner[k] == change.at) was[static_cast<std::size_t>(k)] = before;
  }
  const glm::dvec3 normal = areaNormal(was);
  const bool isThin = glm::length(normal) < 2.0 * change.distance * longestEdge(was);
  return isThin || glm::dot(normal, areaNormal(own)) > 0.0;
}

bool Guard::keepsApart(Positions& at, const Change& change, const glm::dvec3& before) {
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    if (!faces_[i].isPrimary) continue;
    for (const std::uint32_t other :
         near(widened(boxOf(positionsOf(at, faces_[i].corner)), reach_))) {
      if (!trianglesCross(at, faces_[i].corner, stars_.face(other).corner)) continue;
      if (!crossedBefore(at, change, before, other)) return false;
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (!faces_[k].isPrimary) continue;
      if (trianglesCross(at, faces_[i].corner, faces_[k].corner)) return false;
    }
  }
  return true;
}

// Whether a face crosses one of those that change as it is, so that the change does not matter.
bool Guard::crossedBefore(Positions& at, const Change& change, const glm::dvec3& before,
                          std::uint32_t other) const {
  const glm::dvec3 after = at[change.at];
  at[change.at] = before;
  bool is = false;
  for (const NewFace& f : faces_) {
    if (f.isPatch) continue;
    is = is || trianglesCross(at, stars_.face(f.number).corner, stars_.face(other).corner);
  }
  at[change.at] = after;
  return is;
}

// Returns the primary faces that may meet a box, without those that change.
std::vector<std::uint32_t> Guard::near(const Box& box) const {
  std::vector<std::uint32_t> found;
  const auto add = [&](std::uint32_t f) {
    if (stars_.isThere(f) && stamp_[f] != now_) found.push_back(f);
  };
  for (const std::uint32_t i : tree_.meeting(box)) {
    add(primary_[i]);
    const auto parts = parts_.find(primary_[i]);
    if (parts != parts_.end()) std::for_each(parts->second.begin(), parts->second.end(), add);
  }
  return found;
}

}  // namespace sherd
