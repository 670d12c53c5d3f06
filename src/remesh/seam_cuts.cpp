// Cuts the faces of fragments along the seams of the input's attributes.
#include "remesh/seam_cuts.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "mesh/attributes/seams.h"
#include "remesh/face_ring.h"
#include "remesh/seam_charts.h"

namespace sherd {
namespace {

// A corner of a seam in a face is a vertex if it is so far from the face's sides, as a share of
// the face's heights, and so many voxels from the line that the seam would be without it.
constexpr double kWithin = 0.05, kBeside = 0.03;

// Splits the faces of one mesh.
class SeamCutting {
 public:
  SeamCutting(TriangleMesh mesh, const Seams& seams, const GridFrame& frame)
      : seams_(seams), frame_(frame) {
    out_.mesh = std::move(mesh);
  }

  SeamCutMesh run() && {
    measure();
    findCuts();
    if (edges_.empty()) return std::move(out_);
    const std::vector<glm::uvec3> faces = std::move(out_.mesh.triangles);
    const std::vector<std::uint16_t> neighbor = std::move(out_.mesh.neighbor);
    out_.mesh.triangles = {};
    out_.mesh.neighbor = {};
    out_.mesh.triangles.reserve(faces.size() + 2 * edges_.size());
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
      const auto first = static_cast<std::uint32_t>(out_.mesh.triangles.size());
      add(faces[f], neighbor.empty() || neighbor[f] == 0);
      const auto count = static_cast<std::uint32_t>(out_.mesh.triangles.size()) - first;
      if (count > 1) out_.faces.push_back({first, count, faces[f]});
      out_.uncut.resize(first + count, f);
      if (!neighbor.empty()) out_.mesh.neighbor.resize(first + count, neighbor[f]);
    }
    return std::move(out_);
  }

 private:
  // An edge that is cut, with its new vertices in the order of positions.
  struct CutEdge {
    std::array<std::uint32_t, 2> ends{};  // ascending
    std::uint32_t first = 0, count = 0;
  };

  const glm::dvec3& at(std::uint32_t v) const { return out_.mesh.vertices[v]; }

  // Vertices that follow one another are mostly near one another.
  void measure() {
    constexpr std::size_t kBlock = 64;
    const std::span<const glm::dvec3> vertices = out_.mesh.vertices;
    distance_.assign(vertices.size(), std::numeric_limits<double>::infinity());
    chart_.assign(vertices.size(), kNoTriangle);
    tbb::parallel_for(std::size_t{0}, (vertices.size() + kBlock - 1) / kBlock, [&](std::size_t i) {
      const std::size_t end = std::min(vertices.size(), (i + 1) * kBlock);
      Box box{vertices[i * kBlock], vertices[i * kBlock]};
      for (std::size_t v = i * kBlock; v < end; ++v) {
        box.min = glm::min(box.min, vertices[v]);
        box.max = glm::max(box.max, vertices[v]);
      }
      const double radius = 0.5 * glm::length(box.max - box.min) / frame_.voxelSize;
      if (!seams_.isNear(frame_.indexFromWorld(0.5 * (box.min + box.max)), radius)) return;
      for (std::size_t v = i * kBlock; v < end; ++v) {
        const glm::dvec3 at = frame_.indexFromWorld(vertices[v]);
        distance_[v] = seams_.distance(at);
        const bool isBeside = distance_[v] > 2.0 * Seams::kOnSeam && distance_[v] < Seams::kReach;
        if (isBeside) chart_[v] = seams_.sideAt(at);
      }
    });
  }

  bool mayCross(std::uint32_t a, std::uint32_t b) const {
    const double apart = distance_[a] + distance_[b];
    if (!(apart < 2.0 * Seams::kReach)) return false;
    if (chart_[a] != kNoTriangle && chart_[a] == chart_[b]) return false;
    return Seams::mayCross(glm::length(at(a) - at(b)) / frame_.voxelSize, distance_[a],
                           distance_[b]);
  }

  // Appends where a line passes seams, in its order, at most 2^depth - 1 times.
  void addCrossings(const glm::dvec3& begin, const glm::dvec3& end, int depth,
                    std::vector<glm::dvec3>& out) const {
    const auto t = seams_.crossing(frame_.indexFromWorld(begin), frame_.indexFromWorld(end));
    if (!t) return;
    const glm::dvec3 middle = begin + *t * (end - begin);
    if (depth > 1) addCrossings(begin, middle, depth - 1, out);
    out.push_back(middle);
    if (depth > 1) addCrossings(middle, end, depth - 1, out);
  }

