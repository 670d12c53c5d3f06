// Counter-based random numbers: a hash of (seed, stage, item), never a shared generator.
#pragma once

#include <cstdint>

namespace sherd {

/// A bijection of 64 bits that looks random.
/// source  Steele, Lea, Flood, Fast Splittable Pseudorandom Number Generators, 2014 (the finalizer
/// of SplitMix64)
constexpr std::uint64_t mixed(std::uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9u;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// What a number is drawn for: two stages never share a number.
enum class Stage : std::uint64_t {
  seedVoxel = 1,
  partSeed = 2,
  fragmentId = 3,
  erosion = 16,
  reseed = 20,
  noise = 22,
  again = 23,
  haltonDigit = 32,
  gaussianSeed = 33,
  poissonDart = 34,
  impactPlace = 35,
  impactSeed = 36,  // makes a seed of its own for each impact, from which the next two draw
  impactOffset = 37,
  impactRest = 38,
  convexitySample = 64,
  fitPiece = 65,  // makes a seed of its own for each fragment, 0 the whole, for points and the next
  fitSpace = 66,
  pointPiece = 80,  // makes a seed of its own for each fragment, 0 the whole, from which these draw
  pointPlace = 81,
  pointDigit = 82,
  pointShuffle = 83,
  pointCandidate = 84,
  spacePlace = 85,
  spaceSurface = 86,
  spaceOffset = 87,
  pointContact = 88,
  datasetObject = 96,    // makes a seed of its own for each object of a library, and the next
  datasetFracture = 97,  // one for each of its fractures
  datasetOption = 98,
  datasetPose = 99,
  datasetSplit = 100
};

/// 64 random bits of one item.
constexpr std::uint64_t randomBits(std::uint64_t seed, Stage stage, std::uint64_t item) {
  return mixed(mixed(mixed(seed + 0x9e3779b97f4a7c15u) + static_cast<std::uint64_t>(stage)) + item);
}

/// A number of [0, 1), a multiple of 2^-53.
constexpr double randomUnit(std::uint64_t seed, Stage stage, std::uint64_t item) {
  return static_cast<double>(randomBits(seed, stage, item) >> 11) * 0x1p-53;
}

/// A number 0..count-1, each as likely to within count / 2^64.
constexpr std::uint64_t randomBelow(std::uint64_t count, std::uint64_t seed, Stage stage,
                                    std::uint64_t item) {
  __extension__ using Wide = unsigned __int128;
  return static_cast<std::uint64_t>((static_cast<Wide>(randomBits(seed, stage, item)) * count) >>
                                    64);
}

}  // namespace sherd
