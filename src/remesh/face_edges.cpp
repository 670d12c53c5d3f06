// Sorts the uses of edges by their lower vertex.
#include "remesh/face_edges.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace sherd {

FaceEdges::FaceEdges(std::span<const glm::uvec3> triangles, std::size_t vertices)
    : edgesOf_(triangles.size()) {
  struct Half {
    std::uint32_t high = 0;
    Use use;
  };
  std::vector<std::uint32_t> begin(vertices + 1, 0);
  const auto forEachUse = [&](const auto& visit) {
    for (std::uint32_t f = 0; f < triangles.size(); ++f) {
      for (std::uint8_t k = 0; k < 3; ++k) {
        const std::uint32_t a = triangles[f][k], b = triangles[f][(k + 1) % 3];
        visit(std::min(a, b), Half{std::max(a, b), {f, k, a < b}});
      }
    }
  };
  forEachUse([&](std::uint32_t low, const Half&) { ++begin[low + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Half> halves(3 * triangles.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  forEachUse([&](std::uint32_t low, const Half& half) { halves[next[low]++] = half; });

  uses_.reserve(halves.size());
  ends_.reserve(halves.size() / 2);
  for (std::uint32_t low = 0; low < vertices; ++low) {
    const auto from = halves.begin() + begin[low], to = halves.begin() + begin[low + 1];
    std::sort(from, to, [](const Half& a, const Half& b) {  // a face uses an edge once
      return std::tie(a.high, a.use.face) < std::tie(b.high, b.use.face);
    });
    for (auto at = from; at != to; ++at) {
      if (at == from || at->high != (at - 1)->high) {
        first_.push_back(static_cast<std::uint32_t>(uses_.size()));
        ends_.push_back({low, at->high});
      }
      uses_.push_back(at->use);
      edgesOf_[at->use.face][at->use.corner] = static_cast<std::uint32_t>(ends_.size() - 1);
    }
  }
  first_.push_back(static_cast<std::uint32_t>(uses_.size()));
}

std::uint32_t FaceEdges::between(std::uint32_t a, std::uint32_t b) const {
  const std::array<std::uint32_t, 2> ends{std::min(a, b), std::max(a, b)};
  const auto at = std::lower_bound(ends_.begin(), ends_.end(), ends);
  return at != ends_.end() && *at == ends ? static_cast<std::uint32_t>(at - ends_.begin()) : kNone;
}

}  // namespace sherd
