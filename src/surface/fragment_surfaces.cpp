// Areas, integrals and contacts of fragments, summed leaf by leaf.
#include "surface/fragment_surfaces.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>

#include "base/cancel_flag.h"
#include "grow/check_labels.h"
#include "mesh/mass_sums.h"

namespace sherd {
namespace {

void widen(std::optional<Box>& box, const glm::dvec3& low, const glm::dvec3& high) {
  box = box ? Box{glm::min(box->min, low), glm::max(box->max, high)} : Box{low, high};
}

// Returns the triangles that a leaf adds, if the intact solid's.
const IntactLeaf* reusedLeaf(const InterfaceSurface& surface, const IntactSurface* intact,
                             std::size_t leaf) {
  return surface.reusesTriangles(leaf) ? &intact->leaves[leaf] : nullptr;
}

const Solid& checked(const Solid& solid, const Labels& labels, const Labels* uneroded,
                     const IntactSurface* intact) {
  (void)checkedCounts(labels, solid);
  if (uneroded != nullptr) checkLabels(*uneroded, solid);
  checkIntact(intact, solid);
  return solid;
}

}  // namespace

FragmentSurfaces::FragmentSurfaces(const Solid& solid, const Labels& labels, const Labels* uneroded,
                                   std::shared_ptr<const IntactSurface> intact,
                                   const Progress* progress)
    : frame_(checked(solid, labels, uneroded, intact.get()).frame),
      count_(static_cast<std::size_t>(labels.fragmentCount)),
      intact_(std::move(intact)),
      ownNeighborhoods_(intact_ ? std::vector<LeafNeighbors>()
                                : leafNeighbors(solid.blocks->origins)),
      neighborhoods_(intact_ ? intact_->neighborhoods : ownNeighborhoods_),
      ownCreases_(intact_ ? Creases() : Creases(solid, neighborhoods_, progress)),
      cut_(findCut(labels, neighborhoods_, CutExtent::cells, progress)),
      surface_(solid, labels, cut_, neighborhoods_, intact_ ? intact_->creases : ownCreases_,
               intact_.get(), SurfaceVertices::changed, progress),
      reference_(middleOf(solid)),
      changed_(solid.blocks->count()),
      gaps_(count_ + 1) {
  CancelFlag stop(progress);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, changed_.size(), 64),
                    [&](const auto& range) {
                      if (stop.isSet()) return;
                      std::optional<NeighborSearch> search;
                      if (uneroded != nullptr) search.emplace(solid, *uneroded, true);
                      for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
                        measureLeaf(leaf, search ? &*search : nullptr);
                      }
                    });
  stop.throwIfSet();
  std::optional<NeighborSearch> search;
  if (uneroded != nullptr) search.emplace(solid, *uneroded, true);
  for (std::size_t id = 1; id <= count_; ++id) {
    measureGaps(static_cast<std::uint16_t>(id), search ? &*search : nullptr);
  }
}

SurfaceTriangle FragmentSurfaces::triangle(std::size_t leaf, const InterfaceQuad& quad,
                                           std::size_t half,
                                           const std::array<std::uint32_t, 3>& vertex) const {
  const std::vector<glm::dvec3>& at = surface_.vertices().at;
  const std::vector<std::uint16_t>& found = changed_[leaf].neighbor;
  const auto i = static_cast<std::size_t>(&quad - surface_.quadsOf(leaf).data());
  return {{at[vertex[0]], at[vertex[1]], at[vertex[2]]},
          found.empty() ? quad.other : found[2 * i + half]};
}

SurfaceTriangle FragmentSurfaces::gap(std::uint16_t id, std::size_t i) const {
  const std::vector<glm::dvec3>& at = surface_.vertices().at;
  const InterfaceTriangle& t = *surface_.gapsOf(id)[i];
  const std::vector<std::uint16_t>& found = gaps_[id].neighbor;
  return {{at[t.vertex[0]], at[t.vertex[1]], at[t.vertex[2]]}, found.empty() ? t.other : found[i]};
}

