// Builds a closed manifold from voxel faces.  Four faces meet at a lattice edge where two voxels
// share only that edge; there the two faces of each voxel are joined:
//
//          |###
//          |#A#
//     -----+-----
//      #B# |
//      ### |
//
// A vertex is a cycle of joined faces around a lattice corner; a corner may have several vertices.
// If both pairs have the same vertex at each end of such an edge (the voxels are connected beyond
// the ends), the edge would still have four faces, so each pair gets a vertex at its middle.
#include "surface/label_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <glm/geometric.hpp>
#include <numeric>

#include "base/union_find.h"
#include "cut/label_reader.h"
#include "interface/contacts.h"

namespace sherd {
namespace {

using openvdb::Coord;

constexpr std::uint32_t kNone = 0xffffffffu;

Coord towards(int direction) {
  Coord step(0, 0, 0);
  step[direction / 2] = direction % 2 ? 1 : -1;
  return step;
}

// The corners of a face, counter-clockwise from outside.  Lattice corner (i,j,k) is the lowest
// corner of voxel (i,j,k).
std::array<Coord, 4> cornersOf(const VoxelFace& face) {
  const int axis = face.direction / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  Coord base = face.voxel;
  base[axis] += face.direction % 2;
  std::array<Coord, 4> corners{base, base, base, base};
  corners[1][u] += 1;
  corners[2][u] += 1;
  corners[2][v] += 1;
  corners[3][v] += 1;
  if (face.direction % 2 == 0) std::swap(corners[1], corners[3]);
  return corners;
}

// A lattice edge as a side of one face.
struct EdgeUse {
  Coord low;  // the end with the lower coordinates
  int axis = 0;
  std::uint32_t lowSlot = 0, highSlot = 0;  // face * 4 + corner
  std::uint32_t side = 0;                   // face * 4 + side, side k from corner k to k + 1

  bool sameEdge(const EdgeUse& other) const { return low == other.low && axis == other.axis; }
};

std::vector<EdgeUse> edgeUses(std::span<const VoxelFace> faces) {
  std::vector<EdgeUse> uses;
  uses.reserve(faces.size() * 4);
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    const std::array<Coord, 4> corners = cornersOf(faces[f]);
    for (std::uint32_t k = 0; k < 4; ++k) {
      const Coord &from = corners[k], &to = corners[(k + 1) % 4];
      EdgeUse use{from, 0, f * 4 + k, f * 4 + (k + 1) % 4, f * 4 + k};
      while (from[use.axis] == to[use.axis]) ++use.axis;
      if (to[use.axis] < from[use.axis]) {
        use.low = to;
        std::swap(use.lowSlot, use.highSlot);
      }
      uses.push_back(use);
    }
  }
  // Uses by one voxel are adjacent, so that pairs of faces are too.
  std::sort(uses.begin(), uses.end(), [&](const EdgeUse& a, const EdgeUse& b) {
    if (a.low != b.low) return a.low < b.low;
    if (a.axis != b.axis) return a.axis < b.axis;
    const Coord &va = faces[a.side / 4].voxel, &vb = faces[b.side / 4].voxel;
    return va != vb ? va < vb : a.side < b.side;
  });
  return uses;
}

class Builder {
 public:
  Builder(std::span<const VoxelFace> faces, double offsetVoxels)
      : faces_(faces),
        offsetVoxels_(offsetVoxels),
        vertexSets_(faces.size() * 4),
        middle_(faces.size() * 4, kNone) {}

  TriangleMesh build(const GridFrame& frame) {
    const std::vector<EdgeUse> uses = edgeUses(faces_);
    for (std::size_t i = 0; i < uses.size(); i += 2) {
      assert(uses[i].sameEdge(uses[i + 1]));
      vertexSets_.unite(uses[i].lowSlot, uses[i + 1].lowSlot);
      vertexSets_.unite(uses[i].highSlot, uses[i + 1].highSlot);
    }
    makeVertices();
    for (std::size_t i = 0; i + 2 < uses.size(); i += 2) {
      if (!uses[i].sameEdge(uses[i + 2])) continue;
      if (vertexSets_.find(uses[i].lowSlot) != vertexSets_.find(uses[i + 2].lowSlot) ||
          vertexSets_.find(uses[i].highSlot) != vertexSets_.find(uses[i + 2].highSlot)) {
        continue;
      }
      addMiddle(uses[i], uses[i + 1]);
      addMiddle(uses[i + 2], uses[i + 3]);
    }
    for (std::uint32_t f = 0; f < faces_.size(); ++f) addTriangles(f);
    for (glm::dvec3& v : out_.vertices) v = frame.worldFromIndex(v);
    return std::move(out_);
  }

 private:
  static glm::dvec3 positionOf(const Coord& corner) {
    return glm::dvec3(corner.x(), corner.y(), corner.z()) - 0.5;
  }

  // An offset against the faces' normals, into the fragment.
  glm::dvec3 backwards(const glm::dvec3& normals) const {
    const double length = glm::length(normals);
    return length > 0.0 ? normals * (-offsetVoxels_ / length) : glm::dvec3(0.0);
  }

