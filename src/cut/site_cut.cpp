// Squared distances are integers, so that ties agree with those of growth.
#include "cut/site_cut.h"

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "cut/cut_of_leaf.h"
#include "grow/fields/metric.h"

namespace sherd {
namespace {

constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();

// The sites of a fragment that can be its nearest site somewhere in a leaf's halo.
std::vector<Sites::Site> nearLeaf(std::span<const Sites::Site> sites, const openvdb::Coord& origin,
                                  const Sites& all) {
  std::vector<Sites::Site> near(sites.begin(), sites.end());
  if (near.size() < 2) return near;
  // Corners are the voxels of the halo farthest from its middle, or farther than their points.
  const glm::dvec3 middle(all.stretched(origin + openvdb::Coord(4)));
  const int way = all.walls() == nullptr
                      ? 0
                      : (all.walls()->reach() + WallMiddles::kSteps - 1) / WallMiddles::kSteps;
  double reach = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const auto end = [&](int bit) {
      return (corner & bit) != 0 ? 7 + kCutHalo + way : -kCutHalo - way;
    };
    const openvdb::Coord at = origin + openvdb::Coord(end(4), end(2), end(1));
    reach = std::max(reach, glm::length(glm::dvec3(all.stretched(at)) - middle));
  }
  const auto distance = [&](const Sites::Site& site) {
    return glm::length(glm::dvec3(site.stretched) - middle);
  };
  const bool hasWeights = std::any_of(near.begin(), near.end(),
                                      [&](const auto& s) { return s.weight != sites[0].weight; });
  if (hasWeights) return near;  // they are few: a fragment's own
  double least = std::numeric_limits<double>::infinity();
  for (const Sites::Site& site : near) least = std::min(least, distance(site));
  std::erase_if(near, [&](const Sites::Site& site) {
    return distance(site) > (least + 2.0 * reach) * (1.0 + 1e-9);
  });
  return near;
}

}  // namespace

Sites::Sites(const VoronoiSites& sites, std::shared_ptr<const WallMiddles> walls)
    : walls_(std::move(walls)) {
  if (sites.seeds.empty()) return;
  metric_ = metricFor(Metric::euclidean, sites.anisotropy);
  std::vector<Seed> seeds = sites.seeds;
  std::stable_sort(seeds.begin(), seeds.end(),
                   [](const Seed& a, const Seed& b) { return a.fragment < b.fragment; });
  first_.assign(std::size_t{seeds.back().fragment} + 2, 0);
  for (const Seed& seed : seeds) {
    ++first_[seed.fragment + 1u];
    sites_.push_back(
        {sherd::stretched(metric_, stepsOf(seed)), pointOf(seed), weightIn(metric_, seed.weight)});
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
}

glm::i64vec3 Sites::stretched(const openvdb::Coord& voxel) const {
  return sherd::stretched(metric_, stepsOf(Seed{voxel}));
}

glm::i64vec3 Sites::stretchedSteps(const glm::i64vec3& steps) const {
  return sherd::stretched(metric_, steps);
}

std::span<const Sites::Site> Sites::of(std::uint16_t fragment) const {
  if (fragment + std::size_t{1} >= first_.size()) return {};
  return std::span(sites_).subspan(first_[fragment], first_[fragment + 1u] - first_[fragment]);
}

double Sites::slope(const glm::i64vec3& a, const glm::i64vec3& b) const {
  const glm::dvec3 d(a - b);
  glm::dvec3 gradient(0.0);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      gradient[static_cast<int>(column)] +=
          static_cast<double>(metric_.row[3 * row + column]) * d[static_cast<int>(row)];
    }
  }
  return 2.0 * kSeedSteps * glm::length(gradient);
}

namespace {

// The nearest of a fragment's sites to each voxel of a row of the halo.
struct NearestInRow {
  std::array<std::int64_t, kCutSide> squared;
  std::array<std::size_t, kCutSide> site;  // index
};

//   low    the row's first voxel, stretched
//   step   from a voxel to the next, stretched
//   voxels  the range that is needed
NearestInRow nearestInRow(std::span<const Sites::Site> sites, const glm::i64vec3& low,
                          const glm::i64vec3& step, const std::array<std::size_t, 2>& voxels) {
  const auto dot = [](const glm::i64vec3& a, const glm::i64vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  };
  NearestInRow nearest;
  nearest.squared.fill(kFar);
  nearest.site.fill(0);
  const std::int64_t square = dot(step, step);
  const auto first = static_cast<std::int64_t>(voxels[0]);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const glm::i64vec3 d = low + first * step - sites[i].stretched;
    std::int64_t squared = dot(d, d) - sites[i].weight, growth = 2 * dot(d, step) + square;
    for (std::size_t z = voxels[0]; z < voxels[1]; ++z) {
      if (squared < nearest.squared[z]) {
        nearest.squared[z] = squared;
        nearest.site[z] = i;
      }
      squared += growth;
      growth += 2 * square;
    }
  }
  return nearest;
}

