// Report of a mesh's defects and repairs.
#include "folder/manifest/mesh_report.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/text/formatted.h"
#include "base/text/json_text.h"
#include "base/text/option_names.h"
#include "base/text/printable.h"
#include "base/text/text_scan.h"
#include "folder/manifest/small_pieces.h"
#include "mesh/coordinate_system.h"

namespace sherd {
namespace {

std::string brief(double value) { return formatted("%.4g", value); }

std::string percent(double share) { return formatted("%.2g %%", 100.0 * share); }

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// Sums the volumes of the fragments' meshes; of all voxels if some are eroded.
double solidVolume(const FractureResult& result) {
  if (!result.eroded.empty() && result.eroded.front() > 0) {
    return static_cast<double>(result.solid.voxels) * std::pow(result.solid.frame.voxelSize, 3);
  }
  double sum = 0.0;
  for (const Fragment& fragment : result.fragments) sum += fragment.mass.volume;
  return sum;
}

// Returns the mesh's volume: that of the union of its bodies, where it was made, in which overlaps
// count once.
double meshVolume(const FractureResult& result) {
  return result.united.mesh ? volume(result.united.mesh->mesh) : result.solid.report.meshVolume;
}

// Returns the relative difference of the solid's volume from the mesh's.
double difference(const FractureResult& result) {
  const double mesh = meshVolume(result);
  return mesh > 0.0 ? solidVolume(result) / mesh - 1.0 : 0.0;
}

bool isShort(const SolidReport& report) {
  return report.fill != Fill::shell && report.resolution.automatic &&
         report.walls.resolution > kMostAutoResolution;
}

// Returns the automatic resolution and the reason for it.
std::string choiceText(const SolidReport& report) {
  const int used = report.resolution.resolution;
  const double coarser = kLeastAutoResolution / static_cast<double>(used);
  const std::string at = " at " + std::to_string(kLeastAutoResolution);
  std::string choice = "resolution " + std::to_string(used) + ", chosen automatically: ";
  if (report.fill == Fill::shell) return choice + "as for every shell";
  if (used == kLeastAutoResolution) return choice + "it preserves the mesh's walls";
  if (report.walls.forWalls >= report.walls.forVolume) {
    choice += "walls would be down to " + brief(report.walls.thinnest * coarser) + " voxels" + at;
  } else {
    choice += "branches and edges would lose more than 2 % of the volume" + at;
  }
  return isShort(report) ? choice + ", the highest automatic one" : choice;
}

// Returns the file's name, with the object's name if `source` is one object of the file.
std::string titleOf(const SourceMesh& source) {
  const std::string name = printable(source.name);
  return source.objects.size() == 1 ? name + ", " + inQuotes(source.objects.front()) : name;
}

// Of lists in a sentence, so many are named.
constexpr std::size_t kMostNames = 5, kMostReasons = 3;

// "1, 2 and 3", or the first ones and the number of the others.
std::string firstOf(const std::vector<std::string>& names) {
  const std::size_t shown = names.size() > kMostNames ? kMostNames - 1 : names.size();
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) {
    const bool isLast = i > 0 && i + 1 == names.size();
    text += (i == 0 ? "" : isLast ? " and " : ", ") + names[i];
  }
  if (shown == names.size()) return text;
  return text + " and " + std::to_string(names.size() - shown) + " others";
}

}  // namespace

std::string heightText(const CoordinateSystem& coordinates, const Box& box) {
  return lengthText(heightOf(box, coordinates.up), coordinates.metersPerUnit) + " high";
}

nlohmann::ordered_json jsonOfCoordinates(const CoordinateSystem& coordinates) {
  nlohmann::ordered_json unit = nlohmann::ordered_json::object();
  if (const LengthUnit* const known = unitOf(coordinates.metersPerUnit)) unit["name"] = known->name;
  unit["meters"] = coordinates.metersPerUnit;
  unit["from"] = names::of(names::kCoordinateBasis, coordinates.unitFrom);
  return {{"unit", std::move(unit)},
          {"up",
           {{"axis", std::string(1, coordinates.up)},
            {"from", names::of(names::kCoordinateBasis, coordinates.upFrom)}}}};
}

