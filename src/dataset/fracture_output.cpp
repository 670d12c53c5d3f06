// Stores the fractures of one object in a dataset's layout, and records them in its journal.
#include "dataset/fracture_output.h"

#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/folder.h>

#include <chrono>
#include <optional>
#include <utility>

#include "base/little_endian.h"
#include "dataset/journal/object_folder.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/layouts/hdf5_part.h"
#include "dataset/layouts/pfpp.h"
#include "dataset/layouts/split_of.h"
#include "dataset/report/thumbnails.h"
#include "folder/files/fracture_files.h"
#include "folder/files/viewer_file.h"
#include "folder/manifest/input_bodies.h"
#include "folder/manifest/mesh_report.h"
#include "folder/manifest/rounding.h"
#include "formats/arrays/npz.h"

namespace sherd {
namespace {

using Clock = std::chrono::steady_clock;

double elapsedSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Makes files.  What a format can't hold, such as a .vox of too many voxels, is the object's
// error, and no output's that would end the run.
template <class Make>
void making(const StagedFiles& files, const Make& make) try {
  make();
} catch (const Error& e) {
  if (e.code() != ErrorCode::output || files.isDiskAtFault()) throw;
  throw Error(ErrorCode::input, e.what(), e.options());
}

// Writes the neighbor of each face, in folders that no loader reads as fragments.
void writeNeighbors(const FractureResult& result, const FractureOptions& options,
                    const std::string& fracture, StagedFiles& files) {
  const auto write = [&](const TriangleMesh& mesh, const std::string& folder, std::size_t i) {
    NpyArray array{"", "<u2", {mesh.triangles.size()}, {}};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      storeLittle(array.bytes, mesh.neighborOf(t));
    }
    OutputFile(files, "neighbor/" + folder + fracture + "/piece_" + std::to_string(i) + ".npy")
        .write(npyHeader(array) + array.bytes);
  };
  for (std::size_t i = 0; i < result.kept(); ++i) {
    const Fragment& fragment = result.fragments[i];
    write(fragment.mesh, "", i);
    for (std::size_t k = 0; k < fragment.coarse.size(); ++k) {
      const std::string most = std::to_string(options.surface.triangles[k]);
      write(fragment.coarse[k], "decimated_" + most + "/", i);
    }
  }
}

}  // namespace

FractureOutput::FractureOutput(OutputOf of, Journal& journal, const DatasetRun& run,
                               const DatasetOptions& options, ObjectStore& store,
                               const Progress& progress)
    : of_(of),
      journal_(journal),
      run_(run),
      options_(options),
      store_(store),
      progress_(progress),
      writer_(of.source, options.each.write, options.layout == DatasetLayout::bb) {}

NamedObject FractureOutput::named(const FractureOptions& options) const {
  return {of_.object,     splitOf(of_.object, options_.split),
          of_.source,     writer_.materials(),
          options,        options_.each.write,
          of_.longestSide};
}

bool FractureOutput::isInWorld() const { return hasWorldPositions(options_.layout); }

// Returns the frame of the files, if poses are asked for.
std::optional<UnitBox> FractureOutput::frameOfPoses() const {
  if (!options_.poses) return std::nullopt;
  return isInWorld() ? UnitBox{} : of_.unitBox;
}

