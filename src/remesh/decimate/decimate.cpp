// Edge collapse by quadric error that preserves the regions of equal neighbor:
//
//     free     - free      to the minimum of the quadric
//     free     - boundary  to the boundary vertex; likewise for fixed vertices
//     boundary - boundary  along a boundary edge only, to the minimum of the quadric
//     boundary - fixed     along a boundary edge only, to the fixed vertex
//
// No collapse changes the topology, flips a face or removes most of a label's volume.  Meshes that
// share faces are decimated together, so the shared faces stay shared.  At edges where a surface of
// which no mesh is made ends, boundaries collapse into vertices that are there.
#include "remesh/decimate/decimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>
#include <tuple>

#include "base/cancel_flag.h"
#include "base/sort_unique.h"
#include "remesh/collapse_log.h"
#include "remesh/decimate/crossing_faces.h"
#include "remesh/decimate/edge_collapse.h"
#include "remesh/decimate/fan_crossings.h"
#include "remesh/decimate/quadric.h"

namespace sherd {
namespace {

using Index = CollapsingMesh::Index;

// Weight of a pull towards the edge's midpoint, which decides only where the quadric is singular:
// in planes and along straight lines.  Half the digits of a double: well above rounding errors and
// well below the quadric.
constexpr double kPull = 1e-8;

// The least cosine between a face's normals before and after a collapse, 78 degrees.  Quadrics do
// not prevent folds.
constexpr double kLeastCosine = 0.2;

// The least height of a face in the unit box, unless it had less area before.  Its corners must not
// become collinear in single precision, which files hold.
constexpr double kLeastHeight = 4e-6;

// The least share of its volume that a label keeps; it may gain as much as it may lose.  Without a
// limit a thin fragment would lose most of it to the collapses of larger ones beside it.  A
// tetrahedron inscribed in a ball has 0.12 of the ball's volume, an icosahedron 0.6.
double leastVolume(std::size_t triangles) {
  constexpr double kLeast = 0.1, kMost = 0.9, kTriangles = 20.0;
  if (triangles == 0) return kLeast;  // as far as errors allow
  return std::clamp(1.0 - kTriangles / static_cast<double>(triangles), kLeast, kMost);
}

// How often other edges collapse where faces crossed.
constexpr std::size_t kMostRounds = 8;

struct Candidate {
  double cost;
  double error;    // mean squared distance to the planes, in the unit box
  Index from, to;  // from < to
  std::uint32_t fromVersion, toVersion;
  bool operator>(const Candidate& other) const {
    return std::tie(cost, from, to) > std::tie(other.cost, other.from, other.to);
  }
};

// What became of a surface's faces, with the vertices that collapses made.
struct Record {
  std::vector<glm::dvec3> vertices{};
  std::vector<ComplexFace> faces{};  // corners all 0 of those that are gone
  std::vector<Quadric> quadrics{};   // [vertices] with those of undone collapses
  CollapseLog log{0};
};

class Decimator {
 public:
  explicit Decimator(const LabeledComplex& complex, const CollapseRules* rules = nullptr)
      : mesh_(complex),
        fixed_(complex.fixed),
        world_(complex.vertices),
        at_(complex.vertices),
        quadrics_(at_.size()),
        version_(at_.size(), 0),
        rules_(rules) {
    toUnitBox();
    if (rules_ != nullptr) {
      leastHeight_ = rules_->leastHeight / scale_;
      mostSquared_ = rules_->error * rules_->error / (scale_ * scale_);
      record_ = {complex.vertices, complex.faces, {}, CollapseLog(complex.faces.size())};
      number_.resize(at_.size());
      std::iota(number_.begin(), number_.end(), 0u);
    }
    findBoundaries();
    volume_.assign(std::size_t{mesh_.labels()} + 1, 0.0);
    for (const ComplexFace& face : mesh_.faces()) {
      addQuadrics(face.corner);
      const glm::uvec3& t = face.corner;
      addVolume(face, sixfold(at_[t.x], at_[t.y], at_[t.z]), volume_);
    }
    whole_ = volume_;
    if (rules_ != nullptr) record_.quadrics = quadrics_;
    for (Index v = 0; v < at_.size(); ++v) {
      for (const Index n : mesh_.neighbors(v)) {
        if (v < n) queueEdge(v, n);
      }
    }
    queue_ = Queue(std::greater<>(), std::move(first_));
    isQueued_ = true;
  }

