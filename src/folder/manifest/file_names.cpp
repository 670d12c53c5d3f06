// Names of a fracture's files.
#include "folder/manifest/file_names.h"

#include <algorithm>

#include "base/text/option_names.h"

namespace sherd {
namespace {

std::vector<std::string> meshNames(const std::string& name, const WriteOptions& write) {
  std::vector<std::string> names;
  for (const MeshFileFormat format : write.meshFormats) {
    names.push_back(
        name + "." +
        (format == MeshFileFormat::stlText ? "stl" : names::of(names::kMeshFileFormat, format)));
  }
  return names;
}

// Adds the files to which .obj, .ply and .usda files refer; a .glb embeds its textures.
void addMaterialFiles(FractureFiles& files, const std::string& stem, const MaterialTable& table,
                      const WriteOptions& write) {
  const auto wanted = [&](MeshFileFormat format) {
    return std::find(write.meshFormats.begin(), write.meshFormats.end(), format) !=
           write.meshFormats.end();
  };
  const bool hasUsda = write.usd && !write.plainMeshes &&
                       std::find(write.usdFormats.begin(), write.usdFormats.end(),
                                 UsdFormat::usda) != write.usdFormats.end();
  const bool hasObj = write.mesh && wanted(MeshFileFormat::obj) && !write.plainMeshes;
  const bool hasPly = write.mesh && wanted(MeshFileFormat::ply) && !write.plainMeshes;
  if (hasObj) files.materials = "meshes/" + withoutBlanks(stem) + ".mtl";
  if (!hasObj && !hasPly && !hasUsda) return;
  for (const MaterialTable::Image& image : table.textures) {
    files.textures.push_back("meshes/" + image.file);
  }
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
  list.insert(list.end(), usd.begin(), usd.end());
  list.insert(list.end(), houdini.begin(), houdini.end());
  for (const std::string& file : {allVdb, solidVdb, solidSdf, correspondences, preview, seeds,
                                  boundaries, cost, scene, graph, constraints, viewer}) {
    if (!file.empty()) list.push_back(file);
  }
  return list;
}

std::string fragmentName(const std::string& stem, std::size_t id, std::size_t fragments) {
  const std::size_t digits = std::max<std::size_t>(3, std::to_string(fragments).size());
  const std::string number = std::to_string(id);
  return stem + "_" + std::string(digits - number.size(), '0') + number;
}

bool isSubfolder(const std::string& name) {
  for (const char* own : {"fragments", "meshes", "points", "proxies", "sdf"}) {
    if (name == own) return true;
  }
  return false;
}

std::vector<std::string> houdiniNames(const std::string& prefix,
                                      const std::vector<std::size_t>& triangles) {
  std::vector<std::string> names{prefix + "pieces.geo"};
  for (const std::size_t t : triangles) {
    names.push_back(prefix + "pieces_t" + std::to_string(t) + ".geo");
  }
  return names;
}

FractureFiles fileNames(const SourceMesh& source, std::size_t fragments,
                        const std::vector<std::size_t>& triangles, const MaterialTable& table,
                        const WriteOptions& write) {
  const std::string stem = safeName(source.stem, "piece");
  FractureFiles files;
  for (std::size_t id = 1; id <= fragments; ++id) {
    const std::string name = fragmentName(stem, id, fragments);
    if (write.vdb && write.vdbFiles != VdbFiles::single) {
      files.vdb.push_back("fragments/" + name + ".vdb");
    }
    if (write.proxy) files.proxy.push_back("proxies/" + name + ".obj");
    if (write.mesh) files.mesh.push_back(meshNames("meshes/" + name, write));
    if (write.points.count > 0) {
      files.points.emplace_back();
      for (const PointFormat format : write.pointFormats) {
        files.points.back().push_back("points/" + name + "." +
                                      names::of(names::kPointFormat, format));
      }
    }
    if (write.distances.count > 0) files.sdf.push_back("sdf/" + name + ".npz");
    if (!write.mesh || triangles.empty()) continue;
    std::vector<std::vector<std::string>>& coarse = files.coarse.emplace_back();
    for (const std::size_t t : triangles) {
      coarse.push_back(meshNames("meshes/" + name + "_t" + std::to_string(t), write));
    }
  }
  if (write.vdb && write.vdbFiles != VdbFiles::files) files.allVdb = "fragments.vdb";
  if (write.solid && write.vdb) files.solidVdb = "fragments/" + stem + ".vdb";
  if (write.solid && write.mesh) files.solidMesh = meshNames("meshes/" + stem, write);
  if (write.scene) files.scene = "scene.glb";
  for (const UsdFormat format : write.usdFormats) {
    if (write.usd)
      files.usd.push_back(std::string("scene.") + names::of(names::kUsdFormat, format));
  }
  if (write.houdini) files.houdini = houdiniNames({}, triangles);
  if (write.graph) files.graph = "graph.json";
  if (write.graph || write.houdini) files.constraints = "graph.geo";
  if (write.viewer) files.viewer = "viewer.html";
  addMaterialFiles(files, stem, table, write);
  if (write.distances.count > 0) files.solidSdf = "sdf/" + stem + ".npz";
  if (write.correspondences > 0) files.correspondences = "correspondences.npz";
  for (const VoxelFormat format : write.voxelFormats) {
    if (!write.labels) break;
    files.labels.push_back(std::string("labels.") + names::of(names::kVoxelFormat, format));
  }
  if (write.preview) files.preview = "preview.png";
  if (write.seeds) files.seeds = "seeds.json";
  if (write.boundaries) files.boundaries = "boundaries.obj";
  if (write.cost) files.cost = "cost.vdb";
  return files;
}

}  // namespace sherd
