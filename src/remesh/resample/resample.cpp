// Adds samples to a mesh and collapses its vertices into them.
#include "remesh/resample/resample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "base/random.h"
#include "intersect/self_crossings.h"
#include "mesh/search/nearest_on_triangle.h"
#include "remesh/resample/sampled_mesh.h"
#include "remesh/resample/surface_samples.h"

namespace sherd {
namespace {

using Index = SampledMesh::Index;

// The cosine of the angle between two faces above which their edge is a crease: 55 degrees.
constexpr double kCreaseCosine = 0.5736;

// How many edges of a crease are left out where it ends, unless they are sharp, of 70 degrees: of a
// surface that is curved as strongly as voxels resolve it, creases are such pieces.
constexpr int kPrunedEdges = 3;
constexpr double kSharpCosine = 0.342;

// Where a chain of features turns by more than 60 degrees there is a corner.
constexpr double kTurnCosine = -0.5;

// The least cosine between a new triangle and the mean of those that it replaces, and the least
// quality of one: 1 is equilateral.
constexpr double kLeastCosine = 0.6, kLeastQuality = 0.05;

// How far a vertex may be from the triangles that replace those around it, voxels, in one pass over
// the vertices after the other: where the surface is curved as strongly as voxels resolve it, few
// collapse in the first ones.
constexpr std::array kTolerances{0.05, 0.1, 0.15, kMostResampled};

constexpr int kFlipPasses = 2;

// How far a vertex that could not collapse moves, as a share of an edge.
constexpr double kLeastSlide = 0.15, kMostSlide = 0.5;

// The least cosine between the two triangles that a flip makes, unless they had less before.
constexpr double kFlipCosine = 0.94;

glm::dvec3 areaNormal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return glm::cross(b - a, c - a);
}

// 1 of an equilateral triangle, 0 of one without area.
double qualityOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, bc = c - b, ca = a - c;
  const double squares = glm::dot(ab, ab) + glm::dot(bc, bc) + glm::dot(ca, ca);
  return squares > 0.0 ? 2.0 * std::sqrt(3.0) * glm::length(glm::cross(ab, -ca)) / squares : 0.0;
}

glm::dvec3 unitOrZero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : glm::dvec3(0.0);
}

class Resampling {
 public:
  ///   kept  [vertices] those that stay, and all faces between them
  Resampling(const LabeledMesh& mesh, const GridFrame& frame, std::uint64_t seed,
             const std::vector<bool>& kept)
      : mesh_(verticesOf(mesh.mesh, frame), facesOf(mesh.mesh)),
        first_(static_cast<Index>(mesh.mesh.vertices.size())),
        seed_(seed),
        kept_(kept) {
    markFeatures(mesh);
  }

  const SampledMesh& run() {
    std::vector<ResampledPoint> samples = surfaceSamples(mesh_, isCorner_, kSampleDistance, seed_);
    std::erase_if(samples, [&](const ResampledPoint& sample) {
      const auto& c = mesh_.faces()[sample.face].corner;
      if (sample.edge < 0) return isKept(c[0]) && isKept(c[1]) && isKept(c[2]);
      const auto k = static_cast<std::size_t>(sample.edge);
      return isKept(c[k]) && isKept(c[(k + 1) % 3]);
    });
    insert(std::move(samples));
    for (const double tolerance : kTolerances) {
      tolerance_ = tolerance;
      for (Index v = 0; v < first_; ++v) {
        if (!mesh_.around(v).empty()) remove(v);
      }
    }
    for (Index v = 0; v < first_; ++v) {
      if (!mesh_.around(v).empty() && !isCorner_[v]) slide(v);
    }
    for (int pass = 0; pass < kFlipPasses; ++pass) flipAll();
    return mesh_;
  }

 private:
  static std::vector<glm::dvec3> verticesOf(const TriangleMesh& mesh, const GridFrame& frame) {
    std::vector<glm::dvec3> at;
    at.reserve(2 * mesh.vertices.size());
    for (const glm::dvec3& v : mesh.vertices) at.push_back(inVoxels(frame, v));
    return at;
  }

