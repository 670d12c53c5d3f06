// Rejects fractures that are too similar to earlier ones.
#include "dataset/distinct.h"

#include <algorithm>
#include <tuple>

namespace sherd {
namespace {

constexpr std::uint64_t kMostVoxels = 131'072;

std::vector<std::uint16_t> sampled(const Labels& labels) {
  const LeafBlocks& blocks = *labels.blocks;
  const std::uint64_t voxels = blocks.insideVoxels();
  const std::uint64_t taken = std::min(voxels, kMostVoxels);
  std::vector<std::uint16_t> sample;
  sample.reserve(taken);
  std::uint64_t visited = 0;
  blocks.forEachInside([&](std::size_t voxel) {
    // The k-th of `taken` is voxel k * voxels / taken.
    if (visited * taken / voxels == sample.size() && sample.size() < taken) {
      sample.push_back(labels.fragment[voxel]);
    }
    ++visited;
  });
  return sample;
}

// Counts voxels on which matched fragments agree.
std::size_t agreeing(const std::vector<std::uint16_t>& a, std::size_t fragmentsA,
                     const std::vector<std::uint16_t>& b, std::size_t fragmentsB) {
  const std::size_t width = fragmentsB + 1;
  std::vector<std::uint32_t> overlap((fragmentsA + 1) * width, 0);
  std::size_t eroded = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] > fragmentsA || b[i] > fragmentsB) {
      eroded += a[i] == b[i];
    } else {
      ++overlap[a[i] * width + b[i]];
    }
  }
  std::vector<std::tuple<std::uint32_t, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 1; i <= fragmentsA; ++i) {
    for (std::size_t j = 1; j <= fragmentsB; ++j) {
      if (overlap[i * width + j] > 0) pairs.emplace_back(overlap[i * width + j], i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end(), std::greater<>());
  std::vector<bool> takenA(fragmentsA + 1, false), takenB(fragmentsB + 1, false);
  std::size_t agree = eroded;
  for (const auto& [count, i, j] : pairs) {
    if (takenA[i] || takenB[j]) continue;
    takenA[i] = takenB[j] = true;
    agree += count;
  }
  return agree;
}

}  // namespace

bool Distinct::add(const Labels& labels, double share, bool always) {
  Sample sample{sampled(labels), labels.fragmentCount};
  const auto isClose = [&](const Sample& other) {
    const std::size_t agree = agreeing(sample.labels, static_cast<std::size_t>(sample.fragments),
                                       other.labels, static_cast<std::size_t>(other.fragments));
    return static_cast<double>(sample.labels.size() - agree) <
           share * static_cast<double>(sample.labels.size());
  };
  const bool isNew = always || std::none_of(samples_.begin(), samples_.end(), isClose);
  if (isNew) samples_.push_back(std::move(sample));
  return isNew;
}

}  // namespace sherd
