// Connectivity under edge collapses.
#include "surface/edge_collapse.h"

#include <algorithm>
#include <iterator>

namespace sherd {

CollapsingMesh::CollapsingMesh(const TriangleMesh& mesh, std::span<const std::uint16_t> facing)
    : faces_(mesh.triangles),
      facing_(facing.begin(), facing.end()),
      around_(mesh.vertices.size()),
      left_(faces_.size()) {
  for (Index f = 0; f < faces_.size(); ++f) {
    for (int k = 0; k < 3; ++k) around_[faces_[f][k]].push_back(f);
  }
}

std::vector<CollapsingMesh::Index> CollapsingMesh::neighbours(Index v) const {
  std::vector<Index> found;
  for (const Index f : around_[v]) {
    for (int k = 0; k < 3; ++k) {
      if (faces_[f][k] != v) found.push_back(faces_[f][k]);
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

bool CollapsingMesh::isRim(Index a, Index b) const {
  std::uint16_t found[2] = {0, 0};  // by the two faces at the edge
  std::size_t n = 0;
  for (const Index f : around_[a]) {
    if (has(f, b)) found[n++ & 1] = facing_[f];
  }
  return found[0] != found[1];
}

int CollapsingMesh::rimEdges(Index v) const {
  const std::uint16_t first = facing_[around_[v].front()];
  if (std::all_of(around_[v].begin(), around_[v].end(),
                  [&](Index f) { return facing_[f] == first; })) {
    return 0;
  }
  int count = 0;
  for (const Index n : neighbours(v)) count += isRim(v, n);
  return count;
}

bool CollapsingMesh::keepsTopology(Index a, Index b) const {
  const std::vector<Index> na = neighbours(a), nb = neighbours(b);
  std::vector<Index> common;
  std::set_intersection(na.begin(), na.end(), nb.begin(), nb.end(), std::back_inserter(common));
  if (common.size() != 2) return false;
  if (na.size() == 3 && nb.size() == 3) return false;  // a tetrahedron
  if (!isRim(a, b)) return true;
  // A face with all three edges on rims is a region, or the end of one, that would vanish.
  return !(isRim(a, common[0]) && isRim(b, common[0])) &&
         !(isRim(a, common[1]) && isRim(b, common[1]));
}

void CollapsingMesh::collapse(Index a, Index b) {
  for (const Index f : around_[b]) {
    glm::uvec3& t = faces_[f];
    if (!has(f, a)) {
      for (int k = 0; k < 3; ++k) {
        if (t[k] == b) t[k] = a;
      }
      around_[a].push_back(f);
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      if (t[k] != b) std::erase(around_[t[k]], f);
    }
    t = glm::uvec3(0);
    --left_;
  }
  around_[b].clear();
}

}  // namespace sherd
