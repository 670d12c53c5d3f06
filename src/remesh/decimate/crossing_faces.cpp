// Finds crossings of collapsed surfaces.
#include "remesh/decimate/crossing_faces.h"

#include <utility>

#include "base/sort_unique.h"
#include "remesh/complex_faults.h"
#include "remesh/vertex_numbers.h"

namespace sherd {
namespace {

bool isGone(const ComplexFace& face) { return face.corner.x == face.corner.y; }

}  // namespace

LabeledComplex withoutGone(std::span<const glm::dvec3> vertices,
                           std::span<const ComplexFace> faces) {
  std::vector<std::uint32_t> used;
  for (const ComplexFace& face : faces) {
    if (!isGone(face)) used.insert(used.end(), {face.corner.x, face.corner.y, face.corner.z});
  }
  const VertexNumbers numbers(std::move(used), vertices.size());
  LabeledComplex out;
  for (const std::uint32_t v : numbers.vertices()) out.vertices.push_back(vertices[v]);
  for (const ComplexFace& face : faces) {
    if (isGone(face)) continue;
    out.faces.push_back(face);
    for (int k = 0; k < 3; ++k) out.faces.back().corner[k] = numbers.of(face.corner[k]);
  }
  return out;
}

std::vector<FacePair> facesThatCross(std::span<const glm::dvec3> vertices,
                                     std::span<const ComplexFace> faces,
                                     std::span<const std::uint8_t> isTested,
                                     const Progress* progress) {
  std::vector<std::uint32_t> source;
  std::vector<std::uint8_t> of;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    if (isGone(faces[f])) continue;
    source.push_back(f);
    of.push_back(isTested[f]);
  }
  std::vector<FacePair> found;
  for (const ComplexFault& fault : faultsOf(withoutGone(vertices, faces), {.of = of}, progress))
    found.push_back({source[fault.faces[0]], source[fault.faces[1]]});
  return found;
}

std::vector<std::uint32_t> cheapestToUndo(std::span<const FacePair> pairs, const CollapseLog& log,
                                          std::size_t depth) {
  std::vector<std::uint32_t> found;
  for (const auto& [a, b] : pairs) {
    const std::size_t ofA = log.collapsesToUndo(std::array{a}, depth).size();
    const std::size_t ofB = log.collapsesToUndo(std::array{b}, depth).size();
    if (ofA + ofB > 0) found.push_back(ofB == 0 || (ofA > 0 && ofA <= ofB) ? a : b);
  }
  sortUnique(found);
  return found;
}

}  // namespace sherd