  static std::vector<SampledMesh::Face> facesOf(const TriangleMesh& mesh) {
    std::vector<SampledMesh::Face> faces;
    faces.reserve(3 * mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
      faces.push_back({{t.x, t.y, t.z}, {}, static_cast<Index>(faces.size())});
    }
    return faces;
  }

  const glm::dvec3& at(Index v) const { return mesh_.vertices()[v]; }

  glm::dvec3 normalOf(Index f) const {
    const auto& c = mesh_.faces()[f].corner;
    return areaNormal(at(c[0]), at(c[1]), at(c[2]));
  }

  // Edges of contacts, and creases.
  void markFeatures(const LabeledMesh& mesh) {
    std::vector<glm::dvec3> normals;
    normals.reserve(mesh.other.size());
    for (Index f = 0; f < mesh.other.size(); ++f) normals.push_back(unitOrZero(normalOf(f)));
    const auto regionOf = [&](Index f) {
      return mesh.other[f] == 0 ? 0u : 1u + mesh.mesh.neighborOf(f);
    };
    for (Index f = 0; f < mesh.other.size(); ++f) {
      const auto& corner = mesh_.faces()[f].corner;
      for (std::size_t k = 0; k < 3; ++k) {
        const Index right = mesh_.sidesOf(corner[k], corner[(k + 1) % 3]).right;
        if (regionOf(f) != regionOf(right) || glm::dot(normals[f], normals[right]) < kCreaseCosine)
          mesh_.markFeature(f, k, true);
      }
    }
    for (int i = 0; i < kPrunedEdges; ++i) pruneFeatures();
    isCorner_.reserve(first_);
    for (Index v = 0; v < first_; ++v) isCorner_.push_back(isKept(v) || isCorner(v));
  }

  // Leaves out edges that end at a vertex without another.
  void pruneFeatures() {
    std::vector<std::array<Index, 2>> pruned;
    for (Index v = 0; v < first_; ++v) {
      const std::vector<Index> ends = mesh_.featuresAt(v);
      if (ends.size() == 1 && !isSharp(v, ends[0])) pruned.push_back({v, ends[0]});
    }
    for (const auto& [v, end] : pruned) {
      const SampledMesh::Sides sides = mesh_.sidesOf(v, end);
      mesh_.markFeature(sides.left, mesh_.indexIn(sides.left, v), false);
      mesh_.markFeature(sides.right, mesh_.indexIn(sides.right, end), false);
    }
  }

  bool isSharp(Index a, Index b) const {
    const SampledMesh::Sides sides = mesh_.sidesOf(a, b);
    return glm::dot(unitOrZero(normalOf(sides.left)), unitOrZero(normalOf(sides.right))) <
           kSharpCosine;
  }

  // Whether features end or meet at a vertex, or turn.
  bool isCorner(Index v) const {
    const std::vector<Index> ends = mesh_.featuresAt(v);
    if (ends.size() != 2) return !ends.empty();
    return glm::dot(unitOrZero(at(ends[0]) - at(v)), unitOrZero(at(ends[1]) - at(v))) > kTurnCosine;
  }

  // Sets the normals of vertices beside which there is no feature; those of others are 0.
  void findNormals() {
    normals_.assign(first_, glm::dvec3(0.0));
    std::vector<bool> isOnFeature(first_, false);
    for (Index f = 0; f < mesh_.faces().size(); ++f) {
      const SampledMesh::Face& face = mesh_.faces()[f];
      const glm::dvec3 normal = normalOf(f);
      for (std::size_t k = 0; k < 3; ++k) {
        normals_[face.corner[k]] += normal;
        if (!face.isFeature[k]) continue;
        isOnFeature[face.corner[k]] = isOnFeature[face.corner[(k + 1) % 3]] = true;
      }
    }
    for (Index v = 0; v < first_; ++v)
      normals_[v] = isOnFeature[v] ? glm::dvec3(0.0) : unitOrZero(normals_[v]);
  }

