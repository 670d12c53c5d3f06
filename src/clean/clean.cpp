// Removes short edges by collapses, then triangles that are thin by their heights.
#include "clean/clean.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <memory>
#include <tuple>
#include <utility>

#include "base/cancel_flag.h"
#include "clean/change.h"
#include "clean/guard.h"
#include "clean/stars.h"

namespace sherd {
namespace {

constexpr int kMostRounds = 12;

// How far a point of a face may move, tolerances.
constexpr double kReach = 4.0;

// A short edge, or a vertex near an edge.
struct Defect {
  double size = 0.0;                  // length, or height
  std::uint32_t a = 0, b = 0;         // of the edge, a < b
  std::uint32_t tip = Change::kNone;  // the vertex

  bool operator<(const Defect& other) const {
    return std::tie(size, a, b, tip) < std::tie(other.size, other.a, other.b, other.tip);
  }
  bool operator==(const Defect&) const = default;
};

// The triangles of the mesh that a vertex lies on, ascending.
using Carrier = std::vector<std::uint32_t>;

class Cleaning {
 public:
  Cleaning(CleanMesh mesh, const TriangleMesh& cut, const CleanOptions& options)
      : isFixed_(std::move(mesh.isFixed)),
        positions_{std::move(mesh.vertices), {}},
        stars_(std::move(mesh.faces), positions_.exact.size()),
        cut_(cut),
        tolerance_(options.tolerance) {}

  Cleaned clean(const Progress* progress) {
    for (std::uint32_t f = 0; f < stars_.count(); ++f) touched_.push_back(f);
    for (int round = 0; round < kMostRounds; ++round) {
      const std::size_t before = changes_;
      const std::vector<std::uint32_t> faces = std::exchange(touched_, {});
      merge(shortEdges(faces), progress);
      std::vector<std::uint32_t> more = faces;
      more.insert(more.end(), touched_.begin(), touched_.end());
      merge(thinFaces(more), progress);
      if (changes_ == before) break;
    }
    Cleaned result{{std::move(positions_.exact), std::move(isFixed_), {}}, changes_};
    for (std::uint32_t f = 0; f < stars_.count(); ++f) {
      if (stars_.isThere(f)) result.mesh.faces.push_back(stars_.face(f));
    }
    return result;
  }

 private:
  // Returns the edges below the tolerance of some faces, the shortest first.
  std::vector<Defect> shortEdges(const std::vector<std::uint32_t>& faces) const {
    std::vector<Defect> found;
    for (const std::uint32_t f : faces) {
      if (!stars_.isThere(f) || !stars_.face(f).isPrimary()) continue;
      const glm::uvec3& t = stars_.face(f).corner;
      for (int k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
        const double length = glm::distance(positions_.exact[a], positions_.exact[b]);
        if (length < tolerance_ && !(isFixed_[a] && isFixed_[b])) found.push_back({length, a, b});
      }
    }
    return sorted(std::move(found));
  }

  // Returns the faces of which a corner is nearer than the tolerance to the opposite edge, between
  // its ends.
  std::vector<Defect> thinFaces(const std::vector<std::uint32_t>& faces) const {
    std::vector<Defect> found;
    for (const std::uint32_t f : faces) {
      if (!stars_.isThere(f) || !stars_.face(f).isPrimary()) continue;
      if (const Defect defect = thinnest(stars_.face(f).corner); defect.size < tolerance_) {
        found.push_back(defect);
      }
    }
    return sorted(std::move(found));
  }

  static std::vector<Defect> sorted(std::vector<Defect> defects) {
    std::sort(defects.begin(), defects.end());
    defects.erase(std::unique(defects.begin(), defects.end()), defects.end());
    return defects;
  }

  // Returns the longest edge of a triangle, the corner opposite it, and its height.
  Defect thinnest(const glm::uvec3& t) const {
    const std::vector<glm::dvec3>& at = positions_.exact;
    int longest = 0;
    double length = -1.0;
    for (int k = 0; k < 3; ++k) {
      const double own = glm::distance(at[t[k]], at[t[(k + 1) % 3]]);
      if (own <= length) continue;
      length = own;
      longest = k;
    }
    const auto [a, b] = std::minmax(t[longest], t[(longest + 1) % 3]);
    const double twice = glm::length(glm::cross(at[t.y] - at[t.x], at[t.z] - at[t.x]));
    return {length > 0.0 ? twice / length : 0.0, a, b, t[(longest + 2) % 3]};
  }

  void merge(const std::vector<Defect>& defects, const Progress* progress) {
    for (std::size_t i = 0; i < defects.size(); ++i) {
      if (i % 64 == 0) throwIfCancelled(progress);
      if (defects[i].tip == Change::kNone) {
        collapseEdge(defects[i]);
      } else {
        removeThin(defects[i]);
      }
    }
  }