  /// Collapses edges of labels with more than `triangles` triangles, as long as each vertex stays
  /// within `error`, root mean square, of the planes of its original faces.
  void collapseTo(std::size_t triangles, double error, const Progress* progress) {
    constexpr std::size_t kStepsPerPoll = 4096;
    std::size_t steps = 0;
    const double maxError = error / scale_;
    leastVolume_ = leastVolume(triangles);
    above_ = 0;
    for (std::uint16_t label = 1; label <= mesh_.labels(); ++label) {
      above_ += mesh_.trianglesLeft(label) > triangles;
    }
    if (mesh_.labels() == 0) above_ = 1;
    std::vector<Candidate> deferred;  // too large an error, or labels with few enough triangles
    for (bool hasCollapsed = true; hasCollapsed && above_ > 0;) {
      hasCollapsed = false;
      std::vector<Candidate> refused;
      while (above_ > 0 && !queue_.empty()) {
        if (steps++ % kStepsPerPoll == 0) throwIfCancelled(progress);
        const Candidate next = queue_.top();
        queue_.pop();
        if (isStale(next)) continue;
        const std::vector<std::uint16_t> labels = labelsAt(next.from, next.to);
        if (next.error > maxError * maxError || !isAnyAbove(labels, triangles)) {
          deferred.push_back(next);
          continue;
        }
        const std::optional<glm::dvec3> target = targetOf(next.from, next.to);
        if (target && mesh_.keepsTopology(next.from, next.to) &&
            flipsNoFace(next.from, next.to, *target) && keepsEnds(next.from, next.to, *target) &&
            (rules_ == nullptr || !fanCrosses(mesh_, at_, next.from, next.to, *target)) &&
            keepsVolumes(next.from, next.to, *target)) {
          for (const std::uint16_t label : labels) above_ -= mesh_.trianglesLeft(label) > triangles;
          collapse(next.from, next.to, *target);
          for (const std::uint16_t label : labels) above_ += mesh_.trianglesLeft(label) > triangles;
          hasCollapsed = true;
        } else {
          refused.push_back(next);
        }
      }
      // Refused collapses may be allowed once neighboring edges have collapsed.
      queueAgain(refused);
    }
    queueAgain(deferred);
  }

  /// Undoes what makes faces cross, and collapses other edges in its place, until none do.
  ///   return  the faces that are left
  LabeledComplex withoutCrossings(double error, const Progress* progress) {
    std::vector<std::uint8_t> isTested(record_.faces.size());
    for (std::uint32_t f = 0; f < isTested.size(); ++f) isTested[f] = record_.log.isChanged(f);
    for (std::size_t round = 0;; ++round) {
      const std::vector<FacePair> pairs =
          facesThatCross(record_.vertices, record_.faces, isTested, progress);
      const std::vector<Index> crossing =
          cheapestToUndo(pairs, record_.log, std::size_t{1} << round / 2);
      if (crossing.empty()) return withoutGone(record_.vertices, record_.faces);
      isTested.assign(isTested.size(), 0);
      for (const FacePair& pair : pairs) isTested[pair[0]] = isTested[pair[1]] = 1;
      for (const Index f : undo(crossing, std::size_t{1} << round / 2)) isTested[f] = 1;
      if (round < kMostRounds) collapseTo(0, error, progress);
    }
  }

  std::vector<LabeledMesh> result() const {
    return meshesOf(world_, mesh_.faces(), mesh_.labels());
  }

