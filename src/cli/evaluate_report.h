// What `sherd evaluate` found, and the ways to tell it.
#pragma once

#include <sherd/evaluate.h>

#include <optional>
#include <string>
#include <vector>

#include "cgal/cgal_checks.h"

namespace sherd::cli {

struct EvaluateReport {
  std::string folder;  ///< as it was given
  FragmentSet set;     ///< its meshes are not needed any more
  std::string whole;   ///< the unbroken mesh's file name, or empty
  Evaluation figures;
  std::vector<CgalVerdict> cgal;  ///< [fragments], or empty: not asked; without a mesh all false
};

[[nodiscard]] std::string reportJson(const EvaluateReport& report);
[[nodiscard]] std::string reportTable(const EvaluateReport& report);
[[nodiscard]] std::string reportCsv(const EvaluateReport& report);   ///< a row for each fragment
[[nodiscard]] std::string reportPlot(const EvaluateReport& report);  ///< SVG

/// part / whole, or 0 of nothing.
inline double ratio(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

/// Everything that is wrong with a mesh, added up.
inline std::size_t faults(const MeshQuality& q) {
  return q.boundaryEdges + q.nonManifoldEdges + q.flippedEdges + q.nonManifoldVertices +
         q.degenerateTriangles + q.duplicateTriangles;
}

inline double contactsPerFragment(const Evaluation& figures) {
  return 2.0 * static_cast<double>(figures.contacts) /
         static_cast<double>(figures.fragments.size());
}

/// The sum of the fragments' volumes over the unbroken mesh's, less one.
inline std::optional<double> volumeError(const Evaluation& figures) {
  if (!figures.fit.wholeVolume || figures.open > 0) return {};
  return figures.volume / *figures.fit.wholeVolume - 1.0;
}

}  // namespace sherd::cli