void FragmentSurfaces::measureLeaf(std::size_t leaf, NeighborSearch* search) {
  ChangedLeaf own;
  const std::vector<glm::dvec3>& at = surface_.vertices().at;
  const std::span<const InterfaceQuad> quads = surface_.quadsOf(leaf);
  own.areaSums.reserve(2 * quads.size());
  std::size_t firstOfLabel = 0;
  for (std::size_t i = 0; i < quads.size(); ++i) {
    if (i > 0 && quads[i].label != quads[i - 1].label) firstOfLabel = 2 * i;
    for (const std::array<std::uint32_t, 3>& t : trianglesOf(quads[i], at)) {
      addArea(own.areaSums, firstOfLabel, at[t[0]], at[t[1]], at[t[2]]);
      if (search == nullptr) continue;
      // The surface of eroded voxels themselves is of no fragment.
      const bool isCrack = quads[i].other != 0 && quads[i].label != Labels::kEroded;
      own.neighbor.push_back(isCrack
                                 ? search->across({at[t[0]], at[t[1]], at[t[2]]}, quads[i].label)
                                 : std::uint16_t{0});
    }
  }
  changed_[leaf] = std::move(own);
}

void FragmentSurfaces::measureGaps(std::uint16_t id, NeighborSearch* search) {
  ChangedGaps own;
  const auto gaps = surface_.gapsOf(id);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    const SurfaceTriangle t = gap(id, i);
    addArea(own.areaSums, 0, t.corner[0], t.corner[1], t.corner[2]);
    if (search == nullptr) continue;
    own.neighbor.push_back(gaps[i]->other == 0 ? 0 : search->across(t.corner, id));
  }
  gaps_[id] = std::move(own);
}

template <class Visit>
void FragmentSurfaces::forEachChanged(std::uint16_t id, const Visit& visit) const {
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    for (const InterfaceQuad& quad : surface_.quadsOf(leaf, id)) {
      const auto halves = trianglesOf(quad, surface_.vertices().at);
      for (const std::size_t half : {0, 1}) {
        visit(triangle(leaf, quad, half, halves[half]), halves[half]);
      }
    }
  }
  const auto gaps = surface_.gapsOf(id);
  for (std::size_t i = 0; i < gaps.size(); ++i) visit(gap(id, i), gaps[i]->vertex);
}

Fragment FragmentSurfaces::measured(std::uint16_t id) const {
  Fragment fragment;
  fragment.id = id;
  // Summed leaf by leaf, so that sums do not depend on which leaves are the intact solid's.
  MassSums mass(reference_);
  const std::vector<glm::dvec3>& at = surface_.vertices().at;
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    if (const IntactLeaf* const reused = reusedLeaf(surface_, intact_.get(), leaf)) {
      if (!reused->areaSums.empty()) fragment.area += reused->areaSums.back();
      mass.add(reused->mass);
      continue;
    }
    const std::span<const InterfaceQuad> quads = surface_.quadsOf(leaf, id);
    if (quads.empty()) continue;
    MassSums ofLeaf(reference_);
    for (const InterfaceQuad& quad : quads) {
      for (const auto& t : trianglesOf(quad, at)) ofLeaf.add(at[t[0]], at[t[1]], at[t[2]]);
    }
    mass.add(ofLeaf);
    const auto last = static_cast<std::size_t>(&quads.back() - surface_.quadsOf(leaf).data());
    fragment.area += changed_[leaf].areaSums[2 * last + 1];
  }
  const auto gaps = surface_.gapsOf(id);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    const SurfaceTriangle t = gap(id, i);
    mass.add(t.corner[0], t.corner[1], t.corner[2]);
  }
  if (!gaps.empty()) fragment.area += gaps_[id].areaSums.back();
  forEachChanged(id, [&](const SurfaceTriangle& t, const auto&) {
    const auto& [a, b, c] = t.corner;
    if (t.neighbor != 0) fragment.fractureArea += glm::length(glm::cross(b - a, c - a)) / 2.0;
  });
  fragment.mass = mass.properties();
  return fragment;
}

