// Replaces each facet by a triangulated polygon.  Polygons share their borders.
#include "remesh/decimate/merge_facets.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <span>
#include <utility>

#include "base/cancel_flag.h"
#include "base/random.h"
#include "base/sort_unique.h"
#include "remesh/complex_faults.h"
#include "remesh/decimate/facet_chains.h"
#include "remesh/decimate/facet_polygon.h"
#include "remesh/face_edges.h"
#include "remesh/near_points.h"

namespace sherd {
namespace {

constexpr std::uint32_t kUnset = 0xffffffffu;

// How far vertices may move onto the planes around them.
constexpr double kMostSnap = 10.0;

// How often faces are split off facets whose borders still cross.
constexpr int kMostSplits = 8;

// Near polygons that cross each other the faces stay: within this many tolerances, then within
// twice that, and so on; after so many rounds all of them.
constexpr double kFirstRadius = 5.0;
constexpr int kMostMerges = 8;

// From this round on faults of the cracks themselves are left alone.
constexpr int kOwnFaults = 2;

// Vertices are displaced at random by this share of the tolerance, so that no four are in a plane,
// and none lies on the surface that the cracks are to cut.
constexpr double kDisplacement = 1e-3;

class FacetMerging {
 public:
  FacetMerging(const LabeledComplex& complex, const MergeOptions& options, const Progress* progress)
      : complex_(complex),
        edges_(trianglesOf(complex), complex.vertices.size()),
        tolerance_(std::max(options.facets.cracks.tolerance, options.facets.original.tolerance)),
        facets_(facetsOf(complex, edges_, options.facets, progress)),
        seed_(options.displacementSeed),
        mostFaults_(options.mostFaults),
        positions_(snapped(complex, facets_, kMostSnap * tolerance_)),
        polygons_(facets_.planes.size()),
        sides_(polygons_.size()),
        isTested_(polygons_.size(), 1),
        isRestored_(complex.faces.size(), false) {
    for (std::uint32_t v = 0; v < positions_.size(); ++v) positions_[v] += displacement(v);
  }

  MergedFacets merge(const Progress* progress) {
    double radius = kFirstRadius * tolerance_;
    for (int round = 0;; ++round, radius *= 2.0) {
      throwIfCancelled(progress);
      makeAllPolygons(progress);
      Assembled all = assembled();
      if (round == kMostMerges) return std::move(all.merged);
      std::vector<ComplexFault> faults =
          faultsOf(all.merged.complex, {.of = all.isTested, .source = all.source}, progress);
      if (round >= kOwnFaults) eraseOwn(faults, all.facet);
      if (faults.empty()) return std::move(all.merged);
      testNext(faults, all.facet);
      if (round + 1 == kMostMerges) {
        keepFaces([](std::size_t) { return true; });
      } else if (faults.size() > mostFaults_) {
        keepFaces([&](std::size_t f) { return complex_.faces[f].back != 0; });
      } else {
        restoreNear(faults, radius);
      }
    }
  }

 private:
  glm::dvec3 displacement(std::uint32_t v) const {
    glm::dvec3 d(0.0);
    if (!seed_) return d;
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t item = 3 * std::uint64_t{v} + static_cast<unsigned>(k);
      d[k] =
          kDisplacement * tolerance_ * (2.0 * randomUnit(*seed_, Stage::crackVertex, item) - 1.0);
    }
    return d;
  }

  // Leaves out faults of cracks before facets were merged, which no face that stays can mend: by
  // now all around them stay.
  void eraseOwn(std::vector<ComplexFault>& faults, std::span<const std::uint32_t> facet) const {
    if (complex_.labels > 0) return;
    std::erase_if(faults, [&](const ComplexFault& fault) {
      return facet[fault.faces[0]] == kUnset && facet[fault.faces[1]] == kUnset;
    });
  }

