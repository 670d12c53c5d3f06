// Writes a fracture to a folder.
#include <sherd/error.h>
#include <sherd/folder.h>

#include <algorithm>
#include <utility>

#include "base/files/atomic_file.h"
#include "base/files/unfinished.h"
#include "base/text/printable.h"
#include "folder/files/fracture_files.h"
#include "folder/manifest/file_names.h"
#include "folder/manifest/manifest.h"
#include "folder/manifest/mesh_report.h"
#include "folder/manifest/read_manifest.h"
#include "pipeline/fracture_stages.h"
#include "surface/extract.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// Makes and writes fragments in alternating batches, and frees what is not needed afterwards.
//   result  receives the fragments; their number is final
//   bodies  receives the input's
std::vector<MeshFacts> makeAndWrite(GrownFracture& grown, const FractureOptions& options,
                                    const WriteOptions& write, FractureResult& result,
                                    InputBodies& bodies, FractureWriting& writing,
                                    StageClock& clock, const Progress* progress) {
  const SurfaceOptions& surface = options.surface;
  if (!surface.meshes) {
    measureFragments(grown, result, surface, progress);
    clock.done("extract");
    writing.writeAll(progress);
    clock.done("write");
    return meshFacts(result, bodies);
  }
  Extraction extraction(result.solid, result.labels, grown.extractOptions(surface), progress);
  result.exactFailure = extraction.exactFailure();
  result.smooth = extraction.smooth();
  result.united = extraction.united();
  result.surfaces = extraction.surfaces();
  result.unmerged = extraction.unmerged();
  bodies = inputBodies(result, options);
  clock.done("extract");
  writing.begin(progress);
  clock.done("write");
  std::vector<MeshFacts> facts;
  if (result.surfaces) facts = meshFacts(*result.surfaces);
  const bool sharesPointsOfMeshes =
      write.sharePoints && write.points.count > 0 && !result.surfaces && !result.unmerged;
  std::size_t first = 0;
  for (std::vector<Fragment> some = extraction.next(); !some.empty(); some = extraction.next()) {
    clock.done("extract");
    if (!result.surfaces) {
      for (MeshFacts& own : meshFacts(some, bodies)) facts.push_back(std::move(own));
    }
    const std::size_t end = first + some.size();
    std::move(some.begin(), some.end(),
              result.fragments.begin() + static_cast<std::ptrdiff_t>(first));
    writing.write(first, end);
    for (std::size_t i = first; i < end; ++i) {
      Fragment& fragment = result.fragments[i];
      if (!write.needsAllLevelSets()) fragment.surface = nullptr;
      if (write.needsAllMeshes() || sharesPointsOfMeshes) continue;
      fragment.mesh = {};
    }
    first = end;
    reportProgress(progress, "write",
                   static_cast<double>(end) / static_cast<double>(result.fragments.size()));
    clock.done("write");
  }
  result.surfaces.reset();  // points are written; what is left needs meshes alone
  std::vector<std::vector<Contact>> contacts = extraction.contacts();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    result.fragments[i].contacts = std::move(contacts[i]);
  }
  clock.done("extract");
  return facts;
}

void warnOfCrossings(FractureReplacement& replacement, std::span<const MeshFacts> facts,
                     const WriteOptions& write) {
  std::string warning = crossingsWarning(facts, write);
  if (!warning.empty()) replacement.warn(std::move(warning));
}

void warnOfSmooth(FractureReplacement& replacement, const SourceMesh& source,
                  const FractureResult& result) {
  const std::string text =
      smoothText(source, result.fragments.size(), result.exactFailure, result.smooth);
  if (!text.empty()) replacement.warn(printable(source.name) + ": " + text);
}

void checkInput(const FractureInput& input, const WriteOptions& write) {
  if (input.finished == nullptr && !input.only.empty()) {
    throw Error(ErrorCode::usage, "fragments can be broken again only of a finished fracture");
  }
  if (input.finished != nullptr && input.solid) {
    throw Error(ErrorCode::usage, "either a solid or a finished fracture can be broken, not both");
  }
  if (input.finished != nullptr && write.cost) {
    throw Error(ErrorCode::usage, "a fracture that is broken again has no arrival costs to write",
                OptionNames{"write"});
  }
  if (input.finished != nullptr && write.sourceFaces) {
    throw Error(ErrorCode::usage,
                "a fracture that is broken again does not have the faces of its input",
                OptionNames{"source-faces"});
  }
}

// Returns options with smooth surfaces where exact ones are not asked for and cut no mesh.
FractureOptions chosenFor(const FractureInput& input, FractureOptions options) {
  const bool hasMesh = input.finished != nullptr ? input.finished->isExact : !input.solid;
  if (options.surface.surface == Surface::automatic && !hasMesh) {
    options.surface.surface = Surface::smooth;
  }
  return options;
}

