// Squared distances in integers, so that voxels agree with growth to the last tie.
#include "surface/site_cut.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>

#include "grow/metric.h"

namespace sherd {
namespace {

constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();

struct Nearest {
  std::int64_t squared = kFar;
  glm::i64vec3 site{0};
};

Nearest nearestOf(std::span<const glm::i64vec3> sites, const glm::i64vec3& at) {
  Nearest nearest;
  for (const glm::i64vec3& site : sites) {
    const glm::i64vec3 d = at - site;
    const std::int64_t squared = d.x * d.x + d.y * d.y + d.z * d.z;
    if (squared < nearest.squared) nearest = {squared, site};
  }
  return nearest;
}

// The sites that can be the nearest of theirs somewhere in a leaf's halo.
std::vector<glm::i64vec3> nearLeaf(std::span<const glm::i64vec3> sites,
                                   const openvdb::Coord& origin, const Sites& all) {
  std::vector<glm::i64vec3> near(sites.begin(), sites.end());
  if (near.size() < 2) return near;
  // No voxel of the halo is farther from its middle one than a corner is.
  const glm::dvec3 middle(all.stretched(origin + openvdb::Coord(4)));
  double reach = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const auto end = [&](int bit) { return (corner & bit) != 0 ? 7 + kCutHalo : -kCutHalo; };
    const openvdb::Coord at = origin + openvdb::Coord(end(4), end(2), end(1));
    reach = std::max(reach, glm::length(glm::dvec3(all.stretched(at)) - middle));
  }
  const auto distance = [&](const glm::i64vec3& site) {
    return glm::length(glm::dvec3(site) - middle);
  };
  double least = std::numeric_limits<double>::infinity();
  for (const glm::i64vec3& site : near) least = std::min(least, distance(site));
  std::erase_if(near, [&](const glm::i64vec3& site) {
    return distance(site) > (least + 2.0 * reach) * (1.0 + 1e-9);
  });
  return near;
}

// Rows of bits, each spread by the halo's width along all axes: the leaf's own part.
std::array<std::uint8_t, 64> spread(const std::array<std::uint16_t, kCutSide * kCutSide>& rows) {
  std::array<std::uint8_t, 64> out{};
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      unsigned bits = 0;
      for (int i = x; i <= x + 2 * kCutHalo; ++i) {
        for (int j = y; j <= y + 2 * kCutHalo; ++j) {
          bits |= rows[static_cast<std::size_t>(i * kCutSide + j)];
        }
      }
      for (int k = 1; k <= 2 * kCutHalo; k *= 2) bits |= bits >> k | bits >> 1;
      out[static_cast<std::size_t>(x * 8 + y)] = static_cast<std::uint8_t>(bits);
    }
  }
  return out;
}

}  // namespace

Sites::Sites(const VoronoiSites& sites) {
  if (sites.seeds.empty()) return;
  const sherd_metric metric = metricFor(Metric::euclidean, sites.grain);
  for (std::size_t i = 0; i < 9; ++i) rows_[i] = metric.row[i];
  std::vector<Seed> seeds = sites.seeds;
  std::stable_sort(seeds.begin(), seeds.end(),
                   [](const Seed& a, const Seed& b) { return a.fragment < b.fragment; });
  first_.assign(std::size_t{seeds.back().fragment} + 2, 0);
  for (const Seed& seed : seeds) {
    ++first_[seed.fragment + 1u];
    sites_.push_back(stretched(seed.voxel));
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
}

glm::i64vec3 Sites::stretched(const openvdb::Coord& voxel) const {
  const auto row = [&](std::size_t i) {
    return rows_[3 * i] * voxel.x() + rows_[3 * i + 1] * voxel.y() + rows_[3 * i + 2] * voxel.z();
  };
  return {row(0), row(1), row(2)};
}

std::span<const glm::i64vec3> Sites::of(std::uint16_t fragment) const {
  if (fragment + std::size_t{1} >= first_.size()) return {};
  return std::span(sites_).subspan(first_[fragment], first_[fragment + 1u] - first_[fragment]);
}

double Sites::slope(const glm::i64vec3& a, const glm::i64vec3& b) const {
  const glm::dvec3 d(a - b);
  glm::dvec3 gradient(0.0);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      gradient[static_cast<int>(column)] +=
          static_cast<double>(rows_[3 * row + column]) * d[static_cast<int>(row)];
    }
  }
  return 2.0 * glm::length(gradient);
}

