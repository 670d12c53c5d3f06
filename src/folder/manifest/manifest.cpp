// manifest.json: the options, statistics and files of a fracture.
#include "folder/manifest/manifest.h"

#include <sherd/evaluate.h>
#include <sherd/folder.h>
#include <sherd/growth.h>
#include <sherd/options.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/text/json_of.h"
#include "base/text/json_text.h"
#include "base/text/option_names.h"
#include "clean/rounded_crossings.h"
#include "folder/manifest/mesh_report.h"
#include "folder/manifest/read_manifest.h"
#include "folder/manifest/rounding.h"
#include "folder/manifest/split_parents.h"
#include "formats/voxels/vdb_unit.h"
#include "options/record.h"
#include "remesh/region_edges.h"
#include "surface/fragment_surfaces.h"

namespace sherd {
namespace {

using OrderedJson = nlohmann::ordered_json;

//   fracture  BreakHistory::sha256
OrderedJson sourceJson(const SourceMesh& source, const std::string& fracture,
                       const WriteOptions& write) {
  const bool isOfFiles = !fracture.empty();
  OrderedJson json = {
      {"file", source.name},
      {isOfFiles ? "fracture_sha256" : "sha256", isOfFiles ? fracture : source.sha256}};
  json.update(jsonOfCoordinates(coordinatesOf(source.coordinates, write)));
  if (isOfFiles) return json;
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

// Returns the options with what this fracture made of them.
RunOptions asUsed(const FractureOptions& options, const FractureResult& result,
                  const WriteOptions& write) {
  RunOptions used{.fracture = options, .volume = {}, .write = write};
  used.recenter = write.offset.has_value();
  if (isDouble(write, isExact(options, result), result.solid))
    used.write.precision = Precision::full;
  used.fracture.pieces = static_cast<int>(result.fragments.size());
  if (!result.parents.empty()) {
    used.fracture.erode.iterations = 0;  // of the whole: ignored
  } else if (options.seeds.on == SeedsOn::automatic) {
    used.fracture.seeds.on = result.seedsOn;
  }
  SmoothOptions& smooth = used.fracture.surface.smooth;
  const int side = result.solid.box.longestSide();
  smooth.iterations = {.count = smooth.iterations.over(side)};
  smooth.boundaryIterations = {.count = smooth.boundaryIterations.over(side)};
  double& sigma = used.write.distances.sigma;
  if (sigma <= 0.0) sigma = result.solid.frame.voxelSize;
  return used;
}

OrderedJson gridJson(const SourceMesh& source, const FractureOptions& options,
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
          {"origin", jsonOf(solid.frame.worldFromIndex(first))},
          {"solid_voxels", solid.voxels},
          {"eroded_voxels", solid.voxels - labeled}};
}

OrderedJson contactsJson(const Fragment& fragment, bool areThin, std::map<int, double> boundaries) {
  OrderedJson contacts = OrderedJson::array();
  for (const Contact& contact : fragment.contacts) {
    if (contact.isThin != areThin) continue;
    contacts.push_back({{"id", contact.fragment},
                        {"area", plain(contact.area)},
                        {"normal", jsonOf(contact.normal)},
                        {"centroid", jsonOf(contact.centroid)},
                        {"boundary_length", boundaries[contact.fragment]}});
  }
  return contacts;
}

// Adds what was broken again, and the breaks before.
void addHistory(OrderedJson& manifest, const FractureResult& result) {
  manifest["only"] = result.broken;
  if (result.history.breaks.empty()) return;
  manifest["history"] = OrderedJson::array();
  for (const std::string& text : result.history.breaks) {
    manifest["history"].push_back(OrderedJson::parse(text));
  }
  if (result.history.omitted > 0) manifest["history_omitted"] = result.history.omitted;
}

// Returns [fragments] the seed positions of each, the primary seed first.
std::vector<OrderedJson> seedPositions(const FractureResult& result) {
  std::vector<OrderedJson> positions(result.fragments.size(), OrderedJson::array());
  for (const Seed& seed : result.seeds) {
    positions[seed.fragment - 1u].push_back(
        jsonOf(result.solid.frame.worldFromIndex(pointOf(seed))));
  }
  return positions;
}

OrderedJson bodiesJson(const SourceMesh& source, const InputBodies& bodies) {
  OrderedJson json = {{"input", bodies.count}, {"united", bodies.united}};
  const std::vector<std::vector<std::string>> objects = bodies.objects(source);
  if (!objects.empty()) json["objects"] = objects;
  return json;
}

// Why some fragments have smooth surfaces instead of exact ones.
OrderedJson smoothJson(const SourceMesh& source, const std::vector<SmoothBodies>& smooth) {
  OrderedJson all = OrderedJson::array();
  for (const SmoothBodies& bodies : smooth) {
    OrderedJson json = {{"reason", bodies.reason}, {"fragments", bodies.fragments}};
    const std::vector<std::string> objects = objectsOf(source, bodies.triangles);
    if (!objects.empty()) json["objects"] = objects;
    all.push_back(std::move(json));
  }
  return all;
}

OrderedJson fragmentJson(const Fragment& fragment, const MeshFacts& facts,
                         const FractureResult& result, bool hasBodies, OrderedJson seeds,
                         OrderedJson files) {
  const glm::dmat3& m = fragment.mass.inertia;
  OrderedJson json = {
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
      {"surface", names::of(names::kSurface, fragment.meshedAs)},
      {"eroded_voxels", result.eroded[static_cast<std::size_t>(fragment.id)]},
      {"seeds", std::move(seeds)},
      {"files", std::move(files)},
      {"contacts", contactsJson(fragment, false, facts.boundaryLengths)}};
  OrderedJson thin = contactsJson(fragment, true, facts.boundaryLengths);
  if (!thin.empty()) json["thin_contacts"] = std::move(thin);
  if (facts.roundedCrossings) json["rounded_crossings"] = *facts.roundedCrossings;
  if (hasBodies) json["bodies"] = facts.bodies;
  return json;
}

// The splits in order, each with the split that its piece comes from.
OrderedJson splitsJson(const FractureResult& result, const SplitParents& parents) {
  OrderedJson all = OrderedJson::array();
  const std::vector<Split>& splits = result.labels.splits;
  for (std::size_t i = 0; i < splits.size(); ++i) {
    const Split& split = splits[i];
    OrderedJson json = {{"id", i + 1},
                        {"parent", parents.ofSplit[i]},
                        {"level", split.generation + 1},
                        {"voxels", split.voxels}};
    if (split.normal != glm::ivec3(0)) {
      const GridFrame& frame = result.solid.frame;
      const glm::dvec3 normal = glm::normalize(glm::dvec3(split.normal));
      const double index =
          static_cast<double>(split.offset) / (64.0 * glm::length(glm::dvec3(split.normal)));
      json["plane"] = {{"normal", jsonOf(normal)},
                       {"distance", plain(glm::dot(normal, frame.worldFromIndex(glm::dvec3(0.0))) +
                                          frame.voxelSize * index)}};
    }
    if (split.isSphere) {
      const double radius = std::sqrt(static_cast<double>(split.offset)) / 64.0;
      json["sphere"] = {
          {"center", jsonOf(result.solid.frame.worldFromIndex(glm::dvec3(split.center) / 64.0))},
          {"radius", plain(radius * result.solid.frame.voxelSize)}};
    }
    all.push_back(std::move(json));
  }
  return all;
}

// Returns a path, or a list if there are several.
OrderedJson pathsJson(const std::vector<std::string>& paths) {
  return paths.size() == 1 ? OrderedJson(paths[0]) : OrderedJson(paths);
}

OrderedJson decimatedJson(const Fragment& fragment, const std::vector<std::size_t>& asked,
                          const std::vector<std::vector<std::string>>& files) {
  OrderedJson meshes = OrderedJson::array();
  for (std::size_t i = 0; i < files.size(); ++i) {
    meshes.push_back({{"asked", asked[i]},
                      {"triangles", fragment.coarse[i].triangles.size()},
                      {"file", pathsJson(files[i])}});
  }
  return meshes;
}

// The files of one fragment.
OrderedJson filesJson(const FractureFiles& files, std::size_t i) {
  OrderedJson own = OrderedJson::object();
  if (!files.vdb.empty()) own["vdb"] = files.vdb[i];
  if (!files.mesh.empty()) own["mesh"] = pathsJson(files.mesh[i]);
  if (!files.points.empty()) own["points"] = pathsJson(files.points[i]);
  if (!files.sdf.empty()) own["sdf"] = files.sdf[i];
  if (!files.proxy.empty()) own["proxy"] = files.proxy[i];
  return own;
}

// Adds the files that hold all fragments or the intact solid, and the list of all files.
void addFiles(OrderedJson& manifest, const FractureFiles& files) {
  OrderedJson solid = OrderedJson::object();
  if (!files.solidVdb.empty()) solid["vdb"] = files.solidVdb;
  if (!files.solidMesh.empty()) solid["mesh"] = pathsJson(files.solidMesh);
  if (!solid.empty()) manifest["solid"] = std::move(solid);
  if (!files.allVdb.empty()) manifest["vdb"] = files.allVdb;
  if (!files.scene.empty()) manifest["scene"] = files.scene;
  if (!files.usd.empty()) manifest["usd"] = pathsJson(files.usd);
  if (!files.houdini.empty()) manifest["houdini"] = pathsJson(files.houdini);
  if (!files.graph.empty()) manifest["graph"] = files.graph;
  if (!files.viewer.empty()) manifest["viewer"] = files.viewer;
  if (!files.solidSdf.empty()) manifest["sdf"] = files.solidSdf;
  if (!files.correspondences.empty()) manifest["correspondences"] = files.correspondences;
  manifest["files"] = files.all();
}

}  // namespace

std::vector<MeshFacts> meshFacts(std::span<const Fragment> fragments, const InputBodies& bodies) {
  std::vector<MeshFacts> facts(fragments.size());
  tbb::parallel_for(std::size_t{0}, facts.size(), [&](std::size_t i) {
    facts[i] = {bounds(fragments[i].mesh),
                lengthsOf(boundaryLoops(fragments[i]), fragments[i].mesh.vertices)};
    if (fragments[i].meshedAs == Surface::exact) {
      facts[i].roundedCrossings = roundedCrossings(fragments[i].mesh);
      facts[i].bodies = bodies.of(fragments[i].mesh);
    } else if (const auto own = bodies.ofSmooth.find(fragments[i].id);
               own != bodies.ofSmooth.end()) {
      facts[i].bodies = own->second;
    }
  });
  return facts;
}

std::vector<MeshFacts> meshFacts(const FragmentSurfaces& surfaces) {
  std::vector<MeshFacts> facts(surfaces.count());
  std::vector<std::map<int, double>> lengths = surfaces.boundaryLengths();
  tbb::parallel_for(std::size_t{0}, facts.size(), [&](std::size_t i) {
    facts[i] = {surfaces.box(static_cast<std::uint16_t>(i + 1)), std::move(lengths[i + 1])};
  });
  return facts;
}

std::vector<MeshFacts> meshFacts(const FractureResult& result, const InputBodies& bodies) {
  return result.surfaces ? meshFacts(*result.surfaces) : meshFacts(result.fragments, bodies);
}

std::string crossingsWarning(std::span<const MeshFacts> facts, const WriteOptions& write) {
  std::size_t crossings = 0;
  for (const MeshFacts& own : facts) crossings += own.roundedCrossings.value_or(0);
  if (crossings == 0 || !writesFloats(write)) return {};
  return std::to_string(crossings) +
         (crossings == 1 ? " pair of triangles crosses" : " pairs of triangles cross") +
         " each other where files of single precision round their vertices; .ply and .obj with the "
         "option precision auto or double have no such pairs";
}

int resolutionUsed(const SourceMesh& source, const FractureOptions& options, const Solid& solid) {
  if (options.solid.voxelSize <= 0.0 && options.solid.resolution != kAutoResolution) {
    return options.solid.resolution;
  }
  if (source.mesh.triangles.empty()) return solid.box.longestSide();  // a volume's own voxels
  return resolutionFor(source.mesh, solid.frame.voxelSize);
}

OrderedJson breakJson(const SourceMesh& source, const FractureOptions& options,
                      const FractureResult& result, const WriteOptions& write) {
  const bool isRefracture = !result.parents.empty();
  OrderedJson manifest = {
      {"schema", kManifestSchema},
      {"source", sourceJson(source, result.history.sha256, write)},
      {"options", recordedOptions(asUsed(options, result, write), isRefracture)}};
  if (isRefracture) addHistory(manifest, result);
  return manifest;
}

std::string manifestText(const SourceMesh& source, const FractureOptions& options,
                         const FractureResult& result, std::span<const MeshFacts> facts,
                         const InputBodies& bodies, const FractureFiles& files,
                         const WriteOptions& write, const OrderedJson* assemblage) {
  const bool isRefracture = !result.parents.empty();
  OrderedJson manifest = breakJson(source, options, result, write);
  if (!source.mesh.triangles.empty() && !isRefracture)
    manifest["report"] = reportJson(source, result);
  const bool isRequested = !options.seeds.given && !isRefracture;
  if (isRequested && static_cast<std::size_t>(options.pieces) < result.fragments.size()) {
    manifest["pieces_asked"] = options.pieces;
  }
  if (!result.exactFailure.empty()) manifest["exact_failure"] = result.exactFailure;
  if (!result.smooth.empty()) manifest["smooth_bodies"] = smoothJson(source, result.smooth);
  if (write.offset) manifest["offset"] = jsonOf(*write.offset);
  if (assemblage != nullptr) manifest["assemblage"] = *assemblage;
  manifest["grid"] = gridJson(source, options, result);
  const double unit = vdbUnitOf(result.solid.frame.voxelSize, write.vdbOptions.half);
  const bool hasVdb = !files.vdb.empty() || !files.allVdb.empty() || !files.solidVdb.empty();
  if (hasVdb && unit != 1.0) manifest["grid"]["vdb_unit"] = unit;
  if (const Rounding rounding = roundingOf(write, result.solid); !rounding.files.empty()) {
    manifest["rounding"] = {{"files", rounding.files}, {"length", rounding.length}};
  }
  manifest["components"] = result.components;
  if (bodies.count > 0) manifest["bodies"] = bodiesJson(source, bodies);
  if (result.sizeError > 0.0) manifest["size_error"] = result.sizeError;
  manifest["effective_number"] = effectiveNumber(result);
  manifest["small_components"] = {{"count", result.solid.smallComponents},
                                  {"voxels", result.solid.smallComponentVoxels}};
  manifest["fragments"] = OrderedJson::array();
  manifest["withheld"] = OrderedJson::array();
  const bool isSplit = ruleOf(options.grow.growth).splits && !isRefracture && assemblage == nullptr;
  const SplitParents parents = parentsOf(result.labels.splits, result.fragments.size());
  if (isSplit) manifest["splits"] = splitsJson(result, parents);
  std::vector<OrderedJson> seeds = seedPositions(result);
  for (std::size_t i = 0; i < result.fragments.size(); ++i) {
    const bool isKept = i < result.kept();
    OrderedJson fragment =
        fragmentJson(result.fragments[i], facts[i], result, bodies.count > 0, std::move(seeds[i]),
                     isKept ? filesJson(files, i) : OrderedJson::object());
    if (!result.objectOf.empty()) fragment["object"] = result.objectOf[i];
    if (!isKept) {
      if (isSplit) fragment["split"] = parents.ofFragment[i];
      manifest["withheld"].push_back(std::move(fragment));
      continue;
    }
    if (!files.coarse.empty()) {
      fragment["decimated"] =
          decimatedJson(result.fragments[i], options.surface.triangles, files.coarse[i]);
    }
    if (isSplit) fragment["split"] = parents.ofFragment[i];
    if (!result.parents.empty()) fragment["parent"] = result.parents[i];
    manifest["fragments"].push_back(std::move(fragment));
  }
  addFiles(manifest, files);
  // A source's name may have bytes that are not UTF-8, which JSON does not allow.
  return jsonText(manifest, 1) + "\n";
}

}  // namespace sherd
