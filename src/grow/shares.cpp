// Sizes of fragments.  Every growth starts afresh from seeds, so the result is one of growth alone.
#include <sherd/error.h>
#include <sherd/shares.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

#include "base/random.h"

namespace sherd {
namespace {

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100.0 * share);
  return text;
}

void check(const ShareOptions& options, const Parts& parts, int fragments, std::uint64_t voxels) {
  if (!(options.minShare >= 0.0 && options.minShare <= 1.0)) {
    throw Error(ErrorCode::usage, "the least share lies in 0..1");
  }
  if (options.balance < 0 || options.balance > 100) {
    throw Error(ErrorCode::usage, "the steps of balance lie in 0..100");
  }
  if (options.minShare * fragments > 1.0) {
    throw Error(ErrorCode::usage, std::to_string(fragments) + " fragments cannot each have " +
                                      percent(options.minShare) + " of the solid");
  }
  for (const std::uint64_t part : parts.voxels) {
    const double share = static_cast<double>(part) / static_cast<double>(voxels);
    if (share >= options.minShare) continue;
    throw Error(ErrorCode::usage, "a separate part of the solid has " + percent(share) +
                                      " of it, so no fragment can have at least " +
                                      percent(options.minShare) + " there");
  }
}

// `small` without those whose part of the solid would lose its last seed.
std::vector<std::uint16_t> withoutLastOfParts(const LeafBlocks& blocks, const Parts& parts,
                                              const std::vector<Seed>& seeds,
                                              std::vector<std::uint16_t> small) {
  const auto partOf = [&](const Seed& s) {
    return parts.at(std::size_t{findLeaf(blocks, s.voxel)} * 512 + offsetFromCoord(s.voxel));
  };
  const std::set<std::uint16_t> lost(small.begin(), small.end());
  std::set<std::uint32_t> seeded;
  for (const Seed& s : seeds) {
    if (!lost.count(s.fragment)) seeded.insert(partOf(s));
  }
  std::erase_if(small,
                [&](std::uint16_t id) { return seeded.insert(partOf(seeds[id - 1u])).second; });
  return small;
}

// Replace the seeds of `small` fragments by one new seed each, in what is the largest by then.
// (Not one that would leave its part of the solid without a seed.)
void reseed(const LeafBlocks& blocks, const Parts& parts, const Labels& labels,
            std::vector<Seed>& seeds, std::vector<std::uint16_t> small,
            std::vector<std::uint64_t> voxels, std::uint64_t seed, int attempt) {
  small = withoutLastOfParts(blocks, parts, seeds, std::move(small));
  const std::set<std::uint16_t> lost(small.begin(), small.end());
  const std::size_t primaries = voxels.size() - 1;
  std::erase_if(seeds, [&, i = std::size_t{0}](const Seed& s) mutable {
    return i++ >= primaries && lost.count(s.fragment);  // further seeds of a lost fragment
  });
  std::set<openvdb::Coord> taken;
  for (const Seed& s : seeds) taken.insert(s.voxel);

  // Which voxel of which fragment: its how-manieth, found in one pass below.
  std::vector<std::uint64_t> size = voxels;
  struct Wish {
    std::uint16_t from, id;
    std::uint64_t number;
  };
  std::vector<Wish> wishes;
  for (const std::uint16_t id : small) {
    const auto largest = static_cast<std::size_t>(
        std::max_element(voxels.begin() + 1, voxels.end()) - voxels.begin());
    voxels[largest] /= 2;
    voxels[id] = voxels[largest];
    const auto item = static_cast<std::uint64_t>(attempt) << 16 | id;
    wishes.push_back({static_cast<std::uint16_t>(largest), id,
                      randomBelow(size[largest], seed, Stage::reseed, item)});
  }
  std::vector<std::vector<Wish>> wishesOf(size.size());
  for (const Wish& wish : wishes) wishesOf[wish.from].push_back(wish);
  std::vector<std::uint64_t> met(size.size(), 0);
  blocks.forEachInside([&](std::size_t place) {
    const std::uint16_t label = labels.fragment[place];
    if (label == 0) return;
    const std::uint64_t number = met[label]++;
    for (Wish& wish : wishesOf[label]) {
      if (wish.number != number) continue;
      const openvdb::Coord voxel = blocks.voxelAt(place);
      if (!taken.insert(voxel).second) {
        ++wish.number;  // a seed lies there: the next voxel of the fragment
      } else {
        seeds[wish.id - 1u].voxel = voxel;
      }
    }
  });
}