std::string coordinatesJson(const CoordinateSystem& coordinates) {
  return jsonText(jsonOfCoordinates(coordinates), -1);
}

std::string unitedText(const UnitedBodies& united) {
  std::string text;
  if (united.closed.holes > 0) {
    text = counted(united.closed.holes, "hole") + (united.closed.holes == 1 ? " was" : " were") +
           " closed " +
           (united.closed.faces > 0 ? "by " + counted(united.closed.faces, "face")
                                    : "without faces that are left");
  }
  if (united.loose > 0) {
    text += (text.empty() ? "" : "; ") + std::to_string(united.loose) +
            (united.loose == 1 ? " body of less than 27 voxels was left out"
                               : " bodies of less than 27 voxels were left out");
  }
  const std::string between = text.empty() ? "" : "; ";
  if (united.before != united.after) {
    return text + between + std::to_string(united.before) +
           " bodies, of which some overlap or touch, were united to " +
           std::to_string(united.after);
  }
  if (united.before != 1) return text;  // none, or they touch where that does not connect them
  return text + between + "its surface crosses itself; what lies within it was left out";
}

std::vector<std::string> objectsOf(const SourceMesh& source,
                                   std::span<const std::uint32_t> triangles) {
  if (source.objects.size() < 2) return {};
  std::set<std::uint32_t> objects;
  for (const std::uint32_t t : triangles) {
    if (t < source.objectOfTriangle.size()) objects.insert(source.objectOfTriangle[t]);
  }
  std::vector<std::string> names;
  for (const std::uint32_t object : objects) names.push_back(source.objects[object]);
  return names;
}

std::string aloneText(std::size_t alone) {
  if (alone == 0) return {};
  return std::to_string(alone) +
         (alone == 1 ? " fragment that is kept touches" : " fragments that are kept touch") +
         " only missing ones";
}

std::string smoothText(const SourceMesh& source, std::size_t fragments, const std::string& failure,
                       std::span<const SmoothBodies> smooth) {
  if (!failure.empty()) {
    return failure + ", so the fragments have the smooth surface instead of the exact one";
  }
  if (smooth.empty()) return {};
  std::vector<SmoothBodies> byReason;
  std::size_t count = 0;
  for (const SmoothBodies& bodies : smooth) {
    count += bodies.fragments.size();
    const auto same = std::ranges::find(byReason, bodies.reason, &SmoothBodies::reason);
    if (same == byReason.end()) {
      byReason.push_back(bodies);
      continue;
    }
    same->fragments.insert(same->fragments.end(), bodies.fragments.begin(), bodies.fragments.end());
    same->triangles.insert(same->triangles.end(), bodies.triangles.begin(), bodies.triangles.end());
  }
  std::string text = std::to_string(count) + " of " + counted(fragments, "fragment") +
                     (count == 1 ? " has" : " have") +
                     " the smooth surface instead of the exact one: ";
  const std::size_t shown = std::min(byReason.size(), kMostReasons);
  for (std::size_t i = 0; i < shown; ++i) {
    SmoothBodies& bodies = byReason[i];
    std::ranges::sort(bodies.fragments);
    std::vector<std::string> ids;
    for (const int id : bodies.fragments) ids.push_back(std::to_string(id));
    text += (i == 0 ? "" : "; ") + firstOf(ids);
    std::vector<std::string> objects = objectsOf(source, bodies.triangles);
    for (std::string& name : objects) name = inQuotes(name);
    if (!objects.empty()) text += " (" + firstOf(objects) + ")";
    text += ", since " + bodies.reason;
  }
  if (shown == byReason.size()) return text;
  return text + "; others for " + counted(byReason.size() - shown, "other reason");
}