std::int64_t squared(const glm::i64vec3& v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

// The same of points that do not lie in a row.
//   points  [kCutSide] stretched, those of the range
NearestInRow nearestTo(std::span<const Sites::Site> sites, std::span<const glm::i64vec3> points,
                       const std::array<std::size_t, 2>& voxels) {
  NearestInRow nearest;
  nearest.squared.fill(kFar);
  nearest.site.fill(0);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    for (std::size_t z = voxels[0]; z < voxels[1]; ++z) {
      const std::int64_t d = squared(points[z] - sites[i].stretched) - sites[i].weight;
      if (d >= nearest.squared[z]) continue;
      nearest.squared[z] = d;
      nearest.site[z] = i;
    }
  }
  return nearest;
}

// Number of rivals sorted at first; more are rarely needed.
constexpr std::size_t kRivals = 32;

// Well above rounding errors of a plane's distance, well below relevant differences.
constexpr double kRounding = 1e-6;  // voxels

// Computes the cut of one leaf, row by row of its halo.
class SitesOfLeaf {
 public:
  SitesOfLeaf(const openvdb::Coord& origin, std::span<const std::uint16_t> fragments,
              const Sites& sites)
      : all_(sites),
        fragments_(fragments),
        origin_(origin),
        low_(sites.stretched(origin - openvdb::Coord(kCutHalo))),
        steps_{sites.stretched({1, 0, 0}), sites.stretched({0, 1, 0}), sites.stretched({0, 0, 1})},
        nearest_(fragments.size()),
        ways_(sites.walls(), origin) {
    for (const std::uint16_t fragment : fragments) {
      sites_.push_back(nearLeaf(sites.of(fragment), origin, sites));
    }
    rivals_.resize(sites_.size());
    for (std::size_t k = 0; k < sites_.size(); ++k) withSites_ += hasCut(k) ? 1u : 0u;
    for (std::size_t k = 0; k < sites_.size(); ++k) {
      if (hasCut(k)) findRivals(k, kRivals);
    }
  }

  //   voxels  the range of z that is needed
  void setRow(std::size_t x, std::size_t y, const std::array<std::size_t, 2>& voxels) {
    const glm::i64vec3 low =
        low_ + static_cast<std::int64_t>(x) * steps_[0] + static_cast<std::int64_t>(y) * steps_[1];
    row_ = origin_ + openvdb::Coord(static_cast<int>(x), static_cast<int>(y), 0) -
           openvdb::Coord(kCutHalo);
    least_.fill(kFar);
    if (all_.walls() != nullptr) setMiddles(voxels);
    for (std::size_t k = 0; k < sites_.size(); ++k) {
      nearest_[k] = all_.walls() == nullptr ? nearestInRow(sites_[k], low, steps_[2], voxels)
                                            : nearestTo(sites_[k], stretched_, voxels);
      for (std::size_t z = 0; z < kCutSide; ++z) {
        least_[z] = std::min(least_[z], nearest_[k].squared[z]);
      }
    }
  }

  // True if a nearest site of the row's voxel z has this label.
  bool agrees(std::uint16_t label, std::size_t z) {
    if (found_ >= fragments_.size() || fragments_[found_] != label) {  // adjacent ones mostly agree
      const auto at = std::lower_bound(fragments_.begin(), fragments_.end(), label);
      if (at == fragments_.end() || *at != label) return false;
      found_ = static_cast<std::size_t>(at - fragments_.begin());
    }
    return least_[z] != kFar && nearest_[found_].squared[z] == least_[z];
  }

  bool hasCut(std::size_t k) const { return !sites_[k].empty(); }

  // The distance in voxels, -3..3, of the row's voxel z to the cell of fragment k.  The plane
  // towards the second nearest site need not be the nearest plane, because sites may lie close
  // together.  But a voxel's distance beyond a plane is at most its distance from the site minus
  // the plane's, so planes far from the site are skipped.
  float toCut(std::size_t k, std::size_t z) {
    const double away = glm::length(pointAt(z) - sites_[k][nearest_[k].site[z]].point);
    double d = -3.0;
    for (std::size_t i = 0;; ++i) {
      if (i + 1 == withSites_) break;
      if (i == rivals_[k].size()) findRivals(k, withSites_);
      Rival& rival = rivals_[k][i];
      if (d >= 3.0 || away - rival.plane < d - kRounding) break;
      const double slope = slopeBetween(k, rival, z);
      const auto difference =
          static_cast<double>(nearest_[k].squared[z] - nearest_[rival.other].squared[z]);
      d = std::max(d, slope > 0.0 ? difference / slope : 0.0);
      ++planes_;
    }
    return static_cast<float>(std::min(d, 3.0));
  }

