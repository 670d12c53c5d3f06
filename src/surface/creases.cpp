// Finds the creases of the intact solid, and takes back those whose triangles cross others.
#include "surface/creases.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/common.hpp>
#include <memory>
#include <tuple>
#include <utility>

#include "base/cancel_flag.h"
#include "exact/self_crossings.h"
#include "exact/sort_unique.h"
#include "surface/crease_vertices.h"
#include "surface/intact_labels.h"
#include "surface/leaf_cells.h"
#include "voxelize/region.h"

namespace sherd {

class Creases::Finding {
 public:
  Finding(Creases& to, const Solid& solid, std::span<const LeafNeighbors> neighborhoods)
      : to_(to),
        solid_(solid),
        neighborhoods_(neighborhoods),
        intact_(solid.blocks),
        field_(solid, intact_.labels, intact_.cut, neighborhoods, &to) {}

  void find(const Progress* progress) {
    const std::size_t count = solid_.blocks->count();
    std::vector<std::vector<CreaseVertex>> found(count);
    CancelFlag stop(progress);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t leaf) {
      if (!stop.isSet()) found[leaf] = creaseVertices(field_, leaf);
    });
    stop.throwIfSet();
    for (std::uint32_t leaf = 0; leaf < count; ++leaf) {
      if (found[leaf].empty()) continue;
      leaves_.push_back(leaf);
      to_.origins_.push_back(solid_.blocks->origins[leaf]);
      to_.vertices_.push_back(std::move(found[leaf]));
    }
    // A vertex has two steps back, and each may make another one cross.
    constexpr int kRounds = 4;
    std::vector<std::uint32_t> changed;
    for (std::uint32_t i = 0; i < leaves_.size(); ++i) {
      const std::vector<CreaseVertex>& own = to_.vertices_[i];
      if (std::any_of(own.begin(), own.end(), [](const auto& v) { return v.isForced; }))
        changed.push_back(i);
    }
    for (int round = 0; round < kRounds && !changed.empty(); ++round) {
      changed = moveBack(changed, progress);
    }
  }

 private:
  // The triangles near forced vertices in some leaves.
  struct Triangles {
    std::vector<glm::dvec3> vertices;
    std::vector<glm::uvec3> all;
    std::vector<std::uint8_t> hasCrease;  // [all]
    std::vector<CreaseVertex*> creaseOf;  // [vertices] of rank 2 or 3, or null
    std::vector<std::uint8_t> isNear;     // [vertices] to a forced vertex
    std::vector<std::uint32_t> indexOf;   // [vertices] of its leaf in leaves_
  };

  // Moves the vertices of triangles that cross others back.  Returns the indices in leaves_ of the
  // leaves with such vertices, ascending.
  std::vector<std::uint32_t> moveBack(std::span<const std::uint32_t> within,
                                      const Progress* progress) {
    const Triangles triangles = trianglesAround(within);
    throwIfCancelled(progress);
    const auto crossings =
        selfCrossings(triangles.vertices, triangles.all, progress, {.of = triangles.hasCrease});
    std::vector<std::uint32_t> moved = coincident(triangles);  // vertices
    for (const auto& pair : crossings) {
      for (const std::uint32_t t : pair) {
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t v = triangles.all[t][k];
          if (triangles.creaseOf[v] != nullptr) moved.push_back(v);
        }
      }
    }
    std::vector<CreaseVertex*> creases;  // sheets of one position have a vertex each
    std::vector<std::uint32_t> leaves;
    for (const std::uint32_t v : moved) {
      creases.push_back(triangles.creaseOf[v]);
      leaves.push_back(triangles.indexOf[v]);
    }
    sortUnique(creases);
    sortUnique(leaves);
    for (CreaseVertex* crease : creases) stepBack(*crease);
    for (const std::uint32_t i : leaves) {
      std::erase_if(to_.vertices_[i], [](const CreaseVertex& v) { return v.edges == 0; });
    }
    return leaves;
  }

  // Vertices of several cells on one corner of the input, up to rounding: they are apart here, but
  // may be one in world units.
  static std::vector<std::uint32_t> coincident(const Triangles& triangles) {
    constexpr double kGrid = 0x1p-14;  // voxels
    std::vector<std::pair<std::tuple<double, double, double>, std::uint32_t>> all;
    for (std::uint32_t v = 0; v < triangles.vertices.size(); ++v) {
      if (triangles.creaseOf[v] == nullptr || triangles.isNear[v] == 0) continue;
      const glm::dvec3 at = glm::round(triangles.vertices[v] / kGrid);
      all.emplace_back(std::tuple(at.x, at.y, at.z), v);
    }
    std::sort(all.begin(), all.end());
    std::vector<std::uint32_t> out;
    for (std::size_t i = 1; i < all.size(); ++i) {
      const std::uint32_t v = all[i].second, other = all[i - 1].second;
      if (all[i].first != all[i - 1].first) continue;
      if (triangles.creaseOf[v] == triangles.creaseOf[other]) continue;  // sheets of one cell
      out.push_back(v);
      out.push_back(other);
    }
    return out;
  }

  void stepBack(CreaseVertex& vertex) {
    if (vertex.at != vertex.inCell) {
      vertex.at = vertex.inCell;
      ++to_.movedBack_;
    } else {
      vertex.edges = 0;
      ++to_.reverted_;
    }
  }

  Triangles trianglesAround(std::span<const std::uint32_t> within) {
    const std::size_t count = solid_.blocks->count();
    std::vector<std::uint8_t> hasQuads(count), hasCells(count);
    for (const std::uint32_t i : within) {
      for (const std::uint32_t other : neighborhoods_[leaves_[i]]) {
        if (other != LeafBlocks::kNone) hasQuads[other] = 1;
      }
    }
    for (std::size_t leaf = 0; leaf < count; ++leaf) {
      if (hasQuads[leaf] == 0) continue;
      for (const std::uint32_t other : neighborhoods_[leaf]) {
        if (other != LeafBlocks::kNone) hasCells[other] = 1;
      }
    }
    std::vector<std::unique_ptr<const LeafCells>> cells(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t leaf) {
      if (hasCells[leaf] != 0) cells[leaf] = std::make_unique<LeafCells>(cellsOf(field_, leaf));
    });
    Triangles out;
    AllCells all;
    for (std::size_t leaf = 0; leaf < count; ++leaf) {
      all.leaves.push_back(cells[leaf].get());
      all.firstVertex.push_back(static_cast<std::uint32_t>(out.vertices.size()));
      if (cells[leaf] == nullptr) continue;
      out.vertices.insert(out.vertices.end(), cells[leaf]->vertices.begin(),
                          cells[leaf]->vertices.end());
    }
    addCreases(all, out);
    findNear(within, all, out);
    std::vector<std::vector<InterfaceQuad>> quads(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t leaf) {
      if (hasQuads[leaf] != 0) quads[leaf] = quadsOf(field_, all, leaf);
    });
    for (const std::vector<InterfaceQuad>& ofLeaf : quads) {
      for (const InterfaceQuad& quad : ofLeaf) {
        if (std::none_of(quad.vertex.begin(), quad.vertex.end(),
                         [&](std::uint32_t v) { return out.isNear[v] != 0; })) {
          continue;
        }
        for (const auto& t : trianglesOf(quad, out.vertices)) {
          out.all.emplace_back(t[0], t[1], t[2]);
          out.hasCrease.push_back(std::any_of(t.begin(), t.end(), [&](std::uint32_t v) {
            return out.creaseOf[v] != nullptr && out.isNear[v] != 0;
          }));
        }
      }
    }
    return out;
  }

  // [voxels] the cells within kReach of those of forced vertices.
  std::vector<bool> cellsNear(std::span<const std::uint32_t> within) const {
    constexpr int kReach = 2;
    std::vector<bool> near(solid_.blocks->count() * 512);
    for (const std::uint32_t i : within) {
      for (const CreaseVertex& crease : to_.vertices_[i]) {
        if (!crease.isForced) continue;
        const openvdb::Coord at = coordFromOffset(crease.offset);
        for (int x = at.x() - kReach; x <= at.x() + kReach; ++x) {
          for (int y = at.y() - kReach; y <= at.y() + kReach; ++y) {
            for (int z = at.z() - kReach; z <= at.z() + kReach; ++z) {
              const std::size_t voxel = field_.voxelIndexNear(leaves_[i], x, y, z);
              if (voxel != Field::kNoVoxel) near[voxel] = true;
            }
          }
        }
      }
    }
    return near;
  }

  void findNear(std::span<const std::uint32_t> within, const AllCells& all, Triangles& out) const {
    const std::vector<bool> near = cellsNear(within);
    out.isNear.resize(out.vertices.size());
    for (std::size_t leaf = 0; leaf < all.leaves.size(); ++leaf) {
      if (all.leaves[leaf] == nullptr) continue;
      for (const Cell& cell : all.leaves[leaf]->cells) {
        if (!near[leaf * 512 + cell.offset]) continue;
        for (std::size_t l = 0; l < cell.loops; ++l)
          out.isNear[all.firstVertex[leaf] + cell.firstLoop + l] = 1;
      }
    }
  }

  void addCreases(const AllCells& all, Triangles& out) {
    out.creaseOf.resize(out.vertices.size());
    out.indexOf.resize(out.vertices.size());
    for (std::uint32_t i = 0; i < leaves_.size(); ++i) {
      if (all.leaves[leaves_[i]] == nullptr) continue;
      const LeafCells& cells = *all.leaves[leaves_[i]];
      for (CreaseVertex& crease : to_.vertices_[i]) {
        if (crease.rank == 1) continue;
        const Cell& cell = cells.at(crease.offset);
        for (std::size_t e = 0; e < 12; ++e) {
          if (((crease.edges >> e) & 1) == 0) continue;
          for (const std::uint8_t loop : cell.loopOf[e]) {
            if (loop == CellSheets::kNone) continue;
            const std::uint32_t v = all.firstVertex[leaves_[i]] + cell.firstLoop + loop;
            out.creaseOf[v] = &crease;
            out.indexOf[v] = i;
          }
        }
      }
    }
  }

  Creases& to_;
  const Solid& solid_;
  const std::span<const LeafNeighbors> neighborhoods_;
  const IntactLabels intact_;
  const Field field_;
  std::vector<std::uint32_t> leaves_;  // [origins_]
};