bool SiteCut::holdsEverywhere() const {
  return std::all_of(holds.begin(), holds.end(), [](std::uint8_t row) { return row == 0xff; });
}

namespace {

// Slopes between pairs of fragments; neighbouring voxels mostly have the same nearest sites.
class Slopes {
 public:
  Slopes(const Sites& sites, std::size_t fragments)
      : sites_(sites), count_(fragments), known_(fragments * fragments) {}

  double between(std::size_t a, std::size_t b, const Nearest& from, const Nearest& to) {
    Known& known = known_[a * count_ + b];
    if (known.a != from.site || known.b != to.site || known.slope == 0.0) {
      known = {from.site, to.site, sites_.slope(from.site, to.site)};
    }
    return known.slope;
  }

 private:
  struct Known {
    glm::i64vec3 a{0}, b{0};
    double slope = 0.0;
  };
  const Sites& sites_;
  std::size_t count_;
  std::vector<Known> known_;
};

}  // namespace

SiteCut siteCut(const CutHalo& halo, const openvdb::Coord& origin,
                std::span<const std::uint16_t> fragments, const Sites& sites) {
  SiteCut cut;
  cut.distance.assign(fragments.size() * 512, 3.0f);
  std::vector<std::vector<glm::i64vec3>> sitesOf;
  for (const std::uint16_t fragment : fragments) {
    sitesOf.push_back(nearLeaf(sites.of(fragment), origin, sites));
  }
  std::vector<Nearest> nearest(fragments.size());
  Slopes slopes(sites, fragments.size());
  std::array<std::uint16_t, kCutSide * kCutSide> wrong{};
  std::size_t i = 0;
  for (int x = -kCutHalo; x < 8 + kCutHalo; ++x) {
    for (int y = -kCutHalo; y < 8 + kCutHalo; ++y) {
      for (int z = -kCutHalo; z < 8 + kCutHalo; ++z, ++i) {
        const bool own = ((x | y | z) & ~7) == 0;
        const std::uint16_t label = halo[i];
        if (!own && label == 0) continue;
        const glm::i64vec3 at = sites.stretched(origin + openvdb::Coord(x, y, z));
        std::int64_t least = kFar;
        for (std::size_t k = 0; k < sitesOf.size(); ++k) {
          nearest[k] = nearestOf(sitesOf[k], at);
          least = std::min(least, nearest[k].squared);
        }
        if (label != 0) {
          const auto k = static_cast<std::size_t>(
              std::find(fragments.begin(), fragments.end(), label) - fragments.begin());
          if (k == fragments.size() || nearest[k].squared == kFar || nearest[k].squared != least) {
            wrong[i / kCutSide] |= static_cast<std::uint16_t>(1u << (i % kCutSide));
          }
        }
        if (!own) continue;
        for (std::size_t k = 0; k < fragments.size(); ++k) {
          if (nearest[k].squared == kFar) continue;
          // The plane towards the next nearest site need not be the nearest plane: sites may lie
          // close together.
          double d = -3.0;
          for (std::size_t other = 0; other < fragments.size(); ++other) {
            const Nearest& rival = nearest[other];
            if (other == k || rival.squared == kFar) continue;
            const double slope = slopes.between(k, other, nearest[k], rival);
            const double difference = static_cast<double>(nearest[k].squared - rival.squared);
            d = std::max(d, slope > 0.0 ? difference / slope : 0.0);
          }
          cut.distance[k * 512 + offsetFromCoord({x, y, z})] = static_cast<float>(std::min(d, 3.0));
        }
      }
    }
  }
  const std::array<std::uint8_t, 64> fails = spread(wrong);
  for (std::size_t row = 0; row < 64; ++row) {
    cut.holds[row] = static_cast<std::uint8_t>(~fails[row]);
  }
  return cut;
}

}  // namespace sherd
