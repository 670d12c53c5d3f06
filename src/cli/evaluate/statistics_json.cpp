// Prints statistics of a fracture as one JSON object, or as CSV.
#include <nlohmann/json.hpp>

#include "cli/evaluate/csv_row.h"
#include "cli/evaluate/statistics_report.h"

namespace sherd::cli {
namespace {

using StatisticsObject = nlohmann::ordered_json;

StatisticsObject meanJson(const std::optional<MeanFigure>& figure) {
  if (!figure) return {};
  return {{"count", figure->count},
          {"mean", figure->mean},
          {"deviation", figure->deviation},
          {"standard_error", figure->standardError()}};
}

StatisticsObject fitJson(const std::optional<DistributionFit>& fit, const char* parameter) {
  if (!fit) return {};
  return {{parameter, fit->parameter},
          {"standard_error", fit->standardError},
          {"distance", fit->distance},
          {"p", fit->pValue}};
}

StatisticsObject sizesJson(const SizeFits& sizes) {
  return {{"count", sizes.count},
          {"mean", sizes.mean},
          {"least", sizes.least},
          {"greatest", sizes.greatest},
          {"exponential", fitJson(sizes.exponential, "mean")},
          {"lognormal", fitJson(sizes.lognormal, "s")},
          {"power", fitJson(sizes.power, "tau")}};
}

StatisticsObject orientationJson(const FractureStatistics& s) {
  if (!s.orientation) return {};
  StatisticsObject axes = StatisticsObject::array();
  for (const glm::dvec3& axis : s.orientationAxes) axes.push_back({axis.x, axis.y, axis.z});
  return {{"values", {s.orientation->x, s.orientation->y, s.orientation->z}}, {"axes", axes}};
}

StatisticsObject hurstJson(const std::vector<RoughnessAlong>& hurst) {
  StatisticsObject json = StatisticsObject::array();
  for (const RoughnessAlong& along : hurst) {
    json.push_back({{"direction", along.direction},
                    {"cracks", along.cracks},
                    {"exponent", along.hurst},
                    {"deviation", along.deviation},
                    {"lags", along.lags},
                    {"correlation", along.correlation}});
  }
  return json;
}

StatisticsObject jointsJson(const std::optional<JointStatistics>& joints) {
  if (!joints) return {};
  return {{"gap", joints->gap},
          {"difference",
           joints->difference ? StatisticsObject(*joints->difference) : StatisticsObject()},
          {"removed", joints->removed ? StatisticsObject(*joints->removed) : StatisticsObject()},
          {"deep_share", joints->deepShare}};
}

StatisticsObject gridJson(const std::optional<GridTrace>& grid) {
  if (!grid) return {};
  return {{"fragments", grid->fragments},          {"pitch", grid->pitch},
          {"pitch_known", grid->isKnown},          {"power", grid->power},
          {"standard_error", grid->standardError}, {"found", grid->found}};
}

StatisticsObject statisticsObject(const FractureStatistics& s) {
  return {{"faces_by", nameOf(s.rule)},
          {"plane_share", s.planeShare},
          {"neighbors_known", s.knownNeighbors},
          {"unit", s.unit},
          {"least_area", s.leastArea},
          {"plane_tolerance", s.planeTolerance},
          {"interior_faces", meanJson(s.interiorFaces)},
          {"interior_vertices", meanJson(s.interiorVertices)},
          {"interior_neighbors", meanJson(s.interiorNeighbors)},
          {"faces", meanJson(s.faces)},
          {"vertices", meanJson(s.vertices)},
          {"flat_faces", meanJson(s.flatFaces)},
          {"flat_vertices", meanJson(s.flatVertices)},
          {"corners", meanJson(s.corners)},
          {"thin_axis",
           s.thinAxis ? StatisticsObject(std::string(1, "xyz"[*s.thinAxis])) : StatisticsObject()},
          {"contacts", meanJson(s.contacts)},
          {"neighbors", meanJson(s.neighbors)},
          {"break_share", s.breakShare},
          {"sizes", sizesJson(s.sizes)},
          {"orientation", orientationJson(s)},
          {"roughness", s.roughness ? StatisticsObject(*s.roughness) : StatisticsObject()},
          {"hurst", hurstJson(s.hurst)},
          {"joints", jointsJson(s.joints)},
          {"coincident", s.coincident},
          {"unmatched", s.unmatched},
          {"grid", gridJson(s.grid)},
          {"objects", s.objects},
          {"first_share", s.fragments.front().share},
          {"consecutive_excess",
           s.consecutiveExcess ? StatisticsObject(*s.consecutiveExcess) : StatisticsObject()},
          {"notes", s.notes}};
}

StatisticsObject publishedJson() {
  StatisticsObject json = StatisticsObject::array();
  for (const PublishedFigure& figure : publishedFigures()) {
    json.push_back({{"quantity", figure.quantity},
                    {"low", figure.low},
                    {"high", figure.high},
                    {"of", figure.of},
                    {"source", figure.source}});
  }
  return json;
}

StatisticsObject shapeJson(const FragmentShape& shape) {
  StatisticsObject json = {
      {"id", shape.id},
      {"mesh", shape.name.empty() ? StatisticsObject() : StatisticsObject(shape.name)},
      {"share", shape.share},
      {"break_share", shape.breakShare},
      {"contacts", shape.contacts}};
  if (!shape.hasMesh) return json;
  json["object"] = shape.object;
  json["neighbors"] = shape.neighbors;
  json["faces"] = shape.faces;
  json["vertices"] = shape.vertices;
  json["interior"] = shape.interior;
  json["flat_faces"] = shape.flatFaces;
  json["flat_vertices"] = shape.flatVertices;
  json["corners"] = shape.corners ? StatisticsObject(*shape.corners) : StatisticsObject();
  return json;
}

}  // namespace

std::string statisticsJson(const StatisticsReport& report) {
  const FragmentSet& set = report.set;
  using Object = StatisticsObject;
  Object json = {{"schema", "sherd-report/1"},
                 {"command", "evaluate"},
                 {"folder", report.folder},
                 {"manifest", set.manifest},
                 {"source", set.manifest ? Object(set.source) : Object()},
                 {"seed", set.manifest ? Object(set.seed) : Object()},
                 {"voxel_size", set.manifest ? Object(set.voxelSize) : Object()},
                 {"pieces", report.statistics.fragments.size()},
                 {"statistics", statisticsObject(report.statistics)},
                 {"published", publishedJson()},
                 {"fragments", Object::array()}};
  for (const FragmentShape& shape : report.statistics.fragments) {
    json["fragments"].push_back(shapeJson(shape));
  }
  return json.dump(1, ' ', false, Object::error_handler_t::replace) + "\n";
}

std::string statisticsCsv(const StatisticsReport& report) {
  std::string text =
      "id,mesh,share,break_share,contacts,object,neighbors,faces,vertices,interior,flat_faces,"
      "flat_vertices,corners\n";
  for (const FragmentShape& shape : report.statistics.fragments) {
    CsvRow row;
    row.add(shape.id);
    row.add(shape.name);
    row.add(shape.share);
    row.add(shape.breakShare);
    row.add(shape.contacts);
    const auto add = [&](auto member) {
      row.add(shape.hasMesh ? std::optional(shape.*member) : std::nullopt);
    };
    add(&FragmentShape::object);
    add(&FragmentShape::neighbors);
    add(&FragmentShape::faces);
    add(&FragmentShape::vertices);
    add(&FragmentShape::interior);
    add(&FragmentShape::flatFaces);
    add(&FragmentShape::flatVertices);
    row.add(shape.corners);
    text += row.line();
  }
  return text;
}

}  // namespace sherd::cli
