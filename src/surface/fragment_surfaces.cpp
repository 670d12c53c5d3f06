// Areas, integrals and contacts of fragments, summed leaf by leaf.
#include "surface/fragment_surfaces.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>
#include <utility>

#include "base/cancel_flag.h"
#include "grow/fields/check_labels.h"
#include "mesh/mass_sums.h"
#include "mesh/triangle_area.h"
#include "remesh/region_edges.h"

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

// The areas of the quads of a leaf that are the intact solid's, looked up by ascending edges.
class AreasOfLeaf {
 public:
  AreasOfLeaf(const IntactSurface* intact, std::size_t leaf)
      : own_(intact != nullptr ? &intact->leaves[leaf] : nullptr) {}

  // Returns those of a quad's triangles, or null.
  const std::array<double, 2>* find(const InterfaceQuad& quad) {
    if (!quad.isIntact) return nullptr;
    while (own_->quads[next_].edge < quad.edge) ++next_;
    return &own_->areas[next_];
  }

 private:
  const IntactLeaf* own_;
  std::size_t next_ = 0;
};

const Solid& checkedSolid(const Solid& solid, const Labels& labels, const Labels* uneroded) {
  (void)checkedCounts(labels, solid);
  if (uneroded != nullptr) checkLabels(*uneroded, solid);
  return solid;
}

std::shared_ptr<const CutSolid> cutSolid(const Solid& solid, const Labels& labels,
                                         std::shared_ptr<const IntactSurface> intact,
                                         const Progress* progress) {
  auto cut =
      std::make_shared<CutSolid>(solid, labels, std::move(intact), CutExtent::cells, progress);
  cut->findCreases(solid, progress);
  return cut;
}

}  // namespace

FragmentSurfaces::FragmentSurfaces(const Solid& solid, const Labels& labels, const Labels* uneroded,
                                   std::shared_ptr<const IntactSurface> intact,
                                   const Progress* progress)
    : FragmentSurfaces(
          solid, labels, uneroded,
          cutSolid(checkedSolid(solid, labels, uneroded), labels, std::move(intact), progress),
          SurfaceVertices::changed, progress) {}

FragmentSurfaces::FragmentSurfaces(const Solid& solid, const Labels& labels, const Labels* uneroded,
                                   std::shared_ptr<const CutSolid> cut, SurfaceVertices vertices,
                                   const Progress* progress)
    : frame_(solid.frame),
      count_(static_cast<std::size_t>(labels.fragmentCount)),
      cut_(std::move(cut)),
      surface_(solid, labels, cut_->cut(), cut_->neighborhoods(), cut_->creases(), cut_->intact(),
               vertices, progress),
      reference_(middleOf(solid)) {
  if (vertices == SurfaceVertices::all)
    meshes_.emplace(surface_, cut_->neighborhoods(), cut_->intact());
  if (uneroded != nullptr) findNeighbors(solid, *uneroded, progress);
}

std::uint16_t FragmentSurfaces::neighborOf(std::size_t leaf, const InterfaceQuad& quad,
                                           std::size_t half) const {
  if (neighbors_.empty()) return quad.other;
  const auto i = static_cast<std::size_t>(&quad - surface_.quadsOf(leaf).data());
  return neighbors_[leaf][2 * i + half];
}

SurfaceTriangle FragmentSurfaces::triangle(std::size_t leaf, const InterfaceQuad& quad,
                                           std::size_t half) const {
  const std::vector<glm::dvec3>& at = surface_.vertices().at;
  const auto [a, b, c] = trianglesOf(quad.vertex, quad.split)[half];
  return {{at[a], at[b], at[c]}, neighborOf(leaf, quad, half)};
}

SurfaceTriangle FragmentSurfaces::gap(std::uint16_t id, std::size_t i) const {
  const std::vector<glm::dvec3>& at = surface_.vertices().at;
  const InterfaceTriangle& t = *surface_.gapsOf(id)[i];
  return {{at[t.vertex[0]], at[t.vertex[1]], at[t.vertex[2]]},
          gapNeighbors_.empty() ? t.other : gapNeighbors_[id][i]};
}

