// Removes short edges by collapses, then triangles that are thin by their heights.
#include "clean/clean.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <memory>
#include <utility>

#include "base/cancel_flag.h"
#include "clean/carrier.h"
#include "clean/change.h"
#include "clean/defect.h"
#include "clean/guard.h"
#include "clean/part_sheets.h"
#include "clean/rounded_faults.h"
#include "clean/stars.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

constexpr int kMostRounds = 12;

// Changes that are tried to mend what single precision spoils.  Meshes with hopeless places have
// thousands of them; of seven fractures elsewhere none needed more than 2,958.
constexpr std::size_t kMostTries = 4096;

// How far a point of a face may move, tolerances: to remove slivers, and to part sheets or to mend
// what single precision spoils.
constexpr double kReach = 4.0, kMostReach = 16.0;

std::vector<glm::dvec3> roundedToFloats(const std::vector<glm::dvec3>& exact) {
  std::vector<glm::dvec3> rounded;
  rounded.reserve(exact.size());
  for (const glm::dvec3& p : exact) rounded.emplace_back(glm::vec3(p));
  return rounded;
}

class Cleaning {
 public:
  Cleaning(CleanMesh mesh, const TriangleMesh& cut, const CleanOptions& options)
      : isFixed_(std::move(mesh.isFixed)),
        positions_{std::move(mesh.vertices), {}, options.spacing},
        stars_(std::move(mesh.faces), positions_.exact.size()),
        cut_(cut),
        tolerance_(options.tolerance),
        pinches_(std::move(mesh.pinches)) {
    if (options.spacing > 0.0) positions_.rounded = roundedToFloats(positions_.exact);
  }

  Cleaned clean(const Progress* progress) {
    removeSlivers(progress);
    for (const Pinch& pinch : pinches_) partSheets(pinch);
    if (!positions_.rounded.empty()) mendRounded(progress);
    Cleaned result{{std::move(positions_.exact), std::move(isFixed_), {}}, changes_};
    for (std::uint32_t f = 0; f < stars_.count(); ++f) {
      if (stars_.isThere(f)) result.mesh.faces.push_back(stars_.face(f));
    }
    return result;
  }

 private:
  void removeSlivers(const Progress* progress) {
    for (std::uint32_t f = 0; f < stars_.count(); ++f) touched_.push_back(f);
    for (int round = 0; round < kMostRounds; ++round) {
      const std::size_t before = changes_;
      const std::vector<std::uint32_t> faces = std::exchange(touched_, {});
      merge(shortEdges(stars_, faces, positions_.exact, isFixed_, tolerance_), progress);
      std::vector<std::uint32_t> more = faces;
      more.insert(more.end(), touched_.begin(), touched_.end());
      merge(thinFaces(stars_, more, positions_.exact, tolerance_), progress);
      if (changes_ == before) break;
    }
  }

  // Gives the sheets of a piece that touches itself vertices of their own, some tolerances apart.
  void partSheets(const Pinch& pinch) {
    const double least = kReach * tolerance_;
    for (const double distance : {least, 2.0 * least, 3.0 * least}) {
      for (const SheetParting& parting : partings(stars_, pinch.piece, pinch.vertex)) {
        for (const glm::dvec3& way : waysInto(parting, pinch.vertex)) {
          if (tryParting(parting, pinch, distance, way)) return;
        }
      }
    }
  }

  // Returns unit vectors from a vertex: the first along the faces of a fan.
  std::vector<glm::dvec3> waysInto(const SheetParting& parting, std::uint32_t vertex) const {
    const glm::dvec3& from = positions_.exact[vertex];
    glm::dvec3 along(0.0), inwards(0.0);
    for (const std::uint32_t f : parting.fan) {
      const std::array<glm::dvec3, 3> at = cornersOf(f);
      const glm::dvec3 to = (at[0] + at[1] + at[2]) / 3.0 - from;
      along += to / glm::length(to);
      inwards -= glm::cross(at[1] - at[0], at[2] - at[0]);
    }
    std::vector<glm::dvec3> ways;
    for (const glm::dvec3& way : {along, inwards, along + inwards}) {
      if (const double length = glm::length(way); length > 0.0) ways.push_back(way / length);
    }
    const std::vector<glm::dvec3> axes = waysAlong({}, cut_);
    ways.insert(ways.end(), axes.begin(), axes.end());
    return ways;
  }

  std::array<glm::dvec3, 3> cornersOf(std::uint32_t f) const {
    return positionsOf(positions_.exact, stars_.face(f).corner);
  }