  std::uint64_t planes() const { return planes_; }

 private:
  // Returns the point at which a voxel of the row is compared with sites.
  glm::dvec3 pointAt(std::size_t z) const {
    if (all_.walls() != nullptr) return middles_[z];
    return {row_.x(), row_.y(), row_.z() + static_cast<int>(z)};
  }

  // Sets the middles of the wall at the voxels of the row.
  void setMiddles(const std::array<std::size_t, 2>& voxels) {
    for (std::size_t z = voxels[0]; z < voxels[1]; ++z) {
      const glm::i64vec3 at = ways_.middleAt(row_ + openvdb::Coord(0, 0, static_cast<int>(z)));
      middles_[z] = glm::dvec3(at) / static_cast<double>(WallMiddles::kSteps);
      stretched_[z] = all_.stretchedSteps(at);
    }
  }

  // Another fragment, with the cached slope between the nearest sites of both: adjacent voxels
  // mostly share them.
  struct Rival {
    std::uint32_t other = 0;
    std::uint32_t from = ~std::uint32_t{0}, to = 0;
    double plane = 0.0;  // least distance from a site of this fragment to a plane towards the
                         // other, voxels; negative beyond it
    double slope = 0.0;
  };

  double slopeBetween(std::size_t k, Rival& rival, std::size_t z) const {
    const auto from = static_cast<std::uint32_t>(nearest_[k].site[z]),
               to = static_cast<std::uint32_t>(nearest_[rival.other].site[z]);
    if (rival.from != from || rival.to != to) {
      rival.from = from;
      rival.to = to;
      rival.slope = all_.slope(sites_[k][from].stretched, sites_[rival.other][to].stretched);
    }
    return rival.slope;
  }

  double leastPlane(std::size_t a, std::size_t b) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Sites::Site& one : sites_[a]) {
      for (const Sites::Site& other : sites_[b]) {
        const double slope = all_.slope(one.stretched, other.stretched);
        const auto apart = static_cast<double>(squared(one.stretched - other.stretched) +
                                               one.weight - other.weight);
        least = std::min(least, slope > 0.0 ? apart / slope : 0.0);
      }
    }
    return least;
  }

  // Sets the `most` nearest rivals of a fragment with sites, in a deterministic order.
  void findRivals(std::size_t k, std::size_t most) {
    std::vector<Rival>& rivals = rivals_[k];
    rivals.clear();
    for (std::uint32_t other = 0; other < sites_.size(); ++other) {
      if (other == k || !hasCut(other)) continue;
      rivals.push_back({.other = other, .plane = leastPlane(k, other)});
    }
    const auto end = rivals.begin() + static_cast<std::ptrdiff_t>(std::min(most, rivals.size()));
    std::partial_sort(rivals.begin(), end, rivals.end(), [](const Rival& a, const Rival& b) {
      return a.plane != b.plane ? a.plane < b.plane : a.other < b.other;
    });
    rivals.resize(static_cast<std::size_t>(end - rivals.begin()));
    rivals.shrink_to_fit();
  }

  const Sites& all_;
  std::span<const std::uint16_t> fragments_;
  openvdb::Coord origin_;
  glm::i64vec3 low_;
  std::array<glm::i64vec3, 3> steps_;
  openvdb::Coord row_;                              // its first voxel
  std::array<glm::dvec3, kCutSide> middles_{};      // in walls, of the row's voxels
  std::array<glm::i64vec3, kCutSide> stretched_{};  // the same
  std::vector<std::vector<Sites::Site>> sites_;     // [fragments]
  std::size_t withSites_ = 0;                       // number of fragments with sites
  std::vector<NearestInRow> nearest_;               // [fragments]
  std::array<std::int64_t, kCutSide> least_{};
  std::vector<std::vector<Rival>> rivals_;  // [fragments] by plane, the nearest first
  std::uint64_t planes_ = 0;
  std::size_t found_ = 0;  // fragment of the last label
  WaysAround ways_;
};

}  // namespace

SiteCut siteCut(const CutHalo& halo, const openvdb::Coord& origin,
                std::span<const std::uint16_t> fragments, const Sites& sites,
                const VoxelBits& requested, SiteCutWork* work) {
  SitesOfLeaf ofLeaf(origin, fragments, sites);
  SiteCut cut = cutOfLeaf(halo, fragments.size(), requested, ofLeaf);
  if (work != nullptr) {
    for (const std::uint8_t bits : requested) {
      work->distances += fragments.size() * static_cast<std::size_t>(std::popcount(bits));
    }
    work->planes += ofLeaf.planes();
  }
  return cut;
}

}  // namespace sherd
