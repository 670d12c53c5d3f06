// Measures the power of vertices at the frequency of a grid.
#include "evaluate/cracks/grid_trace.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>
#include <tuple>
#include <utility>

#include "base/cancel_flag.h"
#include "base/random.h"

namespace sherd {
namespace {

constexpr std::size_t kMostFragments = 24;
constexpr std::size_t kLeastVertices = 100;  // of a fragment
constexpr std::size_t kMostVertices = 700;
constexpr std::size_t kRandomDirections = 1200;
constexpr std::size_t kSearchDirections = 60000;          // 0.6 degrees apart
constexpr std::size_t kRefined = 30;                      // of these
constexpr double kFirstStep = 0.006, kLastStep = 0.0002;  // of refining, radians
constexpr double kFoundDegrees = 1.0;
constexpr double kLeastPitch = 1.0 / 3.0, kGreatestPitch = 3.0;  // median edges
constexpr std::size_t kMostFrequencies = 4000;
constexpr std::size_t kScanDirections = 12;  // random ones, beside the axes
constexpr int kMostHarmonic = 4;
constexpr double kSameScore = 0.8;     // of the greatest: a lower harmonic is the grid
constexpr double kMostPitches = 1e4;   // of a sample's radius: phases are in single precision
constexpr double kLeastPower = 1e-12;  // logarithms stay finite

const std::array<glm::dvec3, 3> kAxes{glm::dvec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}};

/// Directions spread evenly over a hemisphere, on a spiral.
std::vector<glm::dvec3> hemisphere(std::size_t count) {
  std::vector<glm::dvec3> directions;
  for (std::size_t k = 0; k < count; ++k) {
    const double i = static_cast<double>(k) + 0.5, z = i / static_cast<double>(count);
    const double angle = std::numbers::pi * (1.0 + std::sqrt(5.0)) * i, r = std::sqrt(1.0 - z * z);
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return directions;
}

/// Sums of exp(2 pi i x.d) for so many directions at a time, which the compiler puts in vectors.
constexpr std::size_t kLanes = 32;
using Lanes = std::array<float, kLanes>;

/// Adds the cosine and the sine of 2 pi times a phase, by Taylor's series: the error is 1e-4.
void addTurn(float phase, float& cosine, float& sine) {
  // Adding and subtracting 1.5 * 2^23 rounds to a whole number.
  constexpr float kRound = 12582912.0f, kTurn = 2.0f * std::numbers::pi_v<float>;
  const float angle = (phase - ((phase + kRound) - kRound)) * kTurn, s = angle * angle;
  cosine +=
      1.0f -
      s / 2.0f *
          (1.0f -
           s / 12.0f *
               (1.0f - s / 30.0f * (1.0f - s / 56.0f * (1.0f - s / 90.0f * (1.0f - s / 132.0f)))));
  sine += angle *
          (1.0f -
           s / 6.0f *
               (1.0f -
                s / 20.0f *
                    (1.0f -
                     s / 42.0f * (1.0f - s / 72.0f * (1.0f - s / 110.0f * (1.0f - s / 156.0f))))));
}

/// Writes the powers of up to kLanes directions.
void powersOfSome(const GridPoints& points, std::span<const glm::dvec3> directions, double* power) {
  Lanes dx{}, dy{}, dz{}, cosine{}, sine{};
  for (std::size_t k = 0; k < directions.size(); ++k) {
    dx[k] = static_cast<float>(directions[k].x);
    dy[k] = static_cast<float>(directions[k].y);
    dz[k] = static_cast<float>(directions[k].z);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float x = points.x[i], y = points.y[i], z = points.z[i];
    for (std::size_t k = 0; k < kLanes; ++k) {
      addTurn(x * dx[k] + y * dy[k] + z * dz[k], cosine[k], sine[k]);
    }
  }
  const auto n = static_cast<double>(points.size());
  for (std::size_t k = 0; k < directions.size(); ++k) {
    power[k] = (double{cosine[k]} * cosine[k] + double{sine[k]} * sine[k]) / n;
  }
}

double meanLogarithm(std::span<const double> powers) {
  double sum = 0.0;
  for (const double power : powers) sum += std::log(std::max(power, kLeastPower));
  return sum / static_cast<double>(powers.size());
}

/// Returns the vertices of cracks that no triangle of the original surface has.
std::vector<std::uint32_t> verticesWithinCracks(const DividedMesh& mesh) {
  enum : char { unused, crack, original };
  std::vector<char> kind(mesh.mesh->vertices.size(), unused);
  for (std::size_t t = 0; t < mesh.neighbor.size(); ++t) {
    const glm::uvec3& corners = mesh.mesh->triangles[t];
    for (const std::uint32_t v : {corners.x, corners.y, corners.z}) {
      if (mesh.neighbor[t] == 0) {
        kind[v] = original;
      } else if (kind[v] == unused) {
        kind[v] = crack;
      }
    }
  }
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < kind.size(); ++v) {
    if (kind[v] == crack) vertices.push_back(v);
  }
  return vertices;
}

/// The vertices of one fragment that are measured, about their mean, world units.
using Sample = std::vector<glm::dvec3>;

Sample sampleOf(const DividedMesh& mesh) {
  const std::vector<std::uint32_t> vertices = verticesWithinCracks(mesh);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;  // in a random order
  for (const std::uint32_t v : vertices) order.emplace_back(mixed(v + 1u), v);
  std::sort(order.begin(), order.end());
  order.resize(std::min(order.size(), kMostVertices));
  Sample sample;
  glm::dvec3 mean(0.0);
  const glm::dvec3 first = mesh.mesh->vertices[order.front().second];
  for (const auto& [random, v] : order) sample.push_back(mesh.mesh->vertices[v] - first);
  for (const glm::dvec3& p : sample) mean += p / static_cast<double>(sample.size());
  for (glm::dvec3& p : sample) p -= mean;
  return sample;
}

/// Returns the samples of fragments evenly spread over the order of those that have enough
/// vertices.
std::vector<Sample> samplesOf(std::span<const DividedMesh> meshes, const Progress* progress) {
  std::vector<const DividedMesh*> all;
  for (const DividedMesh& mesh : meshes) {
    throwIfCancelled(progress);
    if (verticesWithinCracks(mesh).size() >= kLeastVertices) all.push_back(&mesh);
  }
  const std::size_t count = std::min(all.size(), kMostFragments);
  std::vector<Sample> some;
  for (std::size_t k = 0; k < count; ++k) some.push_back(sampleOf(*all[k * all.size() / count]));
  return some;
}

/// Returns the greatest distance of a point from the mean of its sample.
double radiusOf(std::span<const Sample> samples) {
  double radius = 0.0;
  for (const Sample& sample : samples) {
    for (const glm::dvec3& p : sample) radius = std::max(radius, glm::length(p));
  }
  return radius;
}

/// Returns the points of a sample at every other place, from the first or the second, or all.
enum class Half { first, second, both };
GridPoints pointsOf(const Sample& sample, double pitch, Half half) {
  GridPoints points;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    if (half != Half::both && (i % 2 == 0) != (half == Half::first)) continue;
    points.add(sample[i] / pitch);
  }
  return points;
}