// Each primary seed moved to the voxel of its fragment that is nearest to the fragment's centroid.
// Further seeds of a fragment stay.
std::vector<Seed> centredSeeds(const LeafBlocks& blocks, const Labels& labels,
                               std::vector<Seed> seeds) {
  struct Sum {
    std::array<std::int64_t, 3> at{};
    std::int64_t count = 0;
    std::int64_t best = -1;
    openvdb::Coord voxel;
  };
  std::size_t fragments = 0;
  for (const Seed& seed : seeds) fragments = std::max<std::size_t>(fragments, seed.fragment);
  std::vector<Sum> sums(fragments + 1);
  blocks.forEachInside([&](std::size_t place) {
    const std::uint16_t label = labels.fragment[place];
    if (label == 0 || label > fragments) return;
    const openvdb::Coord voxel = blocks.voxelAt(place);
    for (std::size_t i = 0; i < 3; ++i) sums[label].at[i] += voxel[static_cast<int>(i)];
    ++sums[label].count;
  });
  for (Sum& sum : sums) {
    for (std::int64_t& c : sum.at) {  // the centroid, rounded to a voxel
      if (sum.count > 0) c = (2 * c + (c < 0 ? -sum.count : sum.count)) / (2 * sum.count);
    }
  }
  std::set<openvdb::Coord> further;  // seeds that stay where they are
  for (std::size_t i = fragments; i < seeds.size(); ++i) further.insert(seeds[i].voxel);
  blocks.forEachInside([&](std::size_t place) {
    const std::uint16_t label = labels.fragment[place];
    if (label == 0 || label > fragments) return;
    Sum& sum = sums[label];
    const openvdb::Coord voxel = blocks.voxelAt(place);
    std::int64_t distance = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int64_t d = voxel[static_cast<int>(i)] - sum.at[i];
      distance += d * d;
    }
    if ((sum.best >= 0 && distance >= sum.best) || further.count(voxel)) return;
    sum.best = distance;
    sum.voxel = voxel;
  });
  for (std::size_t i = 0; i < fragments; ++i) {
    const Sum& sum = sums[seeds[i].fragment];
    if (sum.best >= 0) seeds[i].voxel = sum.voxel;
  }
  return seeds;
}

}  // namespace

SeededLabels growWithShares(const LeafBlocks& blocks, const Parts& parts, std::vector<Seed> seeds,
                            Device& device, const GrowOptions& growOptions,
                            const ShareOptions& shares, std::uint64_t seed,
                            const Progress* progress) {
  const int fragments = fragmentsOf(seeds);
  const std::uint64_t voxels = blocks.insideVoxels();
  check(shares, parts, fragments, voxels);
  const auto least =
      static_cast<std::uint64_t>(std::ceil(shares.minShare * static_cast<double>(voxels) - 1e-9));
  const auto growFrom = [&](const std::vector<Seed>& from) {
    return std::move(grow(blocks, std::span(&from, 1), device, growOptions, progress).front());
  };
  constexpr int kTriesWithoutSteps = 8;

  Labels labels = growFrom(seeds);
  for (int i = 0; i < shares.balance; ++i) {
    seeds = centredSeeds(blocks, labels, std::move(seeds));
    labels = growFrom(seeds);
  }
  std::uint64_t smallest = 0;
  for (int attempt = 0; attempt < std::max(shares.tries, 1); ++attempt) {
    const std::vector<std::uint64_t> counts = countVoxels(blocks, labels, fragments);
    smallest = *std::min_element(counts.begin() + 1, counts.end());
    if (smallest >= least) return {std::move(seeds), std::move(labels)};
    std::vector<std::uint16_t> small;
    for (int id = 1; id <= fragments; ++id) {
      if (counts[static_cast<std::size_t>(id)] < least) {
        small.push_back(static_cast<std::uint16_t>(id));
      }
    }
    reseed(blocks, parts, labels, seeds, std::move(small), counts, seed, attempt);
    if (attempt >= kTriesWithoutSteps) {
      seeds = centredSeeds(blocks, growFrom(seeds), std::move(seeds));
    }
    labels = growFrom(seeds);
  }
  throw Error(ErrorCode::usage,
              "no " + std::to_string(fragments) + " fragments of at least " +
                  percent(shares.minShare) + " were found in " + std::to_string(shares.tries) +
                  " growths, the smallest had " +
                  percent(static_cast<double>(smallest) / static_cast<double>(voxels)) +
                  "; try --balance 8 or fewer pieces");
}

}  // namespace sherd
