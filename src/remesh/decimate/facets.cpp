// Region growing over faces.
#include "remesh/decimate/facets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "base/cancel_flag.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = Facets::kNone;

// The least cosine between a face's normal and its facet's.
constexpr double kLeastFacetCosine = 0.5;

// Facets of fewer faces are absorbed by larger ones beside them, at an angle below 90 degrees:
// single faces along the lines between facets.
constexpr std::size_t kSmallFacet = 16;

class FacetGrowing {
 public:
  FacetGrowing(const LabeledComplex& complex, const FaceEdges& edges, const FacetOptions& options,
               const Progress* progress)
      : complex_(complex), edges_(edges), options_(options), progress_(progress) {
    facets_.ofFace.assign(complex.faces.size(), kNone);
  }

  Facets grow() {
    for (std::uint32_t f = 0; f < complex_.faces.size(); ++f) {
      if (facets_.ofFace[f] == kNone && !staysFace(f)) growFrom(f);
    }
    absorbSmall();
    keepFew();
    return std::move(facets_);
  }

 private:
  const glm::dvec3& at(std::uint32_t face, int corner) const {
    return complex_.vertices[complex_.faces[face].corner[corner]];
  }
  glm::dvec3 areaNormal(std::uint32_t face) const {  // of length twice the area
    return glm::cross(at(face, 1) - at(face, 0), at(face, 2) - at(face, 0));
  }

  // The plane of the faces so far, weighted by their area.
  void add(std::uint32_t face) {
    const glm::dvec3 normal = areaNormal(face);
    const double area = glm::length(normal);
    normals_ += normal;
    points_ += area * (at(face, 0) + at(face, 1) + at(face, 2)) / 3.0;
    areas_ += area;
  }
  Facets::Plane plane() const {
    const double length = glm::length(normals_);
    return {areas_ > 0.0 ? points_ / areas_ : glm::dvec3(0.0),
            length > 0.0 ? normals_ / length : glm::dvec3(0.0)};
  }

  bool fits(std::uint32_t face, const Facets::Plane& plane, double leastCosine,
            double tolerance) const {
    const glm::dvec3 normal = areaNormal(face);
    if (glm::dot(normal, plane.normal) < leastCosine * glm::length(normal)) return false;
    for (int k = 0; k < 3; ++k) {
      const double distance = glm::dot(at(face, k) - plane.point, plane.normal);
      if (!(std::abs(distance) <= tolerance)) return false;
    }
    return true;
  }

