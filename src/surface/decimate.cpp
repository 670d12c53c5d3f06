// Edge collapse by quadric error, with the regions of equal facing kept as they are:
//
//     free - free      to where the quadric is least
//     free - rim       to the rim's vertex, which stays; so too with fixed vertices
//     rim  - rim       along a rim edge only, to where the quadric is least
//     rim  - fixed     along a rim edge only, to the fixed vertex
//
// and none that changes the topology, turns a face over or takes most of a body.  Meshes that share
// faces are decimated as one, so what they share they share afterwards.
#include "surface/decimate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>
#include <tuple>

#include "base/cancel_flag.h"
#include "surface/edge_collapse.h"
#include "surface/quadric.h"

namespace sherd {
namespace {

using Index = CollapsingMesh::Index;

// Beside the quadric there is a pull towards an edge's middle, so weak that it decides only where
// the quadric does not: in planes and along straight lines.  Half a double's digits: as far above
// rounding as below what it may not disturb.
constexpr double kPull = 1e-8;

// The cosine that a face may turn by in one collapse: 78 degrees. Quadrics do not see folds.
constexpr double kLeastCosine = 0.2;

// The least height of a face in the unit box, unless it had less area before.  Files hold single
// precision, which has to tell its corners from a line.
constexpr double kLeastHeight = 4e-6;

// The least share of its volume that a label keeps.  A tetrahedron in a ball has 0.12 of it.
constexpr double kLeastVolume = 0.1;

struct Candidate {
  double cost;
  double error;    // mean squared distance to the planes, in the unit box
  Index from, to;  // from < to
  std::uint32_t fromVersion, toVersion;
  bool operator>(const Candidate& other) const {
    return std::tie(cost, from, to) > std::tie(other.cost, other.from, other.to);
  }
};

class Decimator {
 public:
  explicit Decimator(const Complex& complex)
      : mesh_(complex),
        fixed_(complex.fixed),
        world_(complex.vertices),
        at_(complex.vertices),
        quadrics_(at_.size()),
        version_(at_.size(), 0) {
    toUnitBox();
    volume_.assign(std::size_t{mesh_.labels()} + 1, 0.0);
    for (const ComplexFace& face : mesh_.faces()) {
      addQuadrics(face.corner);
      const glm::uvec3& t = face.corner;
      addVolume(face, sixfold(at_[t.x], at_[t.y], at_[t.z]), volume_);
    }
    least_ = volume_;
    for (double& least : least_) least *= kLeastVolume;
    for (Index v = 0; v < at_.size(); ++v) {
      for (const Index n : mesh_.neighbours(v)) {
        if (v < n) offer(v, n);
      }
    }
  }

  /// Collapse edges of labels with more triangles than that, as long as no vertex moves by more
  /// than `error` off the planes it came from, in the root of the mean square.
  void collapseTo(std::size_t triangles, double error, const Progress* progress) {
    constexpr std::size_t kBetweenLooks = 4096;
    std::size_t looks = 0;
    const double most = error / scale_;
    above_ = 0;
    for (std::uint16_t label = 1; label <= mesh_.labels(); ++label) {
      above_ += mesh_.trianglesLeft(label) > triangles;
    }
    std::vector<Candidate> later;  // of labels that have few enough, or with too large an error
    for (bool goesOn = true; goesOn && above_ > 0;) {
      goesOn = false;
      std::vector<Candidate> refused;
      while (above_ > 0 && !queue_.empty()) {
        if (looks++ % kBetweenLooks == 0) throwIfCancelled(progress);
        const Candidate next = queue_.top();
        queue_.pop();
        if (isStale(next)) continue;
        const std::vector<std::uint16_t> labels = mesh_.labelsAt(next.from, next.to);
        if (next.error > most * most || !isAnyAbove(labels, triangles)) {
          later.push_back(next);
          continue;
        }
        const std::optional<glm::dvec3> place = placeOf(next.from, next.to);
        if (place && mesh_.keepsTopology(next.from, next.to) &&
            turnsNoFace(next.from, next.to, *place) && keepsBodies(next.from, next.to, *place)) {
          for (const std::uint16_t label : labels) above_ -= mesh_.trianglesLeft(label) > triangles;
          collapse(next.from, next.to, *place);
          for (const std::uint16_t label : labels) above_ += mesh_.trianglesLeft(label) > triangles;
          goesOn = true;
        } else {
          refused.push_back(next);
        }
      }
      // What was refused may do once its surroundings have changed.
      offerAgain(refused);
    }
    offerAgain(later);
  }