 private:
  // Undoes collapses of some faces, whose corners stay from then on.  Returns the faces that
  // change.
  std::vector<Index> undo(std::span<const Index> crossing, std::size_t depth) {
    const std::vector<Index> restored = record_.log.undo(crossing, depth, record_.faces);
    mesh_ = CollapsingMesh({record_.vertices, {}, record_.faces, 0});
    world_ = at_ = record_.vertices;
    for (glm::dvec3& v : at_) v = (v - middle_) / scale_;
    quadrics_ = record_.quadrics;
    version_.assign(at_.size(), 0);
    number_.resize(at_.size());
    std::iota(number_.begin(), number_.end(), 0u);
    findBoundaries();
    fixed_.resize(at_.size(), false);
    for (const Index f : crossing) {
      for (int k = 0; k < 3; ++k) fixed_[record_.faces[f].corner[k]] = true;
    }
    queue_ = {};
    std::vector<Index> ends;
    for (const Index f : restored) {
      const glm::uvec3& t = record_.faces[f].corner;
      ends.insert(ends.end(), {t.x, t.y, t.z});
    }
    sortUnique(ends);
    for (const Index v : ends) queueEdgesOf(v);
    return restored;
  }

  // Where the link condition holds for all surfaces together, a collapse into a boundary keeps the
  // boundary's edges.
  void findBoundaries() {
    if (mesh_.labels() > 0) return;
    boundaries_.assign(at_.size(), 0);
    for (Index v = 0; v < at_.size(); ++v) {
      if (!mesh_.facesAround(v).empty()) boundaries_[v] = mesh_.boundaryEdges(v);
    }
  }
  int boundariesOf(Index v) const {
    return boundaries_.empty() ? mesh_.boundaryEdges(v) : boundaries_[v];
  }

  // Whether the surface of a label ends at an edge.
  bool isOpen(Index a, Index b) const {
    if (mesh_.labels() > 0) return false;
    std::array<std::pair<std::uint16_t, int>, 16> balance;
    std::size_t count = 0;
    const auto add = [&](std::uint16_t label, int by) {
      std::size_t i = 0;
      while (i < count && balance[i].first != label) ++i;
      if (i == balance.size()) return;
      if (i == count) balance[count++] = {label, 0};
      balance[i].second += by;
    };
    for (const Index f : mesh_.facesAround(a)) {
      if (!mesh_.has(f, b)) continue;
      const glm::uvec3& t = mesh_.faces()[f].corner;
      const bool isForward =
          (t.x == a && t.y == b) || (t.y == a && t.z == b) || (t.z == a && t.x == b);
      add(mesh_.faces()[f].front, isForward ? 1 : -1);
      add(mesh_.faces()[f].back, isForward ? -1 : 1);
    }
    return std::any_of(balance.begin(), balance.begin() + static_cast<std::ptrdiff_t>(count),
                       [](const auto& own) { return own.second != 0; });
  }

  std::vector<std::uint16_t> labelsAt(Index a, Index b) const {
    if (mesh_.labels() == 0) return {};
    return mesh_.labelsAt(a, b);
  }

  bool isAnyAbove(const std::vector<std::uint16_t>& labels, std::size_t triangles) const {
    return mesh_.labels() == 0 ||
           std::any_of(labels.begin(), labels.end(),
                       [&](std::uint16_t label) { return mesh_.trianglesLeft(label) > triangles; });
  }

  void queueAgain(const std::vector<Candidate>& candidates) {
    for (const Candidate& again : candidates) {
      if (!isStale(again)) queue_.push(again);
    }
  }

  bool isStale(const Candidate& c) const {
    return version_[c.from] != c.fromVersion || version_[c.to] != c.toVersion;
  }

  // Quadrics hold fourth powers of lengths; near the origin they lose little precision.
  void toUnitBox() {
    const Box box = bounds({at_, {}});
    middle_ = (box.min + box.max) / 2.0;
    scale_ = std::max(longestSide(box), std::numeric_limits<double>::min());
    for (glm::dvec3& v : at_) v = (v - middle_) / scale_;
  }

  glm::dvec3 areaNormal(const glm::uvec3& t) const {  // of length twice the area
    return glm::cross(at_[t.y] - at_[t.x], at_[t.z] - at_[t.x]);
  }