  // Gives back the faces near some points.
  void restoreNear(std::span<const ComplexFault> faults, double radius) {
    std::vector<glm::dvec3> points;
    for (const ComplexFault& fault : faults) points.push_back(fault.at);
    const NearPoints near(points);
    std::vector<std::uint8_t> isNear(complex_.vertices.size(), 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, isNear.size(), 512),
                      [&](const auto& range) {
                        for (std::size_t v = range.begin(); v < range.end(); ++v) {
                          isNear[v] = near.areWithin(radius, complex_.vertices[v]) ? 1 : 0;
                        }
                      });
    keepFaces([&](std::size_t f) {
      const glm::uvec3& t = complex_.faces[f].corner;
      return isNear[t.x] + isNear[t.y] + isNear[t.z] > 0;
    });
  }

  // Takes faces out of their facets, and undoes the snapping of their vertices.
  void keepFaces(const std::function<bool(std::size_t)>& condition) {
    std::vector<bool> isMoved(positions_.size(), false);
    for (std::size_t f = 0; f < complex_.faces.size(); ++f) {
      if (facets_.ofFace[f] == Facets::kNone || !condition(f)) continue;
      facets_.ofFace[f] = Facets::kNone;
      isRestored_[f] = true;
      const glm::uvec3& t = complex_.faces[f].corner;
      for (const std::uint32_t v : {t.x, t.y, t.z}) {
        const glm::dvec3 before = complex_.vertices[v] + displacement(v);
        isMoved[v] = isMoved[v] || positions_[v] != before;
        positions_[v] = before;
      }
    }
    for (std::size_t f = 0; f < complex_.faces.size(); ++f) {
      const glm::uvec3& t = complex_.faces[f].corner;
      if (facets_.ofFace[f] != Facets::kNone && (isMoved[t.x] || isMoved[t.y] || isMoved[t.z]))
        polygons_[facets_.ofFace[f]] = {};
    }
  }

  void makeAllPolygons(const Progress* progress) {
    for (int split = 0; split <= kMostSplits; ++split) {
      makePolygons(split < kMostSplits, progress);
      const bool isAnyFailed = std::any_of(
          polygons_.begin(), polygons_.end(),
          [](const FacetPolygon& polygon) { return !polygon.isMade && !polygon.vertices.empty(); });
      if (!isAnyFailed) return;
      keepFaces([&](std::size_t f) {
        const FacetPolygon& polygon = polygons_[facets_.ofFace[f]];
        const glm::uvec3& t = complex_.faces[f].corner;
        return !polygon.isMade && std::any_of(&t.x, &t.x + 3, [&](std::uint32_t v) {
          return std::binary_search(polygon.vertices.begin(), polygon.vertices.end(), v);
        });
      });
    }
  }

  // Chains that cross each other are refined, which changes the polygons on all sides.  Polygons
  // whose sides did not change since the last call stay.
  //   mayFail  leaves polygons unmade whose borders cross; else their facets keep their faces
  void makePolygons(bool mayFail, const Progress* progress) {
    throwIfCancelled(progress);
    FacetChains chains(edges_, facets_, positions_);
    std::vector<bool> keepsFaces(polygons_.size(), false);
    std::vector<std::uint32_t> todo(polygons_.size());
    std::iota(todo.begin(), todo.end(), 0u);
    while (!todo.empty()) {
      CancelFlag stop(progress);
      tbb::parallel_for(std::size_t{0}, todo.size(), [&](std::size_t i) {
        const std::uint32_t f = todo[i];
        if (!stop.isSet() && !keepsFaces[f]) makePolygon(f, chains);
      });
      stop.throwIfSet();
      std::vector<std::uint32_t> again;
      for (const std::uint32_t f : todo) {
        if (polygons_[f].isMade || keepsFaces[f]) continue;
        const std::size_t before = again.size();
        chains.refine(polygons_[f].chains, again);
        if (again.size() > before || mayFail) continue;
        keepsFaces[f] = true;
        polygons_[f] = {};
        chains.keepAll(chains.of(f), again);
      }
      sortUnique(again);
      todo = std::move(again);
    }
  }