std::vector<std::vector<Contact>> FragmentSurfaces::contacts(const Solid& solid,
                                                             const Labels& labels) const {
  ContactMeasure measure;
  for (std::size_t id = 1; id <= count_; ++id) {
    const auto label = static_cast<std::uint16_t>(id);
    forEachChanged(label, [&](const SurfaceTriangle& t, const auto&) {
      if (t.neighbor != 0) measure.add(label, t);
    });
  }
  return measure.contacts(count_, solid, labels, cut_, neighborhoods_);
}

SurfaceByArea FragmentSurfaces::byArea(std::uint16_t id) const {
  struct Part {
    std::uint32_t leaf;
    const InterfaceQuad* quads;  // null: the intact solid's
  };
  std::vector<Part> own;  // all parts but the last
  SurfaceParts parts;
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    std::span<const double> sums;
    const InterfaceQuad* quads = nullptr;
    if (const IntactLeaf* const reused = reusedLeaf(surface_, intact_.get(), leaf)) {
      sums = reused->areaSums;
    } else {
      const std::span<const InterfaceQuad> ofLabel = surface_.quadsOf(leaf, id);
      quads = ofLabel.data();
      const auto first = static_cast<std::size_t>(quads - surface_.quadsOf(leaf).data());
      sums = std::span(changed_[leaf].areaSums).subspan(2 * first, 2 * ofLabel.size());
    }
    if (sums.empty()) continue;
    own.push_back({leaf, quads});
    parts.areaSums.push_back(sums);
  }
  parts.areaSums.push_back(gaps_[id].areaSums);
  parts.triangle = [this, id, own = std::move(own)](std::size_t part, std::size_t t) {
    if (part == own.size()) return gap(id, t);
    const auto& [leaf, quads] = own[part];
    if (quads != nullptr) {
      const InterfaceQuad& quad = quads[t / 2];
      return triangle(leaf, quad, t % 2, trianglesOf(quad, surface_.vertices().at)[t % 2]);
    }
    return SurfaceTriangle{intact_->corners(leaf, t, frame_), 0};
  };
  return SurfaceByArea(std::move(parts));
}

Box FragmentSurfaces::box(std::uint16_t id) const {
  std::optional<Box> box;
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    const IntactLeaf* const reused = reusedLeaf(surface_, intact_.get(), leaf);
    if (reused != nullptr && !reused->triangles.empty()) {
      widen(box, reused->box.min, reused->box.max);
    }
  }
  forEachChanged(id, [&](const SurfaceTriangle& t, const auto&) {
    for (const glm::dvec3& corner : t.corner) widen(box, corner, corner);
  });
  return box.value_or(Box{});
}

std::size_t FragmentSurfaces::triangles(std::uint16_t id) const {
  std::size_t sum = surface_.gapsOf(id).size();
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    const IntactLeaf* const reused = reusedLeaf(surface_, intact_.get(), leaf);
    sum += reused ? reused->triangles.size() : 2 * surface_.quadsOf(leaf, id).size();
  }
  return sum;
}

std::vector<std::size_t> FragmentSurfaces::vertexCounts() const {
  std::vector<std::size_t> counts(count_ + 1, 0);
  for (const std::uint16_t label : surface_.vertexLabels()) {
    if (label <= count_) ++counts[label];
  }
  for (std::size_t id = 1; id <= count_; ++id) {
    for (const std::uint32_t leaf : surface_.leavesOf(static_cast<std::uint16_t>(id))) {
      if (surface_.firstVertex(leaf) != InterfaceSurface::kNone) continue;
      counts[id] += intact_->leaves[leaf].cells.vertices.size();
    }
  }
  return counts;
}

TriangleMesh FragmentSurfaces::changedMesh(std::uint16_t id) const {
  TriangleMesh mesh;
  std::vector<std::uint32_t> used;
  forEachChanged(id, [&](const SurfaceTriangle& t, const std::array<std::uint32_t, 3>& vertex) {
    mesh.triangles.emplace_back(vertex[0], vertex[1], vertex[2]);
    mesh.neighbor.push_back(t.neighbor);
    used.insert(used.end(), vertex.begin(), vertex.end());
  });
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (const std::uint32_t v : used) mesh.vertices.push_back(surface_.vertices().at[v]);
  for (glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      t[k] = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), t[k]) -
                                        used.begin());
    }
  }
  return mesh;
}

}  // namespace sherd
