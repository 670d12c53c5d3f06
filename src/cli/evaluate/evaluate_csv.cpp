// Prints an evaluation as CSV, a row for each fragment.
#include "cli/evaluate/csv_row.h"
#include "cli/evaluate/evaluate_report.h"

namespace sherd::cli {
namespace {

constexpr const char* kHead =
    "id,mesh,share,volume,area,fracture_area,contacts,convexity,distance_deviation,samples,"
    "triangles,vertices,components,closed,outward,boundary_edges,non_manifold_edges,flipped_edges,"
    "non_manifold_vertices,degenerate_triangles,duplicate_triangles,smallest_angle,"
    "mean_smallest_angle,under_10_degrees,surface_error_mean,surface_error_p99,surface_error_max,"
    "gap_mean,gap_p99,gap_max,overlap_share,overlap_surface_share,overlap_depth";
constexpr const char* kCgalHead =
    ",cgal_polygon_mesh,cgal_valid,cgal_closed,cgal_bounds_volume,cgal_self_intersections,"
    "cgal_convexity";

void addQuality(CsvRow& row, const std::optional<MeshQuality>& q) {
  const auto add = [&](auto member) { row.add(q ? std::optional((*q).*member) : std::nullopt); };
  add(&MeshQuality::triangles);
  add(&MeshQuality::vertices);
  add(&MeshQuality::components);
  add(&MeshQuality::closed);
  row.add(q ? std::optional(q->outward()) : std::nullopt);
  add(&MeshQuality::boundaryEdges);
  add(&MeshQuality::nonManifoldEdges);
  add(&MeshQuality::flippedEdges);
  add(&MeshQuality::nonManifoldVertices);
  add(&MeshQuality::degenerateTriangles);
  add(&MeshQuality::duplicateTriangles);
  add(&MeshQuality::smallestAngle);
  add(&MeshQuality::meanSmallestAngle);
  add(&MeshQuality::sliverShare);
}

std::string rowOf(const FragmentMetrics& f, const CgalVerdict* cgal) {
  CsvRow row;
  row.add(f.id);
  row.add(f.name);
  row.add(f.share);
  row.add(f.volume);
  row.add(f.area);
  row.add(f.fractureArea);
  row.add(f.contacts);
  row.add(f.convexity ? std::optional(f.convexity->value) : std::nullopt);
  row.add(f.convexity ? std::optional(f.convexity->standardDeviation) : std::nullopt);
  row.add(f.convexity ? std::optional(f.convexity->samples) : std::nullopt);
  addQuality(row, f.quality);
  row.add(f.fit.surfaceError);
  row.add(f.fit.gap);
  row.add(f.fit.overlapShare);
  row.add(f.fit.insideShare);
  row.add(f.quality ? std::optional(f.fit.overlapDepth) : std::nullopt);
  if (cgal) {
    row.add(cgal->polygonMesh);
    row.add(cgal->valid);
    row.add(cgal->closed);
    row.add(cgal->boundsVolume);
    row.add(cgal->selfIntersections);
    row.add(cgal->convexity ? std::optional(cgal->convexity->value) : std::nullopt);
  }
  return row.line();
}

}  // namespace

std::string reportCsv(const EvaluateReport& report) {
  std::string text = std::string(kHead) + (report.cgal.empty() ? "" : kCgalHead) + "\n";
  for (std::size_t i = 0; i < report.evaluation.fragments.size(); ++i) {
    text += rowOf(report.evaluation.fragments[i], report.cgal.empty() ? nullptr : &report.cgal[i]);
  }
  return text;
}

}  // namespace sherd::cli