void FragmentSurfaces::findNeighbors(const Solid& solid, const Labels& uneroded,
                                     const Progress* progress) {
  std::vector<std::vector<std::uint16_t>> found(solid.blocks->count());
  CancelFlag stop(progress);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, found.size(), 64), [&](const auto& range) {
    if (stop.isSet()) return;
    NeighborSearch search(solid, uneroded, true);
    for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      for (const InterfaceQuad& quad : surface_.quadsOf(leaf)) {
        // The surface of eroded voxels themselves is of no fragment.
        const bool isCrack = quad.other != 0 && quad.label != Labels::kEroded;
        for (const std::size_t half : {0, 1}) {
          found[leaf].push_back(isCrack
                                    ? search.across(triangle(leaf, quad, half).corner, quad.label)
                                    : std::uint16_t{0});
        }
      }
    }
  });
  stop.throwIfSet();
  NeighborSearch search(solid, uneroded, true);
  std::vector<std::vector<std::uint16_t>> ofGaps(count_ + 1);
  for (std::size_t i = 1; i <= count_; ++i) {
    const auto id = static_cast<std::uint16_t>(i);
    for (std::size_t k = 0; k < surface_.gapsOf(id).size(); ++k) {
      const SurfaceTriangle t = gap(id, k);
      ofGaps[id].push_back(t.neighbor == 0 ? std::uint16_t{0} : search.across(t.corner, id));
    }
  }
  neighbors_ = std::move(found);
  gapNeighbors_ = std::move(ofGaps);
}

template <class Visit>
void FragmentSurfaces::forEachCrackOfQuads(std::uint16_t id, const Visit& visit) const {
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    for (const InterfaceQuad& quad : surface_.quadsOf(leaf, id)) {
      if (quad.other == 0) continue;
      for (const std::size_t half : {0, 1}) {
        const SurfaceTriangle t = triangle(leaf, quad, half);
        if (t.neighbor != 0) visit(t, trianglesOf(quad.vertex, quad.split)[half]);
      }
    }
  }
}

template <class Visit>
void FragmentSurfaces::forEachCrackOfGaps(std::uint16_t id, const Visit& visit) const {
  const auto gaps = surface_.gapsOf(id);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    const SurfaceTriangle t = gap(id, i);
    if (t.neighbor != 0) visit(t, gaps[i]->vertex);
  }
}

Fragment FragmentSurfaces::measured(std::uint16_t id) const {
  Fragment fragment;
  fragment.id = id;
  MassSums mass(reference_);
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    if (const IntactLeaf* const reused = reusedLeaf(surface_, cut_->intact(), leaf)) {
      if (!reused->areaSums.empty()) fragment.area += reused->areaSums.back();
      mass.add(reused->mass);
      continue;
    }
    std::array<MassSums, 8> octants;
    octants.fill(MassSums(reference_));
    AreasOfLeaf areas(cut_->intact(), leaf);
    unsigned reusedOctants = 0;
    double area = 0.0;
    for (const InterfaceQuad& quad : surface_.quadsOf(leaf, id)) {
      const std::size_t octant = octantOf(quad.edge);
      const bool isReused = ((surface_.intactOctants(leaf) >> octant) & 1) != 0;
      reusedOctants |= unsigned{isReused} << octant;
      const std::array<double, 2>* const known = areas.find(quad);
      for (const std::size_t half : {0, 1}) {
        double own = known != nullptr ? (*known)[half] : 0.0;
        if (!isReused) {
          const SurfaceTriangle t = triangle(leaf, quad, half);
          octants[octant].add(t.corner[0], t.corner[1], t.corner[2]);
          if (known == nullptr) own = areaOf(t.corner);
        }
        area += own;
        if (neighborOf(leaf, quad, half) != 0) fragment.fractureArea += own;
      }
    }
    for (std::size_t i = 0; i < 8; ++i) {
      if ((reusedOctants >> i) & 1) octants[i] = cut_->intact()->leaves[leaf].octants[i];
    }
    fragment.area += area;
    mass.add(sumOf(octants, reference_));
  }
  double ofGaps = 0.0;
  for (std::size_t i = 0; i < surface_.gapsOf(id).size(); ++i) {
    const SurfaceTriangle t = gap(id, i);
    const double own = areaOf(t.corner);
    mass.add(t.corner[0], t.corner[1], t.corner[2]);
    ofGaps += own;
    if (t.neighbor != 0) fragment.fractureArea += own;
  }
  fragment.area += ofGaps;
  fragment.mass = mass.properties();
  return fragment;
}