  void addQuadrics(const glm::uvec3& t) {
    const glm::dvec3 doubled = areaNormal(t);
    const double length = glm::length(doubled);
    if (length == 0.0) return;
    const glm::dvec3 normal = doubled / length;
    const Quadric face = Quadric::plane(normal, at_[t.x], length / 2);
    for (int k = 0; k < 3; ++k) {
      const Index a = t[k], b = t[(k + 1) % 3];
      quadrics_[a] += face;
      if (!mesh_.isBoundary(a, b)) continue;
      // A plane through the boundary edge, perpendicular to the face and weighted by the edge's
      // squared length, keeps the boundary in place.
      const glm::dvec3 along = at_[b] - at_[a], across = glm::cross(along, normal);
      const double squared = glm::dot(along, along);
      if (squared == 0.0 || isOpen(a, b)) continue;
      const Quadric wall = Quadric::plane(across / std::sqrt(squared), at_[a], squared);
      quadrics_[a] += wall;
      quadrics_[b] += wall;
    }
  }

  // The position that the edge collapses to; none if the collapse would change a region.
  std::optional<glm::dvec3> targetOf(Index a, Index b) const {
    if (!fixed_.empty() && (fixed_[a] || fixed_[b])) return {};
    const int boundariesA = boundariesOf(a), boundariesB = boundariesOf(b);
    if (boundariesA != 0 && boundariesB != 0 && !mesh_.isBoundary(a, b)) return {};
    const bool fixedA = boundariesA != 0 && boundariesA != 2,
               fixedB = boundariesB != 0 && boundariesB != 2;
    if (fixedA && fixedB) return {};
    if (fixedA || (boundariesA != 0 && boundariesB == 0)) return at_[a];
    if (fixedB || (boundariesB != 0 && boundariesA == 0)) return at_[b];
    if (boundariesA != 0 && isOpen(a, b)) return nearerEnd(a, b);
    return optimum(a, b);
  }

  glm::dvec3 nearerEnd(Index a, Index b) const {
    Quadric q = quadrics_[a];
    q += quadrics_[b];
    return q(at_[b]) < q(at_[a]) ? at_[b] : at_[a];
  }

  // The minimum of the quadric with the pull towards the middle.  If that is farther from the
  // middle than the edge's length, the quadric is nearly singular, and the best of both ends and
  // the middle is used.
  glm::dvec3 optimum(Index a, Index b) const {
    Quadric q = quadrics_[a];
    q += quadrics_[b];
    const glm::dvec3 middle = (at_[a] + at_[b]) / 2.0;
    const double pull = kPull * q.weight();
    if (pull > 0.0) {
      const glm::dmat3 m = q.a + glm::dmat3(pull);
      glm::dvec3 step = solved(m, -(q.a * middle + q.b));
      // A second step corrects the bias of the pull.
      step += solved(m, -(q.a * (middle + step) + q.b));
      // Written so that NaN fails the test.
      if (glm::dot(step, step) <= glm::dot(at_[a] - at_[b], at_[a] - at_[b])) return middle + step;
    }
    glm::dvec3 best = middle;
    for (const glm::dvec3& other : {at_[a], at_[b]}) {
      if (q(other) < q(best)) best = other;
    }
    return best;
  }

  bool flipsNoFace(Index a, Index b, const glm::dvec3& target) const {
    for (const Index v : {a, b}) {
      for (const Index f : mesh_.facesAround(v)) {
        if (mesh_.has(f, a) && mesh_.has(f, b)) continue;
        const glm::uvec3& t = mesh_.faces()[f].corner;
        const glm::dvec3 before = areaNormal(t);
        const auto corner = [&](int k) { return t[k] == v ? target : at_[t[k]]; };
        const glm::dvec3 p = corner(0), q = corner(1), r = corner(2);
        const glm::dvec3 after = glm::cross(q - p, r - p);
        const double lengths = glm::length(before) * glm::length(after);
        // A face without area has no normal to keep.
        if (glm::length(before) == 0.0) continue;
        if (glm::dot(before, after) <= kLeastCosine * lengths) return false;
        const double longest =
            std::max({glm::length(q - p), glm::length(r - q), glm::length(p - r)});
        if (glm::length(after) < std::min(leastHeight_ * longest, glm::length(before)))
          return false;
      }
    }
    return true;
  }

