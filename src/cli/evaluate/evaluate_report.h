// The result of `sherd evaluate`, and its output formats.
#pragma once

#include <sherd/evaluate.h>

#include <optional>
#include <string>
#include <vector>

#include "cli/evaluate/cgal_checks.h"

namespace sherd::cli {

struct EvaluateReport {
  std::string folder;  ///< as given
  FragmentSet set;     ///< its meshes are not used by the reports
  std::string whole;   ///< the intact mesh's file name, or empty
  Evaluation evaluation;
  std::vector<CgalVerdict>
      cgal;  ///< [fragments], or empty without --cgal; all false without a mesh
};

[[nodiscard]] std::string reportJson(const EvaluateReport& report);
[[nodiscard]] std::string reportTable(const EvaluateReport& report);
[[nodiscard]] std::string reportCsv(const EvaluateReport& report);  ///< a row for each fragment

/// Returns part / whole, or 0 where whole is 0.
inline double ratio(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

/// Returns the number of defects of a mesh.
inline std::size_t faults(const MeshQuality& q) {
  return q.boundaryEdges + q.nonManifoldEdges + q.flippedEdges + q.nonManifoldVertices +
         q.degenerateTriangles + q.duplicateTriangles;
}

inline double contactsPerFragment(const Evaluation& evaluation) {
  return 2.0 * static_cast<double>(evaluation.contacts) /
         static_cast<double>(evaluation.fragments.size());
}

/// Returns the fragments' total volume over the intact mesh's, minus 1; nullopt with open meshes.
inline std::optional<double> volumeError(const Evaluation& evaluation) {
  if (!evaluation.fit.wholeVolume || evaluation.open > 0) return {};
  return evaluation.volume / *evaluation.fit.wholeVolume - 1.0;
}

}  // namespace sherd::cli