void FractureOutput::writeWhole(FractureResult whole, const FractureOptions& options) {
  renderThumbnail(kWholeName, whole);
  // Inside the solid, but in no fragment.
  for (std::size_t word = 0; word < whole.solid.blocks->inside.size(); ++word) {
    for (std::size_t bit = 0; bit < 64; ++bit) {
      if ((whole.solid.blocks->inside[word] >> bit) & 1)
        whole.labels.fragment[word * 64 + bit] = Labels::kEroded;
    }
  }
  keepDecimated(whole);
  const NamedFiles names = wholeNames(options_.layout, named(options));
  const std::shared_ptr<StagedFiles> files = store_.stage(names.prefix);
  const bool isUnit =
      options_.layout == DatasetLayout::bb || options_.layout == DatasetLayout::hdf5;
  if (isUnit) intoUnitBox(whole);
  making(*files, [&] {
    if (options_.layout == DatasetLayout::hdf5) {
      writeHdf5Part(OutputFile(*files, names.files.mesh[0][0]), hdf5WholeArrays(whole));
    } else if (options_.layout != DatasetLayout::pfpp) {
      writer_.write(*files, names.files, options, whole, &progress_);
    }
  });
  FractureLine line(kWholeName, {0, 0}, options.seed, 0, {});
  if (isInWorld()) line.setOffset(options_.each.write.offset);
  line.addFragments(whole, names.files, *files, frameOfPoses());
  keep(files, line.json());
}

MadeFracture FractureOutput::made(FractureResult result, const FractureOptions& options,
                                  const FractureOrigin& origin) {
  const Clock::time_point begin = Clock::now();
  MadeFracture made;
  made.surfaceWarning =
      smoothText(of_.source, result.fragments.size(), result.exactFailure, result.smooth);
  if (made.surfaceWarning.empty()) made.surfaceWarning = unitedText(result.united);
  made.aloneWarning = aloneText(result.alone);
  keepDecimated(result);
  const NamedFiles names =
      fractureNames(options_.layout, named(options), origin.planned, origin.number, result.kept());
  made.files = store_.stage(names.prefix);
  FractureLine line(origin.planned.name(), origin.planned, options.seed, origin.attempt,
                    origin.drawn);
  if (isInWorld()) line.setOffset(options_.each.write.offset);
  if (!origin.objects.is_null()) line.setObjects(origin.objects);
  line.addFragments(result, names.files, *made.files, frameOfPoses());
  making(*made.files,
         [&] { writeFiles(*made.files, names.files, options, origin.number, result); });
  record(made, result, options, names, origin.objects);
  made.fragments = result.kept();
  made.line = line.json();
  run_.times.add("write", elapsedSince(begin) - made.files->packing());
  return made;
}

// Writes the manifest, if the layout has one, and finds triangles that cross each other in files
// of single precision.
void FractureOutput::record(MadeFracture& made, const FractureResult& result,
                            const FractureOptions& options, const NamedFiles& names,
                            const Json& objects) const {
  const WriteOptions& write = options_.each.write;
  const bool mayCross = isInWorld() && isExact(options, result) && writesFloats(write);
  if (names.manifest.empty() && !mayCross) return;
  const InputBodies bodies = inputBodies(result, options);
  const std::vector<MeshFacts> facts = meshFacts(result, bodies);
  if (mayCross) made.crossingsWarning = crossingsWarning(facts, write);
  if (names.manifest.empty()) return;
  OutputFile(*made.files, names.manifest)
      .write(manifestText(of_.source, options, result, facts, bodies, names.files, write,
                          objects.is_null() ? nullptr : &objects));
}

// An HDF5 file has one mesh of each fragment: the decimated one, if there is one.
void FractureOutput::keepDecimated(FractureResult& result) const {
  if (options_.layout != DatasetLayout::hdf5) return;
  for (Fragment& fragment : result.fragments) {
    if (!fragment.coarse.empty()) fragment.mesh = std::move(fragment.coarse.front());
  }
}