  // Finds the edges that are cut, and adds their vertices.
  void findCuts() {
    constexpr int kDepth = 2;
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (const glm::uvec3& face : out_.mesh.triangles) {
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = face[k], b = face[(k + 1) % 3];
        if (a < b && mayCross(a, b)) edges.push_back({a, b});  // its other face has b before a
      }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    std::vector<std::vector<glm::dvec3>> cuts(edges.size());
    tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t i) {
      glm::dvec3 low = at(edges[i][0]), high = at(edges[i][1]);
      if (isBefore(high, low)) std::swap(low, high);
      addCrossings(low, high, kDepth, cuts[i]);
    });
    isEnd_.assign(distance_.size(), 0);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (cuts[i].empty()) continue;
      isEnd_[edges[i][0]] = isEnd_[edges[i][1]] = 1;
      edges_.push_back({edges[i], static_cast<std::uint32_t>(out_.mesh.vertices.size()),
                        static_cast<std::uint32_t>(cuts[i].size())});
      for (std::uint32_t k = 0; k < cuts[i].size(); ++k) {
        addVertex(cuts[i][k], {edges[i][0], edges[i][1], k});
      }
    }
  }

  void addVertex(const glm::dvec3& position, const std::array<std::uint32_t, 3>& parent) {
    out_.mesh.vertices.push_back(position);
    out_.parent.push_back(parent);
  }

  // Appends a corner and the cuts of the side that begins there.
  void addSide(std::uint32_t a, std::uint32_t b, int side, FaceRing& ring) const {
    ring.push_back({a, 1u << side | 1u << (side + 2) % 3});
    if (!isEnd_[a] || !isEnd_[b]) return;
    const std::array<std::uint32_t, 2> ends{std::min(a, b), std::max(a, b)};
    const auto found =
        std::lower_bound(edges_.begin(), edges_.end(), ends,
                         [](const CutEdge& e, const auto& of) { return e.ends < of; });
    if (found == edges_.end() || found->ends != ends) return;
    const bool isForward = isBefore(at(a), at(b));
    for (std::uint32_t k = 0; k < found->count; ++k) {
      ring.push_back({found->first + (isForward ? k : found->count - 1 - k), 1u << side});
    }
  }

  void add(const glm::uvec3& face, bool isOriginal) {
    if (isEnd_[face.x] + isEnd_[face.y] + isEnd_[face.z] < 2) {
      out_.mesh.triangles.push_back(face);
      return;
    }
    ring_.clear();
    for (int k = 0; k < 3; ++k) addSide(face[k], face[(k + 1) % 3], k, ring_);
    if (ring_.size() == 3) {
      out_.mesh.triangles.push_back(face);
      return;
    }
    if (isOriginal && addAround(face)) return;
    // With fewer points every diagonal that passes a seam passes a side, too.
    constexpr std::size_t kForced = 5;
    const auto cost = [&](const glm::dvec3& a, const glm::dvec3& b) {
      const bool isBad = ring_.size() > kForced &&
                         seams_.crossing(frame_.indexFromWorld(a), frame_.indexFromWorld(b));
      return (isBad ? 100.0 : 1.0) * glm::length(b - a);
    };
    for (const auto& [a, b, c] : triangulated(ring_, out_.mesh.vertices, cost)) {
      out_.mesh.triangles.emplace_back(ring_[a].vertex, ring_[b].vertex, ring_[c].vertex);
    }
  }

  // Adds triangles around a corner of a seam, if there is one within the face.
  bool addAround(const glm::uvec3& face) {
    const glm::dvec3 a = at(face.x), ab = at(face.y) - a, ac = at(face.z) - a;
    const glm::dvec3 middle = a + (ab + ac) / 3.0;
    const double size =
        std::max({glm::length(ab), glm::length(ac), glm::length(ac - ab)}) / frame_.voxelSize;
    const auto corner = seams_.cornerNear(frame_.indexFromWorld(middle), size);
    if (!corner) return false;
    const glm::dvec3 to = frame_.worldFromIndex(*corner) - a;
    const double bb = glm::dot(ab, ab), bc = glm::dot(ab, ac), cc = glm::dot(ac, ac);
    const double tb = glm::dot(to, ab), tc = glm::dot(to, ac), all = bb * cc - bc * bc;
    const double y = (cc * tb - bc * tc) / all, z = (bb * tc - bc * tb) / all;
    if (!(std::min({y, z, 1.0 - y - z}) > kWithin)) return false;
    const glm::dvec3 in = a + y * ab + z * ac;
    if (glm::length(in - a - to) > Seams::kAside * frame_.voxelSize) return false;
    if (!(fromBorder(in) > kBeside * frame_.voxelSize)) return false;
    const auto center = static_cast<std::uint32_t>(out_.mesh.vertices.size());
    addVertex(in, {face.x, face.x, 0});
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      out_.mesh.triangles.emplace_back(ring_[i].vertex, ring_[(i + 1) % ring_.size()].vertex,
                                       center);
    }
    return true;
  }

  // The distance of a point from the border that the face has without it: the line between two
  // cuts, or from the only one to the corner across.  With more cuts it is infinite.
  double fromBorder(const glm::dvec3& point) const {
    std::vector<glm::dvec3> ends;
    const std::size_t n = ring_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const bool isCut = std::has_single_bit(ring_[i].sides);
      const bool isAcross = n == 4 && std::has_single_bit(ring_[(i + 2) % n].sides);
      if (isCut || isAcross) ends.push_back(at(ring_[i].vertex));
    }
    if (ends.size() != 2) return std::numeric_limits<double>::infinity();
    const glm::dvec3 along = glm::normalize(ends[1] - ends[0]), to = point - ends[0];
    return glm::length(to - glm::dot(to, along) * along);
  }

  const Seams& seams_;
  const GridFrame& frame_;
  SeamCutMesh out_;
  std::vector<double> distance_;      // [vertices of the uncut mesh] to seams, voxels
  std::vector<std::uint32_t> chart_;  // [vertices of the uncut mesh] of those beside seams
  std::vector<CutEdge> edges_;        // ascending
  std::vector<std::uint8_t> isEnd_;   // [vertices of the uncut mesh] of one of them
  FaceRing ring_;                     // of the face at hand
};

}  // namespace