  // Six times the volume between a face and the origin.
  static double sixfold(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
    return glm::dot(p, glm::cross(q, r));
  }

  void addVolume(const ComplexFace& face, double volume, std::vector<double>& ofLabel) const {
    if (face.front <= mesh_.labels()) ofLabel[face.front] += volume;
    if (face.back <= mesh_.labels()) ofLabel[face.back] -= volume;
  }

  // Whether open edges stay where the rules allow them.
  bool keepsEnds(Index a, Index b, const glm::dvec3& target) const {
    if (rules_ == nullptr || boundaries_[a] == 0 || boundaries_[b] == 0) return true;
    const Index from = target == at_[a] ? b : a, to = from == a ? b : a;
    const auto inVoxels = [&](Index v) { return middle_ + scale_ * at_[v]; };
    for (const Index end : mesh_.neighbors(from)) {
      if (end == to || boundaries_[end] == 0 || !isOpen(from, end)) continue;
      if (!rules_->mayMove(inVoxels(from), inVoxels(to), inVoxels(end))) return false;
    }
    return true;
  }

  // True if every label keeps its volume, within limits; then `volume_` holds the volumes after the
  // collapse.
  bool keepsVolumes(Index a, Index b, const glm::dvec3& target) {
    if (mesh_.labels() == 0) return true;
    std::vector<std::uint16_t> labels;
    const auto addAll = [&](double sign) {
      for (const Index v : {a, b}) {
        for (const Index f : mesh_.facesAround(v)) {
          const bool collapses = mesh_.has(f, a) && mesh_.has(f, b);
          if (collapses && v == b) continue;  // counted at a
          const ComplexFace& face = mesh_.faces()[f];
          const glm::uvec3& t = face.corner;
          const auto corner = [&](int k) { return t[k] == v ? target : at_[t[k]]; };
          double change = -sixfold(at_[t.x], at_[t.y], at_[t.z]);
          if (!collapses) change += sixfold(corner(0), corner(1), corner(2));
          addVolume(face, sign * change, volume_);
          labels.push_back(face.front);
          labels.push_back(face.back);
        }
      }
    };
    const auto isOff = [&](std::uint16_t label) {
      return label != 0 && label <= mesh_.labels() &&
             (volume_[label] < leastVolume_ * whole_[label] ||
              volume_[label] > (2.0 - leastVolume_) * whole_[label]);
    };
    addAll(1.0);
    if (std::none_of(labels.begin(), labels.end(), isOff)) return true;
    addAll(-1.0);
    return false;
  }

  void collapse(Index a, Index b, const glm::dvec3& target) {
    if (rules_ != nullptr) record(a, b, target);
    mesh_.collapse(a, b);
    // A fixed end stays fixed.
    if (!boundaries_.empty() &&
        (boundaries_[a] == 0 || (boundaries_[a] == 2 && boundaries_[b] != 0)))
      boundaries_[a] = boundaries_[b];
    if (target == at_[b]) {
      world_[a] = world_[b];
    } else if (target != at_[a]) {
      world_[a] = middle_ + scale_ * target;
    }
    at_[a] = target;
    quadrics_[a] += quadrics_[b];
    ++version_[b];
    ++version_[a];
    queueEdgesOf(a);
  }

  void queueEdgesOf(Index v) {
    for (const Index n : mesh_.neighbors(v)) queueEdge(std::min(v, n), std::max(v, n));
  }

  // Adds a collapse to the record.
  void record(Index a, Index b, const glm::dvec3& target) {
    std::vector<Index> changed = mesh_.facesAround(b);
    if (target != at_[a]) {
      for (const Index f : mesh_.facesAround(a)) {
        if (!mesh_.has(f, b)) changed.push_back(f);
      }
    }
    record_.log.add(changed, record_.faces);
    std::uint32_t vertex = number_[target == at_[b] ? b : a];
    if (target != at_[a] && target != at_[b]) {
      vertex = static_cast<std::uint32_t>(record_.vertices.size());
      record_.vertices.push_back(middle_ + scale_ * target);
      record_.quadrics.emplace_back();
    }
    record_.quadrics[vertex] = quadrics_[a];
    record_.quadrics[vertex] += quadrics_[b];
    for (const Index f : changed) {
      const glm::uvec3& t = mesh_.faces()[f].corner;
      const bool isGone = mesh_.has(f, a) && mesh_.has(f, b);
      for (int k = 0; k < 3; ++k) {
        std::uint32_t& corner = record_.faces[f].corner[k];
        if (isGone)
          corner = 0;
        else if (t[k] == a || t[k] == b)
          corner = vertex;
      }
    }
    number_[a] = vertex;
  }