// Writes a fracture as its layout has it.
void FractureOutput::writeFiles(StagedFiles& files, const FractureFiles& names,
                                const FractureOptions& options, std::size_t number,
                                FractureResult& result) const {
  const std::string name = "fractured_" + std::to_string(number);
  switch (options_.layout) {
    case DatasetLayout::hdf5:
      intoUnitBox(result);
      writeHdf5Part(OutputFile(files, names.mesh[0][0]), hdf5Arrays(result, options_.removal));
      return;
    case DatasetLayout::pfpp: {
      const auto [center, scale] = of_.unitBox;
      const PfppFracture fracture{pfppId(of_.object, number),
                                  objectFolder(DatasetLayout::bb, of_.object) + "/" + name,
                                  options.seed,
                                  options_.each.write.points,
                                  center,
                                  scale};
      return writePfpp(files, {names.points[0][0], names.correspondences}, fracture, result);
    }
    case DatasetLayout::bb:
      intoUnitBox(result);
      writer_.write(files, names, options, result, &progress_);
      if (options_.each.write.mesh) writeNeighbors(result, options, name, files);
      return;
    default:
      for (const std::string& warning : writer_.write(files, names, options, result, &progress_)) {
        warnOnce(of_.object.key + ": " + warning);
      }
  }
}

// Fractures of an object are written in parallel, and mostly have the same warnings.
void FractureOutput::warnOnce(const std::string& warning) const {
  const std::lock_guard lock(warnedMutex_);
  if (warned_.insert(warning).second) run_.warning(warning);
}

void FractureOutput::renderThumbnail(const std::string& name, const FractureResult& result) const {
  if (!run_.thumbnails.contains(name)) return;
  const Clock::time_point begin = Clock::now();
  writeThumbnail(run_.out / thumbnailName(of_.object, name),
                 std::span(result.fragments).first(result.kept()), writer_.coordinates().up);
  if (options_.viewers && name != kWholeName) writePage(name, result);
  run_.times.add("picture", elapsedSince(begin));
}

void FractureOutput::writePage(const std::string& name, const FractureResult& result) const {
  std::vector<SurfaceAttributes> attributes;
  for (std::size_t i = 0; writer_.attributes() != nullptr && i < result.kept(); ++i) {
    attributes.push_back(
        writer_.attributes()->transferTo(result.fragments[i].mesh, writer_.materials().inside()));
  }
  writeViewer(run_.out / viewerName(of_.object, name), writer_, result, attributes, kMaxViewerBytes,
              &progress_);
}

void FractureOutput::keep(std::shared_ptr<StagedFiles> files, Json line) {
  store_.keep(std::move(files), [this, line = std::move(line)](KeptFiles kept) mutable {
    line["files"] = jsonOf(kept.files);
    run_.times.add("store", kept.seconds);
    line["archive"] = kept.archiveBytes;
    journal_.add(line);
  });
}

// Points are of the meshes then, which have moved.
void FractureOutput::intoUnitBox(FractureResult& result) const {
  result.surfaces.reset();
  result.unmerged.reset();
  const auto move = [&](TriangleMesh& mesh) {
    for (glm::dvec3& v : mesh.vertices) v = of_.unitBox.of(v);
  };
  for (Fragment& fragment : result.fragments) {
    move(fragment.mesh);
    for (TriangleMesh& coarse : fragment.coarse) move(coarse);
  }
}

FractureResult wholeResult(const PreparedSolid& ready, const FractureOptions& each,
                           const Progress* progress) {
  const Solid& solid = ready.solid;
  FractureOptions options = each;
  options.surface.meshes = true;
  FractureResult whole;
  whole.solid = solid;
  whole.components = ready.components.count();
  whole.labels.blocks = solid.blocks;
  whole.labels.fragmentCount = 1;
  whole.labels.fragment.assign(solid.blocks->count() * 512, 0);
  for (std::size_t voxel = 0; voxel < whole.labels.fragment.size(); ++voxel) {
    const std::uint64_t mask =
        solid.blocks->inside[voxel / 64] | solid.blocks->exteriorBand[voxel / 64];
    if ((mask >> (voxel % 64)) & 1) whole.labels.fragment[voxel] = 1;
  }
  whole.fragments = extractFragments(
      solid, whole.labels, {.surface = options.surface, .intact = ready.surface}, progress);
  whole.eroded = {0, 0};
  return whole;
}

}  // namespace sherd
