// Counter-based random numbers: a hash of (seed, stage, item), never a shared generator.
#pragma once

#include <cstdint>

namespace sherd {

/// A bijective hash of 64 bits.
///   source  Steele, Lea, Flood, Fast Splittable Pseudorandom Number Generators, 2014 (the
///   finalizer
///           of SplitMix64)
constexpr std::uint64_t mixed(std::uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9u;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// The purpose of a random number: stages have independent numbers.
enum class Stage : std::uint64_t {
  seedVoxel = 1,
  componentSeed = 2,
  fragmentId = 3,
  seedPoint = 4,
  erosion = 16,
  reseed = 20,
  reseedPoint = 21,
  noise = 22,
  refracture = 23,
  haltonDigit = 32,
  gaussianSeed = 33,
  poissonDart = 34,
  impactPosition = 35,
  impactSeed = 36,  // derives a seed per impact, used by the next two
  impactOffset = 37,
  impactRest = 38,
  impactVoxel = 39,
  impactPoint = 40,
  fragmentReach = 41,
  pieceSize = 42,
  impactRing = 43,  // jitter of the rows and sectors of an impact
  sizeNudge = 44,
  seedDensity = 45,
  denseVoxel = 46,
  splitPiece = 48,
  splitShare = 49,
  splitOrder = 50,
  splitPart = 51,
  splitAxis = 52,
  splitTilt = 53,
  convexitySample = 64,
  fitFragment = 65,  // derives a seed per fragment, 0: the whole, for points and the next
  fitSpace = 66,
  statisticsExponential = 67,  // derives a seed per simulation, used by itself; so the next two
  statisticsNormal = 68,
  statisticsPower = 69,
  pointFragment = 80,  // derives a seed per fragment, 0: the whole, used by the next ones
  pointPosition = 81,
  pointDigit = 82,
  pointShuffle = 83,
  pointCandidate = 84,
  spacePosition = 85,
  spaceSurface = 86,
  spaceOffset = 87,
  pointContact = 88,
  resampleFragment = 89,  // derives a seed per fragment, used by the next
  resample = 90,
  resampleSlide = 91,
  crackVertex = 92,
  crackJitter = 95,
  mismatch = 103,  // derives a seed per fragment; 0: of both sides
  scanNoise = 104,
  flatPoint = 93,
  datasetObject = 96,    // derives a seed per object of a library
  datasetFracture = 97,  // derives a seed per fracture of an object
  datasetOption = 98,
  datasetPose = 99,
  datasetSplit = 100,
  datasetRedundant = 101,
  datasetMatches = 102  // derives the seed of points that are matched
};

/// 64 random bits of one item.
constexpr std::uint64_t randomBits(std::uint64_t seed, Stage stage, std::uint64_t item) {
  return mixed(mixed(mixed(seed + 0x9e3779b97f4a7c15u) + static_cast<std::uint64_t>(stage)) + item);
}

/// A uniform number in [0, 1), a multiple of 2^-53.
constexpr double randomUnit(std::uint64_t seed, Stage stage, std::uint64_t item) {
  return static_cast<double>(randomBits(seed, stage, item) >> 11) * 0x1p-53;
}

/// A uniform number 0..count-1, with a bias below count / 2^64.
constexpr std::uint64_t randomBelow(std::uint64_t count, std::uint64_t seed, Stage stage,
                                    std::uint64_t item) {
  __extension__ using Wide = unsigned __int128;
  return static_cast<std::uint64_t>((static_cast<Wide>(randomBits(seed, stage, item)) * count) >>
                                    64);
}

}  // namespace sherd
