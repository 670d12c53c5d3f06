// Connects triangles over edges, and separates the fans around vertices.
#include "remesh/manifold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "base/union_find.h"
#include "remesh/face_edges.h"

namespace sherd {
namespace {

using Use = FaceEdges::Use;

class Fans {
 public:
  explicit Fans(const TriangleMesh& mesh)
      : mesh_(mesh),
        edges_(mesh.triangles, mesh.vertices.size()),
        fans_(3 * mesh.triangles.size()),
        hasOutside_(edges_.count(), false) {}

  // Returns false if an edge is not used as often in one direction as in the other.
  bool connect() {
    for (std::size_t e = 0; e < edges_.count(); ++e) {
      const auto uses = edges_.uses(e);
      const auto forward =
          std::count_if(uses.begin(), uses.end(), [](const Use& use) { return use.isForward; });
      if (2 * static_cast<std::size_t>(forward) != uses.size()) return false;
    }
    do {
      fans_ = UnionFind(3 * mesh_.triangles.size());
      for (std::size_t e = 0; e < edges_.count(); ++e) {
        const auto uses = edges_.uses(e);
        if (uses.size() == 2) {
          connect(uses[0], uses[1]);
        } else {
          connectSheets(e);
        }
      }
    } while (reconnectUnsplit());
    return true;
  }

  // The first of the corners of a fan.
  std::uint32_t fanOf(std::uint32_t corner) { return fans_.find(corner); }

 private:
  std::uint32_t vertexAt(std::uint32_t corner) const {
    return mesh_.triangles[corner / 3][static_cast<int>(corner % 3)];
  }

  void connect(const Use& a, const Use& b) {
    const std::uint32_t from = 3 * a.face + a.corner, to = 3 * a.face + (a.corner + 1u) % 3;
    const std::uint32_t otherFrom = 3 * b.face + b.corner,
                        otherTo = 3 * b.face + (b.corner + 1u) % 3;
    fans_.unite(from, vertexAt(otherFrom) == vertexAt(from) ? otherFrom : otherTo);
    fans_.unite(to, vertexAt(otherFrom) == vertexAt(to) ? otherFrom : otherTo);
  }

  // Where the sheets at an edge are one fan at both ends, the edge still has more than two
  // triangles. Connecting those with the outside between them splits a fan of four triangles at the
  // edge in two.  Returns whether there are such edges that have not been connected so.
  bool reconnectUnsplit() {
    bool isAny = false;
    for (std::size_t e = 0; e < edges_.count(); ++e) {
      if (edges_.uses(e).size() == 2 || hasOutside_[e] || isSplit(e)) continue;
      hasOutside_[e] = isAny = true;
    }
    return isAny;
  }

  // Whether no more than two triangles at an edge have the same fans at both of its ends.
  bool isSplit(std::size_t edge) {
    std::vector<std::array<std::uint32_t, 2>> fans;
    for (const Use& use : edges_.uses(edge)) {
      const std::uint32_t from = fanOf(3 * use.face + use.corner);
      const std::uint32_t to = fanOf(3 * use.face + (use.corner + 1u) % 3);
      fans.push_back(use.isForward ? std::array{from, to} : std::array{to, from});
    }
    std::sort(fans.begin(), fans.end());
    for (std::size_t i = 2; i < fans.size(); ++i) {
      if (fans[i] == fans[i - 2]) return false;
    }
    return true;
  }

  // Around an edge, seen against its direction, the inside begins after a triangle that uses it
  // backward and ends at the next that uses it forward.
  void connectSheets(std::size_t edge) {
    const auto& [low, high] = edges_.ends(edge);
    const glm::dvec3 &from = mesh_.vertices[low], along = mesh_.vertices[high] - from;
    const glm::dvec3 away =
        std::abs(along.x) < std::abs(along.y) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::cross(along, away), v = glm::cross(along, u) / glm::length(along);
    struct Spoke {
      double angle = 0.0;
      Use use;
    };
    std::vector<Spoke> spokes;
    for (const Use& use : edges_.uses(edge)) {
      const std::uint32_t tip = 3 * use.face + (use.corner + 2u) % 3;
      const glm::dvec3 to = mesh_.vertices[vertexAt(tip)] - from;
      spokes.push_back({std::atan2(glm::dot(to, v), glm::dot(to, u)), use});
    }
    std::sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) {
      return a.angle != b.angle ? a.angle < b.angle : a.use.face < b.use.face;
    });
    std::vector<bool> isTaken(spokes.size(), false);
    for (std::size_t i = 0; i < spokes.size(); ++i) {
      if (spokes[i].use.isForward != hasOutside_[edge]) continue;
      for (std::size_t step = 1; step < spokes.size(); ++step) {
        const std::size_t k = (i + step) % spokes.size();
        if (spokes[k].use.isForward == hasOutside_[edge] || isTaken[k]) continue;
        isTaken[k] = true;
        connect(spokes[i].use, spokes[k].use);
        break;
      }
    }
  }

  const TriangleMesh& mesh_;
  const FaceEdges edges_;
  UnionFind fans_;                // [corners]
  std::vector<bool> hasOutside_;  // [edges] between the triangles that are connected
};

}  // namespace

bool makeManifold(LabeledMesh& labeled) {
  TriangleMesh& mesh = labeled.mesh;
  Fans fans(mesh);
  if (!fans.connect()) return false;
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> fanOfVertex(mesh.vertices.size(), kNone);
  std::vector<std::uint32_t> vertexOfFan(3 * mesh.triangles.size(), kNone);
  std::vector<glm::uvec3> triangles = mesh.triangles;
  for (std::uint32_t corner = 0; corner < vertexOfFan.size(); ++corner) {
    const std::uint32_t fan = fans.fanOf(corner);
    std::uint32_t& vertex = triangles[corner / 3][static_cast<int>(corner % 3)];
    if (vertexOfFan[fan] == kNone) {
      vertexOfFan[fan] = vertex;
      if (fanOfVertex[vertex] != kNone) {  // another fan has the vertex
        vertexOfFan[fan] = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(glm::dvec3(mesh.vertices[vertex]));  // a copy: the vector may move
        labeled.positionId.push_back(labeled.positionId[vertex]);
      } else {
        fanOfVertex[vertex] = fan;
      }
    }
    vertex = vertexOfFan[fan];
  }
  mesh.triangles = std::move(triangles);
  return true;
}

}  // namespace sherd
