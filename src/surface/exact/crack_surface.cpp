// Meshes the surfaces between fragments, leaf by leaf.
#include "surface/exact/crack_surface.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <span>
#include <utility>

#include "base/cancel_flag.h"
#include "base/sort_unique.h"
#include "interface/cells/leaf_cells.h"
#include "interface/intact.h"
#include "interface/non_manifold_vertices.h"
#include "intersect/self_crossings.h"
#include "remesh/near_points.h"
#include "surface/exact/sheet_middles.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

// How often faces that cross each other are separated.
constexpr int kMostRounds = 12;

// Sheets this near to crossing faces stay together, voxels; after kMostRounds twice as far, and so
// on.
constexpr double kNearCrossing = 1.5;

// The cells of the leaves with cracks, and of the leaves below them, whose vertices quads have.
class CrackMeshing {
 public:
  CrackMeshing(const Solid& solid, const Labels& labels, const Cut& cut,
               std::span<const LeafNeighbors> neighborhoods, CrackEnds ends)
      : ends_(ends),
        field_(solid, labels, cut, neighborhoods, nullptr),
        neighborhoods_(neighborhoods),
        cells_(neighborhoods.size()),
        quads_(neighborhoods.size()) {}

  LabeledComplex mesh(const GridFrame& frame, const Progress* progress) {
    findLeaves();
    makeCells(progress);
    collectVertices();
    CancelFlag stop(progress);
    tbb::parallel_for(std::size_t{0}, cracked_.size(), [&](std::size_t i) {
      if (!stop.isSet()) quads_[cracked_[i]] = sherd::quadsOf(field_, all_, cracked_[i]);
    });
    stop.throwIfSet();
    const std::vector<glm::dvec3> inCells = vertices_.at;
    straightenBoundaries(quads_, junctions_, vertices_.at, [](std::size_t) { return true; });
    throwIfCancelled(progress);
    const bool areClear = separate(inCells, progress);
    splitSheets(areClear, progress);
    return assembled(frame);
  }

