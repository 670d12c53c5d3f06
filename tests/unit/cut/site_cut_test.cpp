// The cut between Voronoi cells, against planes.
#include "cut/site_cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/random.h"

namespace sherd {
namespace {

// How far a point lies beyond the plane half way from `own` to `other`.
double beyondSite(const glm::dvec3& p, const glm::dvec3& own, const glm::dvec3& other) {
  return glm::dot(p - 0.5 * (own + other), glm::normalize(other - own));
}

TEST(SiteCut, GoesByTheNearestPlaneAndNotByTheNearestSite) {
  // Two sites are neighbors: inside the first cell the second site is nearly always the next
  // nearest, but the plane towards a third is often nearer.
  const std::vector<glm::ivec3> sites{{1, 3, 4}, {0, 3, 4}, {9, 5, 3}, {4, 11, 6}};
  VoronoiSites voronoi;
  std::vector<std::uint16_t> fragments;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    fragments.push_back(static_cast<std::uint16_t>(i + 1));
    Seed seed;
    seed.voxel = openvdb::Coord(sites[i].x, sites[i].y, sites[i].z);
    seed.fragment = fragments.back();
    voronoi.seeds.push_back(seed);
  }
  CutHalo halo{};
  std::size_t at = 0;
  for (int x = -kCutHalo; x < 8 + kCutHalo; ++x) {
    for (int y = -kCutHalo; y < 8 + kCutHalo; ++y) {
      for (int z = -kCutHalo; z < 8 + kCutHalo; ++z) {
        std::size_t nearest = 0;
        const auto squared = [&](std::size_t i) {
          const glm::ivec3 d = sites[i] - glm::ivec3(x, y, z);
          return d.x * d.x + d.y * d.y + d.z * d.z;
        };
        for (std::size_t i = 1; i < sites.size(); ++i) {
          if (squared(i) < squared(nearest)) nearest = i;
        }
        halo[at++] = fragments[nearest];
      }
    }
  }
  VoxelBits all;
  all.fill(0xff);
  const SiteCut cut = siteCut(halo, {0, 0, 0}, fragments, Sites(voronoi), all);
  EXPECT_EQ(cut.holds, all);
  std::size_t notByTheNextSite = 0;
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      for (int z = 0; z < 8; ++z) {
        const glm::dvec3 p(x, y, z);
        const auto v = static_cast<std::size_t>(x * 64 + y * 8 + z);
        for (std::size_t k = 0; k < sites.size(); ++k) {
          double most = -3.0;
          for (std::size_t other = 0; other < sites.size(); ++other) {
            if (other != k) most = std::max(most, beyondSite(p, sites[k], sites[other]));
          }
          EXPECT_NEAR(cut.distance[k * 512 + v], std::min(most, 3.0), 1e-6)
              << x << ' ' << y << ' ' << z;
        }
        notByTheNextSite += beyondSite(p, sites[0], sites[2]) < 0.0 &&
                            beyondSite(p, sites[0], sites[2]) > beyondSite(p, sites[0], sites[1]);
      }
    }
  }
  EXPECT_GT(notByTheNextSite, 50u);
}