  void growFrom(std::uint32_t seed) {
    const auto facet = static_cast<std::uint32_t>(facets_.planes.size());
    normals_ = points_ = glm::dvec3(0.0);
    areas_ = 0.0;
    std::vector<std::uint32_t> faces{seed};
    facets_.ofFace[seed] = facet;
    add(seed);
    Facets::Plane current = plane();
    std::size_t fitted = 1;  // faces that the plane is fitted to
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (++steps_ % kStepsPerPoll == 0) throwIfCancelled(progress_);
      for (const std::uint32_t edge : edges_.of(faces[i])) {
        const std::uint32_t other = across(edge, faces[i]);
        if (other == kNone || facets_.ofFace[other] != kNone || staysFace(other)) continue;
        if (!fits(other, current, kLeastFacetCosine, kindOf(seed).tolerance)) continue;
        facets_.ofFace[other] = facet;
        faces.push_back(other);
        add(other);
        if (faces.size() < 2 * fitted) continue;
        fitted = faces.size();
        current = plane();
      }
    }
    facets_.planes.push_back(plane());
    facets_.tolerances.push_back(kindOf(seed).tolerance);
    facets_.isPlanar.push_back(faces.size() >= kindOf(seed).planarFaces);
    sizes_.push_back(faces.size());
    leastFaces_.push_back(kindOf(seed).leastFaces);
  }

  void absorbSmall() {
    std::vector<std::uint32_t> todo;
    for (std::uint32_t f = 0; f < complex_.faces.size(); ++f) {
      if (!staysFace(f) && !isSmall(f)) todo.push_back(f);
    }
    for (std::size_t i = 0; i < todo.size(); ++i) {
      const std::uint32_t facet = facets_.ofFace[todo[i]];
      for (const std::uint32_t edge : edges_.of(todo[i])) {
        const std::uint32_t other = across(edge, todo[i]);
        if (other == kNone || staysFace(other) || !isSmall(other)) continue;
        const FacetKind& kind = kindOf(other);
        if (!fits(other, facets_.planes[facet], 0.0, kind.ofSmall * kind.tolerance)) continue;
        facets_.ofFace[other] = facet;
        todo.push_back(other);
      }
    }
  }
  // Leaves facets of a few faces out, and numbers the others anew.
  void keepFew() {
    std::vector<std::size_t> counts(facets_.planes.size(), 0);
    for (const std::uint32_t facet : facets_.ofFace) {
      if (facet != kNone) ++counts[facet];
    }
    std::vector<std::uint32_t> number(counts.size(), kNone);
    std::uint32_t kept = 0;
    for (std::size_t f = 0; f < counts.size(); ++f) {
      if (counts[f] < leastFaces_[f]) continue;
      facets_.planes[kept] = facets_.planes[f];
      facets_.tolerances[kept] = facets_.tolerances[f];
      facets_.isPlanar[kept] = facets_.isPlanar[f];
      number[f] = kept++;
    }
    facets_.planes.resize(kept);
    facets_.tolerances.resize(kept);
    facets_.isPlanar.resize(kept);
    for (std::uint32_t& facet : facets_.ofFace) {
      if (facet != kNone) facet = number[facet];
    }
  }

  const FacetKind& kindOf(std::uint32_t face) const { return options_.of(complex_.faces[face]); }

  bool staysFace(std::uint32_t face) const {
    const glm::uvec3& t = complex_.faces[face].corner;
    return kindOf(face).tolerance == 0.0 || complex_.isFixed(t.x) || complex_.isFixed(t.y) ||
           complex_.isFixed(t.z);
  }

  bool isSmall(std::uint32_t face) const { return sizes_[facets_.ofFace[face]] < kSmallFacet; }

  // The face between the same labels on the other side of an edge that has no third face.
  std::uint32_t across(std::uint32_t edge, std::uint32_t face) const {
    const auto uses = edges_.uses(edge);
    if (uses.size() != 2 || uses[0].isForward == uses[1].isForward) return kNone;
    const std::uint32_t other = uses[0].face == face ? uses[1].face : uses[0].face;
    const ComplexFace &a = complex_.faces[face], &b = complex_.faces[other];
    const bool isAlike =
        a.front == b.front && a.back == b.back && a.neighbor == b.neighbor && a.chart == b.chart;
    return isAlike ? other : kNone;
  }

  const LabeledComplex& complex_;
  const FaceEdges& edges_;
  static constexpr std::size_t kStepsPerPoll = 65536;
  const FacetOptions options_;
  const Progress* const progress_;
  std::size_t steps_ = 0;
  Facets facets_;
  std::vector<std::size_t> sizes_;       // [facets] faces that the plane was fitted to
  std::vector<std::size_t> leastFaces_;  // [facets]
  glm::dvec3 normals_{0.0}, points_{0.0};
  double areas_ = 0.0;
};

}  // namespace

Facets facetsOf(const LabeledComplex& complex, const FaceEdges& edges, const FacetOptions& options,
                const Progress* progress) {
  return FacetGrowing(complex, edges, options, progress).grow();
}

std::vector<glm::dvec3> snapped(const LabeledComplex& complex, const Facets& facets, double most) {
  constexpr std::size_t kMostPlanes = 8;
  struct Around {
    std::array<std::uint32_t, kMostPlanes> facet{};
    std::size_t count = 0;
    bool isFixed = false;
  };
  std::vector<Around> around(complex.vertices.size());
  for (std::size_t f = 0; f < complex.faces.size(); ++f) {
    const std::uint32_t facet = facets.ofFace[f];
    for (int k = 0; k < 3; ++k) {
      Around& at = around[complex.faces[f].corner[k]];
      at.isFixed = at.isFixed || facet == kNone;
      if (facet == kNone || !facets.isPlanar[facet]) continue;
      const auto end = at.facet.begin() + static_cast<std::ptrdiff_t>(at.count);
      if (at.count < kMostPlanes && std::find(at.facet.begin(), end, facet) == end) {
        at.facet[at.count++] = facet;
      }
    }
  }
  constexpr double kPull = 1e-3;  // towards where it is
  double loosest = 0.0;
  for (const double tolerance : facets.tolerances) loosest = std::max(loosest, tolerance);
  std::vector<glm::dvec3> positions = complex.vertices;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (around[v].isFixed) continue;
    glm::dmat3 a(kPull);
    glm::dvec3 b(0.0);
    for (std::size_t i = 0; i < around[v].count; ++i) {
      const std::uint32_t facet = around[v].facet[i];
      const Facets::Plane& plane = facets.planes[facet];
      const double weight = std::pow(loosest / facets.tolerances[facet], 2);
      a += weight * glm::outerProduct(plane.normal, plane.normal);
      b += weight * glm::dot(plane.point - positions[v], plane.normal) * plane.normal;
    }
    const glm::dvec3 step = glm::inverse(a) * b;
    if (glm::dot(step, step) <= most * most) positions[v] += step;
  }
  return positions;
}

}  // namespace sherd