std::vector<std::vector<Contact>> FragmentSurfaces::contacts(const Solid& solid,
                                                             const Labels& labels) const {
  ContactMeasure measure;
  for (std::size_t i = 1; i <= count_; ++i) {
    const auto id = static_cast<std::uint16_t>(i);
    forEachCrackOfQuads(id, [&](const SurfaceTriangle& t, const auto&) { measure.add(id, t); });
    // Gaps may also be between fragments that share no voxel face.
    forEachCrackOfGaps(id, [&](const SurfaceTriangle& t, const auto&) {
      if (!neighbors_.empty() || measure.has(id, t.neighbor)) measure.add(id, t);
    });
  }
  // Each face between voxels of two fragments is a quad, unless erosion has parted them.
  if (neighbors_.empty()) return measure.contacts(count_);
  return measure.contacts(count_, voxelContacts(solid, labels, cut_->cut(), cut_->neighborhoods()));
}

SurfaceByArea FragmentSurfaces::byArea(std::uint16_t id) const {
  std::vector<Part> own;  // all parts but the last
  SurfaceParts parts;
  std::size_t changed = surface_.gapsOf(id).size();
  for (const std::uint32_t leaf : surface_.leavesOf(id))
    changed += 2 * surface_.quadsOf(leaf, id).size();
  std::vector<double>& sums = parts.ownSums;
  sums.reserve(changed);
  const auto endPart = [&](std::size_t first) {
    std::partial_sum(sums.begin() + static_cast<std::ptrdiff_t>(first), sums.end(),
                     sums.begin() + static_cast<std::ptrdiff_t>(first));
    parts.areaSums.push_back(std::span(sums).subspan(first));
  };
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    if (const IntactLeaf* const reused = reusedLeaf(surface_, cut_->intact(), leaf)) {
      if (reused->areaSums.empty()) continue;
      own.push_back({leaf, nullptr});
      parts.areaSums.push_back(reused->areaSums);
      continue;
    }
    const std::span<const InterfaceQuad> quads = surface_.quadsOf(leaf, id);
    if (quads.empty()) continue;
    own.push_back({leaf, quads.data()});
    const std::size_t first = sums.size();
    AreasOfLeaf areas(cut_->intact(), leaf);
    for (const InterfaceQuad& quad : quads) {
      const std::array<double, 2>* const known = areas.find(quad);
      for (const std::size_t half : {0, 1})
        sums.push_back(known != nullptr ? (*known)[half]
                                        : areaOf(triangle(leaf, quad, half).corner));
    }
    endPart(first);
  }
  const std::size_t first = sums.size();
  for (std::size_t i = 0; i < surface_.gapsOf(id).size(); ++i)
    sums.push_back(areaOf(gap(id, i).corner));
  endPart(first);
  if (noise_) parts.displace = displacementOf(id, own);
  parts.triangle = [this, id, own = std::move(own)](std::size_t part, std::size_t t) {
    if (part == own.size()) return gap(id, t);
    const auto& [leaf, quads] = own[part];
    if (quads != nullptr) return triangle(leaf, quads[t / 2], t % 2);
    return SurfaceTriangle{cut_->intact()->corners(leaf, t, frame_), 0};
  };
  return SurfaceByArea(std::move(parts));
}