nlohmann::ordered_json reportJson(const SourceMesh& source, const FractureResult& result) {
  const SolidReport& report = result.solid.report;
  const MeshDefects& defects = report.defects;
  nlohmann::ordered_json json = {{"components", defects.components},
                                 {"boundary_edges", defects.boundaryEdges},
                                 {"non_manifold_edges", defects.nonManifoldEdges},
                                 {"misoriented_edges", defects.misorientedEdges},
                                 {"flipped_triangles", defects.flippedTriangles},
                                 {"flipped_components", defects.flippedComponents},
                                 {"dropped_vertices", source.droppedVertices},
                                 {"degenerate_triangles", source.degenerateTriangles},
                                 {"zero_area_triangles", defects.zeroAreaTriangles},
                                 {"duplicate_triangles", defects.duplicateTriangles},
                                 {"sheet_triangles", defects.sheetTriangles},
                                 {"fill", names::of(names::kFill, report.fill)},
                                 {"fill_reason", report.fillReason}};
  if (report.fill == Fill::shell) {
    json["shell_thickness"] = report.shellThickness;
  } else {
    json["mesh_volume"] = meshVolume(result);
  }
  if (report.sheetThickness > 0.0) json["sheet_thickness"] = report.sheetThickness;
  json["solid_volume"] = solidVolume(result);
  if (const ClosedHoles& closed = result.united.closed; closed.holes > 0) {
    json["closed_holes"] = {
        {"holes", closed.holes}, {"faces", closed.faces}, {"area", closed.area}};
  }
  json["bridges"] = report.bridges;
  json["near_bodies"] = report.nearBodies;
  json["resolution"] = {{"used", report.resolution.resolution},
                        {"automatic", report.resolution.automatic},
                        {"for_walls", report.walls.forWalls},
                        {"for_volume", report.walls.forVolume}};
  nlohmann::ordered_json& walls = json["walls"] = {{"thin_share", report.walls.thinShare}};
  if (std::isfinite(report.walls.thinnest)) walls["thinnest_voxels"] = report.walls.thinnest;
  if (report.walls.resolution > 0) walls["resolution_to_hold"] = report.walls.resolution;
  return json;
}

std::string meshReportJson(const SourceMesh& source, const FractureResult& result) {
  return jsonText(reportJson(source, result), -1);
}

std::string meshReport(const SourceMesh& source, const FractureResult& result) {
  const SolidReport& report = result.solid.report;
  const MeshDefects& defects = report.defects;
  std::string found = titleOf(source) + ": " + counted(source.mesh.triangles.size(), "triangle") +
                      " in " + counted(defects.components, "component");
  const std::pair<std::size_t, const char*> faults[] = {
      {defects.boundaryEdges, "boundary edge"},
      {defects.nonManifoldEdges, "non-manifold edge"},
      {defects.misorientedEdges, "misoriented edge"},
      {defects.duplicateTriangles, "duplicate triangle"},
      {source.droppedVertices, "infinite vertex"},
      {source.degenerateTriangles + defects.zeroAreaTriangles, "degenerate triangle"}};
  bool clean = true;
  for (const auto& [count, what] : faults) {
    if (count > 0) found += ", " + counted(count, what);
    clean &= count == 0;
  }
  if (clean) found += ", closed, edge-manifold and consistently oriented";

  std::string done =
      std::string("filled by ") + names::of(names::kFill, report.fill) + ": " + report.fillReason;
  if (report.fill == Fill::shell) done += "; a shell " + brief(report.shellThickness) + " thick";
  if (report.sheetThickness > 0.0) {
    done += "; " + counted(defects.sheetTriangles, "triangle") +
            " on both sides of sheets, as of leaves, made shells " + brief(report.sheetThickness) +
            " thick";
  }
  if (defects.flippedTriangles > 0) {
    done += "; " + counted(defects.flippedTriangles, "triangle") + " flipped";
  }
  if (defects.flippedComponents > 0) {
    done += "; " + counted(defects.flippedComponents, "inside-out component") + " flipped";
  }

  if (report.nearBodies > 0) {
    done += "; " + std::to_string(report.nearBodies) +
            (report.keptBodies > 0 ? " bodies that touch or overlap others, or nearly, kept"
                                   : " bodies closer than a voxel to others kept apart");
  }

  std::string volumes = "volume " + brief(solidVolume(result));
  if (const double own = meshVolume(result); own > 0.0) {
    volumes += ", the mesh's own " + brief(own) + " (" + (difference(result) < 0.0 ? "-" : "+") +
               percent(std::abs(difference(result))) + ")";
  }
  if (report.walls.thinShare > 0.0) {
    volumes += "; walls thinner than a voxel behind " + percent(report.walls.thinShare) +
               " of the surface";
  }
  const std::string choice = report.resolution.automatic ? choiceText(report) + "\n" : "";
  return found + "\n" + done + "\n" + choice + volumes + "\n";
}

