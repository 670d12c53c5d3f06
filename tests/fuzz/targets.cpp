// The readers that are fuzzed, a line each.
#include "fuzz/targets.h"

#include <sherd/error.h>
#include <sherd/files.h>

#include "formats/points/parse_points.h"
#include "formats/voxels/parse_voxels.h"
#include "fuzz/draco_files.h"
#include "fuzz/handmade.h"
#include "fuzz/readers.h"
#include "fuzz/vdb_files.h"

namespace sherd::fuzz {
namespace {

// clang-format off
const std::vector<Target> kTargets{
    {"ply", [](std::string_view bytes) { readMeshNamed("a.ply", bytes); }, ".ply", handmade::ply()},
    {"stl", [](std::string_view bytes) { readMeshNamed("a.stl", bytes); }, ".stl", handmade::stl()},
    {"obj", [](std::string_view bytes) { readMeshNamed("a.obj", bytes); }, ".obj", handmade::obj()},
    {"guide_obj", [](std::string_view bytes) { readGuideNamed("a.obj", bytes); }, "", handmade::guideObj()},
    {"guide_ply", [](std::string_view bytes) { readGuideNamed("a.ply", bytes); }, "", handmade::guidePly()},
    {"off", [](std::string_view bytes) { readMeshNamed("a.off", bytes); }, "", handmade::off()},
    {"gltf", [](std::string_view bytes) { readMeshNamed("a.gltf", bytes); }, "", handmade::gltf()},
    {"glb", [](std::string_view bytes) { readMeshNamed("a.glb", bytes); }, ".glb", dracoGlbs()},
    {"draco", readDraco, "", dracoStreams()},
    {"gz", [](std::string_view bytes) { readMeshNamed("a.obj.gz", bytes); }, "", handmade::gz()},
    {"mtl", readMtl, ".mtl", handmade::mtl()},
    {"model_3mf", readModelOf3mf, "", handmade::model3mf()},
    {"binm", [](std::string_view bytes) { readMeshNamed("a.binm", bytes); }, ".binm", {}},
    {"rle", [](std::string_view bytes) { checkVoxels(parseRle(bytes, "a.rle")); }, ".rle", {}},
    {"npy", [](std::string_view bytes) { checkVoxels(parseNpyLabels(bytes, "a.npy")); }, ".npy", {}},
    {"npz", [](std::string_view bytes) { checkVoxels(parseNpzLabels(bytes, "a.npz").voxels); }, "labels.npz", {}},
    {"vox", [](std::string_view bytes) { checkVoxels(parseMagicaVoxel(bytes, "a.vox")); }, ".vox", {}},
    {"qstack", [](std::string_view bytes) { checkVoxels(parseQuadStack(bytes, "a.qstack")); }, ".qstack", {}},
    {"bing", [](std::string_view bytes) { checkVoxels(parseBing(bytes, "a.bing")); }, ".bing", {}},
    {"vdb", readVdb, ".vdb", vdbFiles()},
    {"points", [](std::string_view bytes) { checkPoints(parsePlyPoints(bytes, "a.ply")); }, "_001.ply", {}},
    {"xyz", [](std::string_view bytes) { checkPoints(parseXyz(bytes, "a.xyz")); }, ".xyz", {}},
    {"binp", [](std::string_view bytes) { checkPoints(parseBinp(bytes, "a.binp")); }, ".binp", {}},
    {"manifest", readManifestOf, "manifest.json", {}},
    {"seeds", readSeedFile, "seeds.json", {}},
    {"journal", readJournalOf, "", handmade::journal()},
    {"dataset", readPlanOf, "", handmade::dataset()},
    {"hdf5_part", readHdf5PartOf, "", handmade::hdf5Part()},
    {"toml", [](std::string_view bytes) { readConfig("a.toml", bytes); }, "", handmade::toml()},
    {"json", [](std::string_view bytes) { readConfig("a.json", bytes); }, "", handmade::json()},
};
// clang-format on

}  // namespace

std::span<const Target> targets() { return kTargets; }

void readOrRefuse(const Target& target, std::string_view bytes) {
  try {
    target.read(bytes);
  } catch (const Error& e) {
    check(e.code() == ErrorCode::input && e.what()[0] != '\0');
  }
}

}  // namespace sherd::fuzz
