// The boundaries between regions of faces with different neighbors.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

namespace sherd {

/// Of each vertex, the neighbor that all faces at it have, or that they have several.
class RegionsAtVertices {
 public:
  explicit RegionsAtVertices(std::size_t vertices) : seen_(vertices, kNone) {}

  /// Adds a face with a neighbor, or 0, at a vertex.
  void add(std::uint32_t vertex, std::uint16_t neighbor) {
    std::uint32_t& known = seen_[vertex];
    if (known != neighbor) known = known == kNone ? neighbor : kSeveral;
  }

  [[nodiscard]] bool areSeveral(std::uint32_t vertex) const { return seen_[vertex] == kSeveral; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu, kSeveral = 0xfffffffeu;
  std::vector<std::uint32_t> seen_;
};

/// Closed loops of vertices by neighbor, with the neighbor's faces on the left seen from outside.
using RegionLoops = std::map<int, std::vector<std::vector<std::uint32_t>>>;

/// The directed edges of a fragment's fracture faces that may lie between two regions.
class RegionEdges {
 public:
  ///   regions  of all faces of the fragment; must outlive the object
  explicit RegionEdges(const RegionsAtVertices& regions) : regions_(regions) {}

  /// Adds a fracture face.
  void add(const std::array<std::uint32_t, 3>& corner, std::uint16_t neighbor) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = corner[k], to = corner[(k + 1) % 3];
      if (regions_.areSeveral(from) && regions_.areSeveral(to))
        edges_.push_back({neighbor, from, to});
    }
  }

  /// Returns the boundary loops of all regions.
  [[nodiscard]] RegionLoops loops() &&;

 private:
  struct Edge {
    std::uint16_t neighbor;
    std::uint32_t from, to;

    auto key() const { return std::tuple(neighbor, from, to); }
    bool operator<(const Edge& other) const { return key() < other.key(); }
  };

  const RegionsAtVertices& regions_;
  std::vector<Edge> edges_;
};

/// Returns the length of all loops of each neighbor.
[[nodiscard]] std::map<int, double> lengthsOf(const RegionLoops& loops,
                                              std::span<const glm::dvec3> vertices);

}  // namespace sherd
