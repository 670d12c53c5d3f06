// The files of a fracture.
#include "folder/files/fracture_files.h"

#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/render.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <filesystem>

#include "base/cancel_flag.h"
#include "base/uncancelled.h"
#include "folder/files/intact_mesh.h"
#include "folder/files/viewer_file.h"
#include "folder/files/write_points.h"
#include "points/sample_surface.h"
#include "remesh/smooth.h"
#include "render/preview_fragment.h"

namespace sherd {
namespace {

constexpr std::size_t kFragmentsPerBatch = 16;  // written in parallel between progress reports

// Returns the labels over the solid's tight box, with the box's transform.
PlacedVoxels labeledBox(const FractureResult& result, int fragments) {
  const openvdb::Coord& first = result.solid.box.min;
  const GridFrame& frame = result.solid.frame;
  const glm::dvec3 origin = frame.worldFromIndex(first);
  return {encodeRuns(result.solid, result.labels, fragments),
          VoxelTransform{{origin, frame.voxelSize}, first}};
}

// Whether a file is written that has the attributes of all meshes at once.
bool hasScenes(const FractureFiles& files) {
  return !files.scene.empty() || !files.usd.empty() || !files.houdini.empty() ||
         !files.viewer.empty();
}

// Whether a file is written that has the faces of the source.
bool hasSourceFaces(const WriteOptions& write) {
  return write.sourceFaces && write.mesh && !write.plainMeshes &&
         std::find(write.meshFormats.begin(), write.meshFormats.end(), MeshFileFormat::ply) !=
             write.meshFormats.end();
}

}  // namespace

FractureWriter::FractureWriter(const SourceMesh& source, const WriteOptions& write,
                               bool isInUnitBox)
    : source_(source),
      options_(write),
      isInUnitBox_(isInUnitBox),
      table_(materialTable(source.appearance)),
      memory_(write.samplingMemory) {
  const bool hasMeshes = write.mesh || write.scene || write.usd || write.houdini || write.viewer;
  const bool hasFaces =
      hasSourceFaces(write) && !source.mesh.triangles.empty() && !isVolumeName(source.name);
  if ((hasMeshes && !source.mesh.attributes.empty()) || hasFaces) {
    attributes_.emplace(source.mesh, hasFaces);
  }
}

bool FractureWriter::isDouble(bool isExact, const Solid& solid) const {
  return sherd::isDouble(options_, isExact, isInUnitBox_ ? Solid() : solid);  // near the origin
}

std::vector<std::string> FractureWriter::write(const OutputFolder& folder,
                                               const FractureFiles& files,
                                               const FractureOptions& options,
                                               const FractureResult& result,
                                               const Progress* progress) const {
  FractureWriting writing(*this, folder, files, options, result);
  writing.writeAll(progress);
  return writing.finish(progress);
}

void FractureWriting::writeAll(const Progress* progress) {
  reportProgress(progress, "write", 0.0);
  begin(progress);
  for (std::size_t first = 0; first < result_.kept(); first += kFragmentsPerBatch) {
    reportProgress(progress, "write",
                   static_cast<double>(first) / static_cast<double>(result_.kept()));
    write(first, std::min(result_.kept(), first + kFragmentsPerBatch));
  }
}

FractureWriting::FractureWriting(const FractureWriter& writer, const OutputFolder& folder,
                                 const FractureFiles& files, const FractureOptions& options,
                                 const FractureResult& result, const CopiedFiles* kept)
    : writer_(writer),
      folder_(folder),
      files_(files),
      options_(options),
      result_(result),
      kept_(kept == nullptr ? CopiedFiles() : *kept),
      meshes_(folder_, files, writer.source(), writer.materials(), writer.attributes(),
              result.solid, writer.options(), writer.coordinatesWritten()),
      attributes_(hasScenes(files) ? result.kept() : 0),
      previews_(files.preview.empty() ? 0 : result.kept()) {
  if (!files.materials.empty()) (void)kept_.copyMaterials(files.materials, folder_);
}

std::span<const Fragment> FractureWriting::kept() const {
  return std::span(result_.fragments).first(result_.kept());
}

GridMetadata FractureWriting::metadata() const {
  const double meters = writer_.coordinatesWritten().metersPerUnit;
  const double density = writer_.options().density * meters * meters * meters;
  return {writer_.source().name, options_.seed, density, result_.parents};
}

void FractureWriting::begin(const Progress* progress) const {
  const WriteOptions& write = writer_.options();
  if (!files_.labels.empty()) {
    const PlacedVoxels voxels = labeledBox(result_, static_cast<int>(result_.kept()));
    for (std::size_t i = 0; i < files_.labels.size(); ++i) {
      throwIfCancelled(progress);
      writeVoxels(folder_ / files_.labels[i], voxels, write.voxelFormats[i]);
    }
  }
  if (!files_.seeds.empty()) {
    writeSeeds(folder_ / files_.seeds, result_.seeds, result_.solid, write.offset);
  }
  if (!files_.cost.empty()) writeCost(folder_ / files_.cost, result_.solid, result_.labels);
  throwIfCancelled(progress);
  if (!files_.solidVdb.empty()) {
    writeVdbOfSolid(folder_ / files_.solidVdb, result_.solid, metadata(), write.vdbOptions);
  }
  throwIfCancelled(progress);
  if (!files_.solidMesh.empty()) {
    const TriangleMesh whole = intactMesh(result_, options_.surface);
    meshes_.write(whole, meshes_.attributesOf(whole), files_.solidMesh, isDouble());
  }
}

void FractureWriting::writeLevelSet(std::size_t i) const {
  if (files_.vdb.empty() || kept_.copyLevelSet(result_.fragments[i], files_.vdb[i], folder_)) {
    return;
  }
  writeVdb(folder_ / files_.vdb[i], result_.fragments[i], metadata(), writer_.options().vdbOptions);
}

void FractureWriting::writePoints(std::size_t i) const {
  const WriteOptions& write = writer_.options();
  if (files_.points.empty() || write.sharePoints) return;
  bool areKept = true;
  for (const std::string& name : files_.points[i]) {
    areKept = areKept && kept_.copyPoints(result_.fragments[i], name, folder_);
  }
  if (areKept) return;
  writePointsOf(folder_, files_.points[i], result_, i, write.points.count, options_.seed, write,
                writer_.memory());
}

void FractureWriting::writeMeshes(std::size_t i) {
  const WriteOptions& write = writer_.options();
  const Fragment& fragment = result_.fragments[i];
  if (!files_.proxy.empty() && !kept_.copyProxy(fragment, files_.proxy[i], folder_)) {
    const std::string name = std::filesystem::path(files_.proxy[i]).stem().string();
    writeProxy(folder_ / files_.proxy[i], fragment, name, write.proxyGap, isDouble());
  }
  if (!files_.mesh.empty() || !attributes_.empty()) {
    SurfaceAttributes attributes = meshes_.attributesOf(fragment.mesh);
    if (!files_.mesh.empty()) {
      meshes_.write(fragment, attributes, files_.mesh[i], isDouble(), kept_);
    }
    if (!attributes_.empty()) attributes_[i] = std::move(attributes);
  }
  writePoints(i);
  for (std::size_t k = 0; !files_.coarse.empty() && k < files_.coarse[i].size(); ++k) {
    const TriangleMesh& coarse = fragment.coarse[k];
    meshes_.write(coarse, meshes_.attributesOf(coarse), files_.coarse[i][k], isDouble());
  }
  if (!previews_.empty()) previews_[i] = previewFragment(fragment, result_.solid);
}

void FractureWriting::write(std::size_t first, std::size_t end) {
  // Two tasks per fragment, as there may be no more fragments than threads.
  tbb::parallel_for(2 * first, 2 * std::min(end, result_.kept()), [&](std::size_t task) {
    uncancelled([&] { task % 2 == 0 ? writeLevelSet(task / 2) : writeMeshes(task / 2); });
  });
}

std::vector<std::string> FractureWriting::finish(const Progress* progress) const {
  std::vector<std::string> warnings;
  const WriteOptions& write = writer_.options();
  if (!files_.boundaries.empty()) {
    writeBoundaries(folder_ / files_.boundaries, kept(), isDouble());
  }
  if (!files_.allVdb.empty()) {
    writeVdbOfAll(folder_ / files_.allVdb, kept(), result_.labels, metadata(), write.vdbOptions);
  }
  throwIfCancelled(progress);
  if (!files_.graph.empty()) {
    writeGraph(folder_ / files_.graph, kept(), metadata(), result_.labels.splits);
  }
  if (!files_.constraints.empty()) {
    const double meters = writer_.coordinatesWritten().metersPerUnit;
    writeConstraints(folder_ / files_.constraints, kept(), write.jointStrength * meters * meters,
                     result_.labels.splits, progress);
  }
  if (!files_.points.empty() && write.sharePoints) {
    const std::vector<std::size_t> counts =
        sharedCounts(result_, result_.kept(), write.points.count);
    tbb::parallel_for(std::size_t{0}, counts.size(), [&](std::size_t i) {
      throwIfCancelled(progress);
      writePointsOf(folder_, files_.points[i], result_, i, counts[i], options_.seed, write,
                    writer_.memory());
    });
  }
  throwIfCancelled(progress);
  if (!files_.scene.empty() || !files_.usd.empty()) {
    meshes_.writeScenes(kept(), attributes_, result_.labels.splits, files_,
                        result_.solid.frame.voxelSize, progress);
  }
  if (!files_.houdini.empty()) {
    meshes_.writeHoudini(kept(), attributes_, result_.labels.splits, files_.houdini, progress);
  }
  if (!files_.viewer.empty()) {
    warnings = writeViewer(folder_ / files_.viewer, writer_, result_, attributes_,
                           ViewerOptions{}.maxBytes, progress);
  }
  if (!files_.solidSdf.empty()) {
    writeAllDistances(folder_, files_, result_, intactMesh(result_, options_.surface),
                      options_.seed, write.distances, progress);
  }
  throwIfCancelled(progress);
  if (!files_.correspondences.empty()) {
    writeAllCorrespondences(folder_ / files_.correspondences, kept(), write.correspondences,
                            options_.seed);
  }
  std::string rounding = writer_.roundingWarning(result_.solid);
  if (!rounding.empty()) warnings.push_back(std::move(rounding));
  reportProgress(progress, "write", 1.0);
  if (!files_.preview.empty()) {
    writePng(folder_ / files_.preview,
             renderFragments(previews_, {.up = writer_.coordinates().up}, progress));
  }
  return warnings;
}

FractureOptions optionsFor(FractureOptions options, const WriteOptions& write) {
  options.grow.keepCost = write.cost;
  if (options.surface.surface == Surface::automatic && !write.needsMeshes() &&
      write.points.count == 0) {
    options.surface.surface = Surface::smooth;
  }
  options.surface.surface = surfaceOf(options);
  options.solid.keepMesh = options.surface.surface == Surface::exact;
  options.solid.keepSeams = options.surface.surface != Surface::labels;
  options.surface.levelSets = write.needsLevelSets();
  options.surface.meshes = write.needsMeshes() || !canLackMeshes(options.surface);
  options.surface.points = write.points.count > 0;
  return options;
}

void checkWriteOptions(const WriteOptions& write, const FractureOptions& options) {
  checkSurfaceOptions(options.surface);
  const auto wanted = [&](MeshFileFormat format) {
    return std::find(write.meshFormats.begin(), write.meshFormats.end(), format) !=
           write.meshFormats.end();
  };
  if (wanted(MeshFileFormat::stl) && wanted(MeshFileFormat::stlText)) {
    throw Error(ErrorCode::usage, "stl and stl-ascii use the same file names; choose one of them");
  }
  if (write.points.seed != 0 || write.distances.seed != 0) {
    throw Error(ErrorCode::usage,
                "seeds of points and distances are derived from the fracture's; do not set them");
  }
  checkPointOptions(write.points);
  const SurfaceOptions& surface = options.surface;
  const Iterations& smoothed = surface.smooth.boundaryIterations;
  const bool isSmoothed =
      surface.smooth.boundaryWeight > 0.0 && (smoothed.count > 0 || smoothed.perVoxel > 0.0);
  const bool isShared = surface.surface == Surface::labels
                            ? !isSmoothed && surface.adaptivity == 0.0
                            : surface.interface == Interface::shared;
  if (write.correspondences > 0 &&
      (!isShared || hasNoise(surface) || !options.erode.iterations.isZero())) {
    throw Error(ErrorCode::usage,
                "correspondences need surfaces that fragments share: not meshed independently, "
                "not eroded, without noise, and of labels neither smoothed at the cracks nor "
                "simplified");
  }
}

}  // namespace sherd