 private:
  void findLeaves() {
    std::vector<std::uint8_t> isCracked(cells_.size(), 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells_.size(), 64),
                      [&](const auto& range) {
                        for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
                          // Cells reach into the leaves above.
                          isCracked[leaf] = onlyLabelOf(field_, leaf) ? 0 : 1;
                        }
                      });
    std::vector<std::uint8_t> hasCells(cells_.size(), 0);
    for (std::uint32_t leaf = 0; leaf < isCracked.size(); ++leaf) {
      if (isCracked[leaf] == 0) continue;
      cracked_.push_back(leaf);
      for (const std::size_t slot : IntactLeaf::kSlots) {
        const std::uint32_t other = neighborhoods_[leaf][slot];
        if (other != LeafBlocks::kNone) hasCells[other] = 1;
      }
    }
    for (std::uint32_t leaf = 0; leaf < hasCells.size(); ++leaf) {
      if (hasCells[leaf] != 0) withCells_.push_back(leaf);
    }
  }

  void makeCells(const Progress* progress) {
    CancelFlag stop(progress);
    tbb::parallel_for(std::size_t{0}, withCells_.size(), [&](std::size_t i) {
      if (stop.isSet()) return;
      cells_[withCells_[i]] = std::make_unique<LeafCells>(cellsOf(field_, withCells_[i]));
    });
    stop.throwIfSet();
  }

  void collectVertices() {
    all_.leaves.resize(cells_.size());
    all_.firstVertex.assign(cells_.size(), kNone);
    for (const std::uint32_t leaf : withCells_) {
      const LeafCells& own = *cells_[leaf];
      all_.leaves[leaf] = &own;
      const auto first = static_cast<std::uint32_t>(vertices_.at.size());
      all_.firstVertex[leaf] = first;
      vertices_.at.insert(vertices_.at.end(), own.vertices.begin(), own.vertices.end());
      for (const std::uint32_t id : own.positionIds)
        vertices_.positionId.push_back(vertices_.positionCount + id);
      for (Junction junction : own.junctions) {
        for (std::uint32_t& v : junction.vertices()) v += first;
        junctions_.push_back(junction);
      }
      markVertices(leaf);
      const std::vector<glm::dvec3> middles = middlesOf(own);
      middles_.insert(middles_.end(), middles.begin(), middles.end());
      std::vector<bool> isBorder(own.positionCount, false);
      for (std::size_t v = 0; v < own.positionIds.size(); ++v) {
        if (isBorder_[first + v]) isBorder[own.positionIds[v]] = true;
      }
      for (const std::uint32_t id : own.nonManifold) {
        if (!isBorder[id]) nonManifold_.push_back(vertices_.positionCount + id);
      }
      vertices_.positionCount += own.positionCount;
    }
  }

  // Marks the vertices of cells that have a corner without a label, which do not lie on the cracks
  // alone, and of cells with several sheets or more than two labels.
  void markVertices(std::uint32_t leaf) {
    const LabelCube<9> corners = field_.cornersOf(leaf);
    isBorder_.resize(vertices_.at.size(), false);
    isComplex_.resize(vertices_.at.size(), false);
    for (const Cell& cell : cells_[leaf]->cells) {
      const openvdb::Coord at = coordFromOffset(cell.offset);
      bool isBorder = false;
      for (int corner = 0; corner < 8; ++corner) {
        const auto x = static_cast<std::size_t>(at.x() + (corner >> 2));
        const auto y = static_cast<std::size_t>(at.y() + ((corner >> 1) & 1));
        const auto z = static_cast<std::size_t>(at.z() + (corner & 1));
        isBorder = isBorder || corners[(x * 9 + y) * 9 + z] == 0;
      }
      const std::size_t first = all_.firstVertex[leaf] + cell.firstLoop;
      std::fill_n(isBorder_.begin() + static_cast<std::ptrdiff_t>(first), cell.loops, isBorder);
      std::fill_n(isComplex_.begin() + static_cast<std::ptrdiff_t>(first), cell.loops,
                  cell.loops > 2);
    }
  }

  // Of which quad a face is: none, if it fills a gap.
  struct Origin {
    std::uint32_t leaf = kNone, quad = kNone;
  };

  // The corners of faces that cross each other, as positions, ascending.  Only where more than two
  // labels or sheets meet can faces cross.
  //   isChanged  (Origin): of the faces that may cross others
  template <class IsChanged>
  std::vector<std::uint32_t> crossingPositions(const IsChanged& isChanged,
                                               const Progress* progress) const {
    const std::vector<glm::dvec3> at = positionsOf(vertices_);
    std::vector<glm::uvec3> faces;
    std::vector<std::uint8_t> isTested;
    forEachFace([&](const std::array<std::uint32_t, 3>& t, std::uint16_t, std::uint16_t,
                    const Origin& origin) {
      if (std::none_of(t.begin(), t.end(), [&](std::uint32_t v) { return isComplex_[v]; })) return;
      faces.emplace_back(vertices_.positionId[t[0]], vertices_.positionId[t[1]],
                         vertices_.positionId[t[2]]);
      isTested.push_back(isChanged(origin) ? 1 : 0);
    });
    std::vector<std::uint32_t> found;
    for (const auto& pair : selfCrossings(at, faces, progress, {.of = isTested})) {
      for (const std::uint32_t f : pair)
        found.insert(found.end(), {faces[f].x, faces[f].y, faces[f].z});
    }
    sortUnique(found);
    return found;
  }

  // Moves the vertices of faces that cross each other back into their cells, then halfway to the
  // middles of these, again and again: with all vertices there, the faces are those of voxels.
  // Returns whether no faces cross.
  bool separate(const std::vector<glm::dvec3>& inCells, const Progress* progress) {
    std::vector<std::uint8_t> moves(vertices_.positionCount, 0);
    std::vector<bool> isMoved(vertices_.positionCount, true);  // all corners of those that crossed
    for (int round = 0; round < kMostRounds; ++round) {
      const std::vector<std::uint32_t> crossing = crossingPositions(
          [&](const Origin& of) {
            const auto& corners = quads_[of.leaf][of.quad].vertex;
            return std::ranges::any_of(
                corners, [&](std::uint32_t v) { return isMoved[vertices_.positionId[v]]; });
          },
          progress);
      if (crossing.empty()) return true;
      isMoved.assign(isMoved.size(), false);
      for (const std::uint32_t id : crossing) isMoved[id] = true;
      for (std::size_t v = 0; v < vertices_.at.size(); ++v) {
        const std::uint32_t id = vertices_.positionId[v];
        if (!std::binary_search(crossing.begin(), crossing.end(), id)) continue;
        const glm::dvec3 middle = glm::floor(inCells[v]) + middles_[v];
        const double share = 1.0 - std::ldexp(1.0, -moves[id]);
        vertices_.at[v] = inCells[v] + share * (middle - inCells[v]);
      }
      for (const std::uint32_t id : crossing) ++moves[id];
    }
    return false;
  }

  // Moves sheets of one label apart that touch, except where faces would cross then.
  //   areClear  whether no faces cross before
  void splitSheets(bool areClear, const Progress* progress) {
    const std::vector<std::vector<InterfaceQuad>> quads = quads_;
    const InterfaceVertices vertices = vertices_;
    const auto isChanged = [&](const Origin& of) {
      if (!areClear || of.leaf == kNone) return true;
      const auto &own = quads_[of.leaf][of.quad].vertex, &before = quads[of.leaf][of.quad].vertex;
      return own != before || std::ranges::any_of(own, [&](std::uint32_t v) {
               return vertices_.positionId[v] != vertices.positionId[v] ||
                      vertices_.at[v] != vertices.at[v];
             });
    };
    double near = kNearCrossing;
    for (int round = 0; !nonManifold_.empty(); ++round) {
      gaps_ = splitNonManifoldVertices(nonManifold_, quads_, vertices_);
      isBorder_.resize(vertices_.at.size(), false);
      isComplex_.resize(vertices_.at.size(), true);
      const std::vector<std::uint32_t> crossing = crossingPositions(isChanged, progress);
      if (crossing.empty()) return;
      keepTogether(crossing, vertices, near);
      if (round >= kMostRounds) near *= 2.0;
      quads_ = quads;
      vertices_ = vertices;
      gaps_.clear();
    }
  }

  // Leaves out positions near those that cross; all if there are none near.
  //   before  the vertices before sheets were split
  //   near    voxels
  void keepTogether(std::span<const std::uint32_t> crossing, const InterfaceVertices& before,
                    double near) {
    const std::vector<glm::dvec3> at = positionsOf(vertices_), was = positionsOf(before);
    std::vector<glm::dvec3> crossings;
    for (const std::uint32_t id : crossing) crossings.push_back(at[id]);
    const NearPoints points(crossings);
    const auto erased = std::erase_if(
        nonManifold_, [&](std::uint32_t id) { return points.areWithin(near, was[id]); });
    if (erased == 0) nonManifold_.clear();
  }

  // [positionIds]
  static std::vector<glm::dvec3> positionsOf(const InterfaceVertices& vertices) {
    std::vector<glm::dvec3> at(vertices.positionCount);
    for (std::size_t v = 0; v < vertices.at.size(); ++v)
      at[vertices.positionId[v]] = vertices.at[v];
    return at;
  }

  LabeledComplex assembled(const GridFrame& frame) const {
    LabeledComplex out;
    std::vector<std::uint32_t> number(vertices_.positionCount, kNone);
    const auto numberOf = [&](std::uint32_t v) {
      std::uint32_t& n = number[vertices_.positionId[v]];
      if (n == kNone) {
        n = static_cast<std::uint32_t>(out.vertices.size());
        out.vertices.push_back(frame.worldFromIndex(vertices_.at[v]));
      }
      return n;
    };
    forEachFace([&](const std::array<std::uint32_t, 3>& t, std::uint16_t front, std::uint16_t back,
                    const Origin&) {
      out.faces.push_back({{numberOf(t[0]), numberOf(t[1]), numberOf(t[2])}, front, back});
    });
    return out;
  }

  template <class Visit>
  void forEachFace(const Visit& visit) const {
    for (const std::uint32_t leaf : cracked_) {
      for (std::uint32_t i = 0; i < quads_[leaf].size(); ++i) {
        const InterfaceQuad& quad = quads_[leaf][i];
        if (quad.label > quad.other) continue;  // the other side of a crack
        const auto inside = [&](std::uint32_t v) { return !isBorder_[v]; };
        const auto count = std::ranges::count_if(quad.vertex, inside);
        if (count == 4) {
          for (const auto& t : sherd::trianglesOf(quad, vertices_.at))
            visit(t, quad.label, quad.other, Origin{leaf, i});
        } else if (count == 3 && ends_ == CrackEnds::halfQuads) {
          std::array<std::uint32_t, 3> t{};
          std::ranges::copy_if(quad.vertex, t.begin(), inside);
          visit(t, quad.label, quad.other, Origin{leaf, i});
        }
      }
    }
    for (const InterfaceTriangle& gap : gaps_) {
      if (gap.label < gap.other) visit(gap.vertex, gap.label, gap.other, Origin{});
    }
  }

  const CrackEnds ends_;
  const Field field_;
  const std::span<const LeafNeighbors> neighborhoods_;
  std::vector<std::uint32_t> cracked_, withCells_;  // leaves, ascending
  std::vector<std::unique_ptr<LeafCells>> cells_;   // [leaf]
  std::vector<std::vector<InterfaceQuad>> quads_;   // [leaf]
  AllCells all_;
  InterfaceVertices vertices_;
  std::vector<std::uint32_t> nonManifold_;  // positions
  std::vector<InterfaceTriangle> gaps_;
  std::vector<bool> isBorder_, isComplex_;  // [vertices]
  std::vector<glm::dvec3> middles_;         // [vertices] in the unit cell
  std::vector<Junction> junctions_;
};

}  // namespace

LabeledComplex crackSurface(const Solid& solid, const Labels& beyond, const Cut& cut,
                            std::span<const LeafNeighbors> neighborhoods, const Progress* progress,
                            CrackEnds ends) {
  Solid whole = solid;
  whole.blocks = beyond.blocks;
  return CrackMeshing(whole, beyond, cut, neighborhoods, ends).mesh(solid.frame, progress);
}

}  // namespace sherd