SeamCutMesh cutAlong(TriangleMesh mesh, const Seams& seams, const GridFrame& frame) {
  return SeamCutting(std::move(mesh), seams, frame).run();
}

std::vector<std::vector<CutFace>> cutTogether(std::span<LabeledMesh> meshes, const Seams& seams,
                                              const GridFrame& frame) {
  std::vector<std::vector<CutFace>> faces(meshes.size());
  std::vector<SeamCutMesh> cut(meshes.size());
  tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t i) {
    cut[i] = cutAlong(std::move(meshes[i].mesh), seams, frame);
    meshes[i].chart = seamCharts(cut[i].mesh, seams, frame);
  });
  std::uint32_t next = 0;
  for (const LabeledMesh& mesh : meshes) {
    for (const std::uint32_t id : mesh.positionId) next = std::max(next, id + 1);
  }
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> idOnEdge;  // by the numbers of its ends
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    LabeledMesh& out = meshes[i];
    out.mesh = std::move(cut[i].mesh);
    faces[i] = std::move(cut[i].faces);
    if (faces[i].empty()) continue;
    std::vector<std::uint16_t> other;
    for (const std::uint32_t f : cut[i].uncut) other.push_back(out.other[f]);
    out.other = std::move(other);
    for (const auto& [a, b, k] : cut[i].parent) {
      std::uint32_t id = next;
      if (a != b) {
        const std::uint32_t first = out.positionId[a], second = out.positionId[b];
        id = idOnEdge.try_emplace({std::min(first, second), std::max(first, second), k}, next)
                 .first->second;
      }
      out.positionId.push_back(id);
      if (id == next) ++next;
    }
  }
  return faces;
}

TriangleMesh uncut(const Fragment& fragment) {
  TriangleMesh out{fragment.mesh.vertices, {}};
  std::uint32_t next = 0;
  const auto keepUntil = [&](std::size_t end) {
    for (; next < end; ++next) {
      out.triangles.push_back(fragment.mesh.triangles[next]);
      out.neighbor.push_back(fragment.mesh.neighborOf(next));
    }
  };
  for (const CutFace& face : fragment.cutFaces) {
    keepUntil(face.first);
    out.triangles.push_back(face.corner);
    out.neighbor.push_back(fragment.mesh.neighborOf(face.first));
    next += face.count;
  }
  keepUntil(fragment.mesh.triangles.size());
  return out;
}

}  // namespace sherd
