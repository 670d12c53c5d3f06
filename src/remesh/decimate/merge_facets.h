// Merging of the faces in nearly planar regions.
#pragma once

#include <sherd/progress.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "remesh/complex.h"
#include "remesh/decimate/facets.h"

namespace sherd {

struct MergeOptions {
  /// Where polygons cross others at more points, all faces of cracks stay: those of thousands of
  /// small fragments.
  std::size_t mostFaults = 2000;
  FacetOptions facets{};  ///< the tolerances are also those of lines between facets
  /// Displaces vertices at random by a thousandth of the larger tolerance, after which none lies in
  /// the plane of a face that it does not belong to: for cracks, so that a mesh can be cut by them.
  std::optional<std::uint64_t> displacementSeed{};
};

/// MergeOptions::mostFaults for a complex.
[[nodiscard]] constexpr std::size_t mostFaultsOf(std::size_t faces) {
  constexpr std::size_t kLeast = 2000, kFacesPerFault = 100;
  return std::max(kLeast, faces / kFacesPerFault);
}

struct MergedFacets {
  LabeledComplex complex;
  std::vector<std::uint32_t> vertex;  ///< [vertices] the one of the complex before
};

/// Returns the complex with each facet as one polygon, triangulated, and the lines between facets
/// with fewer vertices.  All labels share the polygons.  Vertices of facets' borders move onto
/// their planes; others stay.  Where polygons would cross each other or other faces, they keep
/// more.
///   throws  Error(cancelled)
[[nodiscard]] MergedFacets withMergedFacets(const LabeledComplex& complex,
                                            const MergeOptions& options,
                                            const Progress* progress = nullptr);

}  // namespace sherd
