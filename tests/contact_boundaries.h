// The contact boundaries of a fragment: the edges between its original surface and its cracks.
#pragma once

#include <openvdb/math/Coord.h>
#include <sherd/fragments.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace sherd {

// Boundary edges of a fragment, in a grid of one-voxel cells.
class Boundary {
 public:
  enum class Of { cracks, regions };  ///< regions: edges between two cracks too

  Boundary(const Fragment& fragment, double voxelSize, Of of = Of::cracks) : voxelSize_(voxelSize) {
    std::map<std::pair<unsigned, unsigned>, std::set<int>> kinds;  // of the faces at an edge
    for (std::size_t t = 0; t < fragment.mesh.neighbor.size(); ++t) {
      const glm::uvec3& corner = fragment.mesh.triangles[t];
      for (int k = 0; k < 3; ++k) {
        kinds[std::minmax(corner[k], corner[(k + 1) % 3])].insert(
            of == Of::cracks ? fragment.mesh.neighbor[t] != 0 : fragment.mesh.neighbor[t]);
      }
    }
    for (const auto& [edge, kind] : kinds) {
      if (kind.size() < 2) continue;
      const Segment segment{fragment.mesh.vertices[edge.first],
                            fragment.mesh.vertices[edge.second]};
      cells_[cellOf(0.5 * (segment.a + segment.b))].push_back(segment);
    }
  }

  /// Returns true if an edge is within `voxels` of p; voxels <= 2.
  bool isWithin(double voxels, const glm::dvec3& p) const {
    constexpr int kReach = 3;  // an edge is about two voxels long at most
    const openvdb::Coord middle = cellOf(p);
    openvdb::Coord at;
    for (at[0] = middle[0] - kReach; at[0] <= middle[0] + kReach; ++at[0]) {
      for (at[1] = middle[1] - kReach; at[1] <= middle[1] + kReach; ++at[1]) {
        for (at[2] = middle[2] - kReach; at[2] <= middle[2] + kReach; ++at[2]) {
          const auto found = cells_.find(at);
          if (found == cells_.end()) continue;
          for (const Segment& segment : found->second) {
            if (segment.distance(p) < voxels * voxelSize_) return true;
          }
        }
      }
    }
    return false;
  }

 private:
  struct Segment {
    glm::dvec3 a, b;
    double distance(const glm::dvec3& p) const {
      const glm::dvec3 along = b - a;
      const double length = glm::dot(along, along);
      const double t = length > 0.0 ? glm::clamp(glm::dot(p - a, along) / length, 0.0, 1.0) : 0.0;
      return glm::length(p - a - t * along);
    }
  };

  openvdb::Coord cellOf(const glm::dvec3& p) const {
    const glm::dvec3 cell = glm::floor(p / voxelSize_);
    return {static_cast<int>(cell.x), static_cast<int>(cell.y), static_cast<int>(cell.z)};
  }

  double voxelSize_;
  std::map<openvdb::Coord, std::vector<Segment>> cells_;
};

}  // namespace sherd
