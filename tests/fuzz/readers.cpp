// Readers as fuzzing calls them.
#include "fuzz/readers.h"

#include <sherd/error.h>
#include <sherd/folder.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/geometric.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "base/files/below_folder.h"
#include "base/files/parsed_json.h"
#include "cli/arguments/config_file.h"
#include "dataset/journal/journal.h"
#include "dataset/journal/plan.h"
#include "dataset/layouts/hdf5_part.h"
#include "dataset/report/statistics.h"
#include "folder/manifest/read_manifest.h"
#include "folder/read/seed_file.h"
#include "formats/mesh_files/model_3mf.h"
#include "formats/mesh_files/read_mesh.h"
#include "formats/obj/mtl.h"
#include "fuzz/draco_files.h"

namespace sherd::fuzz {
namespace {

namespace fs = std::filesystem;

// Whether an array has one entry for each triangle, or none.
template <class Entries>
bool fits(const Entries& entries, const SourceMesh& source) {
  return entries.empty() || entries.size() == source.mesh.triangles.size();
}

void checkLook(const SourceMesh& source) {
  const Appearance& look = source.appearance;
  const SurfaceAttributes& attributes = source.mesh.attributes;
  check(fits(attributes.texcoords, source) && fits(attributes.colors, source) &&
        fits(attributes.material, source) && fits(attributes.normals, source) &&
        fits(source.mesh.neighbor, source));
  for (const auto& corners : attributes.normals) {
    for (const glm::vec3& n : corners) check(std::abs(glm::dot(n, n) - 1.0f) < 1e-4f);
  }
  for (const auto& corners : attributes.texcoords) {
    for (const glm::vec2& at : corners) check(std::isfinite(at.x) && std::isfinite(at.y));
  }
  for (const std::uint32_t material : attributes.material) {
    check(material < look.materials.size());
  }
  for (const Material& material : look.materials) {
    check(material.texture < static_cast<int>(look.textures.size()));
  }
}

void checkMesh(const TriangleMesh& mesh) {
  check(!mesh.triangles.empty());
  for (const glm::dvec3& v : mesh.vertices) {
    check(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
  }
  for (const glm::uvec3& t : mesh.triangles) {
    check(std::max({t.x, t.y, t.z}) < mesh.vertices.size());
  }
}

}  // namespace

void check(bool holds) {
  if (!holds) std::abort();
}

void readMeshNamed(const char* name, std::string_view bytes) {
  // In no folder that is there: what the mesh names beside it is not found.
  const SourceMesh source = meshFromBytes(fs::path("/absent") / name, std::string(bytes));
  checkLook(source);
  checkMesh(source.mesh);
}

void readGuideNamed(const char* name, std::string_view bytes) {
  const Guide guide = guideFromBytes(fs::path("/absent") / name, std::string(bytes));
  check(!guide.polylines.empty() || !guide.mesh.triangles.empty());
  if (!guide.mesh.triangles.empty()) checkMesh(guide.mesh);
  for (const std::vector<glm::dvec3>& line : guide.polylines) {
    check(line.size() > 1);
    for (const glm::dvec3& v : line) {
      check(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
    }
  }
}

// Each form is read or refused on its own.
void readDraco(std::string_view bytes) {
  for (const DracoPositions positions : {DracoPositions::packed, DracoPositions::plain}) {
    try {
      readMeshNamed("a.glb", wrappedDraco(bytes, positions));
    } catch (const Error& e) {
      check(e.code() == ErrorCode::input);
    }
  }
}

void checkVoxels(const RunLengthVoxels& voxels) {
  std::uint64_t sum = 0;
  for (const Run& run : voxels.runs) sum += run.length;
  check(sum == static_cast<std::uint64_t>(voxels.dims.x()) *
                   static_cast<std::uint64_t>(voxels.dims.y()) *
                   static_cast<std::uint64_t>(voxels.dims.z()));
}

void checkPoints(const SurfacePoints& points) {
  check(points.normals.empty() || points.normals.size() == points.positions.size());
  check(points.neighbor.empty() || points.neighbor.size() == points.positions.size());
}

void readMtl(std::string_view bytes) {
  std::map<std::string, MtlMaterial> materials;
  addMtl(bytes, materials);
}

void readModelOf3mf(std::string_view xml) {
  const MeshFile file{"a.3mf", "a.3mf", MeshFormat::threeMf, {}};
  for (const auto& [id, object] : parsed3mf(file, "a.model", xml).objects) {
    check(object.properties.size() <= object.triangles.size());
    for (const glm::uvec3& t : object.triangles)
      check(std::max({t.x, t.y, t.z}) < object.vertices.size());
  }
}

void readManifestOf(std::string_view bytes) {
  const Manifest manifest = manifestOf(parsedJson(bytes));
  check(!manifest.fragments.empty() && manifest.voxelSize > 0.0);
  for (const std::string& file : manifest.files) check(isBelowFolder(file));
}

// And what the index and the report make of it.  Lines get their checksums here, which no fuzzer
// finds; without, a line is refused.
void readJournalOf(std::string_view bytes) {
  std::string sealed, sum;
  while (bytes.find('\n') != bytes.npos) {
    const std::string_view line = bytes.substr(0, bytes.find('\n'));
    sealed += line.empty() ? "\n" : sealedLine(std::string(line), sum);
    bytes.remove_prefix(line.size() + 1);
  }
  sealed += bytes;
  const JournalText journal = parsedJournal(sealed, "a.jsonl");
  check(journal.bytes <= sealed.size());
  DatasetStatistics figures;
  for (const Json& line : journal.fractures) {
    figures.add(line);
    for (const FileRecord& file : filesOf(line)) check(isBelowFolder(file.name));
  }
}

void readPlanOf(std::string_view bytes) {
  const DatasetPlan plan = parsedPlan(bytes);
  for (const int share : plan.split) check(share >= 0);
  for (const LibraryObject& object : plan.objects) check(isBelowFolder(object.folder));
}

void readHdf5PartOf(std::string_view bytes) {
  std::size_t packed = 0;
  for (const auto& [path, array] : parsedHdf5Part(bytes)) {
    check(isBelowFolder(path) && !array.shape.empty() && array.shape.size() <= kMostHdf5Axes);
    packed += array.packed.size();
  }
  check(packed < bytes.size());
}

void readConfig(const char* name, std::string_view bytes) {
  std::set<std::string> names;
  for (const cli::ConfiguredOption& option : cli::parsedOptions(std::string(bytes), name)) {
    check(names.insert(option.name).second);
    check(option.flag.has_value() == option.values.empty());
    for (const std::string& value : option.values) check(!value.empty());
  }
}

void readSeedFile(std::string_view bytes) {
  for (const SeedPoint& point : seedPoints(parsedJson(bytes))) {
    check(point.fragment >= 1 && point.fragment <= kMaxFragments);
  }
}

}  // namespace sherd::fuzz
