// The files of a fracture.
#include "io/fracture_files.h"

#include <sherd/error.h>
#include <sherd/render.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <filesystem>

#include "io/mesh_writer.h"
#include "io/write_points.h"
#include "uncancelled.h"

namespace sherd {
namespace {

constexpr std::size_t kFragmentsBetweenSteps = 16;  // written in parallel, then progress is told

// The labels over the solid's tight box, and where it lies.
PlacedVoxels labelledBox(const FractureResult& result, int fragments) {
  const openvdb::Coord& first = result.solid.box.min;
  const GridFrame& frame = result.solid.frame;
  const WorldPoint origin = frame.worldFromIndex({{first.x(), first.y(), first.z()}});
  return {encodeRuns(result.solid, result.labels, fragments),
          VoxelPlace{{origin, frame.voxelSize}, first}};
}

}  // namespace

FractureWriter::FractureWriter(const SourceMesh& source, const WriteOptions& write)
    : source_(source), options_(write), table_(materialTable(source.appearance)) {
  const bool hasMeshes = write.mesh || write.scene;
  if (hasMeshes && !source.appearance.surface.empty()) {
    look_.emplace(source.mesh, source.appearance.surface);
  }
}

void FractureWriter::write(const OutputFolder& folder, const FractureFiles& files,
                           const FractureOptions& options, const FractureResult& result,
                           const Progress* progress) const {
  const WriteOptions& write = options_;
  const std::size_t fragments = result.kept();
  std::vector<std::size_t> counts;
  if (!files.points.empty()) counts = pointCounts(result, write);
  step(progress, "write", 0.0);
  if (!files.labels.empty()) {
    const PlacedVoxels voxels = labelledBox(result, static_cast<int>(fragments));
    for (std::size_t i = 0; i < files.labels.size(); ++i) {
      writeVoxels(folder / files.labels[i], voxels, write.voxelFormats[i]);
    }
  }
  if (!files.seeds.empty()) writeSeeds(folder / files.seeds, result.seeds, result.solid);
  if (!files.rims.empty()) {
    writeRims(folder / files.rims, std::span(result.fragments).first(fragments));
  }
  if (!files.cost.empty()) writeCost(folder / files.cost, result.solid, result.labels);
  const VdbNotes notes{source_.name, options.seed, write.density, result.parents};
  const std::span<const Fragment> kept = std::span(result.fragments).first(fragments);
  if (!files.allVdb.empty()) {
    writeVdbOfAll(folder / files.allVdb, kept, result.solid, result.labels, notes,
                  write.vdbOptions);
  }
  if (!files.solidVdb.empty()) {
    writeVdbOfSolid(folder / files.solidVdb, result.solid, notes, write.vdbOptions);
  }
  if (!files.graph.empty()) {
    writeGraph(folder / files.graph, kept, notes);
    writeConstraints(folder / files.constraints, kept);
  }
  const MeshWriter meshes(folder, files, source_, table_, look_ ? &*look_ : nullptr, write);
  if (!files.solidMesh.empty()) {
    const TriangleMesh whole = solidMesh(result.solid, options.surface);
    const std::vector<std::uint16_t> facing(whole.triangles.size(), 0);
    meshes.write(whole, facing, meshes.lookOf(whole, facing), files.solidMesh);
  }
  std::vector<SurfaceLook> looks(files.scene.empty() ? 0 : fragments);
  const auto writeFragment = [&](std::size_t i) {
    const Fragment& fragment = result.fragments[i];
    if (!files.vdb.empty()) writeVdb(folder / files.vdb[i], fragment, notes, write.vdbOptions);
    if (!files.proxy.empty()) {
      const std::string name = std::filesystem::path(files.proxy[i]).stem().string();
      writeProxy(folder / files.proxy[i], fragment, name, write.proxyGap);
    }
    if (!files.mesh.empty() || !looks.empty()) {
      SurfaceLook look = meshes.lookOf(fragment.mesh, fragment.facing);
      if (!files.mesh.empty()) {
        meshes.write(fragment.mesh, fragment.facing, look, files.mesh[i]);
      }
      if (!looks.empty()) looks[i] = std::move(look);
    }
    if (!files.points.empty()) {
      writePointsOf(folder, files.points[i], fragment, counts[i], options.seed, write);
    }
    for (std::size_t k = 0; !files.coarse.empty() && k < files.coarse[i].size(); ++k) {
      const CoarseMesh& coarse = fragment.coarse[k];
      meshes.write(coarse.mesh, coarse.facing, meshes.lookOf(coarse.mesh, coarse.facing),
                   files.coarse[i][k]);
    }
  };
  for (std::size_t begin = 0; begin < fragments; begin += kFragmentsBetweenSteps) {
    step(progress, "write", static_cast<double>(begin) / static_cast<double>(fragments));
    const std::size_t end = std::min(fragments, begin + kFragmentsBetweenSteps);
    tbb::parallel_for(begin, end, [&](std::size_t i) { uncancelled([&] { writeFragment(i); }); });
  }
  if (!files.scene.empty()) meshes.writeScene(kept, looks, files.scene);
  if (!files.solidSdf.empty()) {
    writeAllDistances(folder, files, result, options.seed, write.distances, progress);
  }
  if (!files.correspondences.empty()) {
    writeCorrespondences(folder / files.correspondences,
                         sampleCorrespondences(std::span(result.fragments).first(fragments),
                                               write.correspondences, options.seed));
  }
  step(progress, "write", 1.0);
  if (!files.preview.empty()) {
    writePng(folder / files.preview, renderFragments(std::span(result.fragments).first(fragments),
                                                     {.up = write.up}, progress));
  }
}

void checkWriteOptions(const WriteOptions& write, const FractureOptions& options) {
  const auto wanted = [&](MeshFileFormat format) {
    return std::find(write.meshFormats.begin(), write.meshFormats.end(), format) !=
           write.meshFormats.end();
  };
  if (wanted(MeshFileFormat::stl) && wanted(MeshFileFormat::stlText)) {
    throw Error(ErrorCode::usage,
                "stl and stl-ascii would be files of the same name; ask for one of them");
  }
  const SurfaceOptions& surface = options.surface;
  const Iterations& smoothed = surface.smooth.boundaryIterations;
  const bool isSmoothed =
      surface.smooth.boundaryWeight > 0.0 && (smoothed.count > 0 || smoothed.perVoxel > 0.0);
  const bool isShared = surface.surface == Surface::labels
                            ? !isSmoothed && surface.adaptivity == 0.0
                            : surface.interface == Interface::shared;
  if (write.correspondences > 0 && (!isShared || options.erode.iterations > 0)) {
    throw Error(ErrorCode::usage,
                "correspondences need surfaces that fragments share: not meshed independently, "
                "not worn, and of labels neither smoothed at the cracks nor simplified");
  }
}

}  // namespace sherd
