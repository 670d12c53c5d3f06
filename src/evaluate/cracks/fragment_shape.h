// The shape of one fragment: faces, vertices and corners.
#pragma once

#include <sherd/evaluate.h>

#include <optional>
#include <vector>

#include "evaluate/cracks/crack_faces.h"

namespace sherd {

/// A fragment's mesh, divided into planes.
struct DividedMesh {
  const TriangleMesh* mesh = nullptr;
  std::vector<std::uint16_t> neighbor{};               ///< [m] 0 for the original surface
  std::vector<std::pair<int, double>> neighborArea{};  ///< ascending ids
  std::vector<std::uint32_t> split{};                  ///< [m] or empty: partingSplits
  std::vector<SharedEdge> edges{};
  Areas planes{};
  Areas facets{};  ///< empty before divideIntoFacets
  double area = 0.0, crackArea = 0.0;
  double onePlane =
      0.0;  ///< integral over the cracks of the share of a contact that is in one plane
};

/// Lengths in world units.
struct ShapeLimits {
  double planeTolerance = 0.0;
  double leastArea = 0.0;
  double vertexRadius = 0.0;
};

/// Divides cracks and original surface into planes.
///   neighbor  [m]
[[nodiscard]] DividedMesh divided(const TriangleMesh& mesh, std::vector<std::uint16_t> neighbor,
                                  const ShapeLimits& limits, const Progress* progress);

/// Divides cracks into facets, see FaceRule::facets.
void divideIntoFacets(DividedMesh& mesh, const Progress* progress);

/// Counts, of a mesh, the values of FragmentShape that are measured on it, except for `corners`.
void measureShape(FragmentShape& shape, const DividedMesh& mesh, FaceRule rule,
                  const ShapeLimits& limits);

/// Returns the corners of a fragment of a plate, unless it has part of the rim: original
/// surface whose normal is more than 45 degrees off the axis, of at least the least area and a
/// tenth of the thickness squared.
[[nodiscard]] std::optional<std::size_t> cornersOf(const DividedMesh& mesh, FaceRule rule, int axis,
                                                   const ShapeLimits& limits);

}  // namespace sherd
