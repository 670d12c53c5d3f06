// The rims of a fragment: where its original surface and its cracks meet.
#pragma once

#include <openvdb/math/Coord.h>
#include <sherd/fragments.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <vector>

namespace sherd {

// Vertices of edges between the original surface and cracks, by cells of one voxel.
class Rim {
 public:
  Rim(const Fragment& fragment, double voxelSize) : voxelSize_(voxelSize) {
    std::vector<int> kinds(fragment.mesh.vertices.size(), 0);
    for (std::size_t t = 0; t < fragment.facing.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        kinds[fragment.mesh.triangles[t][k]] |= fragment.facing[t] == 0 ? 1 : 2;
      }
    }
    for (std::size_t v = 0; v < kinds.size(); ++v) {
      if (kinds[v] == 3)
        cells_[cellOf(fragment.mesh.vertices[v])].push_back(fragment.mesh.vertices[v]);
    }
  }

  bool isWithinAVoxel(const glm::dvec3& p) const {
    const openvdb::Coord middle = cellOf(p);
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find(middle + openvdb::Coord(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1));
      if (found == cells_.end()) continue;
      for (const glm::dvec3& v : found->second) {
        if (glm::length(v - p) < voxelSize_) return true;
      }
    }
    return false;
  }

 private:
  openvdb::Coord cellOf(const glm::dvec3& p) const {
    const glm::dvec3 cell = glm::floor(p / voxelSize_);
    return {static_cast<int>(cell.x), static_cast<int>(cell.y), static_cast<int>(cell.z)};
  }

  double voxelSize_;
  std::map<openvdb::Coord, std::vector<glm::dvec3>> cells_;
};

}  // namespace sherd
