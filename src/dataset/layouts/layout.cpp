// The file names of a dataset.
#include "dataset/layouts/layout.h"

#include "base/text/option_names.h"
#include "dataset/layouts/hdf5_part.h"
#include "dataset/layouts/pfpp.h"
#include "folder/manifest/file_names.h"
#include "folder/manifest/read_manifest.h"

namespace sherd {
namespace {

using Names = std::vector<std::string>;

std::string extensionOf(MeshFileFormat format) {
  return format == MeshFileFormat::stlText ? "stl" : names::of(names::kMeshFileFormat, format);
}

Names meshes(const std::string& name, const WriteOptions& write) {
  Names out;
  for (const MeshFileFormat format : write.meshFormats) {
    out.push_back(name + "." + extensionOf(format));
  }
  return out;
}

Names points(const std::string& name, const WriteOptions& write) {
  Names out;
  for (const PointFormat format : write.pointFormats) {
    out.push_back(name + "." + names::of(names::kPointFormat, format));
  }
  return out;
}

Names labels(const std::string& name, const WriteOptions& write) {
  Names out;
  if (!write.labels) return out;
  for (const VoxelFormat format : write.voxelFormats) {
    out.push_back(name + "." + names::of(names::kVoxelFormat, format));
  }
  return out;
}

// Path names, without extensions, by fragment index from 0.
struct Naming {
  std::function<std::string(std::size_t)> mesh, points, vdb, sdf, proxy;
  std::function<std::string(std::size_t, std::size_t)> coarse;
  std::string whole;  // prefix of files that exist once per fracture
  std::string labels;
};

FractureFiles filesBy(const Naming& naming, const NamedObject& object, std::size_t fragments) {
  const WriteOptions& write = object.write;
  FractureFiles files;
  files.labels = labels(naming.labels, write);
  for (std::size_t i = 0; i < fragments; ++i) {
    if (write.mesh) files.mesh.push_back(meshes(naming.mesh(i), write));
    if (write.vdb && write.vdbFiles != VdbFiles::single)
      files.vdb.push_back(naming.vdb(i) + ".vdb");
    if (write.points.count > 0) files.points.push_back(points(naming.points(i), write));
    if (write.distances.count > 0) files.sdf.push_back(naming.sdf(i) + ".npz");
    if (write.proxy) files.proxy.push_back(naming.proxy(i) + ".obj");
    if (!write.mesh || object.options.surface.triangles.empty()) continue;
    std::vector<Names>& coarse = files.coarse.emplace_back();
    for (const std::size_t t : object.options.surface.triangles) {
      coarse.push_back(meshes(naming.coarse(i, t), write));
    }
  }
  const std::string& whole = naming.whole;
  if (write.vdb && write.vdbFiles != VdbFiles::files) files.allVdb = whole + "fragments.vdb";
  if (write.distances.count > 0) files.solidSdf = whole + "solid.npz";
  if (write.correspondences > 0) files.correspondences = whole + "correspondences.npz";
  if (write.preview) files.preview = whole + "preview.png";
  if (write.seeds) files.seeds = whole + "seeds.json";
  if (write.boundaries) files.boundaries = whole + "boundaries.obj";
  if (write.cost) files.cost = whole + "cost.vdb";
  if (write.scene) files.scene = whole + "scene.glb";
  if (write.houdini) files.houdini = houdiniNames(whole, object.options.surface.triangles);
  if (write.graph) files.graph = whole + "graph.json";
  if (write.graph || write.houdini) files.constraints = whole + "graph.geo";
  if (write.viewer) files.viewer = whole + "viewer.html";
  return files;
}

// The paper's names: M_4f_128r_0it.rle, M_4f_128r_0it_2.binm, M_4f_128r_0it_2_1024p.binp; of the
// intact object M_grid_128r.rle, M.binm, M_1024p.binp.
Naming paperNaming(const NamedObject& object, const std::string& base, bool isWhole) {
  const std::string count = "_" + std::to_string(object.write.points.count) + "p";
  const auto numbered = [=](std::size_t i) {
    return isWhole ? base : base + "_" + std::to_string(i);
  };
  Naming naming;
  naming.mesh = naming.vdb = numbered;
  naming.points = [=](std::size_t i) { return numbered(i) + count; };
  naming.sdf = [=](std::size_t i) { return numbered(i) + "_sdf"; };
  naming.proxy = [=](std::size_t i) { return numbered(i) + "_proxy"; };
  naming.coarse = [=](std::size_t i, std::size_t t) {
    return numbered(i) + "_" + std::to_string(t) + "t";
  };
  naming.whole = base + "_";
  naming.labels = isWhole ? base + "_grid_" + std::to_string(object.longestSide) + "r" : base;
  return naming;
}

// Breaking Bad's fractured_3/piece_0.obj, and nothing else in that folder: its readers treat every
// file there as a piece, and every folder with "fractured" or "mode" in its name as a fracture.
Naming bbNaming(const std::string& fracture) {
  const auto in = [=](const std::string& folder) {
    return [=](std::size_t i) {
      return (folder.empty() ? "" : folder + "/") + fracture + "/piece_" + std::to_string(i);
    };
  };
  Naming naming;
  naming.mesh = in("");
  naming.points = in("points");
  naming.vdb = in("vdb");
  naming.sdf = in("sdf");
  naming.proxy = in("proxies");
  naming.coarse = [=](std::size_t i, std::size_t t) {
    return in("decimated_" + std::to_string(t))(i);
  };
  naming.whole = "whole/" + fracture + "_";
  naming.labels = "labels/" + fracture;
  return naming;
}

// One file for all fragments.
FractureFiles oneFile(const std::string& name, std::size_t fragments) {
  FractureFiles files;
  files.mesh.assign(fragments, {name});
  return files;
}

}  // namespace

bool hasWorldPositions(DatasetLayout layout) {
  return layout == DatasetLayout::sherd || layout == DatasetLayout::packed ||
         layout == DatasetLayout::paper;
}

NamedFiles fractureNames(DatasetLayout layout, const NamedObject& object,
                         const PlannedFracture& fracture, std::size_t number,
                         std::size_t fragments) {
  switch (layout) {
    case DatasetLayout::sherd:
    case DatasetLayout::packed:
      return {fracture.name() + "/",
              fileNames(object.source, fragments, object.options.surface.triangles,
                        object.materials, object.write),
              kManifestName};
    case DatasetLayout::paper: {
      const std::string base =
          safeName(object.source.stem, "piece") + "_" + std::to_string(fracture.pieces) + "f_" +
          std::to_string(object.longestSide) + "r_" + std::to_string(fracture.repeat) + "it";
      return {"", filesBy(paperNaming(object, base, false), object, fragments), ""};
    }
    case DatasetLayout::bb:
      return {"", filesBy(bbNaming("fractured_" + std::to_string(number)), object, fragments), ""};
    case DatasetLayout::hdf5:
      return {"", oneFile("fractured_" + std::to_string(number) + kHdf5Part, fragments), ""};
    case DatasetLayout::pfpp: {
      const PfppNames own = pfppNames(object.object, object.split, number);
      FractureFiles files;
      files.points.assign(fragments, {own.points});
      files.correspondences = own.matches;
      return {"", std::move(files), ""};
    }
  }
  return {};
}

NamedFiles wholeNames(DatasetLayout layout, const NamedObject& object) {
  WriteOptions write = object.write;  // only the files of a single fragment
  write.preview = write.seeds = write.boundaries = write.cost = write.scene = write.graph = false;
  write.houdini = write.viewer = false;
  write.vdbFiles = VdbFiles::files;
  write.correspondences = 0;
  write.distances.count = 0;
  const NamedObject whole{object.object,  object.split, object.source,     object.materials,
                          object.options, write,        object.longestSide};
  const std::string stem = safeName(object.source.stem, "piece");
  Naming naming;
  std::string prefix;
  switch (layout) {
    case DatasetLayout::sherd:
    case DatasetLayout::packed: {
      const auto same = [=](std::size_t) { return stem; };
      naming.mesh = naming.points = naming.vdb = naming.sdf = naming.proxy = same;
      const auto in = [=](const char* folder) {
        return [=](std::size_t) { return std::string(folder) + "/" + stem; };
      };
      naming.mesh = in("meshes");
      naming.points = in("points");
      naming.vdb = in("fragments");
      naming.proxy = in("proxies");
      naming.coarse = [=](std::size_t, std::size_t t) {
        return "meshes/" + stem + "_t" + std::to_string(t);
      };
      naming.labels = "labels";
      prefix = "whole/";
      break;
    }
    case DatasetLayout::paper:
      naming = paperNaming(object, stem, true);
      break;
    case DatasetLayout::hdf5:
      return {"", oneFile(std::string("complete") + kHdf5Part, 1), ""};
    case DatasetLayout::pfpp:  // has only fractures
      return {};
    case DatasetLayout::bb: {
      naming = bbNaming("");
      const auto in = [](const char* folder) {
        return [=](std::size_t) { return std::string(folder) + "complete"; };
      };
      naming.mesh = in("");
      naming.points = in("points/");
      naming.vdb = in("vdb/");
      naming.proxy = in("proxies/");
      naming.coarse = [](std::size_t, std::size_t t) {
        return "decimated_" + std::to_string(t) + "/complete";
      };
      naming.labels = "labels/complete";
      break;
    }
  }
  return {prefix, filesBy(naming, whole, 1), ""};
}

std::vector<std::string> filesOfFragment(const FractureFiles& files, std::size_t i) {
  std::vector<std::string> own;
  const auto add = [&](const std::vector<std::string>& more) {
    own.insert(own.end(), more.begin(), more.end());
  };
  if (i < files.mesh.size()) add(files.mesh[i]);
  if (i < files.vdb.size()) own.push_back(files.vdb[i]);
  if (i < files.points.size()) add(files.points[i]);
  if (i < files.sdf.size()) own.push_back(files.sdf[i]);
  if (i < files.proxy.size()) own.push_back(files.proxy[i]);
  if (i < files.coarse.size()) {
    for (const std::vector<std::string>& ofOne : files.coarse[i]) add(ofOne);
  }
  return own;
}

}  // namespace sherd
