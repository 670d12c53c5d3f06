// Files of fragments that stay when other fragments of a fracture are broken again.
#include "folder/files/copied_files.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "base/files/file_bytes.h"
#include "folder/manifest/read_manifest.h"
#include "formats/mesh/piece_mesh.h"
#include "formats/ply/ply_neighbors.h"

namespace sherd {
namespace {

bool areEqual(const VdbOptions& a, const VdbOptions& b) {
  return a.half == b.half && a.compression == b.compression && a.fog == b.fog;
}

bool haveSamePoints(const WriteOptions& a, const WriteOptions& b) {
  return a.points.count == b.points.count && a.points.sampler == b.points.sampler &&
         a.points.rule == b.points.rule && !a.sharePoints && !b.sharePoints;
}

// Formats with one ending.
bool haveSameStl(const WriteOptions& a, const WriteOptions& b) {
  const auto isText = [](const WriteOptions& write) {
    return std::find(write.meshFormats.begin(), write.meshFormats.end(), MeshFileFormat::stlText) !=
           write.meshFormats.end();
  };
  return isText(a) == isText(b);
}

}  // namespace

CopiedFiles::CopiedFiles(const FinishedFracture& finished, const FractureResult& result,
                         const FractureOptions& options, const WriteOptions& write, bool isDouble)
    : manifest_(finished.manifest),
      stays_(static_cast<std::size_t>(finished.labels.fragmentCount) + 1, true),
      isBeside_(stays_.size(), false),
      arePlain_(write.plainMeshes) {
  if (manifest_.empty()) return;
  const Manifest manifest = readManifest(manifest_);
  const RunOptions earlier = inheritedOptions(manifest_);
  const WriteOptions& old = earlier.write;
  listed_.insert(manifest.files.begin(), manifest.files.end());
  for (const int id : result.broken) stays_[static_cast<std::size_t>(id)] = false;
  for (std::size_t id = 1; id < finished.firstFace.size(); ++id) {
    for (std::size_t t = finished.firstFace[id - 1]; t < finished.firstFace[id]; ++t) {
      const std::uint16_t neighbor = finished.faces.neighbor[t];
      if (neighbor < stays_.size() && !stays_[neighbor]) isBeside_[id] = true;
    }
  }
  const CoordinateSystem was = manifest.coordinates, now = coordinatesOf(was, write);
  const bool isSameUnit = was.metersPerUnit == now.metersPerUnit;
  levelSets_ =
      areEqual(old.vdbOptions, write.vdbOptions) && old.density == write.density && isSameUnit;
  meshes_ = isSameUnit && was.up == now.up && old.plainMeshes == write.plainMeshes &&
            haveSameStl(old, write) && (old.precision == Precision::full) == isDouble &&
            !write.sourceFaces && earlier.fracture.surface.triangles == options.surface.triangles;
  points_ = haveSamePoints(old, write);
  proxies_ = meshes_ && old.proxyGap == write.proxyGap;
}

bool CopiedFiles::isSame(const Fragment& fragment, bool areSame, const std::string& name) const {
  const auto id = static_cast<std::size_t>(fragment.id);
  return areSame && id < stays_.size() && stays_[id] && listed_.contains(name);
}

void CopiedFiles::copy(const std::string& name, const OutputFolder& to) const {
  (to / name).write(readFileBytes(listedFile(manifest_, name)));
}

bool CopiedFiles::copyLevelSet(const Fragment& fragment, const std::string& name,
                               const OutputFolder& to) const {
  if (!isSame(fragment, levelSets_, name)) return false;
  copy(name, to);
  return true;
}

bool CopiedFiles::copyMesh(const Fragment& fragment, const std::string& name,
                           const OutputFolder& to) const {
  // Other surfaces than exact ones are made again, of all fragments together.
  if (fragment.meshedAs != Surface::exact || !isSame(fragment, meshes_, name)) return false;
  const bool hasNewNeighbors = !arePlain_ && isBeside_[static_cast<std::size_t>(fragment.id)];
  if (hasNewNeighbors && name.ends_with(".glb")) return false;
  if (!hasNewNeighbors || !name.ends_with(".ply")) {
    copy(name, to);
    return true;
  }
  const TriangleMesh& mesh = fragment.mesh;
  const std::optional<std::string> ply = withNeighbors(readFileBytes(listedFile(manifest_, name)),
                                                       vertexNeighbor(mesh), mesh.neighbor);
  if (ply) (to / name).write(*ply);
  return ply.has_value();
}

bool CopiedFiles::copyPoints(const Fragment& fragment, const std::string& name,
                             const OutputFolder& to) const {
  if (fragment.meshedAs != Surface::exact || !isSame(fragment, points_, name)) return false;
  if (isBeside_[static_cast<std::size_t>(fragment.id)]) return false;  // points have neighbors
  copy(name, to);
  return true;
}

bool CopiedFiles::copyProxy(const Fragment& fragment, const std::string& name,
                            const OutputFolder& to) const {
  if (fragment.meshedAs != Surface::exact || !isSame(fragment, proxies_, name)) return false;
  copy(name, to);
  return true;
}

bool CopiedFiles::copyMaterials(const std::string& name, const OutputFolder& to) const {
  if (!meshes_ || !listed_.contains(name)) return false;
  copy(name, to);
  return true;
}

}  // namespace sherd