// Planes between weighted sites: |p - a|^2 - u = |p - b|^2 - v.
TEST(SiteCut, PlanesMoveByTheWeights) {
  const std::vector<glm::ivec3> sites{{1, 3, 4}, {0, -2, 4}, {9, 5, 3}, {4, 11, 6}};
  const std::vector<double> weights{10.5, -3.0, 20.25, 0.0};  // voxels squared
  VoronoiSites voronoi;
  std::vector<std::uint16_t> fragments;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    fragments.push_back(static_cast<std::uint16_t>(i + 1));
    Seed seed;
    seed.voxel = openvdb::Coord(sites[i].x, sites[i].y, sites[i].z);
    seed.fragment = fragments.back();
    seed.weight = static_cast<std::int64_t>(weights[i] * kSeedSteps * kSeedSteps);
    voronoi.seeds.push_back(seed);
  }
  const auto power = [&](std::size_t i, const glm::dvec3& p) {
    const glm::dvec3 d = p - glm::dvec3(sites[i]);
    return glm::dot(d, d) - weights[i];
  };
  CutHalo halo{};
  std::size_t at = 0;
  for (int x = -kCutHalo; x < 8 + kCutHalo; ++x) {
    for (int y = -kCutHalo; y < 8 + kCutHalo; ++y) {
      for (int z = -kCutHalo; z < 8 + kCutHalo; ++z) {
        std::size_t nearest = 0;
        for (std::size_t i = 1; i < sites.size(); ++i) {
          if (power(i, {x, y, z}) < power(nearest, {x, y, z})) nearest = i;
        }
        halo[at++] = fragments[nearest];
      }
    }
  }
  VoxelBits all;
  all.fill(0xff);
  const SiteCut cut = siteCut(halo, {0, 0, 0}, fragments, Sites(voronoi), all);
  EXPECT_EQ(cut.holds, all);
  for (int v = 0; v < 512; ++v) {
    const glm::dvec3 p(v / 64, v / 8 % 8, v % 8);
    for (std::size_t k = 0; k < sites.size(); ++k) {
      double most = -3.0;
      for (std::size_t other = 0; other < sites.size(); ++other) {
        if (other == k) continue;
        const double apart = glm::length(glm::dvec3(sites[other] - sites[k]));
        most = std::max(most, (power(k, p) - power(other, p)) / (2.0 * apart));
      }
      EXPECT_NEAR(cut.distance[k * 512 + static_cast<std::size_t>(v)], std::min(most, 3.0), 1e-6);
    }
  }
}

// A leaf and those around it, all inside, by x, y, z.
std::shared_ptr<const LeafBlocks> blocksAround() {
  auto blocks = std::make_shared<LeafBlocks>();
  for (int i = 0; i < 27; ++i) {
    blocks->origins.emplace_back(8 * (i / 9 - 1), 8 * (i / 3 % 3 - 1), 8 * (i % 3 - 1));
  }
  blocks->inside.assign(std::size_t{27} * 8, ~std::uint64_t{0});
  return blocks;
}

// The cut of sites in walls, voxel by voxel, against brute force.
//   fragments  1, 2, ... of the sites
void expectCutInWalls(const VoronoiSites& voronoi, std::span<const std::uint16_t> fragments,
                      const std::shared_ptr<const WallMiddles>& walls) {
  const auto middleAt = [&](int x, int y, int z) {
    return glm::dvec3(WaysAround(walls.get(), {0, 0, 0}).middleAt({x, y, z})) / 64.0;
  };
  const auto nearestOf = [&](const glm::dvec3& p, std::uint16_t fragment) {
    const Seed* best = nullptr;
    double least = 1e300;
    for (const Seed& seed : voronoi.seeds) {
      const glm::dvec3 d = p - pointOf(seed);
      if (seed.fragment != fragment || glm::dot(d, d) >= least) continue;
      least = glm::dot(d, d);
      best = &seed;
    }
    return std::pair(least, pointOf(*best));
  };
  CutHalo halo{};
  for (std::size_t v = 0; v < halo.size(); ++v) {
    const auto at = [&](std::size_t i) { return static_cast<int>(i % kCutSide) - kCutHalo; };
    const glm::dvec3 p = middleAt(at(v / kCutSide / kCutSide), at(v / kCutSide), at(v));
    halo[v] = fragments.front();
    for (const std::uint16_t own : fragments) {
      if (nearestOf(p, own).first < nearestOf(p, halo[v]).first) halo[v] = own;
    }
  }
  VoxelBits all;
  all.fill(0xff);
  const SiteCut cut = siteCut(halo, {0, 0, 0}, fragments, Sites(voronoi, walls), all);
  EXPECT_EQ(cut.holds, all);
  for (int v = 0; v < 512; ++v) {
    const glm::dvec3 p = middleAt(v / 64, v / 8 % 8, v % 8);
    for (std::size_t k = 0; k < fragments.size(); ++k) {
      const auto [own, from] = nearestOf(p, fragments[k]);
      double most = -3.0;
      for (const std::uint16_t other : fragments) {
        if (other == fragments[k]) continue;
        const auto [squared, to] = nearestOf(p, other);
        most = std::max(most, (own - squared) / (2.0 * glm::length(to - from)));
      }
      EXPECT_NEAR(cut.distance[k * 512 + static_cast<std::size_t>(v)], std::min(most, 3.0), 1e-5);
    }
  }
}

