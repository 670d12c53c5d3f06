// `sherd inspect`: describes a mesh, voxel file, level set or fracture.
#include <sherd/evaluate.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/mesh.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/input_error.h"
#include "base/memory.h"
#include "base/text/lower_case.h"
#include "base/text/option_names.h"
#include "base/text/printable.h"
#include "cli/terminal/command.h"
#include "cli/terminal/interrupts.h"

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Each inspector returns one flat JSON object; the plain text is made from it.

Json inspected(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
Json inspected(const openvdb::Coord& c) { return {c.x(), c.y(), c.z()}; }

Json inspected(const VdbMetadata& metadata) {
  Json json = Json::object();
  for (const auto& [key, value] : metadata) json[key] = value;
  return json;
}

Json inspectVoxels(const fs::path& file, VoxelFormat format) {
  const PlacedVoxels read = readVoxels(file, {.maxMemory = freeMemory()});
  std::map<std::uint16_t, std::uint64_t> counts;
  for (const Run& run : read.voxels.runs) counts[run.label] += run.length;
  Json labels = Json::object();
  for (const auto& [label, count] : counts) labels[std::to_string(label)] = count;
  Json found = {{"kind", "voxels"},
                {"format", names::of(names::kVoxelFormat, format)},
                {"dims", inspected(read.voxels.dims)},
                {"runs", read.voxels.runs.size()}};
  if (read.transform) {
    found["origin"] = inspected(read.transform->frame.origin);
    found["voxel_size"] = read.transform->frame.voxelSize;
    found["index_min"] = inspected(read.transform->indexMin);
  }
  found["voxels_per_label"] = labels;
  return found;
}

Json inspectVdb(const fs::path& file) {
  const VdbFile vdb = describeVdb(file, {.maxMemory = freeMemory()});
  Json grids = Json::array();
  for (const VdbGrid& grid : vdb.grids) {
    grids.push_back({{"name", grid.name},
                     {"type", grid.type},
                     {"class", grid.gridClass},
                     {"voxel_size", inspected(grid.voxelSize)},
                     {"background", grid.background},
                     {"active_voxels", grid.activeVoxels},
                     {"index_min", inspected(grid.activeBox.min)},
                     {"index_max", inspected(grid.activeBox.max)},
                     {"metadata", inspected(grid.metadata)}});
  }
  return {{"kind", "vdb"}, {"metadata", inspected(vdb.metadata)}, {"grids", grids}};
}

Json inspectMesh(const fs::path& file) {
  const SourceMesh source = readMesh(file, {.maxMemory = freeMemory()}, &untilInterrupted());
  const MeshQuality quality = meshQuality(source.mesh);
  const Box box = bounds(source.mesh);
  Json found = {{"kind", "mesh"},
                {"sha256", source.sha256},
                {"vertices", source.mesh.vertices.size()},
                {"triangles", source.mesh.triangles.size()},
                {"degenerate_triangles", source.degenerateTriangles},
                {"closed", quality.closed},
                {"boundary_edges", quality.boundaryEdges},
                {"non_manifold_edges", quality.nonManifoldEdges},
                {"misoriented_edges", quality.flippedEdges},
                {"components", quality.components},
                {"area", area(source.mesh)},
                {"volume", volume(source.mesh)},
                {"box_min", inspected(box.min)},
                {"box_max", inspected(box.max)}};
  found.update(Json::parse(coordinatesJson(coordinatesOfFile(file, source.coordinates))));
  return found;
}

Json inspectPoints(const fs::path& file, PointFormat format) {
  const SurfacePoints points = readPoints(file, {.maxMemory = freeMemory()});
  Json found = {{"kind", "points"},
                {"format", names::of(names::kPointFormat, format)},
                {"points", points.positions.size()},
                {"normals", !points.normals.empty()},
                {"neighbor", !points.neighbor.empty()}};
  if (points.positions.empty()) return found;
  const Box box = bounds({points.positions, {}});
  found["box_min"] = inspected(box.min);
  found["box_max"] = inspected(box.max);
  return found;
}

// An .npz that is neither voxels nor points.
Json inspectArrays(const fs::path& file) {
  Json arrays = Json::object();
  for (const ArrayEntry& array : arraysOf(file)) arrays[array.name] = array.bytes;
  return {{"kind", "arrays"}, {"bytes_per_array", arrays}};
}

Json inspectManifest(const fs::path& file) {
  const Manifest manifest = readManifest(file);
  Json fragments = Json::array();
  for (const ManifestFragment& fragment : manifest.fragments) {
    fragments.push_back({{"id", fragment.id},
                         {"voxels", fragment.voxels},
                         {"share", fragment.share},
                         {"volume", fragment.volume},
                         {"area", fragment.area},
                         {"fracture_area", fragment.fractureArea},
                         {"contacts", fragment.contacts}});
  }
  Json found = {{"kind", "fracture"},
                {"source", manifest.source},
                {"seed", manifest.seed},
                {"resolution", manifest.resolution},
                {"resolution_is", manifest.automatic ? "auto" : "given"},
                {"voxel_size", manifest.voxelSize},
                {"dims", inspected(manifest.dims)},
                {"solid_voxels", manifest.solidVoxels},
                {"components", manifest.components},
                {"files", manifest.files.size()},
                {"fragments", fragments}};
  if (manifest.offset) found["offset"] = inspected(*manifest.offset);
  if (manifest.bodies > 0) found["bodies"] = manifest.bodies;
  return found;
}

Json inspect(const fs::path& file) {
  requireSettled(file);
  const fs::file_type type = whatIsAt(file);
  if (type == fs::file_type::not_found) inputError(file, "no such file");
  if (type == fs::file_type::directory) return inspectManifest(file / kManifestName);
  const std::string extension = lowerCase(file.extension().string());
  if (extension == ".vdb") return inspectVdb(file);
  if (extension == ".json") return inspectManifest(file);
  switch (kindOf(file, {.maxMemory = freeMemory()})) {
    case FileKind::voxels:
      return inspectVoxels(file, *voxelFormatOf(file));
    case FileKind::points:
      return inspectPoints(file, *pointFormatOf(file));
    case FileKind::mesh:
      return inspectMesh(file);
    case FileKind::other:
      break;
  }
  return extension == ".npz" ? inspectArrays(file) : inspectMesh(file);
}

// ---- Plain text

std::string plain(const Json& value) {
  if (value.is_string()) return printable(value.get<std::string>());
  if (value.is_number_float()) {
    char text[64];
    std::snprintf(text, sizeof text, "%.6g", value.get<double>());
    return text;
  }
  if (value.is_array()) {
    std::string text;
    for (const Json& item : value) text += (text.empty() ? "" : " ") + plain(item);
    return text;
  }
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string pad(const std::string& text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 1, ' ');
}

// Returns a table of objects with equal keys: a header, then a line for each.
std::string table(const Json& rows) {
  std::string text;
  if (rows.empty()) return text;
  for (const auto& [key, value] : rows.front().items()) text += pad(key, 15);
  text += "\n";
  for (const Json& row : rows) {
    for (const auto& [key, value] : row.items()) text += pad(plain(value), 15);
    text += "\n";
  }
  return text;
}

std::string asText(const Json& object, const std::string& indent = "") {
  std::string text;
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) {
      text += indent + printable(key) + "\n" + asText(value, indent + "  ");
    } else if (key == "fragments") {
      text += table(value);
    } else if (key == "grids") {
      for (const Json& grid : value) text += indent + "grid\n" + asText(grid, indent + "  ");
    } else {
      text += indent + pad(printable(key), 22) + plain(value) + "\n";
    }
  }
  return text;
}

void runInspect(const std::string& file, bool json) {
  Json found = {{"schema", "sherd-report/1"}, {"command", "inspect"}, {"file", file}};
  const Json inside = inspect(file);
  if (!json) return printResult(asText(inside));
  found.update(inside);
  printResult(found.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace

void addInspectCommand(CLI::App& app, Action& run) {
  CLI::App* command = app.add_subcommand(
      "inspect", "Describe a mesh, voxels, points, .vdb, manifest or fracture's folder");
  auto file = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  command->add_option("FILE", *file, "The file, or the folder of a fracture")->required();
  command->add_flag("--json", *json, "Print one JSON object");
  command->callback([file, json, &run] { run = [file, json] { runInspect(*file, *json); }; });
}

}  // namespace sherd::cli
