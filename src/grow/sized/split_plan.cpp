// Everything that decides a plane is IEEE double without functions whose last bits differ.
#include "grow/sized/split_plan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <queue>
#include <utility>

#include "base/random.h"
#include "seed/draw/irwin_hall.h"

namespace sherd {
namespace {

// An approximately normal draw of standard deviation 1.
double normalDraw(std::uint64_t seed, Stage stage, std::uint64_t item) {
  return kNormalTerms * meanOfUniforms(kNormalTerms, seed, stage, item);
}

// Sizes of pieces by which the next one is drawn: a tree of sums (Fenwick).
class DrawnBySize {
 public:
  explicit DrawnBySize(std::size_t most) : sums_(most + 1, 0.0) {}

  void add(std::size_t at, double weight) {
    total_ += weight;
    for (std::size_t i = at + 1; i < sums_.size(); i += i & (~i + 1)) sums_[i] += weight;
  }

  // Returns the first piece whose weight and those before it exceed `unit` of all.
  std::size_t at(double unit) const {
    double rest = unit * total_;
    std::size_t found = 0;
    std::size_t step = 1;
    while (2 * step < sums_.size()) step *= 2;
    for (; step > 0; step /= 2) {
      if (found + step >= sums_.size() || sums_[found + step] > rest) continue;
      found += step;
      rest -= sums_[found];
    }
    return found;
  }