// In a wall across x every point is at its middle: the crack is the same at every x.
TEST(SiteCut, WallsBendPlanes) {
  const auto blocks = blocksAround();
  std::vector<std::int16_t> ways(std::size_t{27} * 512 * 3, 0);
  for (std::size_t v = 0; v < std::size_t{27} * 512; ++v) {
    ways[3 * v] = static_cast<std::int16_t>(64 * (3 - blocks->voxelAt(v).x()));
  }
  VoronoiSites voronoi;
  voronoi.seeds = {{{3, 1, 2}, 1, {-20, 0, 0}}, {{3, 6, 4}, 2, {20, 0, 0}}};
  expectCutInWalls(voronoi, std::vector<std::uint16_t>{1, 2},
                   std::make_shared<const WallMiddles>(blocks, ways));
}

// Several sites of each fragment, some near the leaf only by the ways of its voxels.
TEST(SiteCut, WaysMayLeadFarAway) {
  const auto blocks = blocksAround();
  const auto drawn = [](std::uint64_t i, int most) {
    return static_cast<int>(randomBits(7, Stage::noise, i) % static_cast<unsigned>(2 * most + 1)) -
           most;
  };
  std::vector<std::int16_t> ways;
  for (std::uint64_t i = 0; i < 27 * 512 * 3; ++i) {
    ways.push_back(static_cast<std::int16_t>(drawn(i, 64 * 12)));
  }
  VoronoiSites voronoi;
  for (std::uint64_t i = 0; i < 40; ++i) {
    const auto at = [&](std::uint64_t axis) { return drawn(100000 + 3 * i + axis, 14); };
    voronoi.seeds.push_back({{at(0), at(1), at(2)}, static_cast<std::uint16_t>(1 + i % 5)});
  }
  expectCutInWalls(voronoi, std::vector<std::uint16_t>{1, 2, 3, 4, 5},
                   std::make_shared<const WallMiddles>(blocks, ways));
}

// Sites on a lattice, each moved by less than a voxel, numbered from 1; and their fragments.
VoronoiSites lattice(int spacing, int halo, std::vector<std::uint16_t>& fragments) {
  VoronoiSites voronoi;
  for (int x = -halo; x < 8 + halo; x += spacing) {
    for (int y = -halo; y < 8 + halo; y += spacing) {
      for (int z = -halo; z < 8 + halo; z += spacing) {
        fragments.push_back(static_cast<std::uint16_t>(fragments.size() + 1));
        Seed seed;
        const int shift = spacing > 1 ? (7 * x + 3 * y + 5 * z) & 1 : 0;
        seed.voxel = openvdb::Coord(x + shift, y, z);
        seed.fragment = fragments.back();
        voronoi.seeds.push_back(seed);
      }
    }
  }
  return voronoi;
}

// Each distance is the greatest over the planes towards all other sites, but few are evaluated:
// however many small fragments a leaf has, a distance costs the same.
TEST(SiteCut, ADistanceOfManySmallCellsTakesFewPlanes) {
  VoxelBits all;
  all.fill(0xff);
  for (const int spacing : {4, 3, 2, 1}) {
    std::vector<std::uint16_t> fragments;
    const VoronoiSites voronoi = lattice(spacing, kCutHalo, fragments);
    SiteCutWork work;
    // Labels don't matter here.
    const SiteCut cut = siteCut(CutHalo{}, {0, 0, 0}, fragments, Sites(voronoi), all, &work);
    EXPECT_EQ(work.distances, 512 * fragments.size());
    EXPECT_LT(work.planes, 16 * work.distances) << fragments.size() << " fragments";
    for (std::size_t k = 0; k < fragments.size(); k += 1 + fragments.size() / 40) {
      for (std::size_t v = 0; v < 512; v += 13) {
        const auto at = [](const openvdb::Coord& c) { return glm::dvec3(c.x(), c.y(), c.z()); };
        const glm::dvec3 p = at(coordFromOffset(static_cast<std::uint32_t>(v)));
        double most = -3.0;
        for (std::size_t other = 0; other < fragments.size(); ++other) {
          if (other == k) continue;
          most = std::max(
              most, beyondSite(p, at(voronoi.seeds[k].voxel), at(voronoi.seeds[other].voxel)));
        }
        ASSERT_NEAR(cut.distance[k * 512 + v], std::min(most, 3.0), 1e-6) << k << ' ' << v;
      }
    }
  }
}