  std::vector<LabelledFaces> result() const {
    return meshesOf(world_, mesh_.faces(), mesh_.labels());
  }

 private:
  bool isAnyAbove(const std::vector<std::uint16_t>& labels, std::size_t triangles) const {
    return std::any_of(labels.begin(), labels.end(),
                       [&](std::uint16_t label) { return mesh_.trianglesLeft(label) > triangles; });
  }

  void offerAgain(const std::vector<Candidate>& candidates) {
    for (const Candidate& again : candidates) {
      if (!isStale(again)) queue_.push(again);
    }
  }

  bool isStale(const Candidate& c) const {
    return version_[c.from] != c.fromVersion || version_[c.to] != c.toVersion;
  }

  // Quadrics hold fourth powers of coordinates' size; about the origin little is lost.
  void toUnitBox() {
    const Box box = bounds({at_, {}});
    middle_ = (box.min + box.max) / 2.0;
    scale_ = std::max(longestSide(box), std::numeric_limits<double>::min());
    for (glm::dvec3& v : at_) v = (v - middle_) / scale_;
  }

  glm::dvec3 areaNormal(const glm::uvec3& t) const {  // as long as twice the area
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
      if (!mesh_.isRim(a, b)) continue;
      // A wall on the rim, of the area of a square on the edge, holds the rim as a line.
      const glm::dvec3 along = at_[b] - at_[a], across = glm::cross(along, normal);
      const double squared = glm::dot(along, along);
      if (squared == 0.0) continue;
      const Quadric wall = Quadric::plane(across / std::sqrt(squared), at_[a], squared);
      quadrics_[a] += wall;
      quadrics_[b] += wall;
    }
  }

  // Where the edge goes; nothing where its collapse would change a region.
  std::optional<glm::dvec3> placeOf(Index a, Index b) const {
    if (fixed_[a] || fixed_[b]) return {};
    const int rimsA = mesh_.rimEdges(a), rimsB = mesh_.rimEdges(b);
    if (rimsA != 0 && rimsB != 0 && !mesh_.isRim(a, b)) return {};
    const bool fixedA = rimsA != 0 && rimsA != 2, fixedB = rimsB != 0 && rimsB != 2;
    if (fixedA && fixedB) return {};
    if (fixedA || (rimsA != 0 && rimsB == 0)) return at_[a];
    if (fixedB || (rimsB != 0 && rimsA == 0)) return at_[b];
    return least(a, b);
  }

  // The least of the quadric with the pull towards the middle.  Where that lies farther off than
  // the edge is long, the quadric decides too little, and the best of three stands in.
  glm::dvec3 least(Index a, Index b) const {
    Quadric q = quadrics_[a];
    q += quadrics_[b];
    const glm::dvec3 middle = (at_[a] + at_[b]) / 2.0;
    const double pull = kPull * q.weight();
    if (pull > 0.0) {
      const glm::dmat3 m = q.a + glm::dmat3(pull);
      glm::dvec3 step = solved(m, -(q.a * middle + q.b));
      // Once more from there: takes back what the pull has cost where the quadric decides.
      step += solved(m, -(q.a * (middle + step) + q.b));
      // Asked so that what is no number is no.
      if (glm::dot(step, step) <= glm::dot(at_[a] - at_[b], at_[a] - at_[b])) return middle + step;
    }
    glm::dvec3 best = middle;
    for (const glm::dvec3& other : {at_[a], at_[b]}) {
      if (q(other) < q(best)) best = other;
    }
    return best;
  }

