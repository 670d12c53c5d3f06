// Finds the creases of the intact solid, and takes back those whose triangles cross others.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/common.hpp>
#include <memory>
#include <tuple>
#include <utility>

#include "base/cancel_flag.h"
#include "base/sort_unique.h"
#include "cut/intact_labels.h"
#include "interface/cells/cell_set.h"
#include "interface/cells/crease_vertices.h"
#include "interface/cells/creases.h"
#include "interface/cells/leaf_cells.h"
#include "interface/cells/quad_crossings.h"
#include "voxelize/region.h"

namespace sherd {

class Creases::Finder {
 public:
  Finder(Creases& to, const Solid& solid, std::span<const LeafNeighbors> neighborhoods,
         KeepCrossings keep)
      : to_(to),
        keep_(keep),
        solid_(solid),
        neighborhoods_(neighborhoods),
        intact_(solid.blocks),
        field_(solid, intact_.labels, intact_.cut, neighborhoods, &to),
        aroundMoved_(solid.blocks->count()) {}

  void find(const Progress* progress) {
    const std::size_t count = solid_.blocks->count();
    std::vector<LeafCreases> found(count);
    CancelFlag stop(progress);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t leaf) {
      if (stop.isSet()) return;
      found[leaf] = creaseVertices(field_, leaf);
      if (keep_ == KeepCrossings::no) found[leaf].crossings = {};
    });
    stop.throwIfSet();
    for (std::uint32_t leaf = 0; leaf < count; ++leaf) {
      if (found[leaf].vertices.empty() && found[leaf].crossings.empty()) continue;
      leaves_.push_back(leaf);
      to_.origins_.push_back(solid_.blocks->origins[leaf]);
      to_.vertices_.push_back(std::move(found[leaf].vertices));
      if (keep_ == KeepCrossings::yes) to_.crossings_.push_back(std::move(found[leaf].crossings));
    }
    std::vector<std::uint32_t> changed;
    for (std::uint32_t i = 0; i < leaves_.size(); ++i) {
      const std::vector<CreaseVertex>& own = to_.vertices_[i];
      if (std::any_of(own.begin(), own.end(), [](const auto& v) { return v.isForced; }))
        changed.push_back(i);
    }
    // A vertex has two steps back, and each may make another one cross.
    constexpr int kRounds = 4;
    CellSet near = cellsNear(changed);
    for (int round = 0; round < kRounds && !changed.empty(); ++round) {
      if (round > 0) {
        // All other pairs of triangles have been compared.
        near = cellsNear(changed);
        near.intersect(aroundMoved_);
      }
      changed = moveBack(near, progress);
    }
  }

 private:
  // The quads near forced vertices.
  struct Surface {
    std::vector<glm::dvec3> vertices;
    std::vector<CreaseVertex*> creaseOf;            // [vertices] of rank 2 or 3, or null
    std::vector<std::uint8_t> isNear;               // [vertices] to a forced vertex
    std::vector<std::uint32_t> indexOf;             // [vertices] of its leaf in leaves_
    std::vector<std::uint16_t> offsetOf;            // [vertices] of its cell in its leaf
    std::vector<std::vector<QuadTriangles>> quads;  // [leaf]
  };

  // Moves the vertices of triangles near some cells that cross others back.  Returns the indices in
  // leaves_ of the leaves with such vertices, ascending.
  std::vector<std::uint32_t> moveBack(const CellSet& near, const Progress* progress) {
    const Surface surface = surfaceAt(near, progress);
    std::vector<std::uint32_t> moved = verticesOfCrossings(
        solid_.blocks->origins, neighborhoods_, surface.quads, surface.vertices, progress);
    for (const std::uint32_t v : coincident(surface)) moved.push_back(v);
    sortUnique(moved);
    std::vector<CreaseVertex*> creases;  // sheets of one position have a vertex each
    std::vector<std::uint32_t> leaves;
    for (const std::uint32_t v : moved) {
      if (surface.creaseOf[v] == nullptr) continue;
      constexpr int kReach = 3;  // of triangles that a triangle with the vertex may cross
      const std::uint32_t i = surface.indexOf[v];
      creases.push_back(surface.creaseOf[v]);
      leaves.push_back(i);
      aroundMoved_.addAround(neighborhoods_[leaves_[i]], surface.offsetOf[v], kReach);
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
  static std::vector<std::uint32_t> coincident(const Surface& surface) {
    constexpr double kGrid = 0x1p-14;  // voxels
    std::vector<std::pair<std::tuple<double, double, double>, std::uint32_t>> all;
    for (std::uint32_t v = 0; v < surface.vertices.size(); ++v) {
      if (surface.creaseOf[v] == nullptr || surface.isNear[v] == 0) continue;
      const glm::dvec3 at = glm::round(surface.vertices[v] / kGrid);
      all.emplace_back(std::tuple(at.x, at.y, at.z), v);
    }
    std::sort(all.begin(), all.end());
    std::vector<std::uint32_t> out;
    for (std::size_t i = 1; i < all.size(); ++i) {
      const std::uint32_t v = all[i].second, other = all[i - 1].second;
      if (all[i].first != all[i - 1].first) continue;
      if (surface.creaseOf[v] == surface.creaseOf[other]) continue;  // sheets of one cell
      out.push_back(v);
      out.push_back(other);
    }
    return out;
  }

  static void stepBack(CreaseVertex& vertex) {
    if (vertex.at != vertex.inCell) {
      vertex.at = vertex.inCell;
    } else {
      vertex.edges = 0;
    }
  }

  // The cells near the forced vertices of some leaves.
  CellSet cellsNear(std::span<const std::uint32_t> within) const {
    constexpr int kReach = 2;
    CellSet near(solid_.blocks->count());
    for (const std::uint32_t i : within) {
      for (const CreaseVertex& crease : to_.vertices_[i]) {
        if (crease.isForced) near.addAround(neighborhoods_[leaves_[i]], crease.offset, kReach);
      }
    }
    return near;
  }

  Surface surfaceAt(const CellSet& near, const Progress* progress) {
    const std::size_t count = solid_.blocks->count();
    const CellSet made = near.grown(neighborhoods_);  // by the cells of their quads
    std::vector<std::unique_ptr<const LeafCells>> cells(count);
    const std::vector<std::uint32_t> leaves = made.leaves();
    CancelFlag stop(progress);
    tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t i) {
      const std::uint32_t leaf = leaves[i];
      if (stop.isSet()) return;
      cells[leaf] = std::make_unique<LeafCells>(cellsOf(field_, leaf, nullptr, made.of(leaf)));
    });
    stop.throwIfSet();
    Surface out;
    AllCells all{std::vector<const LeafCells*>(count), std::vector<std::uint32_t>(count)};
    for (const std::uint32_t leaf : leaves) {
      const LeafCells& own = *cells[leaf];
      all.leaves[leaf] = &own;
      all.firstVertex[leaf] = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.insert(out.vertices.end(), own.vertices.begin(), own.vertices.end());
      for (const Cell& cell : own.cells) {
        out.offsetOf.insert(out.offsetOf.end(), cell.loops, cell.offset);
        out.isNear.insert(out.isNear.end(), cell.loops, near.has(leaf, cell.offset) ? 1 : 0);
      }
    }
    addCreases(made, all, out);
    out.quads.resize(count);
    tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t i) {
      if (stop.isSet()) return;
      const LeafEdges edges =
          edgesAround(neighborhoods_[leaves[i]], [&](std::size_t leaf) { return near.of(leaf); });
      const std::vector<InterfaceQuad> quads = quadsOf(field_, all, leaves[i], &edges);
      std::vector<QuadTriangles>& own = out.quads[leaves[i]];
      own.reserve(quads.size());
      for (const InterfaceQuad& quad : quads) own.push_back(trianglesOf(quad, out));
    });
    stop.throwIfSet();
    return out;
  }

  static QuadTriangles trianglesOf(const InterfaceQuad& quad, const Surface& surface) {
    QuadTriangles out;
    out.offset = surface.offsetOf[quad.vertex[2]];  // see quadsOf
    const auto halves = sherd::trianglesOf(quad, surface.vertices);
    for (std::size_t half = 0; half < 2; ++half) {
      const auto& t = halves[half];
      out.triangle[half] = {t[0], t[1], t[2]};
      out.isTested[half] = std::any_of(t.begin(), t.end(), [&](std::uint32_t v) {
        return surface.creaseOf[v] != nullptr && surface.isNear[v] != 0;
      });
    }
    return out;
  }

  void addCreases(const CellSet& made, const AllCells& all, Surface& out) {
    out.creaseOf.resize(out.vertices.size());
    out.indexOf.resize(out.vertices.size());
    for (std::uint32_t i = 0; i < leaves_.size(); ++i) {
      const std::uint32_t leaf = leaves_[i];
      if (made.of(leaf) == nullptr) continue;
      for (CreaseVertex& crease : to_.vertices_[i]) {
        if (crease.rank == 1 || !made.has(leaf, crease.offset)) continue;
        const Cell& cell = all.leaves[leaf]->at(crease.offset);
        for (std::size_t e = 0; e < 12; ++e) {
          if (((crease.edges >> e) & 1) == 0) continue;
          for (const std::uint8_t loop : cell.loopOf[e]) {
            if (loop == CellSheets::kNone) continue;
            const std::uint32_t v = all.firstVertex[leaf] + cell.firstLoop + loop;
            out.creaseOf[v] = &crease;
            out.indexOf[v] = i;
          }
        }
      }
    }
  }

  Creases& to_;
  const KeepCrossings keep_;
  const Solid& solid_;
  const std::span<const LeafNeighbors> neighborhoods_;
  const IntactLabels intact_;
  const Field field_;
  std::vector<std::uint32_t> leaves_;  // [origins_]
  CellSet aroundMoved_;                // of triangles that may cross others since a vertex moved
};

Creases::Creases(const Solid& solid, std::span<const LeafNeighbors> neighborhoods,
                 const Progress* progress, KeepCrossings keep) {
  if (solid.region == nullptr || solid.region->boundary() == nullptr) return;
  Finder(*this, solid, neighborhoods, keep).find(progress);
}

}  // namespace sherd