// Many planes of sites on a grid are equally near, and of those none may be passed over.
TEST(SiteCut, ADistanceIsTheGreatestOfAllPlanesWhereManyAreEquallyNear) {
  VoxelBits all;
  all.fill(0xff);
  for (std::uint64_t draw = 0; draw < 6; ++draw) {
    const std::size_t count = 33 + 40 * draw;
    VoronoiSites voronoi;
    std::vector<std::uint16_t> fragments;
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto along = [&](std::uint64_t axis) {
        return static_cast<int>(mixed((draw * 1000 + i) * 3 + axis) % 12) - kCutHalo;
      };
      fragments.push_back(static_cast<std::uint16_t>(i + 1));
      Seed seed;
      seed.voxel = openvdb::Coord(along(0), along(1), along(2));
      seed.fragment = fragments.back();
      voronoi.seeds.push_back(seed);
    }
    const SiteCut cut = siteCut(CutHalo{}, {0, 0, 0}, fragments, Sites(voronoi), all);
    const auto at = [](const openvdb::Coord& c) { return glm::dvec3(c.x(), c.y(), c.z()); };
    for (std::size_t k = 0; k < count; ++k) {
      for (std::uint32_t v = 0; v < 512; ++v) {
        double most = -3.0;
        for (std::size_t other = 0; other < count; ++other) {
          const glm::dvec3 own = at(voronoi.seeds[k].voxel),
                           theirs = at(voronoi.seeds[other].voxel);
          if (other == k) continue;
          most =
              std::max(most, own == theirs ? 0.0 : beyondSite(at(coordFromOffset(v)), own, theirs));
        }
        ASSERT_NEAR(cut.distance[k * 512 + v], std::min(most, 3.0), 1e-6) << draw << ' ' << k;
      }
    }
  }
}

TEST(SiteCut, HoldsWhereNoVoxelUpToTwoAwayIsAnothers) {
  Seed a, b;
  a.voxel = openvdb::Coord(-20, 3, 4);
  a.fragment = 1;
  b.voxel = openvdb::Coord(60, 3, 4);
  b.fragment = 2;
  VoronoiSites voronoi;
  voronoi.seeds = {a, b};
  const Sites sites(voronoi);
  const std::vector<std::uint16_t> fragments{1, 2};
  VoxelBits all;
  all.fill(0xff);
  for (const openvdb::Coord& other : {openvdb::Coord(4, 4, 4), openvdb::Coord(0, 7, 1),
                                      openvdb::Coord(-2, 9, 3), openvdb::Coord(9, -1, -2)}) {
    CutHalo halo;
    halo.fill(1);  // the whole halo is nearest to the first
    const openvdb::Coord from = other + openvdb::Coord(kCutHalo);
    halo[static_cast<std::size_t>((from.x() * kCutSide + from.y()) * kCutSide + from.z())] = 2;
    const SiteCut cut = siteCut(halo, {0, 0, 0}, fragments, sites, all);
    for (std::uint32_t v = 0; v < 512; ++v) {
      const openvdb::Coord d = coordFromOffset(v) - other;
      const int away = std::max({std::abs(d.x()), std::abs(d.y()), std::abs(d.z())});
      const bool holds = (cut.holds[v >> 3] >> (v & 7)) & 1;
      EXPECT_EQ(holds, away > 2) << other << ' ' << coordFromOffset(v);
    }
  }
}

}  // namespace
}  // namespace sherd