  void collapseEdge(const Defect& edge) {
    const bool isThere = !stars_.around(edge.a).empty() && !stars_.around(edge.b).empty();
    if (!isThere || stars_.atEdge(edge.a, edge.b).empty()) return;
    const Carrier ofA = carrierOf(edge.a), ofB = carrierOf(edge.b);
    // A vertex where more pieces meet stays, so that their borders stay where they are.
    const bool aStays =
        isFixed_[edge.a] || stars_.around(edge.a).size() >= stars_.around(edge.b).size();
    for (const bool stays : {aStays, !aStays}) {
      const std::uint32_t at = stays ? edge.a : edge.b, gone = stays ? edge.b : edge.a;
      const Carrier &from = stays ? ofB : ofA, &to = stays ? ofA : ofB;
      if (isFixed_[gone] || !std::includes(to.begin(), to.end(), from.begin(), from.end()))
        continue;
      if (tryChange(collapse(stars_, gone, at, positions_.exact))) return;
    }
  }

  void removeThin(const Defect& thin) {
    const std::vector<std::uint32_t> edge = stars_.atEdge(thin.a, thin.b);
    const bool isThere = std::any_of(edge.begin(), edge.end(),
                                     [&](std::uint32_t f) { return stars_.face(f).has(thin.tip); });
    if (!isThere) return;
    Carrier ofEdge;
    for (const std::uint32_t f : edge) {
      const CleanFace& face = stars_.face(f);
      if (face.isOutside()) ofEdge.push_back(face.source);
    }
    std::sort(ofEdge.begin(), ofEdge.end());
    ofEdge.erase(std::unique(ofEdge.begin(), ofEdge.end()), ofEdge.end());
    const Carrier ofTip = carrierOf(thin.tip);
    const auto lies = [](const Carrier& in, const Carrier& of) {
      return std::includes(in.begin(), in.end(), of.begin(), of.end());
    };
    const std::vector<glm::dvec3>& at = positions_.exact;
    glm::dvec3 position = at[thin.tip];
    if (!lies(ofTip, ofEdge)) {
      if (isFixed_[thin.tip] || !lies(ofEdge, ofTip)) return;
      const glm::dvec3 along = at[thin.b] - at[thin.a];
      const double share = glm::dot(position - at[thin.a], along) / glm::dot(along, along);
      position = at[thin.a] + share * along;
    }
    Change change = attach(stars_, thin.a, thin.b, thin.tip, position, at);
    if (isThinner(change, thin.size)) return;
    (void)tryChange(change);
  }

  // Whether a change makes a face thinner than a height.
  bool isThinner(const Change& change, double height) {
    const glm::dvec3 before = std::exchange(positions_.exact[change.at], change.position);
    bool is = false;
    for (const auto* faces : {&change.moved, &change.added}) {
      for (const Change::Face& f : *faces) is = is || thinnest(f.corner).size <= height;
    }
    positions_.exact[change.at] = before;
    return is;
  }

  Carrier carrierOf(std::uint32_t vertex) const {
    Carrier carrier;
    for (const std::uint32_t f : stars_.around(vertex)) {
      if (stars_.face(f).isOutside()) carrier.push_back(stars_.face(f).source);
    }
    std::sort(carrier.begin(), carrier.end());
    carrier.erase(std::unique(carrier.begin(), carrier.end()), carrier.end());
    return carrier;
  }

  bool tryChange(const Change& change) {
    if (!guard_) guard_ = std::make_unique<Guard>(stars_, positions_, cut_, kReach * tolerance_);
    if (!guard_->allows(change)) return false;
    positions_.exact[change.at] = change.position;
    for (const std::uint32_t f : change.removed) stars_.remove(f);
    for (const Change::Face& part : change.added) {
      CleanFace face = stars_.face(part.number);
      face.corner = part.corner;
      const std::uint32_t number = stars_.add(face);
      guard_->addPart(number, part.number);
      guard_->addDistance(number, change.distance);
    }
    for (const Change::Face& f : change.moved) {
      stars_.setCorners(f.number, f.corner);
      guard_->addDistance(f.number, change.distance);
    }
    for (const std::uint32_t f : stars_.around(change.at)) touched_.push_back(f);
    ++changes_;
    return true;
  }

  std::vector<bool> isFixed_;
  CleanPositions positions_;
  Stars stars_;
  const TriangleMesh& cut_;
  const double tolerance_;
  std::unique_ptr<Guard> guard_;        // made by the first change
  std::vector<std::uint32_t> touched_;  // faces that have changed since they were looked at
  std::size_t changes_ = 0;
};

}  // namespace

Cleaned cleaned(CleanMesh mesh, const TriangleMesh& cut, const CleanOptions& options,
                const Progress* progress) {
  return Cleaning(std::move(mesh), cut, options).clean(progress);
}

}  // namespace sherd
