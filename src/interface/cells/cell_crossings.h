// The crossings of a cell's edges by surfaces, and their tangent planes.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "interface/cells/cell.h"
#include "interface/cells/crease_point.h"
#include "interface/cells/input_crossings.h"

namespace sherd {

/// Labels and distances at the corners of a cell.
struct CellValues {
  CellLabels labels{};
  std::array<float, 8> toSurface{};  ///< distance to the solid's surface, any unit, inside
                                     ///< negative; set where a label is 0
  std::array<std::array<float, 8>, 8> toCut{};  ///< [corner whose label][corner] voxels to the cut,
                                                ///< inside negative; set where two fragments meet
  /// Of the edges between 0 and other labels; none where the distances have the same crossings, or
  /// no triangle of the input crosses the edge.
  std::array<std::optional<InputCrossing>, 12> onInput{};
};

/// The crossing of an edge, in 0..1 along each axis.
struct Crossing {
  unsigned low = 0, high = 0;  ///< corners of the edge
  bool isOuter = false;        ///< one has label 0
  bool isLowOutside = false;   ///< the lower one has
  TangentPlane plane;          ///< the normal points to the higher corner; of outer crossings by
                               ///< the input only
};

/// The crossings of one position.
struct Crossings {
  std::array<Crossing, 12> all;
  std::size_t count = 0;
  glm::dvec3 mean{0.0};
  bool onePair = true;  ///< of labels
  std::size_t outers = 0;
  bool areOnInput = false;  ///< there are outer crossings, and the input has all of them
  float snapWeight = 0.0f;  ///< the largest of its labels

  [[nodiscard]] std::span<const Crossing> span() const { return std::span(all).first(count); }
  [[nodiscard]] std::span<Crossing> span() { return std::span(all).first(count); }
};

/// Returns the crossings of one position of a cell.
///   snapWeight  see cellVertex
[[nodiscard]] Crossings crossingsOf(const CellValues& values, const CellSheets& sheets,
                                    unsigned position, std::span<const float> snapWeight);

/// Returns the unit normal of the surface of the distances, by the gradient of the trilinear
/// interpolant; 0 if it vanishes.
[[nodiscard]] glm::dvec3 normalAt(const CellValues& values, const Crossing& crossing);

/// The planes of all crossings, or only of those of the solid's surface.
class TangentPlanes {
 public:
  TangentPlanes(const Crossings& crossings, bool onlyOuter) {
    for (const Crossing& crossing : crossings.span()) {
      if (crossing.isOuter || !onlyOuter) all_[count_++] = crossing.plane;
    }
  }
  [[nodiscard]] std::span<const TangentPlane> span() const { return std::span(all_).first(count_); }

 private:
  std::array<TangentPlane, 12> all_;
  std::size_t count_ = 0;
};

}  // namespace sherd