  // Moves a point of a face onto the curved surface through its corners, so that chords cut off no
  // more than they did: onto the mean of the corners' tangent planes it would move twice as far.
  //   source  Boubekeur, Alexa, Phong tessellation, 2008
  glm::dvec3 lifted(const SampledMesh::Face& face, const glm::dvec3& p) const {
    const glm::dvec3 &a = at(face.corner[0]), &b = at(face.corner[1]), &c = at(face.corner[2]);
    const glm::dvec3 normal = areaNormal(a, b, c);
    const double squared = glm::dot(normal, normal);
    if (squared == 0.0) return p;
    const std::array share{glm::dot(normal, areaNormal(p, b, c)) / squared,
                           glm::dot(normal, areaNormal(p, c, a)) / squared,
                           glm::dot(normal, areaNormal(p, a, b)) / squared};
    glm::dvec3 by(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& n = normals_[face.corner[k]];
      by += 0.5 * share[k] * glm::dot(at(face.corner[k]) - p, n) * n;
    }
    return p + by;
  }

  void insert(std::vector<ResampledPoint> samples) {
    findNormals();
    std::stable_sort(samples.begin(), samples.end(), [](const auto& a, const auto& b) {
      return std::tie(a.face, a.edge, a.along) < std::tie(b.face, b.edge, b.along);
    });
    const std::vector<SampledMesh::Face> whole = mesh_.faces();
    Index last = SampledMesh::kNone;
    const ResampledPoint* before = nullptr;
    for (const ResampledPoint& sample : samples) {
      if (sample.edge < 0) continue;
      const auto k = static_cast<std::size_t>(sample.edge);
      const auto& corner = whole[sample.face].corner;
      const bool isNext =
          before != nullptr && before->face == sample.face && before->edge == sample.edge;
      last = mesh_.splitEdge(isNext ? last : corner[k], corner[(k + 1) % 3], sample.at);
      before = &sample;
    }
    std::vector<Index> first(whole.size(), SampledMesh::kNone), next;  // parts of whole faces
    const auto addParts = [&] {
      for (auto f = static_cast<Index>(next.size()); f < mesh_.faces().size(); ++f) {
        Index& own = first[mesh_.faces()[f].source];
        next.push_back(own);
        own = f;
      }
    };
    addParts();
    for (const ResampledPoint& sample : samples) {
      if (sample.edge >= 0) continue;
      const Index part = partAround(sample, first, next, whole);
      if (part == SampledMesh::kNone) continue;
      (void)mesh_.splitFace(part, lifted(whole[sample.face], sample.at));
      addParts();
    }
  }

  // Returns the part of a face that a point is in, none if it is nearly on an edge.
  Index partAround(const ResampledPoint& sample, const std::vector<Index>& first,
                   const std::vector<Index>& next,
                   const std::vector<SampledMesh::Face>& whole) const {
    const auto& corner = whole[sample.face].corner;
    const glm::dvec3 normal = areaNormal(at(corner[0]), at(corner[1]), at(corner[2]));
    Index best = SampledMesh::kNone;
    double most = kLeastShare;
    for (Index f = first[sample.face]; f != SampledMesh::kNone; f = next[f]) {
      const auto& c = mesh_.faces()[f].corner;
      const double area = glm::dot(normal, areaNormal(at(c[0]), at(c[1]), at(c[2])));
      double least = std::numeric_limits<double>::max();
      for (std::size_t k = 0; k < 3; ++k) {
        const double share =
            glm::dot(normal, areaNormal(sample.at, at(c[k]), at(c[(k + 1) % 3]))) / area;
        least = std::min(least, share);
      }
      if (!(least > most)) continue;
      most = least;
      best = f;
    }
    return best;
  }

  // A face around a vertex: it, then `from` and `to`, counter-clockwise.
  struct Spoke {
    Index from, to;
    glm::dvec3 mean{0.0};  // unit normal of the faces on its side
  };