Creases::Creases(const Solid& solid, std::span<const LeafNeighbors> neighborhoods,
                 const Progress* progress) {
  if (solid.region == nullptr || solid.region->boundary() == nullptr) return;
  Finding(*this, solid, neighborhoods).find(progress);
}

std::span<const CreaseVertex> Creases::of(const openvdb::Coord& origin) const {
  const auto at = std::lower_bound(origins_.begin(), origins_.end(), origin);
  if (at == origins_.end() || *at != origin) return {};
  return vertices_[static_cast<std::size_t>(at - origins_.begin())];
}

const CreaseVertex* CreasesOfLeaf::find(std::uint32_t offset, const CellSheets& sheets,
                                        unsigned position) {
  while (!left_.empty() && left_.front().offset < offset) left_ = left_.subspan(1);
  if (left_.empty() || left_.front().offset != offset) return nullptr;
  const std::uint16_t edges = edgesOf(sheets, position);
  for (const CreaseVertex& vertex : left_) {
    if (vertex.offset != offset) break;
    if (vertex.edges == edges) return &vertex;
  }
  return nullptr;
}

std::uint16_t edgesOf(const CellSheets& sheets, unsigned position) {
  unsigned edges = 0;
  for (unsigned e = 0; e < 12; ++e) {
    if (sheets.positionOf[e] == position) edges |= 1u << e;
  }
  return static_cast<std::uint16_t>(edges);
}

}  // namespace sherd