GrownFracture grownFrom(FractureInput& input, const FractureOptions& options, Device& device,
                        const Progress* progress) {
  if (input.finished != nullptr) {
    return regrown(*input.finished, input.only, options, device, progress);
  }
  if (input.solid) return grown(std::move(*input.solid), options, device, progress);
  FractureOptions own = options;
  own.solid.objects = input.source.objectOfTriangle;
  return grown(input.source.mesh, own, device, progress);
}

// Returns the files that stay of a fracture that is broken again.
CopiedFiles copiedFiles(const FractureInput& input, const FractureOptions& options,
                        const WriteOptions& write, const FractureWriter& writer,
                        const FractureResult& result) {
  if (input.finished == nullptr) return {};
  return {*input.finished, result, options, write,
          writer.isDouble(isExact(options, result), result.solid)};
}

}  // namespace

WrittenFolder writeFracture(const fs::path& folder, const SourceMesh& source,
                            const FractureOptions& options, const FractureResult& result,
                            const WriteOptions& write, const Progress* progress) {
  checkWriteOptions(write, options);
  const auto lacksMesh = [](const Fragment& fragment) { return fragment.mesh.vertices.empty(); };
  if (write.needsMeshes() && std::ranges::any_of(result.fragments, lacksMesh)) {
    throw Error(
        ErrorCode::usage,
        "the fracture has no meshes, which these files need; complete its options for them");
  }
  const FractureWriter writer(source, write);
  const FractureFiles files =
      fileNames(source, result.kept(), options.surface.triangles, writer.materials(), write);
  FractureReplacement replacement(folder, files.all());
  replacement.write([&](const fs::path& staged) {
    for (std::string& warning : writer.write(staged, files, options, result, progress)) {
      replacement.warn(std::move(warning));
    }
    const InputBodies bodies = inputBodies(result, options);
    const std::vector<MeshFacts> facts = meshFacts(result, bodies);
    warnOfCrossings(replacement, facts, write);
    warnOfSmooth(replacement, source, result);
    writeWhole(staged / kManifestName,
               manifestText(source, options, result, facts, bodies, files, write));
  });
  const Uncut whole;
  replacement.putInPlace();
  fs::path manifest = replacement.keep();
  return {std::move(manifest), replacement.warnings()};
}

StagedFracture stageFracture(const fs::path& folder, FractureInput input,
                             const FractureOptions& asked, Device& device,
                             const WriteOptions& write, const Progress* progress) {
  checkInput(input, write);
  const FractureOptions options = optionsFor(chosenFor(input, asked), write);
  checkWriteOptions(write, options);
  checkFractureFolder(folder);
  const SourceMesh& source = input.source;
  GrownFracture grown = grownFrom(input, options, device, progress);
  const FractureWriter writer(source, write);
  StageClock clock(std::move(grown.result.times));
  if (options.surface.meshes) settle(grown, options.surface, progress);
  clock.done("extract");
  FractureResult result = std::move(grown.result);
  result.fragments.resize(static_cast<std::size_t>(result.labels.fragmentCount));
  const FractureFiles files =
      fileNames(source, result.kept(), options.surface.triangles, writer.materials(), write);
  FractureReplacement replacement(folder, files.all());
  replacement.write([&](const fs::path& staged) {
    const CopiedFiles kept = copiedFiles(input, options, write, writer, result);
    FractureWriting writing(writer, staged, files, options, result, &kept);
    InputBodies bodies;
    const std::vector<MeshFacts> facts =
        makeAndWrite(grown, options, write, result, bodies, writing, clock, progress);
    for (std::string& warning : writing.finish(progress)) replacement.warn(std::move(warning));
    warnOfCrossings(replacement, facts, write);
    warnOfSmooth(replacement, source, result);
    writeWhole(staged / kManifestName,
               manifestText(source, options, result, facts, bodies, files, write));
  });
  clock.done("write");
  result.times = clock.times();
  return {std::move(result), std::move(replacement)};
}

WrittenFracture fractureInto(const fs::path& folder, FractureInput input,
                             const FractureOptions& options, Device& device,
                             const WriteOptions& write, const Progress* progress) {
  StagedFracture staged = stageFracture(folder, std::move(input), options, device, write, progress);
  const Uncut whole;
  staged.replacement.putInPlace();
  fs::path manifest = staged.replacement.keep();
  return {std::move(staged.result), {std::move(manifest), staged.replacement.warnings()}};
}

}  // namespace sherd
