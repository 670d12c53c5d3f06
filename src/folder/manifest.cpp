// manifest.json: the options, statistics and files of a fracture.
#include "folder/manifest.h"

#include <sherd/evaluate.h>
#include <sherd/io.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/json_of.h"
#include "base/option_names.h"
#include "folder/mesh_report.h"
#include "folder/read_manifest.h"

namespace sherd {
namespace {

using Json = nlohmann::ordered_json;

Json sourceJson(const SourceMesh& source, bool isRefracture) {
  if (isRefracture) return {{"file", source.name}, {"fracture_sha256", source.sha256}};
  Json json = {{"file", source.name}, {"sha256", source.sha256}};
  if (!source.grids.empty()) json["grids"] = source.grids;
  if (source.isovalue) json["isovalue"] = *source.isovalue;
  if (source.mesh.triangles.empty()) return json;
  json["file_vertices"] = source.fileVertices;
  json["vertices"] = source.mesh.vertices.size();
  json["triangles"] = source.mesh.triangles.size();
  json["degenerate_triangles"] = source.degenerateTriangles;
  if (source.objects.size() == 1) json["object"] = source.objects.front();
  return json;
}

// 1 / sum of squared shares: n equal fragments count as n.
double effectiveNumber(const FractureResult& result) {
  std::vector<double> voxels;
  for (const Fragment& f : result.fragments) voxels.push_back(static_cast<double>(f.voxels));
  return effectiveCount(voxels);
}

Json impactJson(const Impact& impact) {
  Json json = Json::object();
  if (const auto* point = std::get_if<WorldPoint>(&impact.target)) json["point"] = jsonOf(point->v);
  if (const auto* ray = std::get_if<Ray>(&impact.target)) {
    json["ray"] = {{"origin", jsonOf(ray->origin.v)}, {"direction", jsonOf(ray->direction)}};
  }
  json["count"] = impact.count;
  if (impact.sigma > 0.0) {
    json["sigma"] = impact.sigma;
  } else {
    json["bias"] = impact.bias;
  }
  json["merge"] = impact.merge;
  return json;
}

Json seedOptionsJson(const FractureOptions& options) {
  if (!options.seedFile.empty()) return {{"file", options.seedFile.filename().string()}};
  const SeedOptions& seeds = options.seeds;
  Json json = {{"sampler", names::of(names::kSampler, seeds.sampler)},
               {"on", names::of(names::kSeedsOn, seeds.on)},
               {"extra", seeds.extraSeeds},
               {"extra_per_piece", options.extraSeedsPerPiece},
               {"merge_metric", names::of(names::kMetric, seeds.mergeMetric)},
               {"random_impacts", seeds.randomImpacts},
               {"impacts", Json::array()}};
  for (const Impact& impact : seeds.impacts) json["impacts"].push_back(impactJson(impact));
  return json;
}

Json growOptionsJson(const GrowOptions& grow) {
  const GrowthRule& rule = ruleOf(grow.growth);
  Json json = {{"growth", rule.name}};
  if (rule.usesNeighborhood) json["neighborhood"] = grow.neighborhood;
  if (rule.usesMetric) json["metric"] = names::of(names::kMetric, grow.metric);
  if (grow.anisotropy.strength != 0.0) {
    json["grain"] = {{"direction", jsonOf(grow.anisotropy.direction)},
                     {"strength", grow.anisotropy.strength}};
  }
  json["roughness"] = grow.roughness;
  json["hurst"] = grow.hurst;
  json["roughness_window"] = grow.roughnessWindow;
  json["outer_steps"] = grow.outerSteps;
  json["isolated"] = names::of(names::kIsolated, grow.regrowIsolated);
  return json;
}

Json erodeOptionsJson(const ErodeOptions& erode) {
  if (erode.iterations == 0) return {{"iterations", 0}};
  return {{"iterations", erode.iterations},
          {"shape", names::of(names::kErodeShape, erode.shape)},
          {"size", erode.size},
          {"planes", erode.planes},
          {"threshold", erode.threshold},
          {"probability", erode.probability},
          {"on", names::of(names::kErodeOn, erode.on)},
          {"islands", names::of(names::kIslands, erode.islands)}};
}

Json pointOptionsJson(const WriteOptions& write) {
  Json json = {{"count", write.points.count},
               {"shared", write.sharePoints},
               {"sampler", names::of(names::kPointSampler, write.points.sampler)},
               {"rule", names::of(names::kPointRule, write.points.rule)},
               {"formats", Json::array()}};
  for (const PointFormat format : write.pointFormats) {
    json["formats"].push_back(names::of(names::kPointFormat, format));
  }
  return json;
}

Json distanceOptionsJson(const WriteOptions& write, const Solid& solid) {
  const double sigma = write.distances.sigma;
  return {{"count", write.distances.count},
          {"type", names::of(names::kSampleType, write.distances.type)},
          {"sigma", sigma > 0.0 ? sigma : solid.frame.voxelSize}};
}

Json surfaceOptionsJson(const SurfaceOptions& surface, int longestSide) {
  const SmoothOptions& smooth = surface.smooth;
  return {{"of", names::of(names::kSurface, surface.surface)},
          {"interface", names::of(names::kInterface, surface.interface)},
          {"adaptivity", surface.adaptivity},
          {"smooth",
           {{"method", names::of(names::kSmoothing, smooth.method)},
            {"iterations", smooth.iterations.over(longestSide)},
            {"weight", smooth.weight},
            {"boundary_iterations", smooth.boundaryIterations.over(longestSide)},
            {"boundary_weight", smooth.boundaryWeight}}},
          {"triangles", surface.triangles}};
}

Json vdbOptionsJson(const WriteOptions& write) {
  return {{"files", names::of(names::kVdbFiles, write.vdbFiles)},
          {"fog", write.vdbOptions.fog},
          {"half", write.vdbOptions.half},
          {"compression", names::of(names::kVdbCompression, write.vdbOptions.compression)}};
}

Json optionsJson(const FractureOptions& options, const FractureResult& result,
                 const WriteOptions& write) {
  Json json = {{"pieces", result.fragments.size()}, {"seed", options.seed}};
  if (options.voxelSize > 0.0) {
    json["voxel_size"] = options.voxelSize;
  } else if (options.resolution == kAutoResolution) {
    json["resolution"] = kAutomatic;
  } else {
    json["resolution"] = options.resolution;
  }
  if (result.parents.empty()) {
    json["fill"] = names::of(names::kFill, options.fill);
    if (options.shellThickness > 0.0) json["shell_thickness"] = options.shellThickness;
  }
  json["seeds"] = seedOptionsJson(options);
  json["grow"] = growOptionsJson(options.grow);
  json["min_share"] = options.shares.minShare;
  json["balance"] = options.shares.balance;
  json["share_tries"] = options.shares.tries;
  json["erode"] = erodeOptionsJson(options.erode);
  if (options.dropShare > 0.0) json["drop_share"] = options.dropShare;
  json["missing"] = options.missing;
  if (write.points.count > 0) json["points"] = pointOptionsJson(write);
  if (write.distances.count > 0) json["sdf"] = distanceOptionsJson(write, result.solid);
  if (write.correspondences > 0) json["correspondences"] = write.correspondences;
  if (write.density != 1.0) json["density"] = write.density;
  if (write.proxy) json["proxy_gap"] = write.proxyGap;
  if (write.needsLevelSets()) json["vdb"] = vdbOptionsJson(write);
  if (write.mesh) json["plain_meshes"] = write.plainMeshes;
  if (write.preview) json["up"] = std::string(1, write.up);
  json["surface"] = surfaceOptionsJson(options.surface, result.solid.box.longestSide());
  return json;
}

// Voxels along the longest side.
int resolutionUsed(const SourceMesh& source, const FractureOptions& options, const Solid& solid) {
  if (options.voxelSize <= 0.0 && options.resolution != kAutoResolution) return options.resolution;
  if (source.mesh.triangles.empty()) return solid.box.longestSide();  // a volume's own voxels
  return resolutionFor(source.mesh, solid.frame.voxelSize);
}

Json gridJson(const SourceMesh& source, const FractureOptions& options,
              const FractureResult& result) {
  const Solid& solid = result.solid;
  const openvdb::Coord& first = solid.box.min;
  const std::uint64_t labeled = std::transform_reduce(
      result.fragments.begin(),
      result.fragments.end() - static_cast<std::ptrdiff_t>(result.withheld), std::uint64_t{0},
      std::plus<>(), [](const Fragment& f) { return f.voxels; });
  return {{"resolution", resolutionUsed(source, options, solid)},
          {"voxel_size", solid.frame.voxelSize},
          {"dims", jsonOf(solid.box.dims())},
          {"index_min", jsonOf(first)},
          {"origin", jsonOf(solid.frame.worldFromIndex({{first.x(), first.y(), first.z()}}).v)},
          {"solid_voxels", solid.voxels},
          {"eroded_voxels", solid.voxels - labeled}};
}

// Returns the length of the contact boundary by neighbor id, world units.
std::map<int, double> boundaryLengths(const Fragment& fragment) {
  std::map<int, double> lengths;
  for (const auto& [other, curves] : boundaryLoops(fragment)) {
    double& length = lengths[other];
    for (const std::vector<std::uint32_t>& curve : curves) {
      for (std::size_t i = 0; i < curve.size(); ++i) {
        length += glm::length(fragment.mesh.vertices[curve[(i + 1) % curve.size()]] -
                              fragment.mesh.vertices[curve[i]]);
      }
    }
  }
  return lengths;
}

Json contactsJson(const Fragment& fragment, std::map<int, double> boundaries) {
  Json contacts = Json::array();
  for (const Contact& contact : fragment.contacts) {
    contacts.push_back({{"id", contact.fragment},
                        {"area", plain(contact.area)},
                        {"normal", jsonOf(contact.normal)},
                        {"centroid", jsonOf(contact.centroid.v)},
                        {"boundary_length", boundaries[contact.fragment]}});
  }
  return contacts;
}

// Returns [fragments] the seed positions of each, the primary seed first.
std::vector<Json> seedPositions(const FractureResult& result) {
  std::vector<Json> positions(result.fragments.size(), Json::array());
  for (const Seed& seed : result.seeds) {
    const openvdb::Coord& v = seed.voxel;
    positions[seed.fragment - 1u].push_back(
        jsonOf(result.solid.frame.worldFromIndex({{v.x(), v.y(), v.z()}}).v));
  }
  return positions;
}

Json fragmentJson(const Fragment& fragment, const MeshFacts& facts, const FractureResult& result,
                  Json seeds, Json files) {
  const glm::dmat3& m = fragment.mass.inertia;
  return {
      {"id", fragment.id},
      {"voxels", fragment.voxels},
      {"volume", plain(fragment.mass.volume)},
      {"share", static_cast<double>(fragment.voxels) / static_cast<double>(result.solid.voxels)},
      {"bbox", {{"min", jsonOf(facts.box.min)}, {"max", jsonOf(facts.box.max)}}},
      {"centroid", jsonOf(fragment.mass.centroid)},
      {"inertia",
       {plain(m[0][0]), plain(m[1][1]), plain(m[2][2]), plain(m[1][0]), plain(m[2][0]),
        plain(m[2][1])}},
      {"area", plain(fragment.area)},
      {"fracture_area", plain(fragment.fractureArea)},
      {"original_area", plain(fragment.area - fragment.fractureArea)},
      {"eroded_voxels", result.eroded[static_cast<std::size_t>(fragment.id)]},
      {"seeds", std::move(seeds)},
      {"files", std::move(files)},
      {"contacts", contactsJson(fragment, facts.boundaryLengths)}};
}

// Returns a path, or a list if there are several.
Json pathsJson(const std::vector<std::string>& paths) {
  return paths.size() == 1 ? Json(paths[0]) : Json(paths);
}

Json decimatedJson(const Fragment& fragment, const std::vector<std::size_t>& asked,
                   const std::vector<std::vector<std::string>>& files) {
  Json meshes = Json::array();
  for (std::size_t i = 0; i < files.size(); ++i) {
    meshes.push_back({{"asked", asked[i]},
                      {"triangles", fragment.coarse[i].triangles.size()},
                      {"file", pathsJson(files[i])}});
  }
  return meshes;
}

}  // namespace

std::vector<std::string> FractureFiles::all() const {
  std::vector<std::string> list;
  list.insert(list.end(), labels.begin(), labels.end());
  list.insert(list.end(), vdb.begin(), vdb.end());
  for (const std::vector<std::string>& ofFragment : mesh) {
    list.insert(list.end(), ofFragment.begin(), ofFragment.end());
  }
  list.insert(list.end(), solidMesh.begin(), solidMesh.end());
  list.insert(list.end(), proxy.begin(), proxy.end());
  if (!materials.empty()) list.push_back(materials);
  list.insert(list.end(), textures.begin(), textures.end());
  for (const std::vector<std::string>& ofFragment : points) {
    list.insert(list.end(), ofFragment.begin(), ofFragment.end());
  }
  list.insert(list.end(), sdf.begin(), sdf.end());
  for (const auto& ofFragment : coarse) {
    for (const std::vector<std::string>& ofOne : ofFragment) {
      list.insert(list.end(), ofOne.begin(), ofOne.end());
    }
  }
  for (const std::string& file : {allVdb, solidVdb, solidSdf, correspondences, preview, seeds,
                                  boundaries, cost, scene, graph, constraints}) {
    if (!file.empty()) list.push_back(file);
  }
  return list;
}

std::vector<MeshFacts> meshFacts(std::span<const Fragment> fragments) {
  std::vector<MeshFacts> facts(fragments.size());
  tbb::parallel_for(std::size_t{0}, facts.size(), [&](std::size_t i) {
    facts[i] = {bounds(fragments[i].mesh), boundaryLengths(fragments[i])};
  });
  return facts;
}

std::string manifestText(const SourceMesh& source, const FractureOptions& options,
                         const FractureResult& result, std::span<const MeshFacts> facts,
                         const FractureFiles& files, const WriteOptions& write) {
  Json manifest = {{"schema", kManifestSchema},
                   {"source", sourceJson(source, !result.parents.empty())},
                   {"options", optionsJson(options, result, write)}};
  if (!source.mesh.triangles.empty()) manifest["report"] = reportJson(source, result);
  const bool isRequested = options.seedFile.empty() && result.parents.empty();
  if (isRequested && static_cast<std::size_t>(options.pieces) < result.fragments.size()) {
    manifest["pieces_asked"] = options.pieces;
  }
  manifest["grid"] = gridJson(source, options, result);
  manifest["components"] = result.components;
  manifest["effective_number"] = effectiveNumber(result);
  manifest["small_components"] = {{"count", result.solid.smallComponents},
                                  {"voxels", result.solid.smallComponentVoxels}};
  manifest["fragments"] = Json::array();
  manifest["withheld"] = Json::array();
  std::vector<Json> seeds = seedPositions(result);
  for (std::size_t i = 0; i < result.fragments.size(); ++i) {
    Json own = Json::object();
    if (i >= result.kept()) {
      manifest["withheld"].push_back(
          fragmentJson(result.fragments[i], facts[i], result, std::move(seeds[i]), std::move(own)));
      continue;
    }
    if (!files.vdb.empty()) own["vdb"] = files.vdb[i];
    if (!files.mesh.empty()) own["mesh"] = pathsJson(files.mesh[i]);
    if (!files.points.empty()) own["points"] = pathsJson(files.points[i]);
    if (!files.sdf.empty()) own["sdf"] = files.sdf[i];
    if (!files.proxy.empty()) own["proxy"] = files.proxy[i];
    Json fragment =
        fragmentJson(result.fragments[i], facts[i], result, std::move(seeds[i]), std::move(own));
    if (!files.coarse.empty()) {
      fragment["decimated"] =
          decimatedJson(result.fragments[i], options.surface.triangles, files.coarse[i]);
    }
    if (!result.parents.empty()) fragment["parent"] = result.parents[i];
    manifest["fragments"].push_back(std::move(fragment));
  }
  Json solid = Json::object();
  if (!files.solidVdb.empty()) solid["vdb"] = files.solidVdb;
  if (!files.solidMesh.empty()) solid["mesh"] = pathsJson(files.solidMesh);
  if (!solid.empty()) manifest["solid"] = std::move(solid);
  if (!files.allVdb.empty()) manifest["vdb"] = files.allVdb;
  if (!files.scene.empty()) manifest["scene"] = files.scene;
  if (!files.graph.empty()) manifest["graph"] = files.graph;
  if (!files.solidSdf.empty()) manifest["sdf"] = files.solidSdf;
  if (!files.correspondences.empty()) manifest["correspondences"] = files.correspondences;
  manifest["files"] = files.all();
  // A source's name may have bytes that are not UTF-8, which JSON does not allow.
  return manifest.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sherd