/// Returns the mean logarithm of the power along the axes, less that of other directions.
double excess(const GridPoints& points, std::span<const glm::dvec3> others) {
  return meanLogarithm(powersAlong(points, kAxes)) - meanLogarithm(powersAlong(points, others));
}

double medianEdge(std::span<const DividedMesh> meshes) {
  std::vector<double> lengths;
  for (const DividedMesh& mesh : meshes) {
    for (const SharedEdge& e : mesh.edges) {
      if (mesh.neighbor[e.a] == 0 || mesh.neighbor[e.b] == 0) continue;
      lengths.push_back(glm::distance(mesh.mesh->vertices[e.low], mesh.mesh->vertices[e.high]));
    }
  }
  if (lengths.empty()) return 0.0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

/// Returns the pitch of the greatest power of the first halves of the samples, 0 without edges.
double strongestPitch(std::span<const Sample> samples, double edge, const Progress* progress) {
  if (!(edge > 0.0)) return 0.0;
  const double radius = radiusOf(samples);
  const std::vector<glm::dvec3> others = hemisphere(kScanDirections);
  const auto scoreOf = [&](double frequency) {
    double sum = 0.0;
    for (const Sample& sample : samples) {
      sum += excess(pointsOf(sample, 1.0 / frequency, Half::first), others);
    }
    return sum;
  };
  const double low = 1.0 / (kGreatestPitch * edge), high = 1.0 / (kLeastPitch * edge);
  // Phases of neighboring frequencies differ by a quarter of a turn at the farthest points.
  const auto count = static_cast<std::size_t>(std::clamp(
      std::ceil(4.0 * radius * (high - low)), 1.0, static_cast<double>(kMostFrequencies)));
  std::vector<double> scores(count + 1);
  const auto frequencyOf = [&](std::size_t k) {
    return low + (high - low) * static_cast<double>(k) / static_cast<double>(count);
  };
  tbb::parallel_for(std::size_t{0}, scores.size(), [&](std::size_t k) {
    throwIfCancelled(progress);
    scores[k] = scoreOf(frequencyOf(k));
  });
  const auto best =
      static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin());
  double frequency = frequencyOf(best), score = scores[best];
  for (double step = 0.5 * (high - low) / static_cast<double>(count); step > 1e-5 * frequency;
       step *= 0.5) {
    for (const double near : {frequency - step, frequency + step}) {
      if (const double found = scoreOf(near); found > score)
        std::tie(frequency, score) = std::pair(near, found);
    }
  }
  for (int k = kMostHarmonic; k > 1; --k) {
    if (frequency / k >= low && scoreOf(frequency / k) >= kSameScore * score) return k / frequency;
  }
  return 1.0 / frequency;
}

