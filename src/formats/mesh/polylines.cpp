// Joins edges to polylines.
#include "formats/mesh/polylines.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace sherd {
namespace {

using Edge = std::array<std::uint32_t, 2>;

// Returns for each vertex the lowest one at the same position.
std::vector<std::uint32_t> lowestEqual(std::span<const glm::dvec3> vertices) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    return std::tuple(vertices[i].x, vertices[i].y, vertices[i].z, i);
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::vector<std::uint32_t> lowest(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool isEqual = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
    lowest[order[i]] = isEqual ? lowest[order[i - 1]] : order[i];
  }
  return lowest;
}

// The edges at each vertex.
class Graph {
 public:
  Graph(std::size_t vertices, std::vector<Edge> edges)
      : edges_(std::move(edges)), first_(vertices + 1, 0), isUsed_(edges_.size(), false) {
    for (const Edge& edge : edges_) {
      for (const std::uint32_t v : edge) ++first_[v + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    at_.resize(2 * edges_.size());
    std::vector<std::size_t> end(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      for (const std::uint32_t v : edges_[i]) at_[end[v]++] = i;
    }
  }

  [[nodiscard]] std::size_t degree(std::uint32_t v) const { return first_[v + 1] - first_[v]; }

  // Follows unused edges from a vertex to the next one that does not have two; returns the
  // vertices.
  std::vector<std::uint32_t> follow(std::uint32_t from) {
    std::vector<std::uint32_t> line{from};
    for (std::uint32_t v = from; const std::size_t* edge = unusedAt(v);) {
      isUsed_[*edge] = true;
      v = edges_[*edge][0] == v ? edges_[*edge][1] : edges_[*edge][0];
      line.push_back(v);
      if (degree(v) != 2) break;
    }
    return line;
  }

  [[nodiscard]] bool hasUnused(std::uint32_t v) const { return unusedAt(v) != nullptr; }

 private:
  [[nodiscard]] const std::size_t* unusedAt(std::uint32_t v) const {
    for (std::size_t i = first_[v]; i < first_[v + 1]; ++i) {
      if (!isUsed_[at_[i]]) return &at_[i];
    }
    return nullptr;
  }

  std::vector<Edge> edges_;
  std::vector<std::size_t> first_, at_;
  std::vector<bool> isUsed_;
};

}  // namespace

std::vector<std::vector<glm::dvec3>> joinedPolylines(std::span<const glm::dvec3> vertices,
                                                     std::span<const Edge> edges) {
  const std::vector<std::uint32_t> lowest = lowestEqual(vertices);
  std::vector<Edge> distinct;
  for (const Edge& edge : edges) {
    const auto [low, high] = std::minmax(lowest[edge[0]], lowest[edge[1]]);
    if (low != high) distinct.push_back({low, high});
  }
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  Graph graph(vertices.size(), std::move(distinct));
  std::vector<std::vector<glm::dvec3>> polylines;
  for (const bool isRing : {false, true}) {
    for (std::uint32_t v = 0; v < vertices.size(); ++v) {
      while ((isRing || graph.degree(v) != 2) && graph.hasUnused(v)) {
        std::vector<glm::dvec3>& line = polylines.emplace_back();
        for (const std::uint32_t i : graph.follow(v)) line.push_back(vertices[i]);
      }
    }
  }
  return polylines;
}

}  // namespace sherd