  bool tryParting(const SheetParting& parting, const Pinch& pinch, double distance,
                  const glm::dvec3& way) {
    const glm::dvec3 position = positions_.exact[pinch.vertex] + distance * way;
    if (spare_ == Change::kNone) {
      spare_ = stars_.addVertex();
      positions_.exact.push_back(position);
      if (!positions_.rounded.empty()) positions_.rounded.push_back(position);
      isFixed_.push_back(false);
    }
    const Change change = part(stars_, parting, pinch.vertex, spare_, position, distance);
    if (!partsSheets(stars_, change, pinch.vertex, pinch.piece)) return false;
    if (!guard().keepsFaces(change, kMostReach * tolerance_)) return false;
    make(change);
    spare_ = Change::kNone;
    return true;
  }

  // Changes the faces that single precision spoils, and those around them, until there are none, or
  // nothing helps.
  void mendRounded(const Progress* progress) {
    std::vector<std::uint32_t> vertices = cutVertices();
    for (int round = 0; round < kMostRounds && !vertices.empty(); ++round) {
      const std::vector<std::uint32_t> faults =
          roundedFaults(stars_, positions_, isFixed_, vertices, progress);
      touched_.clear();
      for (const std::uint32_t f : faults) {
        throwIfCancelled(progress);
        if (stars_.isThere(f) && tries_ < kMostTries) mend(f);
      }
      vertices.clear();
      for (const std::uint32_t f : touched_) {
        if (!stars_.isThere(f)) continue;
        const glm::uvec3& corner = stars_.face(f).corner;
        vertices.insert(vertices.end(), {corner.x, corner.y, corner.z});
      }
      std::sort(vertices.begin(), vertices.end());
      vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    }
  }

