// What a fracture tells when it is done.
#include "cli/fracture_telling.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/text_scan.h"
#include "folder/mesh_report.h"

namespace sherd::cli {
namespace {

std::string number(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

bool isMesh(const FractureTelling& told) { return !told.source.mesh.triangles.empty(); }

}  // namespace

std::vector<std::string> warningsOf(const FractureTelling& told) {
  const SourceMesh& source = told.source;
  const FractureResult& result = told.result;
  std::vector<std::string> warnings = source.warnings;
  const std::vector<MeshFileFormat>& formats = told.write.meshFormats;
  if (std::find(formats.begin(), formats.end(), MeshFileFormat::glb) != formats.end()) {
    for (const Texture& texture : source.appearance.textures) {
      if (imageType(texture.bytes) != ImageType::other) continue;
      warnings.push_back(source.name + ": its texture " + inQuotes(texture.name) +
                         " is neither PNG nor JPEG, so .glb files go without it");
    }
  }
  const std::size_t fragments = result.fragments.size();
  if (told.options.seedFile.empty() && result.parents.empty() &&
      static_cast<std::size_t>(told.options.pieces) < fragments) {
    warnings.push_back(told.mesh + " has " + std::to_string(result.parts) +
                       " separate parts, so it became " + std::to_string(fragments) +
                       " fragments, not " + std::to_string(told.options.pieces));
  }
  if (isMesh(told)) {
    for (std::string& warning : reportWarnings(source, result)) {
      warnings.push_back(std::move(warning));
    }
  }
  if (result.solid.specks > 0) {
    warnings.push_back(told.mesh + ": " + std::to_string(result.solid.specks) +
                       (result.solid.specks == 1 ? " part" : " parts") + " under " +
                       std::to_string(kSpeckVoxels) + " voxels dropped, " +
                       std::to_string(result.solid.speckVoxels) + " voxels in all");
  }
  warnings.insert(warnings.end(), told.ofFolder.begin(), told.ofFolder.end());
  return warnings;
}

std::string textOf(const FractureTelling& told) {
  const FractureResult& result = told.result;
  const std::string withheld =
      result.withheld > 0 ? ", " + std::to_string(result.withheld) + " of them withheld," : "";
  return (isMesh(told) ? reportText(told.source, result) : "") + told.folder + ": " +
         std::to_string(result.fragments.size()) + " fragments of " + told.source.name + withheld +
         " in " + number(told.times.back().seconds, 3) + " s (" +
         std::to_string(result.solid.voxels) + " voxels of " +
         number(result.solid.frame.voxelSize, 4) + ", seed " + std::to_string(told.options.seed) +
         ", " + told.device.name + ")\n";
}

nlohmann::ordered_json jsonOf(const FractureTelling& told) {
  const SourceMesh& source = told.source;
  const FractureResult& result = told.result;
  double volumeOut = 0.0;
  for (const Fragment& fragment : result.fragments) volumeOut += fragment.mass.volume;
  nlohmann::ordered_json seconds;
  for (const StageTime& time : told.times) seconds[time.stage] = time.seconds;
  return {{"schema", "sherd-report/1"},
          {"command", "fracture"},
          {"source", source.name},
          {"manifest", told.manifest.string()},
          {"seed", told.options.seed},
          {"device", {{"platform", told.device.platform}, {"name", told.device.name}}},
          {"pieces_asked", told.options.pieces},
          {"fragments", result.fragments.size()},
          {"withheld", result.withheld},
          {"parts", result.parts},
          {"freed_voxels", result.labels.freed},
          {"worn_voxels", result.worn.front()},
          {"specks", result.solid.specks},
          {"voxel_size", result.solid.frame.voxelSize},
          {"voxels", result.solid.voxels},
          {"vertices_in", source.mesh.vertices.size()},
          {"triangles_in", source.mesh.triangles.size()},
          {"volume_in", std::abs(volume(source.mesh))},
          {"volume_out", volumeOut},
          {"report", isMesh(told) ? reportJson(source, result) : nlohmann::ordered_json()},
          {"warnings", warningsOf(told)},
          {"seconds", seconds}};
}

}  // namespace sherd::cli