Box FragmentSurfaces::box(std::uint16_t id) const {
  std::optional<Box> box;
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    const IntactLeaf* const reused = reusedLeaf(surface_, cut_->intact(), leaf);
    if (reused != nullptr && !reused->quads.empty()) {
      widen(box, reused->box.min, reused->box.max);
    }
  }
  const std::vector<glm::dvec3>& at = surface_.vertices().at;
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    for (const InterfaceQuad& quad : surface_.quadsOf(leaf, id)) {
      for (const std::uint32_t v : quad.vertex) widen(box, at[v], at[v]);
    }
  }
  for (const InterfaceTriangle* gap : surface_.gapsOf(id)) {
    for (const std::uint32_t v : gap->vertex) widen(box, at[v], at[v]);
  }
  return box.value_or(Box{});
}

std::size_t FragmentSurfaces::triangles(std::uint16_t id) const {
  std::size_t sum = surface_.gapsOf(id).size();
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    const IntactLeaf* const reused = reusedLeaf(surface_, cut_->intact(), leaf);
    sum += reused ? reused->triangles() : 2 * surface_.quadsOf(leaf, id).size();
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
      counts[id] += cut_->intact()->leaves[leaf].cells.vertices.size();
    }
  }
  return counts;
}

std::vector<std::map<int, double>> FragmentSurfaces::boundaryLengths() const {
  const std::vector<glm::dvec3>& at = surface_.vertices().at;
  // What neighbors the faces at a vertex have: an edge between two regions ends at vertices with
  // several.  Each vertex belongs to one fragment.  No quad of a crack has a vertex of an intact
  // one.
  RegionsAtVertices regions(at.size());
  std::vector<std::map<int, double>> lengths(count_ + 1);
  tbb::parallel_for(std::size_t{1}, count_ + 1, [&](std::size_t i) {
    const auto id = static_cast<std::uint16_t>(i);
    for (const std::uint32_t leaf : surface_.leavesOf(id)) {
      for (const InterfaceQuad& quad : surface_.quadsOf(leaf, id)) {
        if (quad.isIntact) continue;
        const QuadHalves halves = trianglesOf(quad.vertex, quad.split);
        for (const std::size_t half : {0, 1}) {
          for (const std::uint32_t v : halves[half]) regions.add(v, neighborOf(leaf, quad, half));
        }
      }
    }
    const auto gaps = surface_.gapsOf(id);
    for (std::size_t k = 0; k < gaps.size(); ++k) {
      for (const std::uint32_t v : gaps[k]->vertex) regions.add(v, gap(id, k).neighbor);
    }
    RegionEdges edges(regions);
    const auto add = [&](const SurfaceTriangle& t, const std::array<std::uint32_t, 3>& vertex) {
      edges.add(vertex, t.neighbor);
    };
    forEachCrackOfQuads(id, add);
    forEachCrackOfGaps(id, add);
    lengths[id] = lengthsOf(std::move(edges).loops(), at);
  });
  return lengths;
}

LabeledMesh FragmentSurfaces::meshOf(std::uint16_t id) const {
  assert(meshes_);
  LabeledMesh mesh = meshes_->meshOf(id);
  if (neighbors_.empty()) {
    mesh.mesh.neighbor = mesh.other;
    return mesh;
  }
  mesh.mesh.neighbor.reserve(mesh.other.size());
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    if (const IntactLeaf* const reused = reusedLeaf(surface_, cut_->intact(), leaf)) {
      mesh.mesh.neighbor.insert(mesh.mesh.neighbor.end(), reused->triangles(), 0);
    }
    const std::span<const InterfaceQuad> quads = surface_.quadsOf(leaf, id);
    const auto first =
        neighbors_[leaf].begin() + 2 * (quads.data() - surface_.quadsOf(leaf).data());
    mesh.mesh.neighbor.insert(mesh.mesh.neighbor.end(), first,
                              first + 2 * static_cast<std::ptrdiff_t>(quads.size()));
  }
  const std::vector<std::uint16_t>& ofGaps = gapNeighbors_[id];
  mesh.mesh.neighbor.insert(mesh.mesh.neighbor.end(), ofGaps.begin(), ofGaps.end());
  return mesh;
}

}  // namespace sherd