 private:
  std::vector<double> sums_;
  double total_ = 0.0;
};

// x^power for whole powers and, linear between, for others: the last bits of pow differ.
double raised(double x, double power) {
  double result = 1.0;
  for (int i = 0; i < static_cast<int>(power); ++i) result *= x;
  const double part = power - std::floor(power);
  return result * (1.0 - part) + result * x * part;
}

void shuffle(std::vector<double>& values, std::uint64_t seed) {
  for (std::size_t i = values.size(); i > 1; --i) {
    std::swap(values[i - 1], values[randomBelow(i, seed, Stage::splitOrder, i)]);
  }
}

}  // namespace

std::vector<double> sharesOfSplits(const SplitOptions& options, std::size_t pieces,
                                   std::uint64_t seed) {
  std::vector<double> shares{1.0}, weights{1.0};
  DrawnBySize drawn(pieces);
  drawn.add(0, 1.0);
  while (shares.size() < pieces) {
    const std::size_t step = shares.size();
    const std::size_t at = std::min(drawn.at(randomUnit(seed, Stage::splitPiece, step)), step - 1);
    const double part =
        std::clamp(0.5 + options.offset * normalDraw(seed, Stage::splitShare, step), 0.05, 0.95);
    const double whole = shares[at];
    for (const auto& [index, share] :
         {std::pair(at, whole * part), std::pair(step, whole * (1.0 - part))}) {
      // Relative to the mean, so that high powers of many small shares do not vanish.
      const double weight = raised(share * static_cast<double>(pieces), options.power);
      if (index == step) {
        shares.push_back(share);
        weights.push_back(weight);
        drawn.add(index, weight);
      } else {
        drawn.add(index, weight - weights[index]);
        shares[index] = share;
        weights[index] = weight;
      }
    }
  }
  shuffle(shares, seed);
  return shares;
}

std::vector<double> raisedTo(double least, std::vector<double> shares) {
  const double rest = 1.0 - least * static_cast<double>(shares.size());
  for (double& share : shares) share = least + std::max(rest, 0.0) * share;
  return shares;
}

std::size_t firstOf(std::span<const double> shares, double fraction) {
  const double wanted = fraction * std::accumulate(shares.begin(), shares.end(), 0.0);
  double sum = shares.front();
  std::size_t best = 1;
  double least = std::abs(sum - wanted);
  for (std::size_t n = 2; n < shares.size(); ++n) {
    sum += shares[n - 1];
    if (std::abs(sum - wanted) >= least) continue;
    least = std::abs(sum - wanted);
    best = n;
  }
  return best;
}

std::vector<std::vector<double>> sharesOfComponents(std::span<const double> shares,
                                                    std::span<const double> mass,
                                                    std::span<const std::uint64_t> most) {
  std::vector<std::vector<double>> all(most.size());
  if (all.size() == 1) {
    all.front().assign(shares.begin(), shares.end());
    return all;
  }
  const double total = std::accumulate(mass.begin(), mass.end(), 0.0);
  // Components by the share that they are not given yet, the greatest first, then by number.
  using Missing = std::pair<double, std::size_t>;
  const auto isAfter = [](const Missing& a, const Missing& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  };
  std::priority_queue<Missing, std::vector<Missing>, decltype(isAfter)> missing(isAfter);
  for (std::size_t c = 0; c < all.size(); ++c) missing.emplace(mass[c] / total, c);
  std::vector<double> descending(shares.begin(), shares.end());
  std::stable_sort(descending.begin(), descending.end(), std::greater<>());
  std::size_t empty = all.size();
  for (std::size_t i = 0; i < descending.size(); ++i) {
    const bool onlyEmpty = descending.size() - i <= empty;  // from here on
    const auto isFull = [&](std::size_t c) {
      return all[c].size() >= most[c] || (onlyEmpty && !all[c].empty());
    };
    while (isFull(missing.top().second)) missing.pop();
    const auto [share, best] = missing.top();
    missing.pop();
    empty -= all[best].empty() ? 1 : 0;
    all[best].push_back(descending[i]);
    missing.emplace(share - descending[i], best);
  }
  return all;
}

void VoxelSums::add(const VoxelSums& other, const glm::ivec3& low) {
  const std::int64_t n = other.count;
  count += n;
  const std::array<std::int64_t, 3> at{low.x, low.y, low.z};
  for (std::size_t i = 0; i < 3; ++i) {
    sum[i] += other.sum[i] + n * at[i];
    squares[i] += other.squares[i] + 2 * at[i] * other.sum[i] + n * at[i] * at[i];
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = k == 2 ? 1 : 0, j = k == 0 ? 1 : 2;
    squares[3 + k] +=
        other.squares[3 + k] + at[i] * other.sum[j] + at[j] * other.sum[i] + n * at[i] * at[j];
  }
}

glm::dvec3 VoxelSums::mean() const {
  return glm::dvec3(static_cast<double>(sum[0]), static_cast<double>(sum[1]),
                    static_cast<double>(sum[2])) /
         static_cast<double>(std::max<std::int64_t>(count, 1));
}

glm::dmat3 VoxelSums::covariance() const {
  const glm::dvec3 m = mean();
  const auto n = static_cast<double>(std::max<std::int64_t>(count, 1));
  const auto of = [&](std::size_t square, int i, int j) {
    return static_cast<double>(squares[square]) / n - m[i] * m[j];
  };
  const double xy = of(3, 0, 1), xz = of(4, 0, 2), yz = of(5, 1, 2);
  // Voxels are cubes, whose own variance keeps a piece of one layer from being flat.
  constexpr double kVoxel = 1.0 / 12.0;
  return {glm::dvec3(of(0, 0, 0) + kVoxel, xy, xz), glm::dvec3(xy, of(1, 1, 1) + kVoxel, yz),
          glm::dvec3(xz, yz, of(2, 2, 2) + kVoxel)};
}

namespace {

glm::dvec3 normalVector(std::uint64_t seed, Stage stage, std::uint64_t item) {
  return {normalDraw(seed, stage, 3 * item), normalDraw(seed, stage, 3 * item + 1),
          normalDraw(seed, stage, 3 * item + 2)};
}

}  // namespace

glm::dvec3 crackNormal(const glm::dmat3& covariance, const SplitOptions& options,
                       const Anisotropy& anisotropy, std::uint64_t seed, std::uint64_t item) {
  // Lengths along the grain are divided by 1 + strength, so that pieces get longer along it.
  const glm::dvec3 along = glm::normalize(anisotropy.direction);
  const double shrink = 1.0 / (1.0 + anisotropy.strength) - 1.0;
  const glm::dmat3 scaled = glm::dmat3(1.0) + shrink * glm::outerProduct(along, along);
  glm::dmat3 power = scaled * covariance * scaled;
  // The covariance to the eighth power turns a random direction towards the long axis: a piece half
  // as long again as wide to some 5 degrees of it.  It is a continuous function of the piece,
  // unlike an eigenvector where axes are equally long, so that cracks are the same at every
  // resolution.
  for (int i = 0; i < 3; ++i) {
    power /= std::max(power[0][0] + power[1][1] + power[2][2], 1e-300);
    power = power * power;
  }
  const glm::dvec3 random = normalVector(seed, Stage::splitAxis, item);
  glm::dvec3 axis = power * random;
  const double length = glm::length(axis);
  axis = length > 1e-12 * glm::length(random) ? axis / length : glm::dvec3(0.0, 0.0, 1.0);
  constexpr double kRadians = 3.14159265358979323846 / 180.0;
  const glm::dvec3 tilted =
      axis + options.tilt * kRadians * normalVector(seed, Stage::splitTilt, item);
  return scaled * (glm::length(tilted) > 1e-9 ? tilted : axis);
}

glm::ivec3 inSteps(const glm::dvec3& direction) {
  const glm::dvec3 steps = direction / glm::length(direction) * 16384.0;
  glm::ivec3 whole(0);
  for (int i = 0; i < 3; ++i) whole[i] = static_cast<int>(std::floor(steps[i] + 0.5));
  return whole;
}

ProjectedVoxels::ProjectedVoxels(double mean, double deviation)
    : low_(mean - 5.0 * deviation - 1e-6),
      width_((10.0 * deviation + 2e-6) / static_cast<double>(kBins)) {}

void ProjectedVoxels::add(double mean, double deviation, double voxels) {
  const double half = std::sqrt(3.0) * deviation;  // an even distribution of this deviation
  const double first = (mean - half - low_) / width_, last = (mean + half - low_) / width_;
  const auto bin = [](double at) {
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(kBins - 1)));
  };
  const std::size_t from = bin(first), to = bin(last);
  if (from == to) {
    bins_[from] += voxels;
    return;
  }
  const double perBin = voxels / (last - first);
  bins_[from] += perBin * (static_cast<double>(from + 1) - std::max(first, 0.0));
  for (std::size_t i = from + 1; i < to; ++i) bins_[i] += perBin;
  bins_[to] += perBin * (std::min(last, static_cast<double>(kBins)) - static_cast<double>(to));
}

double ProjectedVoxels::quantile(double fraction) const {
  double rest = fraction * std::accumulate(bins_.begin(), bins_.end(), 0.0);
  std::size_t i = 0;
  for (; i + 1 < kBins && bins_[i] <= rest; ++i) rest -= bins_[i];
  const double within = bins_[i] > 0.0 ? std::clamp(rest / bins_[i], 0.0, 1.0) : 0.5;
  return low_ + (static_cast<double>(i) + within) * width_;
}

}  // namespace sherd