  // The faces around a vertex, in order.
  //   first  an end of one of its edges
  void gatherRing(Index v, Index first) {
    ring_.clear();
    Index from = first;
    do {
      for (const Index f : mesh_.around(v)) {
        const SampledMesh::Face& face = mesh_.faces()[f];
        const auto k = static_cast<std::size_t>(face.indexOf(v));
        if (face.corner[(k + 1) % 3] != from) continue;
        ring_.push_back({from, face.corner[(k + 2) % 3]});
        from = ring_.back().to;
        break;
      }
    } while (from != first);
  }

  // Sets the mean normals: of all faces, or of those before and after `other`.
  void setMeans(Index v, Index other) {
    std::size_t begin = 0;
    glm::dvec3 sum(0.0);
    const auto endSide = [&](std::size_t end) {
      const glm::dvec3 mean = unitOrZero(sum);
      for (; begin < end; ++begin) ring_[begin].mean = mean;
      sum = glm::dvec3(0.0);
    };
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      if (ring_[i].from == other) endSide(i);
      sum += areaNormal(at(v), at(ring_[i].from), at(ring_[i].to));
    }
    endSide(ring_.size());
  }

  // The least quality of the triangles if a vertex collapses into `kept`; below 0 if it may not.
  double qualityAfter(Index v, Index kept, double enough) const {
    double least = 1.0, nearest = std::numeric_limits<double>::max();
    for (const Spoke& spoke : ring_) {
      if (spoke.from == kept || spoke.to == kept) continue;
      const glm::dvec3 &a = at(kept), &b = at(spoke.from), &c = at(spoke.to);
      least = std::min(least, qualityOf(a, b, c));
      if (least < enough) return -1.0;
      const glm::dvec3 normal = areaNormal(a, b, c);
      if (glm::dot(normal, spoke.mean) < kLeastCosine * glm::length(normal)) return -1.0;
      const glm::dvec3 to = nearestOnTriangle(at(v), a, b, c) - at(v);
      nearest = std::min(nearest, glm::dot(to, to));
    }
    return nearest <= tolerance_ * tolerance_ ? least : -1.0;
  }

  // Collapses a vertex into a sample or a corner beside it, if that is possible.
  void remove(Index v) {
    if (isCorner_[v]) return;
    const std::vector<Index> ends = mesh_.featuresAt(v);
    const bool isOnFeature = !ends.empty();
    gatherRing(v, isOnFeature ? ends[0] : someEnd(v));
    setMeans(v, isOnFeature ? ends[1] : SampledMesh::kNone);
    Index best = SampledMesh::kNone;
    double most = kLeastQuality;
    const auto consider = [&](Index kept) {
      if (!isSample(kept)) return;
      const double quality = qualityAfter(v, kept, most);
      if (quality <= most || !mesh_.mayCollapse(v, kept)) return;
      most = quality;
      best = kept;
    };
    if (isOnFeature) {
      if (distanceToSegment(at(v), at(ends[0]), at(ends[1])) >
          std::min(tolerance_, kMostOffFeature))
        return;
      for (const Index end : ends) consider(end);
    } else {
      for (const Spoke& spoke : ring_) consider(spoke.from);
    }
    if (best != SampledMesh::kNone) mesh_.collapse(v, best);
  }

  // Moves a vertex that could not collapse along its feature, or in one of its faces, if the
  // surface stays near.
  void slide(Index v) {
    const auto unit = [&](std::uint64_t k) {
      return randomUnit(seed_, Stage::resampleSlide, 3 * std::uint64_t{v} + k);
    };
    const std::vector<Index> ends = mesh_.featuresAt(v);
    const bool isOnFeature = !ends.empty();
    gatherRing(v, isOnFeature ? ends[0] : someEnd(v));
    setMeans(v, isOnFeature ? ends[1] : SampledMesh::kNone);
    const glm::dvec3 from = at(v);
    const double far = kLeastSlide + (kMostSlide - kLeastSlide) * unit(0);
    glm::dvec3 to;
    if (isOnFeature) {
      const std::size_t k = unit(1) < 0.5 ? 0 : 1;
      to = from + far * (at(ends[k]) - from);
      if (distanceToSegment(from, to, at(ends[1 - k])) > kMostOffFeature) return;
    } else {
      const Spoke& spoke =
          ring_[static_cast<std::size_t>(unit(1) * static_cast<double>(ring_.size()))];
      const double share = unit(2);
      to = from + far * (share * at(spoke.from) + (1.0 - share) * at(spoke.to) - from);
    }
    if (isNear(from, to)) mesh_.move(v, to);
  }

  // Whether the triangles around a vertex stay near it, and good, if it moves.
  bool isNear(const glm::dvec3& from, const glm::dvec3& to) const {
    double nearest = std::numeric_limits<double>::max();
    for (const Spoke& spoke : ring_) {
      const glm::dvec3 &b = at(spoke.from), &c = at(spoke.to);
      const glm::dvec3 normal = areaNormal(to, b, c);
      if (qualityOf(to, b, c) < kLeastQuality ||
          glm::dot(normal, spoke.mean) < kLeastCosine * glm::length(normal))
        return false;
      const glm::dvec3 off = nearestOnTriangle(from, to, b, c) - from;
      nearest = std::min(nearest, glm::dot(off, off));
    }
    return nearest <= kMostResampled * kMostResampled;
  }

  // Returns the other end of an edge at a vertex.
  Index someEnd(Index v) const {
    const SampledMesh::Face& face = mesh_.faces()[mesh_.around(v).front()];
    return face.corner[static_cast<std::size_t>((face.indexOf(v) + 1) % 3)];
  }

  bool isKept(Index v) const { return v < first_ && kept_[v]; }

  bool isSample(Index v) const { return v >= first_ || isCorner_[v]; }

  static double distanceToSegment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 along = b - a;
    const double squared = glm::dot(along, along);
    const double t = squared > 0.0 ? std::clamp(glm::dot(p - a, along) / squared, 0.0, 1.0) : 0.0;
    return glm::distance(p, a + t * along);
  }

  void flipAll() {
    for (Index f = 0; f < mesh_.faces().size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        const SampledMesh::Face& face = mesh_.faces()[f];
        if (face.isGone()) break;
        const Index a = face.corner[k], b = face.corner[(k + 1) % 3];
        if (a < b && !face.isFeature[k] && isBetterFlipped(a, b)) mesh_.flip(a, b);
      }
    }
  }

  bool isBetterFlipped(Index a, Index b) const {
    const SampledMesh::Sides sides = mesh_.sidesOf(a, b);
    if (isKept(a) && isKept(b) && isKept(sides.leftApex) && isKept(sides.rightApex)) return false;
    const glm::dvec3 &pa = at(a), &pb = at(b), &pc = at(sides.leftApex), &pd = at(sides.rightApex);
    const double before = std::min(qualityOf(pa, pb, pc), qualityOf(pb, pa, pd));
    const double after = std::min(qualityOf(pc, pd, pb), qualityOf(pd, pc, pa));
    if (after <= before + 1e-3) return false;
    const glm::dvec3 left = areaNormal(pa, pb, pc), right = areaNormal(pb, pa, pd);
    const glm::dvec3 one = unitOrZero(areaNormal(pc, pd, pb)),
                     two = unitOrZero(areaNormal(pd, pc, pa));
    const glm::dvec3 mean = unitOrZero(left + right);
    const double cosineBefore = glm::dot(unitOrZero(left), unitOrZero(right));
    if (glm::dot(one, two) < std::min(kFlipCosine, cosineBefore)) return false;
    if (glm::dot(one, mean) < kLeastCosine || glm::dot(two, mean) < kLeastCosine) return false;
    return mesh_.mayFlip(a, b);
  }

  // Of a part's area: less is on an edge.
  static constexpr double kLeastShare = 0.005;

  SampledMesh mesh_;
  const Index first_;  // sample
  const std::uint64_t seed_;
  const std::vector<bool>& kept_;
  double tolerance_ = 0.0;      // voxels
  std::vector<bool> isCorner_;  // [vertices that were there] where features end or meet
  std::vector<Spoke> ring_;
  std::vector<glm::dvec3> normals_;  // [vertices that were there] unit, or 0
};

}  // namespace

