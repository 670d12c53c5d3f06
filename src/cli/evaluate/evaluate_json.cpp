// Prints an evaluation as one JSON object.
#include <nlohmann/json.hpp>

#include "cli/evaluate/evaluate_report.h"

namespace sherd::cli {
namespace {

using Json = nlohmann::ordered_json;

template <class Value>
Json jsonOf(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

/// Returns distances in world units, as shares of the diagonal, and in voxels.
Json jsonOf(const std::optional<DistanceSummary>& d, const EvaluateReport& report) {
  if (!d) return {};
  const auto lengths = [&](double unit) {
    return Json{
        {"mean", ratio(d->mean, unit)}, {"p99", ratio(d->p99, unit)}, {"max", ratio(d->max, unit)}};
  };
  Json json = lengths(1.0);
  json["samples"] = d->samples;
  json["of_diagonal"] = lengths(report.evaluation.fit.diagonal);
  if (report.set.voxelSize > 0.0) json["voxels"] = lengths(report.set.voxelSize);
  return json;
}

Json qualityJson(const MeshQuality& q) {
  return {{"triangles", q.triangles},
          {"vertices", q.vertices},
          {"components", q.components},
          {"closed", q.closed},
          {"manifold", q.manifold()},
          {"boundary_edges", q.boundaryEdges},
          {"non_manifold_edges", q.nonManifoldEdges},
          {"flipped_edges", q.flippedEdges},
          {"non_manifold_vertices", q.nonManifoldVertices},
          {"degenerate_triangles", q.degenerateTriangles},
          {"duplicate_triangles", q.duplicateTriangles},
          {"smallest_angle", q.smallestAngle},
          {"mean_smallest_angle", q.meanSmallestAngle},
          {"under_10_degrees", q.sliverShare},
          {"smallest_angles", q.smallestAngles}};
}

Json cgalJson(const CgalVerdict& verdict) {
  Json json = {{"polygon_mesh", verdict.polygonMesh},
               {"valid", verdict.valid},
               {"closed", verdict.closed},
               {"bounds_volume", verdict.boundsVolume},
               {"self_intersections", jsonOf(verdict.selfIntersections)},
               {"convexity", nullptr}};
  if (verdict.convexity) json["convexity"] = verdict.convexity->value;
  return json;
}

Json fragmentJson(const EvaluateReport& report, std::size_t i) {
  const FragmentMetrics& f = report.evaluation.fragments[i];
  Json json = {{"id", f.id},
               {"mesh", f.name.empty() ? Json() : Json(f.name)},
               {"share", f.share},
               {"volume", f.volume},
               {"area", f.area},
               {"fracture_area_share", ratio(f.fractureArea, f.area)},
               {"contacts", f.contacts},
               {"convexity", nullptr}};
  if (f.convexity) {
    json["convexity"] = f.convexity->value;
    json["distance_deviation"] = f.convexity->standardDeviation;
    json["samples"] = f.convexity->samples;
  } else if (f.quality) {
    json["no_convexity"] = f.noConvexity;
  }
  if (!f.quality) return json;
  json["quality"] = qualityJson(*f.quality);
  json["quality"]["outward"] = f.quality->outward();
  if (!report.cgal.empty()) json["cgal"] = cgalJson(report.cgal[i]);
  json["surface_error"] = jsonOf(f.fit.surfaceError, report);
  json["gap"] = jsonOf(f.fit.gap, report);
  json["overlap"] = {{"share", jsonOf(f.fit.overlapShare)},
                     {"surface_share", jsonOf(f.fit.insideShare)},
                     {"depth", f.fit.overlapDepth}};
  return json;
}

Json wholeJson(const EvaluateReport& report) {
  if (report.whole.empty()) return {};
  const Fit& fit = report.evaluation.fit;
  return {{"file", report.whole},
          {"volume", jsonOf(fit.wholeVolume)},
          {"volume_error", jsonOf(volumeError(report.evaluation))},
          {"void_share", jsonOf(fit.voidShare)},
          {"missing", jsonOf(fit.missing, report)}};
}

}  // namespace

std::string reportJson(const EvaluateReport& report) {
  const Evaluation& evaluation = report.evaluation;
  const bool manifest = report.set.manifest;
  Json json = {
      {"schema", "sherd-report/1"},
      {"command", "evaluate"},
      {"folder", report.folder},
      {"manifest", manifest},
      {"source", manifest ? Json(report.set.source) : Json()},
      {"seed", manifest ? Json(report.set.seed) : Json()},
      {"voxel_size", manifest ? Json(report.set.voxelSize) : Json()},
      {"pieces", evaluation.fragments.size()},
      {"effective_pieces", evaluation.effectiveFragments},
      {"smallest_share", evaluation.smallestShare},
      {"largest_share", evaluation.largestShare},
      {"volume", evaluation.volume},
      {"contacts", evaluation.contacts},
      {"contacts_per_fragment", contactsPerFragment(evaluation)},
      {"fracture_area_share", ratio(evaluation.fractureArea, evaluation.area)},
      {"convexity", jsonOf(evaluation.convexity)},
      {"convexity_standard_error", jsonOf(evaluation.convexityStandardError)},
      {"diagonal", evaluation.fit.diagonal},
      {"sound", evaluation.sound},
      {"open", evaluation.open},
      {"quality", nullptr},
      {"whole", wholeJson(report)},
      {"surface_error", jsonOf(evaluation.fit.surfaceError, report)},
      {"gap", jsonOf(evaluation.fit.gap, report)},
      {"overlap",
       {{"share", jsonOf(evaluation.fit.overlapShare)}, {"depth", evaluation.fit.overlapDepth}}},
      {"notes", evaluation.notes},
      {"fragments", Json::array()}};
  if (evaluation.quality.triangles > 0) json["quality"] = qualityJson(evaluation.quality);
  for (std::size_t i = 0; i < evaluation.fragments.size(); ++i) {
    json["fragments"].push_back(fragmentJson(report, i));
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sherd::cli
