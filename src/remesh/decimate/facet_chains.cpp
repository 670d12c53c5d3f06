// Follows border edges from branch to branch, and simplifies the chains.
#include "remesh/decimate/facet_chains.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "base/sort_unique.h"

namespace sherd {
namespace {

// How much farther than a chain inside the solid one on the open border may move.  It lies beyond
// the solid by more.
constexpr double kOpenBorder = 5.0;

// Chains that cross get a finer tolerance, down to the finest; then all their vertices are kept.
constexpr double kFiner = 0.25;
constexpr double kFinest = 0.02;

double distanceToSegment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double squared = glm::dot(along, along);
  const double t = squared > 0.0 ? glm::clamp(glm::dot(p - a, along) / squared, 0.0, 1.0) : 0.0;
  return glm::length(p - (a + t * along));
}

// Border edges by their vertices.
class BorderEdges {
 public:
  BorderEdges(const FaceEdges& edges, std::vector<std::uint32_t> borders, std::size_t vertices)
      : all_(std::move(borders)), first_(vertices + 1, 0), at_(2 * all_.size()) {
    for (const std::uint32_t e : all_) {
      for (const std::uint32_t v : edges.ends(e)) ++first_[v + 1];
    }
    for (std::size_t v = 0; v < vertices; ++v) first_[v + 1] += first_[v];
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (const std::uint32_t e : all_) {
      for (const std::uint32_t v : edges.ends(e)) at_[next[v]++] = e;
    }
  }

  const std::vector<std::uint32_t>& all() const { return all_; }
  std::span<const std::uint32_t> at(std::uint32_t vertex) const {
    return std::span(at_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  std::vector<std::uint32_t> all_;
  std::vector<std::uint32_t> first_;  // [vertices + 1] into at_
  std::vector<std::uint32_t> at_;
};

}  // namespace

FacetChains::FacetChains(const FaceEdges& edges, const Facets& facets,
                         std::span<const glm::dvec3> positions)
    : edges_(edges), facets_(facets), positions_(positions), ofFacet_(facets.planes.size()) {
  findChains();
  separateChains();
}

bool FacetChains::isBorder(std::size_t edge) const {
  const auto uses = edges_.uses(edge);
  if (std::all_of(uses.begin(), uses.end(), [&](const FaceEdges::Use& use) {
        return facets_.ofFace[use.face] == Facets::kNone;
      })) {
    return false;
  }
  return uses.size() != 2 || uses[0].isForward == uses[1].isForward ||
         facets_.ofFace[uses[0].face] != facets_.ofFace[uses[1].face];
}

void FacetChains::findChains() {
  std::vector<std::uint32_t> all;
  for (std::uint32_t e = 0; e < edges_.count(); ++e) {
    if (isBorder(e)) all.push_back(e);
  }
  const BorderEdges borders(edges_, std::move(all), positions_.size());
  std::vector<bool> isUsed(edges_.count(), false);
  const auto follow = [&](std::uint32_t v, std::uint32_t edge) {
    Chain chain;
    chain.vertices.push_back(v);
    addFacets(edge, v, chain);
    while (true) {
      isUsed[edge] = true;
      const auto& ends = edges_.ends(edge);
      v = ends[0] == v ? ends[1] : ends[0];
      chain.vertices.push_back(v);
      const auto here = borders.at(v);
      if (isEnd(here)) break;
      edge = here[0] == edge ? here[1] : here[0];
      if (isUsed[edge]) break;
    }
    add(std::move(chain));
  };
  for (std::uint32_t v = 0; v < positions_.size(); ++v) {
    const auto here = borders.at(v);
    if (!isEnd(here)) continue;
    for (const std::uint32_t e : here) {
      if (!isUsed[e]) follow(v, e);
    }
  }
  for (const std::uint32_t e : borders.all()) {  // loops
    if (!isUsed[e]) follow(edges_.ends(e)[0], e);
  }
}

// Whether chains end at a vertex with these border edges.  At the open border a facet and a face of
// none may meet, where no third border edge begins.
bool FacetChains::isEnd(std::span<const std::uint32_t> edges) const {
  if (edges.size() != 2) return true;
  const auto a = edges_.uses(edges[0]), b = edges_.uses(edges[1]);
  const auto isNone = [&](const FaceEdges::Use& use) {
    return facets_.ofFace[use.face] == Facets::kNone;
  };
  return a.size() != b.size() ||
         std::count_if(a.begin(), a.end(), isNone) != std::count_if(b.begin(), b.end(), isNone);
}

void FacetChains::addFacets(std::uint32_t edge, std::uint32_t from, Chain& chain) const {
  for (const FaceEdges::Use& use : edges_.uses(edge)) {
    const std::uint32_t facet = facets_.ofFace[use.face];
    const bool startsHere = (edges_.ends(edge)[0] == from) == use.isForward;
    if (facet == Facets::kNone) {
      chain.isFixed = true;
    } else {
      chain.facets.push_back({facet, startsHere});
    }
  }
}

void FacetChains::add(Chain chain) {
  const auto number = static_cast<std::uint32_t>(chains_.size());
  for (const Beside& beside : chain.facets) {
    std::vector<std::uint32_t>& own = ofFacet_[beside.facet];
    if (own.empty() || own.back() != number) own.push_back(number);
  }
  chain.own = std::numeric_limits<double>::infinity();
  for (const Beside& beside : chain.facets)
    chain.own = std::min(chain.own, facets_.tolerances[beside.facet]);
  setTolerance(chain,
               chain.isFixed ? 0.0 : (chain.facets.size() == 1 ? kOpenBorder : 1.0) * chain.own);
  chains_.push_back(std::move(chain));
}

void FacetChains::setTolerance(Chain& chain, double tolerance) const {
  chain.tolerance = tolerance;
  chain.kept.clear();
  const std::size_t last = chain.vertices.size() - 1;
  std::vector<bool> keeps(chain.vertices.size(), tolerance == 0.0);
  keeps.front() = keeps.back() = true;
  std::size_t middle = last;
  if (chain.vertices.front() == chain.vertices.back()) {
    middle = farthestFromFirst(chain);
    keeps[middle] = true;
  }
  keepBetween(chain, 0, middle, keeps);
  keepBetween(chain, middle, last, keeps);
  for (std::size_t i = 0; i < keeps.size(); ++i) {
    if (keeps[i]) chain.kept.push_back(chain.vertices[i]);
  }
}

std::size_t FacetChains::farthestFromFirst(const Chain& chain) const {
  std::size_t farthest = 0;
  const glm::dvec3& first = position(chain.vertices.front());
  for (std::size_t i = 1; i < chain.vertices.size(); ++i) {
    if (glm::distance(position(chain.vertices[i]), first) >
        glm::distance(position(chain.vertices[farthest]), first)) {
      farthest = i;
    }
  }
  return farthest;
}

//   source  Douglas, Peucker, Algorithms for the reduction of the number of points required to
//           represent a digitized line, 1973
void FacetChains::keepBetween(const Chain& chain, std::size_t from, std::size_t to,
                              std::vector<bool>& keeps) const {
  if (chain.tolerance == 0.0) return;  // all are kept
  std::vector<std::array<std::size_t, 2>> spans{{from, to}};
  while (!spans.empty()) {
    const auto [begin, end] = spans.back();
    spans.pop_back();
    double farthest = chain.tolerance;
    std::size_t split = begin;
    for (std::size_t i = begin + 1; i < end; ++i) {
      const double d =
          distanceToSegment(position(chain.vertices[i]), position(chain.vertices[begin]),
                            position(chain.vertices[end]));
      if (d > farthest) {
        farthest = d;
        split = i;
      }
    }
    if (split == begin) continue;
    keeps[split] = true;
    spans.push_back({begin, split});
    spans.push_back({split, end});
  }
}

void FacetChains::separateChains() {
  for (bool isAny = true; isAny;) {
    const std::vector<std::uint32_t> touching = touchingChains();
    std::vector<std::uint32_t> facets;
    refine(touching, facets);
    isAny = !touching.empty();
  }
}

// Chains that can be refined, ascending.
std::vector<std::uint32_t> FacetChains::touchingChains() const {
  std::vector<Side> sides;
  for (std::uint32_t c = 0; c < chains_.size(); ++c) {
    const std::vector<std::uint32_t>& kept = chains_[c].kept;
    for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
      sides.push_back({std::min(kept[i], kept[i + 1]), std::max(kept[i], kept[i + 1]), c});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.ends() < b.ends(); });
  std::vector<std::uint32_t> touching;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].ends() != sides[i - 1].ends()) continue;
    if (haveCommonFacet(sides[i].chain, sides[i - 1].chain)) continue;
    touching.insert(touching.end(), {sides[i].chain, sides[i - 1].chain});
  }
  std::erase_if(touching, [&](std::uint32_t c) { return chains_[c].tolerance == 0.0; });
  sortUnique(touching);
  return touching;
}

