// Text, warnings and JSON about a written fracture.
#include "cli/fracture_printer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "base/text/formatted.h"
#include "base/text/json_of.h"
#include "base/text/lower_case.h"
#include "base/text/printable.h"
#include "base/text/text_scan.h"

namespace sherd::cli {
namespace {

std::string number(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

// Whether a mesh was broken, and not fragments again.
bool isMesh(const FractureSummary& summary) {
  return !summary.source.mesh.triangles.empty() && summary.result.parents.empty();
}

// Box of the mesh, or of a volume's voxels.
Box boxOf(const FractureSummary& summary) {
  if (isMesh(summary)) return bounds(summary.source.mesh);
  const Solid& solid = summary.result.solid;
  const glm::dvec3 half(0.5 * solid.frame.voxelSize);
  return {solid.frame.worldFromIndex(solid.box.min) - half,
          solid.frame.worldFromIndex(solid.box.max) + half};
}

CoordinateSystem coordinatesOf(const FractureSummary& summary) {
  return sherd::coordinatesOf(summary.source.coordinates, summary.write);
}

// The ending of a file's name, without that of a compressed one.
std::string endingOf(const std::string& name) {
  std::filesystem::path path = lowerCase(name);
  if (path.extension() == ".gz") path = path.stem();
  return printable(path.extension().string());
}

// Where one of the two is from, and the option that changes it.
std::string originText(CoordinateBasis basis, const std::string& ending, const char* options) {
  switch (basis) {
    case CoordinateBasis::file:
      return "as the file says";
    case CoordinateBasis::option:
      return "as given";
    case CoordinateBasis::format:
      break;
  }
  return "assumed" + (ending.empty() ? "" : " for " + ending) + ": " + options;
}

// "bust.stl: 495 mm high, z up (assumed for .stl: --up, --unit)"
std::string sizeLine(const FractureSummary& summary) {
  const std::string ending = endingOf(summary.source.name);
  const CoordinateSystem coordinates = coordinatesOf(summary);
  const std::string high =
      printable(summary.source.name) + ": " + heightText(coordinates, boxOf(summary));
  const std::string up = std::string(1, coordinates.up) + " up";
  if (coordinates.unitFrom == coordinates.upFrom) {
    return high + ", " + up + " (" + originText(coordinates.upFrom, ending, "--up, --unit") + ")\n";
  }
  return high + " (unit " + originText(coordinates.unitFrom, ending, "--unit") + "), " + up + " (" +
         originText(coordinates.upFrom, ending, "--up") + ")\n";
}

}  // namespace

std::vector<std::string> warningsOf(const FractureSummary& summary) {
  const SourceMesh& source = summary.source;
  const FractureResult& result = summary.result;
  std::vector<std::string> warnings = source.warnings;
  const std::vector<MeshFileFormat>& formats = summary.write.meshFormats;
  if (std::find(formats.begin(), formats.end(), MeshFileFormat::glb) != formats.end()) {
    for (const Texture& texture : source.appearance.textures) {
      if (imageType(texture.bytes) != ImageType::other) continue;
      warnings.push_back(source.name + ": its texture " + inQuotes(texture.name) +
                         " is neither PNG nor JPEG, so .glb files omit it");
    }
  }
  const std::size_t fragments = result.fragments.size();
  if (!summary.options.seeds.given && result.parents.empty() &&
      static_cast<std::size_t>(summary.options.pieces) < fragments) {
    warnings.push_back(summary.mesh + " has " + std::to_string(result.components) +
                       " components, so it became " + std::to_string(fragments) +
                       " fragments, not " + std::to_string(summary.options.pieces));
  }
  if (isMesh(summary)) {
    for (std::string& warning : meshWarnings(source, result)) {
      warnings.push_back(std::move(warning));
    }
  }
  warnings.insert(warnings.end(), result.guideWarnings.begin(), result.guideWarnings.end());
  if (result.alone > 0) warnings.push_back(summary.mesh + ": " + aloneText(result.alone));
  const Length& depth = summary.options.erode.iterations;
  const int side = result.solid.box.longestSide();
  if (depth.percent > 0.0 && depth.over(side) < 0.5 && result.eroded.front() == 0) {
    warnings.push_back(
        formatted("%g %% of the longest side is less than half a voxel of %d; "
                  "nothing was eroded",
                  depth.percent, side));
  }
  if (result.solid.smallComponents > 0) {
    warnings.push_back(summary.mesh + ": " + std::to_string(result.solid.smallComponents) +
                       (result.solid.smallComponents == 1 ? " component" : " components") +
                       " under " + std::to_string(leastComponentVoxels(result.solid)) +
                       " voxels dropped, " + std::to_string(result.solid.smallComponentVoxels) +
                       " voxels in all");
  }
  warnings.insert(warnings.end(), summary.ofFolder.begin(), summary.ofFolder.end());
  return warnings;
}

std::string textOf(const FractureSummary& summary) {
  const FractureResult& result = summary.result;
  const std::string withheld =
      result.withheld > 0 ? ", " + std::to_string(result.withheld) + " of them withheld," : "";
  const std::optional<glm::dvec3>& offset = summary.write.offset;
  const std::string moved = offset ? ", recentered from (" + number(offset->x, 10) + ", " +
                                         number(offset->y, 10) + ", " + number(offset->z, 10) + "),"
                                   : "";
  return (isMesh(summary) ? meshReport(summary.source, result) : "") + sizeLine(summary) +
         printable(summary.folder) + ": " + std::to_string(result.fragments.size()) +
         " fragments of " + printable(summary.source.name) + withheld + moved + " in " +
         number(summary.times.back().seconds, 3) + " s (" + std::to_string(result.solid.voxels) +
         " voxels of " + number(result.solid.frame.voxelSize, 4) + ", seed " +
         std::to_string(summary.options.seed) + ", " + summary.device.name + ")\n";
}

nlohmann::ordered_json jsonOf(const FractureSummary& summary) {
  const SourceMesh& source = summary.source;
  const FractureResult& result = summary.result;
  double volumeOut = 0.0;
  for (const Fragment& fragment : result.fragments) volumeOut += fragment.mass.volume;
  nlohmann::ordered_json seconds;
  for (const StageTime& time : summary.times) seconds[time.stage] = time.seconds;
  nlohmann::ordered_json json = {
      {"schema", "sherd-report/1"},
      {"command", "fracture"},
      {"source", source.name},
      {"manifest", summary.manifest.string()},
      {"seed", summary.options.seed},
      {"device", {{"platform", summary.device.platform}, {"name", summary.device.name}}},
      {"pieces_asked", summary.options.pieces},
      {"fragments", result.fragments.size()},
      {"withheld", result.withheld},
      {"components", result.components},
      {"disconnected_voxels", result.labels.disconnected},
      {"eroded_voxels", result.eroded.front()},
      {"small_components", result.solid.smallComponents},
      {"voxel_size", result.solid.frame.voxelSize},
      {"voxels", result.solid.voxels},
      {"vertices_in", source.mesh.vertices.size()},
      {"triangles_in", source.mesh.triangles.size()},
      {"volume_in", std::abs(volume(source.mesh))},
      {"volume_out", volumeOut},
      {"report", isMesh(summary) ? nlohmann::ordered_json::parse(meshReportJson(source, result))
                                 : nlohmann::ordered_json()},
      {"warnings", warningsOf(summary)},
      {"seconds", seconds}};
  const CoordinateSystem coordinates = coordinatesOf(summary);
  json.update(nlohmann::ordered_json::parse(coordinatesJson(coordinates)));
  const Box box = boxOf(summary);
  const int axis = coordinates.up - 'x';
  json["height_meters"] = (box.max[axis] - box.min[axis]) * coordinates.metersPerUnit;
  if (summary.write.offset) json["offset"] = sherd::jsonOf(*summary.write.offset);
  return json;
}

}  // namespace sherd::cli