// Of single precision there are many numbers half way between two of the grid, which the offset
// keeps from flipping.
glm::dvec3 inVoxels(const GridFrame& frame, const glm::dvec3& world) {
  constexpr double kGrid = 0x1p-24, kOffset = 0.3183;
  return kGrid * glm::floor(frame.indexFromWorld(world) / kGrid + kOffset);
}

namespace {

// How often a mesh that crosses itself is made anew.
constexpr int kRounds = 6;

// A mesh, and of each triangle the face that it comes from.
struct Resampled {
  TriangleMesh mesh;
  std::vector<Index> source;
};

Resampled resampledMesh(const LabeledMesh& mesh, const GridFrame& frame, std::uint64_t seed,
                        const std::vector<bool>& kept) {
  Resampling resampling(mesh, frame, seed, kept);
  const SampledMesh& made = resampling.run();
  Resampled out;
  std::vector<Index> number(made.vertices().size(), SampledMesh::kNone);
  for (Index v = 0; v < number.size(); ++v) {
    if (made.around(v).empty()) continue;
    number[v] = static_cast<Index>(out.mesh.vertices.size());
    const bool stays = v < mesh.mesh.vertices.size() &&
                       made.vertices()[v] == inVoxels(frame, mesh.mesh.vertices[v]);
    out.mesh.vertices.push_back(stays ? mesh.mesh.vertices[v]
                                      : frame.worldFromIndex(made.vertices()[v]));
  }
  for (const SampledMesh::Face& face : made.faces()) {
    if (face.isGone()) continue;
    out.mesh.triangles.emplace_back(number[face.corner[0]], number[face.corner[1]],
                                    number[face.corner[2]]);
    out.mesh.neighbor.push_back(mesh.mesh.neighborOf(face.source));
    out.source.push_back(face.source);
  }
  return out;
}

// Keeps the faces that triangles come from, and those around them; returns whether one is new.
bool keepAround(const TriangleMesh& mesh, const std::vector<bool>& isCrossed,
                std::vector<bool>& kept) {
  std::vector<bool> isNear(kept.size(), false);
  for (std::size_t f = 0; f < isCrossed.size(); ++f) {
    for (int k = 0; isCrossed[f] && k < 3; ++k) isNear[mesh.triangles[f][k]] = true;
  }
  bool isNew = false;
  for (const glm::uvec3& t : mesh.triangles) {
    if (!isNear[t.x] && !isNear[t.y] && !isNear[t.z]) continue;
    for (int k = 0; k < 3; ++k) {
      isNew = isNew || !kept[t[k]];
      kept[t[k]] = true;
    }
  }
  return isNew;
}

}  // namespace

TriangleMesh resampled(const LabeledMesh& mesh, const GridFrame& frame, const FragmentKey& key) {
  const std::uint64_t seed = randomBits(key.seed, Stage::resampleFragment, key.fragment);
  std::vector<bool> kept(mesh.mesh.vertices.size(), false);
  Resampled made;
  for (int round = 0; round < kRounds; ++round) {
    made = resampledMesh(mesh, frame, seed, kept);
    std::vector<bool> isCrossed(mesh.mesh.triangles.size(), false);
    for (const auto& pair : selfCrossings(made.mesh.vertices, made.mesh.triangles)) {
      for (const std::uint32_t t : pair) isCrossed[made.source[t]] = true;
    }
    if (!keepAround(mesh.mesh, isCrossed, kept)) break;
  }
  return std::move(made.mesh);
}

}  // namespace sherd