std::vector<std::string> meshWarnings(const SourceMesh& source, const FractureResult& result) {
  std::vector<std::string> warnings;
  const SolidReport& report = result.solid.report;
  const MeshDefects& defects = report.defects;
  // Voxels count what bodies have in common once, also where these are kept.
  const bool isOfVoxels =
      !result.fragments.empty() && ((!result.eroded.empty() && result.eroded.front() > 0) ||
                                    result.fragments.front().meshedAs != Surface::exact);
  const bool mayOverlap = report.keptBodies > 0 && isOfVoxels;
  if (std::abs(difference(result)) > kVolumesAgree && !mayOverlap) {
    warnings.push_back(titleOf(source) + ": the solid's volume is " + brief(solidVolume(result)) +
                       ", the mesh's own " + brief(meshVolume(result)) +
                       "; overlaps count once, and walls thinner than a voxel are lost");
  }
  if (std::string united = unitedText(result.united); !united.empty()) {
    warnings.push_back(titleOf(source) + ": " + std::move(united));
  }
  if (defects.sheetTriangles > 0 && report.fill != Fill::shell && report.sheetThickness == 0.0) {
    warnings.push_back(titleOf(source) + ": " + counted(defects.sheetTriangles, "triangle") +
                       " on both sides of sheets are so few that they are left out; the fill shell "
                       "keeps them");
  }
  for (std::string& clause : smallPieces(result)) {
    warnings.push_back(titleOf(source) + ": " + std::move(clause));
  }
  if (report.hiddenBodies > 0) {
    warnings.push_back(titleOf(source) + ": " + std::to_string(report.hiddenBodies) +
                       (report.hiddenBodies == 1 ? " body has no voxels of its own and is left out"
                                                 : " bodies have no voxels of their own and are "
                                                   "left out") +
                       ": thinner than voxels, or within smaller bodies");
  }
  if (report.lacksBodies) {
    warnings.push_back(titleOf(source) +
                       ": bodies are not kept, since they are known of closed meshes that are "
                       "filled by winding only");
  }
  if (report.hasJoinedBodies) {
    warnings.push_back(titleOf(source) +
                       ": there are so many bodies within some voxels that those closer than a "
                       "voxel are joined; a higher resolution keeps them apart");
  }
  if (report.tookTooLong) {
    warnings.push_back(titleOf(source) + ": the mesh is a shell, since " + report.fillReason +
                       "; the fill winding closes it in any case");
  }
  if (isShort(report)) {
    warnings.push_back(titleOf(source) + ": the mesh needs a resolution of " +
                       std::to_string(report.walls.resolution) +
                       " voxels, above the highest automatic one, " +
                       std::to_string(kMostAutoResolution) + "; walls are " +
                       brief(report.walls.thinnest) + " voxels thin and may be lost");
  } else if (report.walls.thinnest < 1.0 && report.walls.resolution > 0 &&
             report.fill != Fill::shell) {
    warnings.push_back(titleOf(source) + ": walls are down to " + brief(report.walls.thinnest) +
                       " voxels thin and may be lost; a resolution of " +
                       std::to_string(report.walls.resolution) + " preserves them");
  }
  return warnings;
}

}  // namespace sherd