  void makePolygon(std::uint32_t facet, const FacetChains& chains) {
    std::vector<Side> sides = chains.sidesOf(facet);
    FacetPolygon& polygon = polygons_[facet];
    if (polygon.isMade && std::ranges::equal(sides, sides_[facet], {}, &Side::ends, &Side::ends))
      return;
    polygon = polygonOf(facet, sides, chains, facets_.planes[facet]);
    sides_[facet] = std::move(sides);
    isTested_[facet] = 1;
  }

  struct Assembled {
    MergedFacets merged;
    std::vector<std::uint32_t> facet;    // [faces] kUnset: a face of before
    std::vector<std::uint8_t> isTested;  // [faces] 0 or 1: for crossings with all others
    std::vector<std::uint32_t> source;   // [faces] those of one need not be compared
  };

  // Faces that stay are not compared with each other, and neither are triangles of one polygon,
  // which lie side by side in its plane.
  Assembled assembled() const {
    Assembled all;
    LabeledComplex& out = all.merged.complex;
    out.labels = complex_.labels;
    std::vector<std::uint32_t> number(complex_.vertices.size(), kUnset);
    const auto add = [&](const glm::uvec3& corner, std::uint32_t f, std::uint32_t facet,
                         bool isTested, std::uint32_t source) {
      ComplexFace face = complex_.faces[f];  // at fixed vertices it has its corners, in their order
      for (int k = 0; k < 3; ++k) {
        std::uint32_t& n = number[corner[k]];
        if (n == kUnset) {
          n = static_cast<std::uint32_t>(out.vertices.size());
          out.vertices.push_back(positions_[corner[k]]);
          all.merged.vertex.push_back(corner[k]);
          if (!complex_.fixed.empty()) out.fixed.push_back(complex_.fixed[corner[k]]);
        }
        face.corner[k] = n;
      }
      out.faces.push_back(face);
      all.facet.push_back(facet);
      all.isTested.push_back(isTested ? 1 : 0);
      all.source.push_back(source);
    };
    const auto facets = static_cast<std::uint32_t>(polygons_.size());
    std::vector<bool> isDone(facets, false);
    for (std::uint32_t f = 0; f < complex_.faces.size(); ++f) {
      const std::uint32_t facet = facets_.ofFace[f];
      if (facet == Facets::kNone) {
        add(complex_.faces[f].corner, f, kUnset, isRestored_[f], facets);
      } else if (!polygons_[facet].isMade) {
        add(complex_.faces[f].corner, f, facet, true, facets + 1 + f);
      } else if (!isDone[facet]) {
        isDone[facet] = true;
        for (const glm::uvec3& t : polygons_[facet].triangles)
          add(t, f, facet, isTested_[facet] != 0, facet);
      }
    }
    return all;
  }

  // Only what changes from here on is compared next, and what crosses others.
  //   facet  [faces] of the assembled complex
  void testNext(std::span<const ComplexFault> faults, std::span<const std::uint32_t> facet) {
    isTested_.assign(polygons_.size(), 0);
    isRestored_.assign(complex_.faces.size(), false);
    for (const ComplexFault& fault : faults) {
      for (const std::uint32_t f : fault.faces) {
        if (facet[f] != kUnset) isTested_[facet[f]] = 1;
      }
    }
  }

  const LabeledComplex& complex_;
  const FaceEdges edges_;
  const double tolerance_;  // the larger one
  Facets facets_;
  const std::optional<std::uint64_t> seed_;
  const std::size_t mostFaults_;
  std::vector<glm::dvec3> positions_;     // [vertices]
  std::vector<FacetPolygon> polygons_;    // [facets]
  std::vector<std::vector<Side>> sides_;  // [facets] of the polygons that are made
  std::vector<std::uint8_t> isTested_;    // [facets] made since polygons were compared
  std::vector<bool> isRestored_;          // [faces] taken out of a facet since then
};

}  // namespace

MergedFacets withMergedFacets(const LabeledComplex& complex, const MergeOptions& options,
                              const Progress* progress) {
  if (complex.faces.empty()) return {complex, {}};
  return FacetMerging(complex, options, progress).merge(progress);
}

}  // namespace sherd