  bool turnsNoFace(Index a, Index b, const glm::dvec3& place) const {
    for (const Index v : {a, b}) {
      for (const Index f : mesh_.facesAround(v)) {
        if (mesh_.has(f, a) && mesh_.has(f, b)) continue;
        const glm::uvec3& t = mesh_.faces()[f].corner;
        const glm::dvec3 before = areaNormal(t);
        const auto corner = [&](int k) { return t[k] == v ? place : at_[t[k]]; };
        const glm::dvec3 p = corner(0), q = corner(1), r = corner(2);
        const glm::dvec3 after = glm::cross(q - p, r - p);
        const double lengths = glm::length(before) * glm::length(after);
        // A face that had no area may become anything.
        if (glm::length(before) == 0.0) continue;
        if (glm::dot(before, after) <= kLeastCosine * lengths) return false;
        const double longest =
            std::max({glm::length(q - p), glm::length(r - q), glm::length(p - r)});
        if (glm::length(after) < std::min(kLeastHeight * longest, glm::length(before)))
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

  // Whether no label is left with next to nothing, and if so its volume afterwards in `volume_`.
  bool keepsBodies(Index a, Index b, const glm::dvec3& place) {
    std::vector<std::uint16_t> labels;
    const auto addAll = [&](double sign) {
      for (const Index v : {a, b}) {
        for (const Index f : mesh_.facesAround(v)) {
          const bool collapses = mesh_.has(f, a) && mesh_.has(f, b);
          if (collapses && v == b) continue;  // met already
          const ComplexFace& face = mesh_.faces()[f];
          const glm::uvec3& t = face.corner;
          const auto corner = [&](int k) { return t[k] == v ? place : at_[t[k]]; };
          double change = -sixfold(at_[t.x], at_[t.y], at_[t.z]);
          if (!collapses) change += sixfold(corner(0), corner(1), corner(2));
          addVolume(face, sign * change, volume_);
          labels.push_back(face.front);
          labels.push_back(face.back);
        }
      }
    };
    const auto isTooSmall = [&](std::uint16_t label) {
      return label != 0 && label <= mesh_.labels() && volume_[label] < least_[label];
    };
    addAll(1.0);
    if (std::none_of(labels.begin(), labels.end(), isTooSmall)) return true;
    addAll(-1.0);
    return false;
  }

  void collapse(Index a, Index b, const glm::dvec3& place) {
    mesh_.collapse(a, b);
    if (place == at_[b]) {
      world_[a] = world_[b];
    } else if (place != at_[a]) {
      world_[a] = middle_ + scale_ * place;
    }
    at_[a] = place;
    quadrics_[a] += quadrics_[b];
    ++version_[b];
    ++version_[a];
    for (const Index n : mesh_.neighbours(a)) offer(std::min(a, n), std::max(a, n));
  }

  void offer(Index a, Index b) {
    const std::optional<glm::dvec3> place = placeOf(a, b);
    if (!place) return;  // and never: regions stay what they are
    Quadric q = quadrics_[a];
    q += quadrics_[b];
    // The pull ranks collapses that cost nothing: short edges first, so that planes are thinned out
    // evenly.
    const double squared = glm::dot(at_[a] - at_[b], at_[a] - at_[b]);
    const double error = std::max(q(*place), 0.0);
    queue_.push({error + kPull * q.weight() * squared, q.weight() > 0.0 ? error / q.weight() : 0.0,
                 a, b, version_[a], version_[b]});
  }

  CollapsingMesh mesh_;
  std::vector<bool> fixed_;
  std::size_t above_ = 0;          // labels with more triangles than are asked for
  std::vector<glm::dvec3> world_;  // to the bit where nothing moved
  std::vector<glm::dvec3> at_;     // in the unit box
  glm::dvec3 middle_{0.0};
  double scale_ = 1.0;
  std::vector<double> volume_, least_;  // [labels + 1] sixfold, in the unit box
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> version_;  // [vertices] counts moves: a candidate of another is stale
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
};

}  // namespace

std::vector<std::vector<CoarseMesh>> decimated(const Complex& complex,
                                               std::span<const std::size_t> triangles,
                                               const Progress* progress) {
  std::vector<std::vector<CoarseMesh>> out(complex.labels,
                                           std::vector<CoarseMesh>(triangles.size()));
  if (triangles.empty()) return out;  // the decimator's own set-up costs more than the mesh did
  std::vector<std::size_t> order(triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return triangles[a] > triangles[b]; });
  Decimator decimator(complex);
  for (const std::size_t i : order) {
    decimator.collapseTo(triangles[i], std::numeric_limits<double>::infinity(), progress);
    std::vector<LabelledFaces> result = decimator.result();
    for (std::size_t label = 0; label < result.size(); ++label) {
      out[label][i] = {std::move(result[label].mesh.mesh), std::move(result[label].facing),
                       triangles[i]};
    }
  }
  return out;
}

std::vector<CoarseMesh> decimated(const TriangleMesh& mesh, std::span<const std::uint16_t> facing,
                                  std::span<const std::size_t> triangles) {
  return std::move(decimated(complexOf(mesh, facing), triangles).front());
}

std::vector<LabelledFaces> simplified(const Complex& complex, double error,
                                      const Progress* progress) {
  Decimator decimator(complex);
  decimator.collapseTo(0, error, progress);
  return decimator.result();
}

}  // namespace sherd