bool FacetChains::haveCommonFacet(std::uint32_t a, std::uint32_t b) const {
  const std::vector<Beside>& others = chains_[b].facets;
  return std::any_of(chains_[a].facets.begin(), chains_[a].facets.end(), [&](const Beside& x) {
    return std::any_of(others.begin(), others.end(),
                       [&](const Beside& y) { return x.facet == y.facet; });
  });
}

std::vector<Side> FacetChains::sidesOf(std::uint32_t facet) const {
  std::vector<Side> sides;
  for (const std::uint32_t c : ofFacet_[facet]) {
    const std::vector<std::uint32_t>& kept = chains_[c].kept;
    for (const Beside& beside : chains_[c].facets) {
      if (beside.facet != facet) continue;
      for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
        sides.push_back(beside.isForward ? Side{kept[i], kept[i + 1], c}
                                         : Side{kept[i + 1], kept[i], c});
      }
    }
  }
  const auto isBefore = [](const Side& a, const Side& b) { return a.ends() < b.ends(); };
  std::sort(sides.begin(), sides.end(), isBefore);
  std::vector<Side> left;
  for (const Side& side : sides) {
    if (!std::binary_search(sides.begin(), sides.end(), Side{side.to, side.from}, isBefore)) {
      left.push_back(side);
    }
  }
  return left;
}

void FacetChains::refine(std::span<const std::uint32_t> chains,
                         std::vector<std::uint32_t>& facets) {
  for (const std::uint32_t c : chains) {
    Chain& chain = chains_[c];
    if (chain.tolerance == 0.0) continue;
    const double finer = kFiner * chain.tolerance;
    setTolerance(chain, finer < kFinest * chain.own ? 0.0 : finer);
    for (const Beside& beside : chain.facets) facets.push_back(beside.facet);
  }
}

void FacetChains::keepAll(std::span<const std::uint32_t> chains,
                          std::vector<std::uint32_t>& facets) {
  for (const std::uint32_t c : chains) {
    Chain& chain = chains_[c];
    if (chain.tolerance == 0.0) continue;
    setTolerance(chain, 0.0);
    for (const Beside& beside : chain.facets) facets.push_back(beside.facet);
  }
}

}  // namespace sherd