  void makeVertices() {
    vertex_.assign(faces_.size() * 4, kNone);
    std::vector<glm::dvec3> normals;
    std::vector<Coord> corners;
    for (std::uint32_t slot = 0; slot < vertex_.size(); ++slot) {
      const std::uint32_t first = vertexSets_.find(slot);
      if (vertex_[first] == kNone) {  // then first == slot: roots are the lowest
        vertex_[first] = static_cast<std::uint32_t>(corners.size());
        corners.push_back(cornersOf(faces_[slot / 4])[slot % 4]);
        normals.emplace_back(0.0);
      }
      vertex_[slot] = vertex_[first];
      const Coord n = towards(faces_[slot / 4].direction);
      normals[vertex_[slot]] += glm::dvec3(n.x(), n.y(), n.z());
    }
    std::vector<std::uint32_t> order(corners.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return corners[a] < corners[b]; });
    for (std::uint32_t v = 0; v < corners.size(); ++v) {
      out_.vertices.push_back(positionOf(corners[v]));
    }
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Coord& here = corners[order[i]];
      if ((i > 0 && corners[order[i - 1]] == here) ||
          (i + 1 < order.size() && corners[order[i + 1]] == here)) {
        out_.vertices[order[i]] += backwards(normals[order[i]]);
      }
    }
  }

  void addMiddle(const EdgeUse& a, const EdgeUse& b) {
    glm::dvec3 at = positionOf(a.low), normals(0.0);
    at[a.axis] += 0.5;
    for (const EdgeUse& use : {a, b}) {
      const Coord n = towards(faces_[use.side / 4].direction);
      normals += glm::dvec3(n.x(), n.y(), n.z());
      middle_[use.side] = static_cast<std::uint32_t>(out_.vertices.size());
    }
    out_.vertices.push_back(at + backwards(normals));
  }

  void addTriangles(std::uint32_t f) {
    // The outline is triangulated as a fan.  The fan starts at a middle vertex if there is one,
    // because that is collinear with its two neighbors; else at a corner of even sum.
    std::array<std::uint32_t, 8> outline{};
    std::size_t n = 0, start = 0;
    bool hasMiddle = false;
    const std::array<Coord, 4> corners = cornersOf(faces_[f]);
    for (std::uint32_t k = 0; k < 4; ++k) {
      const bool even = ((corners[k].x() + corners[k].y() + corners[k].z()) & 1) == 0;
      if (!hasMiddle && even) start = n;
      outline[n++] = vertex_[f * 4 + k];
      if (middle_[f * 4 + k] == kNone) continue;
      if (!hasMiddle) start = n;
      hasMiddle = true;
      outline[n++] = middle_[f * 4 + k];
    }
    for (std::size_t i = 1; i + 1 < n; ++i) {
      out_.triangles.push_back(
          {outline[start], outline[(start + i) % n], outline[(start + i + 1) % n]});
      out_.neighbor.push_back(faces_[f].neighbor);
    }
  }

  std::span<const VoxelFace> faces_;
  double offsetVoxels_;
  UnionFind vertexSets_;               // [faces * 4] the faces' corners
  std::vector<std::uint32_t> vertex_;  // [faces * 4]
  std::vector<std::uint32_t> middle_;  // [faces * 4] vertex on a side, or kNone
  TriangleMesh out_;
};

}  // namespace

std::vector<VoxelFace> facesOf(const Solid& solid, const Labels& labels, const Labels& uneroded,
                               std::uint16_t fragment, std::span<const std::uint32_t> leaves) {
  const LeafBlocks& blocks = *solid.blocks;
  LabelReader now(blocks, labels), before(blocks, uneroded);
  const auto neighbor = [&](const Coord& voxel, const Coord& step) {
    Coord at = voxel + step;
    for (int away = 1; away <= kMaxErosionDepth && before.isInside(at); ++away, at += step) {
      if (before.at(at) != fragment) return before.at(at);
    }
    return std::uint16_t{0};
  };
  std::vector<VoxelFace> faces;
  for (const std::uint32_t leaf : leaves) {
    for (std::size_t x = 0; x < 8; ++x) {
      for (std::uint64_t bits = blocks.inside[leaf * 8 + x]; bits; bits &= bits - 1) {
        const std::size_t voxelIndex =
            std::size_t{leaf} * 512 + x * 64 + static_cast<std::size_t>(std::countr_zero(bits));
        if (labels.fragment[voxelIndex] != fragment) continue;
        const Coord voxel = blocks.voxelAt(voxelIndex);
        for (int direction = 0; direction < 6; ++direction) {
          const Coord step = towards(direction);
          if (now.isInside(voxel + step) && now.at(voxel + step) == fragment) continue;
          faces.push_back({voxel, direction, neighbor(voxel, step)});
        }
      }
    }
  }
  return faces;
}

TriangleMesh meshOfFaces(std::span<const VoxelFace> faces, const GridFrame& frame,
                         double offsetVoxels) {
  return Builder(faces, offsetVoxels).build(frame);
}

}  // namespace sherd
