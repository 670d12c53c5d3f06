// Weighted sample elimination: Poisson-disk subsets of points.
#include "points/eliminate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <queue>
#include <utility>

namespace sherd {
namespace {

/// Points sorted into cubic cells, so that neighborhoods are contiguous in memory: linked lists
/// through points in the order of drawing took several times as long.
class Cells {
 public:
  Cells(std::span<const glm::dvec3> points, double side) : side_(side) {
    glm::dvec3 low = points.front();
    for (const glm::dvec3& p : points) low = glm::min(low, p);
    const auto cellAt = [&](const glm::dvec3& p) -> Cell {
      // Points beyond 2^60 cells from the lowest corner share one cell.
      return Cell(glm::min(glm::floor((p - low) / side), glm::dvec3(0x1p60)));
    };
    sort(points, cellAt);
    group(cellAt);
  }

  /// Returns the original index of the k-th sorted point.
  std::size_t indexOf(std::size_t k) const { return indices_[k]; }

  /// Calls visit(other, distance) for each other point nearer than the cells' side.
  template <class Visit>
  void forEachNear(std::size_t k, const Visit& visit) const {
    const std::size_t cell = cellOf_[k];
    for (std::size_t n = firstNear_[cell]; n < firstNear_[cell + 1]; ++n) {
      for (std::size_t other = begins_[near_[n]]; other < begins_[near_[n] + 1]; ++other) {
        if (other == k) continue;
        const double distance = glm::length(positions_[k] - positions_[other]);
        if (distance < side_) visit(other, distance);
      }
    }
  }

 private:
  using Cell = glm::i64vec3;

  template <class CellAt>
  void sort(std::span<const glm::dvec3> points, const CellAt& cellAt) {
    std::vector<std::array<std::int64_t, 4>> order;
    order.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Cell cell = cellAt(points[i]);
      order.push_back({cell.x, cell.y, cell.z, static_cast<std::int64_t>(i)});
    }
    std::sort(order.begin(), order.end());
    for (const auto& entry : order) {
      indices_.push_back(static_cast<std::uint32_t>(entry[3]));
      positions_.push_back(points[indices_.back()]);
    }
  }

  // Cells are sorted by x, y, z, so the neighbors in a row of z are contiguous.
  template <class CellAt>
  void group(const CellAt& cellAt) {
    std::vector<std::array<std::int64_t, 3>> cells;
    for (std::size_t k = 0; k < positions_.size(); ++k) {
      const Cell cell = cellAt(positions_[k]);
      const std::array<std::int64_t, 3> key{cell.x, cell.y, cell.z};
      if (cells.empty() || cells.back() != key) {
        cells.push_back(key);
        begins_.push_back(static_cast<std::uint32_t>(k));
      }
      cellOf_.push_back(static_cast<std::uint32_t>(cells.size() - 1));
    }
    begins_.push_back(static_cast<std::uint32_t>(positions_.size()));
    for (const auto& [x, y, z] : cells) {
      firstNear_.push_back(static_cast<std::uint32_t>(near_.size()));
      for (int n = 0; n < 9; ++n) {
        const std::array<std::int64_t, 3> first{x + n / 3 - 1, y + n % 3 - 1, z - 1};
        auto at = std::lower_bound(cells.begin(), cells.end(), first);
        for (;
             at != cells.end() && (*at)[0] == first[0] && (*at)[1] == first[1] && (*at)[2] <= z + 1;
             ++at) {
          near_.push_back(static_cast<std::uint32_t>(at - cells.begin()));
        }
      }
    }
    firstNear_.push_back(static_cast<std::uint32_t>(near_.size()));
  }

  double side_;
  std::vector<std::uint32_t> indices_;    // [points] original index
  std::vector<glm::dvec3> positions_;     // [points]
  std::vector<std::uint32_t> cellOf_;     // [points] index of the point's cell
  std::vector<std::uint32_t> begins_;     // [cells + 1] first point of each
  std::vector<std::uint32_t> firstNear_;  // [cells + 1] first entry of each in near_
  std::vector<std::uint32_t> near_;       // the cells around each cell, itself included
};

}  // namespace

std::vector<std::size_t> eliminated(std::span<const glm::dvec3> candidates, std::size_t keep,
                                    double area) {
  if (keep == 0) return {};
  // The largest radius of `keep` disks that fit on a plane of this area.
  const double largest = std::sqrt(area / (2.0 * std::sqrt(3.0) * static_cast<double>(keep)));
  // The paper's weight limiting, with its beta and gamma and 1 kept of 5; without it pairs of very
  // near candidates dominate.
  const double share = 1.0 / static_cast<double>(kCandidatesPerPoint);
  const double least = largest * 0.65 * (1.0 - share * std::sqrt(share));
  const double reach = 2.0 * largest;
  const auto weightAt = [&](double distance) {
    const double near = 1.0 - std::max(distance, 2.0 * least) / reach;
    const double squared = near * near, fourth = squared * squared;
    return fourth * fourth;
  };

  const Cells cells(candidates, reach);
  std::vector<double> weight(candidates.size(), 0.0);
  std::vector<std::pair<double, std::size_t>> entries;
  entries.reserve(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    cells.forEachNear(i, [&](std::size_t, double distance) { weight[i] += weightAt(distance); });
    entries.emplace_back(weight[i], i);
  }
  // Weights only decrease, so an outdated entry is reinserted with its current weight.
  std::priority_queue<std::pair<double, std::size_t>> queue({}, std::move(entries));
  std::vector<bool> stays(candidates.size(), true);
  for (std::size_t left = candidates.size(); left > keep;) {
    const auto [priority, i] = queue.top();
    queue.pop();
    if (priority != weight[i]) {
      queue.emplace(weight[i], i);
      continue;
    }
    stays[i] = false;
    --left;
    cells.forEachNear(i, [&](std::size_t j, double distance) { weight[j] -= weightAt(distance); });
  }
  std::vector<std::size_t> kept;
  kept.reserve(keep);
  for (std::size_t i = 0; i < stays.size(); ++i) {
    if (stays[i]) kept.push_back(cells.indexOf(i));
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace sherd