  void queueEdge(Index a, Index b) {
    const std::optional<glm::dvec3> target = targetOf(a, b);
    if (!target) return;  // never allowed, because regions stay the same
    Quadric q = quadrics_[a];
    q += quadrics_[b];
    // The pull orders collapses of zero cost: short edges first, so that planes are thinned evenly.
    const double squared = glm::dot(at_[a] - at_[b], at_[a] - at_[b]);
    const double error = std::max(q(*target), 0.0);
    // Errors only grow, so that one that is too large need not wait.
    if (rules_ != nullptr && error > q.weight() * mostSquared_) return;
    const Candidate edge{error + kPull * q.weight() * squared,
                         q.weight() > 0.0 ? error / q.weight() : 0.0,
                         a,
                         b,
                         version_[a],
                         version_[b]};
    if (isQueued_) {
      queue_.push(edge);
    } else {
      first_.push_back(edge);
    }
  }

  CollapsingMesh mesh_;
  std::vector<bool> fixed_;
  std::size_t above_ = 0;          // labels with more triangles than requested
  std::vector<glm::dvec3> world_;  // world units; unmoved vertices keep their bits
  std::vector<glm::dvec3> at_;     // in the unit box
  glm::dvec3 middle_{0.0};
  double scale_ = 1.0;
  std::vector<double> volume_, whole_;  // [labels + 1] sixfold, in the unit box; now, at first
  double leastVolume_ = 0.0;            // share
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> version_;  // [vertices] counts moves, to detect stale candidates
  std::vector<int> boundaries_;         // [vertices] of the mesh; empty: they change
  double leastHeight_ = kLeastHeight, mostSquared_ = 0.0;
  const CollapseRules* const rules_;
  Record record_;                      // with rules
  std::vector<std::uint32_t> number_;  // [vertices] theirs in the record
  using Queue = std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>>;
  std::vector<Candidate> first_;  // before there is a queue, which is faster made of all of them
  Queue queue_;
  bool isQueued_ = false;
};

}  // namespace

std::vector<std::vector<TriangleMesh>> decimated(const LabeledComplex& complex,
                                                 std::span<const std::size_t> triangles,
                                                 const Progress* progress) {
  std::vector<std::vector<TriangleMesh>> out(complex.labels,
                                             std::vector<TriangleMesh>(triangles.size()));
  if (triangles.empty()) return out;  // setting up the decimator costs more than meshing
  std::vector<std::size_t> order(triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return triangles[a] > triangles[b]; });
  Decimator decimator(complex);
  for (const std::size_t i : order) {
    decimator.collapseTo(triangles[i], std::numeric_limits<double>::infinity(), progress);
    std::vector<LabeledMesh> result = decimator.result();
    for (std::size_t label = 0; label < result.size(); ++label) {
      out[label][i] = std::move(result[label].mesh);
    }
  }
  return out;
}

std::vector<TriangleMesh> decimated(const TriangleMesh& mesh,
                                    std::span<const std::size_t> triangles) {
  return std::move(decimated(complexOf(mesh), triangles).front());
}

std::vector<LabeledMesh> simplified(const LabeledComplex& complex, double error,
                                    const Progress* progress) {
  Decimator decimator(complex);
  decimator.collapseTo(0, error, progress);
  return decimator.result();
}

LabeledComplex collapsed(const LabeledComplex& surface, const CollapseRules& rules,
                         const Progress* progress) {
  Decimator decimator(surface, &rules);
  decimator.collapseTo(0, rules.error, progress);
  return decimator.withoutCrossings(rules.error, progress);
}

}  // namespace sherd
