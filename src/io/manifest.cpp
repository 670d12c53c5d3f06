// manifest.json: what a fracture is, and which files hold it.
#include "io/manifest.h"

#include <sherd/io.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

namespace sherd {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "sherd/1";

// Adding zero turns -0 into 0 and leaves every other number as it is.
double plain(double value) { return value + 0.0; }

Json jsonOf(const glm::dvec3& v) { return {plain(v.x), plain(v.y), plain(v.z)}; }
Json jsonOf(const openvdb::Coord& c) { return {c.x(), c.y(), c.z()}; }

Json sourceJson(const SourceMesh& source) {
  return {{"file", source.name},
          {"sha256", source.sha256},
          {"file_vertices", source.fileVertices},
          {"vertices", source.mesh.vertices.size()},
          {"triangles", source.mesh.triangles.size()},
          {"degenerate_triangles", source.degenerateTriangles}};
}

Json optionsJson(const FractureOptions& options, const FractureResult& result) {
  Json json = {{"pieces", result.fragments.size()}, {"seed", options.seed}};
  if (options.voxelSize > 0.0) {
    json["voxel_size"] = options.voxelSize;
  } else {
    json["resolution"] = options.resolution;
  }
  return json;
}

// Voxels along the mesh's longest side; the small term keeps a side of exactly n voxels from
// becoming n + 1.
int resolutionUsed(const SourceMesh& source, const FractureOptions& options, double voxelSize) {
  if (options.voxelSize <= 0.0) return options.resolution;
  const Box box = bounds(source.mesh);
  const glm::dvec3 side = (box.max - box.min) / voxelSize;
  return static_cast<int>(std::ceil(std::max({side.x, side.y, side.z}) - 1e-9));
}

Json gridJson(const SourceMesh& source, const FractureOptions& options,
              const FractureResult& result) {
  const Solid& solid = result.solid;
  const openvdb::Coord& first = solid.box.min;
  const std::uint64_t labelled =
      std::transform_reduce(result.fragments.begin(), result.fragments.end(), std::uint64_t{0},
                            std::plus<>(), [](const Fragment& f) { return f.voxels; });
  return {{"resolution", resolutionUsed(source, options, solid.frame.voxelSize)},
          {"voxel_size", solid.frame.voxelSize},
          {"dims", jsonOf(solid.box.dims())},
          {"index_min", jsonOf(first)},
          {"origin", jsonOf(solid.frame.worldFromIndex({{first.x(), first.y(), first.z()}}).v)},
          {"solid_voxels", solid.voxels},
          {"worn_voxels", solid.voxels - labelled}};
}

Json contactsJson(const Fragment& fragment) {
  Json contacts = Json::array();
  for (const Contact& contact : fragment.contacts) {
    contacts.push_back({{"id", contact.fragment},
                        {"area", plain(contact.area)},
                        {"normal", jsonOf(contact.normal)},
                        {"centroid", jsonOf(contact.centroid.v)}});
  }
  return contacts;
}

Json fragmentJson(const Fragment& fragment, std::uint64_t solidVoxels, Json files) {
  const Box box = bounds(fragment.mesh);
  const glm::dmat3& m = fragment.mass.inertia;
  return {{"id", fragment.id},
          {"voxels", fragment.voxels},
          {"volume", plain(fragment.mass.volume)},
          {"share", static_cast<double>(fragment.voxels) / static_cast<double>(solidVoxels)},
          {"bbox", {{"min", jsonOf(box.min)}, {"max", jsonOf(box.max)}}},
          {"centroid", jsonOf(fragment.mass.centroid)},
          {"inertia",
           {plain(m[0][0]), plain(m[1][1]), plain(m[2][2]), plain(m[1][0]), plain(m[2][0]),
            plain(m[2][1])}},
          {"area", plain(fragment.area)},
          {"fracture_area", plain(fragment.fractureArea)},
          {"files", std::move(files)},
          {"contacts", contactsJson(fragment)}};
}

}  // namespace

std::vector<std::string> FractureFiles::all() const {
  std::vector<std::string> list;
  if (!labels.empty()) list.push_back(labels);
  list.insert(list.end(), vdb.begin(), vdb.end());
  list.insert(list.end(), mesh.begin(), mesh.end());
  if (!preview.empty()) list.push_back(preview);
  return list;
}

std::string manifestText(const SourceMesh& source, const FractureOptions& options,
                         const FractureResult& result, const FractureFiles& files) {
  Json manifest = {{"schema", kSchema},
                   {"source", sourceJson(source)},
                   {"options", optionsJson(options, result)}};
  if (static_cast<std::size_t>(options.pieces) < result.fragments.size()) {
    manifest["pieces_asked"] = options.pieces;
  }
  manifest["grid"] = gridJson(source, options, result);
  manifest["parts"] = result.parts;
  manifest["specks"] = {{"parts", result.solid.specks}, {"voxels", result.solid.speckVoxels}};
  manifest["fragments"] = Json::array();
  for (std::size_t i = 0; i < result.fragments.size(); ++i) {
    Json own = Json::object();
    if (!files.vdb.empty()) own["vdb"] = files.vdb[i];
    if (!files.mesh.empty()) own["mesh"] = files.mesh[i];
    manifest["fragments"].push_back(
        fragmentJson(result.fragments[i], result.solid.voxels, std::move(own)));
  }
  manifest["withheld"] = Json::array();
  manifest["files"] = files.all();
  // A source's name may hold bytes that are not UTF-8; JSON cannot.
  return manifest.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<nlohmann::json> readManifest(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file))) return {};
  std::ifstream in(file, std::ios::binary);
  nlohmann::json json = nlohmann::json::parse(in, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("schema") || json["schema"] != kSchema) return {};
  return json;
}

std::optional<std::vector<std::string>> listedFiles(const nlohmann::json& manifest) {
  const auto found = manifest.find("files");
  if (found == manifest.end() || !found->is_array()) return {};
  std::vector<std::string> files;
  for (const nlohmann::json& entry : *found) {
    if (!entry.is_string()) return {};
    const std::filesystem::path path = entry.get<std::string>();
    const bool below = !path.empty() && path.is_relative() && path.has_filename() &&
                       std::none_of(path.begin(), path.end(),
                                    [](const auto& part) { return part == ".." || part == "."; });
    if (!below) return {};
    files.push_back(entry.get<std::string>());
  }
  return files;
}

}  // namespace sherd
