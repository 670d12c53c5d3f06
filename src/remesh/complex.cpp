// Converts meshes to a complex and back.
#include "remesh/complex.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <utility>

namespace sherd {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

// [vertices] index of each vertex among the label's vertices at its position: 0, 1, ..
std::vector<std::uint8_t> sheetsOf(const LabeledMesh& mesh, std::vector<std::uint8_t>& count) {
  std::vector<std::uint8_t> sheet;
  sheet.reserve(mesh.positionId.size());
  for (const std::uint32_t positionId : mesh.positionId) sheet.push_back(count[positionId]++);
  for (const std::uint32_t positionId : mesh.positionId) count[positionId] = 0;
  return sheet;
}

LabeledMesh meshOf(std::span<const glm::dvec3> vertices, std::span<const ComplexFace> faces,
                   std::span<const std::uint32_t> own, std::uint16_t label) {
  LabeledMesh out;
  const auto add = [&](std::uint32_t v) {
    out.mesh.vertices.push_back(vertices[v]);
    out.positionId.push_back(v);
    return static_cast<std::uint32_t>(out.positionId.size() - 1);
  };
  // In the order of the complex, so that an unchanged mesh keeps its vertex order.
  std::vector<std::uint32_t> used;
  used.reserve(3 * own.size());
  for (const std::uint32_t f : own) {
    for (int k = 0; k < 3; ++k) used.push_back(faces[f].corner[k]);
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (const std::uint32_t v : used) (void)add(v);
  const auto numberOf = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin());
  };
  std::map<std::pair<std::uint32_t, std::uint8_t>, std::uint32_t> moreSheets;  // above 0
  for (const std::uint32_t f : own) {
    const ComplexFace& face = faces[f];
    const bool isFront = face.front == label;
    glm::uvec3 corner;
    for (const int k : {0, 1, 2}) {
      const std::uint32_t v = face.corner[k];
      const std::uint8_t sheet =
          (isFront ? face.frontSheet : face.backSheet)[static_cast<std::size_t>(k)];
      if (sheet == 0) {
        corner[k] = numberOf(v);
      } else {
        const auto [found, isNew] = moreSheets.try_emplace({v, sheet}, kNone);
        if (isNew) found->second = add(v);
        corner[k] = found->second;
      }
    }
    if (!isFront) std::swap(corner.y, corner.z);
    out.mesh.triangles.push_back(corner);
    out.other.push_back(isFront ? face.back : face.front);
    out.mesh.neighbor.push_back(isFront ? face.neighbor : face.front);
    if (face.chart != 0) out.chart.resize(out.other.size() - 1, 0);
    if (face.chart != 0 || !out.chart.empty()) out.chart.push_back(face.chart);
  }
  return out;
}

}  // namespace

std::vector<glm::uvec3> trianglesOf(const LabeledComplex& complex) {
  std::vector<glm::uvec3> triangles;
  triangles.reserve(complex.faces.size());
  for (const ComplexFace& face : complex.faces) triangles.push_back(face.corner);
  return triangles;
}

LabeledComplex complexOf(const TriangleMesh& mesh, std::span<const std::uint32_t> charts) {
  LabeledComplex out{mesh.vertices, std::vector<bool>(mesh.vertices.size(), false), {}, 1};
  out.faces.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    out.faces.push_back({mesh.triangles[t], 1, 0, mesh.neighborOf(t)});
    if (!charts.empty()) out.faces.back().chart = charts[t];
  }
  return out;
}

LabeledComplex complexOf(std::span<const LabeledMesh> meshes) {
  LabeledComplex out;
  out.labels = static_cast<std::uint16_t>(meshes.size());
  std::size_t positionCount = 0;
  for (const LabeledMesh& mesh : meshes) {
    for (const std::uint32_t positionId : mesh.positionId)
      positionCount = std::max<std::size_t>(positionCount, positionId + 1u);
  }
  out.vertices.resize(positionCount);
  out.fixed.resize(positionCount);
  std::vector<std::uint8_t> count(positionCount, 0);
  std::vector<std::vector<std::uint8_t>> sheets;
  for (const LabeledMesh& mesh : meshes) {
    sheets.push_back(sheetsOf(mesh, count));
    for (std::size_t v = 0; v < mesh.positionId.size(); ++v) {
      out.vertices[mesh.positionId[v]] = mesh.mesh.vertices[v];
      if (sheets.back()[v] > 0) out.fixed[mesh.positionId[v]] = true;
    }
  }
  // Faces at fixed vertices by key, to set the sheets of their backs.
  using Key = std::array<std::uint32_t, 5>;  // lower label, higher label, positions ascending
  std::map<Key, std::size_t> atFixed;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const LabeledMesh& mesh = meshes[i];
    const auto label = static_cast<std::uint16_t>(i + 1);
    for (std::size_t t = 0; t < mesh.other.size(); ++t) {
      const std::uint16_t other = mesh.other[t];
      const glm::uvec3& vertex = mesh.mesh.triangles[t];
      ComplexFace face{
          {mesh.positionId[vertex.x], mesh.positionId[vertex.y], mesh.positionId[vertex.z]},
          label,
          other,
          mesh.mesh.neighborOf(t),
          {sheets[i][vertex.x], sheets[i][vertex.y], sheets[i][vertex.z]},
          {},
          mesh.chart.empty() ? 0 : mesh.chart[t]};
      const bool isBack = out.isClosed(other) && other < label;
      const glm::uvec3& c = face.corner;
      if (out.fixed[c.x] || out.fixed[c.y] || out.fixed[c.z]) {
        Key key{std::min(label, other), std::max(label, other), c.x, c.y, c.z};
        std::sort(key.begin() + 2, key.end());
        if (!isBack) {
          atFixed[key] = out.faces.size();
        } else if (const auto found = atFixed.find(key); found != atFixed.end()) {
          ComplexFace& front = out.faces[found->second];
          for (int k = 0; k < 3; ++k) {
            for (int j = 0; j < 3; ++j) {
              if (front.corner[k] != c[j]) continue;
              front.backSheet[static_cast<std::size_t>(k)] =
                  face.frontSheet[static_cast<std::size_t>(j)];
            }
          }
        }
      }
      if (!isBack) out.faces.push_back(face);
    }
  }
  return out;
}

std::vector<LabeledMesh> meshesOf(std::span<const glm::dvec3> vertices,
                                  std::span<const ComplexFace> faces, std::uint16_t labels) {
  std::vector<std::vector<std::uint32_t>> own(labels);
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    if (faces[f].corner.x == faces[f].corner.y) continue;
    for (const std::uint16_t label : {faces[f].front, faces[f].back}) {
      if (label >= 1 && label <= labels) own[label - 1u].push_back(f);
    }
  }
  std::vector<LabeledMesh> out(labels);
  tbb::parallel_for(std::size_t{0}, out.size(), [&](std::size_t i) {
    out[i] = meshOf(vertices, faces, own[i], static_cast<std::uint16_t>(i + 1));
  });
  return out;
}

}  // namespace sherd