  // Returns the vertices of faces that are not triangles of the mesh as it is.
  std::vector<std::uint32_t> cutVertices() const {
    std::vector<bool> isCut(positions_.exact.size(), false);
    for (std::uint32_t f = 0; f < stars_.count(); ++f) {
      const glm::uvec3& t = stars_.face(f).corner;
      if (!stars_.isThere(f) || (isFixed_[t.x] && isFixed_[t.y] && isFixed_[t.z])) continue;
      for (int k = 0; k < 3; ++k) isCut[t[k]] = true;
    }
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t v = 0; v < isCut.size(); ++v) {
      if (isCut[v]) vertices.push_back(v);
    }
    return vertices;
  }

  // Tries what moves points least first.
  void mend(std::uint32_t f) {
    isMending_ = true;
    const std::array<Defect, 3> edges = edgesOf(stars_.face(f).corner, positions_.exact);
    const glm::uvec3 corner = stars_.face(f).corner;
    bool isDone = false;
    const auto collapseBelow = [&](double length) {
      for (const Defect& edge : edges) {
        if (edge.size < length) isDone = isDone || collapseEdge(edge);
      }
    };
    collapseBelow(2.0 * tolerance_);
    if (const Defect thin = thinnest(corner, positions_.exact);
        !isDone && thin.size < 2.0 * tolerance_) {
      isDone = removeThin(thin);
    }
    for (int k = 0; k < 3; ++k) isDone = isDone || nudge(corner[k]);
    collapseBelow(kMostReach * tolerance_);
    isMending_ = false;
  }

  void merge(const std::vector<Defect>& defects, const Progress* progress) {
    for (std::size_t i = 0; i < defects.size(); ++i) {
      if (i % 64 == 0) throwIfCancelled(progress);
      if (defects[i].tip == Change::kNone) {
        (void)collapseEdge(defects[i]);
      } else {
        (void)removeThin(defects[i]);
      }
    }
  }

  // Returns whether it is done, as those below.
  bool collapseEdge(const Defect& edge) {
    const bool isThere = !stars_.around(edge.a).empty() && !stars_.around(edge.b).empty();
    if (!isThere || stars_.atEdge(edge.a, edge.b).empty()) return false;
    const Carrier ofA = carrierAt(edge.a), ofB = carrierAt(edge.b);
    // A vertex where more pieces meet stays, so that their borders stay where they are.
    const bool aStays =
        isFixed_[edge.a] || stars_.around(edge.a).size() >= stars_.around(edge.b).size();
    for (const bool stays : {aStays, !aStays}) {
      const std::uint32_t at = stays ? edge.a : edge.b, gone = stays ? edge.b : edge.a;
      const Carrier &from = stays ? ofB : ofA, &to = stays ? ofA : ofB;
      if (isFixed_[gone] || !liesOn(to, from)) continue;
      if (tryChange(collapse(stars_, gone, at, positions_.exact))) return true;
    }
    return false;
  }

  bool removeThin(const Defect& thin) {
    const std::vector<std::uint32_t> edge = stars_.atEdge(thin.a, thin.b);
    const bool isThere = std::any_of(edge.begin(), edge.end(),
                                     [&](std::uint32_t f) { return stars_.face(f).has(thin.tip); });
    if (!isThere) return false;
    const Carrier ofEdge = carrierOf(stars_, edge), ofTip = carrierAt(thin.tip);
    const std::vector<glm::dvec3>& at = positions_.exact;
    glm::dvec3 position = at[thin.tip];
    if (!liesOn(ofTip, ofEdge)) {
      if (isFixed_[thin.tip] || !liesOn(ofEdge, ofTip)) return false;
      const glm::dvec3 along = at[thin.b] - at[thin.a];
      const double share = glm::dot(position - at[thin.a], along) / glm::dot(along, along);
      position = at[thin.a] + share * along;
    }
    Change change = attach(stars_, thin.a, thin.b, thin.tip, position, at);
    return !isThinner(change, thin.size) && tryChange(change);
  }

  // Whether a change makes a face thinner than a height.
  bool isThinner(const Change& change, double height) {
    const glm::dvec3 before = std::exchange(positions_.exact[change.at], change.position);
    bool is = false;
    for (const auto* faces : {&change.moved, &change.added}) {
      for (const Change::Face& f : *faces)
        is = is || thinnest(f.corner, positions_.exact).size <= height;
    }
    positions_.exact[change.at] = before;
    return is;
  }

  // Moves a vertex by a few spacings of floats, within what it lies on.
  bool nudge(std::uint32_t vertex) {
    if (isFixed_[vertex]) return false;
    const std::vector<glm::dvec3> ways = waysAlong(carrierAt(vertex), cut_);
    for (const double step : {1.0, 2.0, 4.0}) {
      for (const glm::dvec3& way : ways) {
        Change change{.at = vertex,
                      .position = positions_.exact[vertex] + step * positions_.spacing * way,
                      .distance = step * positions_.spacing};
        for (const std::uint32_t f : stars_.around(vertex)) {
          change.moved.push_back({f, stars_.face(f).corner});
        }
        if (tryChange(change)) return true;
      }
    }
    return false;
  }

  Carrier carrierAt(std::uint32_t vertex) const { return carrierOf(stars_, stars_.around(vertex)); }

  bool tryChange(const Change& change) {
    tries_ += isMending_ ? 1u : 0u;
    if (!guard().allows(change, (isMending_ ? kMostReach : kReach) * tolerance_)) return false;
    if (isMending_ && !guard().mends(change)) return false;
    make(change);
    return true;
  }

  Guard& guard() {
    if (!guard_) {
      guard_ = std::make_unique<Guard>(stars_, positions_, cut_, kMostReach * tolerance_);
    }
    return *guard_;
  }

  void make(const Change& change) {
    positions_.exact[change.at] = change.position;
    if (!positions_.rounded.empty()) {
      positions_.rounded[change.at] = glm::dvec3(glm::vec3(change.position));
    }
    for (const std::uint32_t f : change.removed) stars_.remove(f);
    const auto add = [&](const CleanFace& face, std::uint32_t beside) {
      const std::uint32_t number = stars_.add(face);
      guard_->addPart(number, beside);
      guard_->addDistance(number, change.distance);
    };
    for (const Change::Face& part : change.added) {
      CleanFace face = stars_.face(part.number);
      face.corner = part.corner;
      add(face, part.number);
    }
    for (const Change::Patch& patch : change.patches) add(patch.face, patch.beside);
    for (const Change::Face& f : change.moved) {
      stars_.setCorners(f.number, f.corner);
      guard_->addDistance(f.number, change.distance);
    }
    for (const std::uint32_t f : stars_.around(change.at)) touched_.push_back(f);
    ++changes_;
  }

  std::vector<bool> isFixed_;
  CleanPositions positions_;
  Stars stars_;
  const TriangleMesh& cut_;
  const double tolerance_;
  const std::vector<Pinch> pinches_;
  std::unique_ptr<Guard> guard_;         // made by the first change
  std::vector<std::uint32_t> touched_;   // faces that have changed since they were looked at
  std::uint32_t spare_ = Change::kNone;  // a vertex without faces
  bool isMending_ = false;               // changes are to mend what single precision spoils
  std::size_t tries_ = 0;                // of them
  std::size_t changes_ = 0;
};

}  // namespace

Cleaned cleaned(CleanMesh mesh, const TriangleMesh& cut, const CleanOptions& options,
                const Progress* progress) {
  return Cleaning(std::move(mesh), cut, options).clean(progress);
}

}  // namespace sherd