/// Returns the direction of the greatest power.
glm::dvec3 strongest(const GridPoints& points, std::span<const glm::dvec3> directions) {
  const std::vector<double> power = powersAlong(points, directions);
  std::vector<std::size_t> order(power.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::partial_sort(order.begin(), order.begin() + kRefined, order.end(),
                    [&](std::size_t a, std::size_t b) { return power[a] > power[b]; });
  glm::dvec3 best(0.0);
  double most = -1.0;
  for (std::size_t k = 0; k < kRefined; ++k) {
    glm::dvec3 d = directions[order[k]];
    double value = power[order[k]];
    for (double step = kFirstStep; step > kLastStep;) {
      const glm::dvec3 axis = std::abs(d.x) < 0.6 ? kAxes[0] : kAxes[1];
      const glm::dvec3 u = glm::normalize(glm::cross(d, axis)), v = glm::cross(d, u);
      std::array<glm::dvec3, 8> ring;
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const double angle = static_cast<double>(i) * std::numbers::pi / 4.0;
        ring[i] = glm::normalize(d + step * (std::cos(angle) * u + std::sin(angle) * v));
      }
      const std::vector<double> around = powersAlong(points, ring);
      const auto top =
          static_cast<std::size_t>(std::max_element(around.begin(), around.end()) - around.begin());
      if (around[top] > value) {
        std::tie(d, value) = std::pair(ring[top], around[top]);
      } else {
        step *= 0.5;
      }
    }
    if (value > most) std::tie(best, most) = std::pair(d, value);
  }
  return best;
}

}  // namespace

void GridPoints::add(const glm::dvec3& p) {
  x.push_back(static_cast<float>(p.x));
  y.push_back(static_cast<float>(p.y));
  z.push_back(static_cast<float>(p.z));
}

std::vector<double> powersAlong(const GridPoints& points, std::span<const glm::dvec3> directions) {
  std::vector<double> powers(directions.size());
  for (std::size_t k = 0; k < directions.size(); k += kLanes) {
    const std::size_t count = std::min(kLanes, directions.size() - k);
    powersOfSome(points, directions.subspan(k, count), powers.data() + k);
  }
  return powers;
}

std::optional<GridTrace> gridTraceOf(std::span<const DividedMesh> meshes, double pitch,
                                     const Progress* progress) {
  const std::vector<Sample> samples = samplesOf(meshes, progress);
  if (samples.empty()) return {};
  GridTrace trace{.fragments = samples.size(), .pitch = pitch, .isKnown = pitch > 0.0};
  if (!trace.isKnown) trace.pitch = strongestPitch(samples, medianEdge(meshes), progress);
  if (!(trace.pitch > 0.0 && radiusOf(samples) <= kMostPitches * trace.pitch)) return {};
  const std::vector<glm::dvec3> others = hemisphere(kRandomDirections),
                                search = hemisphere(kSearchDirections);
  const double closest = std::cos(glm::radians(kFoundDegrees));
  std::vector<double> logarithms(samples.size());
  std::vector<char> isFound(samples.size());
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
    throwIfCancelled(progress);
    // A pitch that was chosen by the first half has its power there by chance too.
    const Half half = trace.isKnown ? Half::both : Half::second;
    logarithms[i] = excess(pointsOf(samples[i], trace.pitch, half), others);
    const glm::dvec3 d = glm::abs(strongest(pointsOf(samples[i], trace.pitch, Half::both), search));
    isFound[i] = std::max({d.x, d.y, d.z}) > closest;
  });
  const auto n = static_cast<double>(samples.size());
  double mean = 0.0, squares = 0.0;
  for (const double value : logarithms) mean += value / n;
  for (const double value : logarithms) squares += (value - mean) * (value - mean);
  trace.power = std::exp(mean);
  trace.standardError = n > 1.0 ? trace.power * std::sqrt(squares / (n - 1.0) / n) : 0.0;
  trace.found = static_cast<double>(std::count(isFound.begin(), isFound.end(), 1)) / n;
  return trace;
}

}  // namespace sherd
