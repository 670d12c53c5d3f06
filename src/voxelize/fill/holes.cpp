// The surface that closes a mesh's holes.
#include "voxelize/fill/holes.h"

#include <sherd/solid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <optional>
#include <unordered_map>
#include <vector>

#include "base/cancel_flag.h"

namespace sherd {
namespace {

using openvdb::Coord;

// For WorkLimit: two look-ups of voxels; and two winding numbers of all caps, and four cells.
constexpr std::uint64_t kStepsPerVisit = 50, kStepsPerCrossing = 1000;

// The surface is searched for within this many voxels of the boundary.
constexpr int kStartVoxels = 2;

std::uint64_t keyOf(const Coord& c) {
  constexpr int kBits = 20;  // a grid is below 2^13 voxels wide
  const auto biased = [](int v) { return static_cast<std::uint64_t>(v + (1 << (kBits - 1))); };
  return biased(c.x()) << 2 * kBits | biased(c.y()) << kBits | biased(c.z());
}

// From a voxel to the next one along an axis.
struct Step {
  Coord from;
  int axis;
};

Coord shifted(Coord c, int axis, int by) {
  c[axis] += by;
  return c;
}

class HoleNet {
 public:
  HoleNet(const GeneralizedWinding& winding, const TriangleTree& tree)
      : winding_(winding), tree_(tree) {}

  void startAt(const glm::dvec3& point) {
    const Coord middle(static_cast<int>(std::floor(point.x)), static_cast<int>(std::floor(point.y)),
                       static_cast<int>(std::floor(point.z)));
    for (int x = -kStartVoxels; x <= kStartVoxels; ++x) {
      for (int y = -kStartVoxels; y <= kStartVoxels; ++y) {
        for (int z = -kStartVoxels; z <= kStartVoxels; ++z) {
          for (int axis = 0; axis < 3; ++axis) visit({middle + Coord(x, y, z), axis});
        }
      }
    }
  }

  void follow(const Progress* progress) {
    constexpr std::size_t kStepsPerCancelCheck = 256;
    for (std::size_t i = 0; i < crossed_.size(); ++i) {
      if (i % kStepsPerCancelCheck == 0) {
        throwIfCancelled(progress);
        winding_.work().check();
      }
      const Step step = crossed_[i];
      forEachCell(step, [&](const Coord& cell) {
        for (int axis = 0; axis < 3; ++axis) {
          const int b = (axis + 1) % 3, c = (axis + 2) % 3;
          for (int corner = 0; corner < 4; ++corner) {
            visit({shifted(shifted(cell, b, corner & 1), c, corner >> 1), axis});
          }
        }
      });
    }
  }

  [[nodiscard]] TriangleMesh mesh() const {
    TriangleMesh out;
    std::unordered_map<std::uint64_t, std::uint32_t> vertexOf;
    const auto vertex = [&](const Coord& cell) {
      const auto [found, isNew] =
          vertexOf.try_emplace(keyOf(cell), static_cast<std::uint32_t>(out.vertices.size()));
      if (isNew) {
        const Cell& c = cells_.at(keyOf(cell));
        out.vertices.push_back(c.sum / static_cast<double>(c.crossings));
      }
      return found->second;
    };
    for (const Step& step : crossed_) {
      std::array<std::uint32_t, 4> quad{};
      std::size_t k = 0;
      forEachCell(step, [&](const Coord& cell) { quad[k++] = vertex(cell); });
      out.triangles.emplace_back(quad[0], quad[1], quad[2]);
      out.triangles.emplace_back(quad[0], quad[2], quad[3]);
    }
    return out;
  }

 private:
  struct Voxel {
    double distance = 0.0;         // to the mesh; infinite from 1 voxel
    std::optional<bool> inside{};  // computed on first use
  };
  struct Cell {
    glm::dvec3 sum{0.0};
    int crossings = 0;
  };

  // Calls visit(cell) for the four cells around a step, in cyclic order; a cell is identified by
  // its lowest voxel.
  template <class Visit>
  static void forEachCell(const Step& step, Visit&& visit) {
    const int b = (step.axis + 1) % 3, c = (step.axis + 2) % 3;
    visit(step.from);
    visit(shifted(step.from, b, -1));
    visit(shifted(shifted(step.from, b, -1), c, -1));
    visit(shifted(step.from, c, -1));
  }

  Voxel& voxel(const Coord& at) {
    const auto [found, isNew] = voxels_.try_emplace(keyOf(at));
    if (isNew) found->second.distance = tree_.nearest({at.x(), at.y(), at.z()}, 1.0).distance;
    return found->second;
  }
  bool isInside(Voxel& voxel, const Coord& at) const {
    if (!voxel.inside) voxel.inside = winding_.isInside(at);
    return *voxel.inside;
  }

  // Records a step whose ends are on different sides, if no triangle can lie between them.
  void visit(const Step& step) {
    if (!seen_.try_emplace(keyOf(step.from) << 2 | static_cast<std::uint64_t>(step.axis), true)
             .second) {
      return;
    }
    const Coord next = shifted(step.from, step.axis, 1);
    Voxel &from = voxel(step.from), &to = voxel(next);  // references stay valid
    if (from.distance + to.distance <= 1.0) return;
    winding_.work().add(kStepsPerVisit);
    if (isInside(from, step.from) == isInside(to, next)) return;
    winding_.work().add(kStepsPerCrossing);
    const double a = winding_.at(step.from), b = winding_.at(next);
    glm::dvec3 crossing(step.from.x(), step.from.y(), step.from.z());
    crossing[step.axis] += (0.5 - a) / (b - a);
    crossed_.push_back(step);
    forEachCell(step, [&](const Coord& at) {
      Cell& cell = cells_[keyOf(at)];
      cell.sum += crossing;
      ++cell.crossings;
    });
  }

  const GeneralizedWinding& winding_;
  const TriangleTree& tree_;
  std::unordered_map<std::uint64_t, Voxel> voxels_;
  std::unordered_map<std::uint64_t, bool> seen_;
  std::unordered_map<std::uint64_t, Cell> cells_;
  std::vector<Step> crossed_;
};

}  // namespace

TriangleMesh holeSurface(const GeneralizedWinding& winding, const TriangleTree& tree,
                         const Progress* progress) {
  HoleNet net(winding, tree);
  const TriangleMesh& caps = winding.caps();
  for (const glm::uvec3& t : caps.triangles) {
    throwIfCancelled(progress);
    winding.work().check();
    for (int k = 0; k < 2; ++k) {
      if (t[k + 1] != t[k] + 1) continue;  // an inner edge of the cap
      const glm::dvec3 a = caps.vertices[t[k]], b = caps.vertices[t[k + 1]];
      const int steps = std::max(1, static_cast<int>(std::ceil(glm::distance(a, b))));
      for (int i = 0; i <= steps; ++i) net.startAt(a + static_cast<double>(i) / steps * (b - a));
    }
  }
  net.follow(progress);
  winding.work().check();
  return net.mesh();
}

}  // namespace sherd
