// The files that targets begin with.
#include <sherd/device.h>
#include <sherd/folder.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "fuzz/readers.h"
#include "fuzz/targets.h"
#include "shapes.h"

namespace sherd::fuzz {
namespace {

namespace fs = std::filesystem;

std::string bytesOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

std::vector<std::vector<std::string>> startingFiles() {
  std::string folder = (fs::temp_directory_path() / "sherd-fuzz-XXXXXX").string();
  check(mkdtemp(folder.data()) != nullptr);
  SourceMesh cube;
  cube.name = "cube.obj";
  cube.stem = "cube";
  cube.mesh = shapes::cube(1.0);
  cube.appearance.materials = {{"a", {0.5f, 0.25f, 1.0f}, -1}};
  cube.mesh.attributes.material.assign(cube.mesh.triangles.size(), 0);
  FractureOptions options;
  options.pieces = 2;
  options.solid.resolution = 8;
  Device device;
  using F = MeshFileFormat;
  using V = VoxelFormat;
  using P = PointFormat;
  writeFracture(folder, cube, options, fracture(cube.mesh, options, device),
                {.preview = false,
                 .seeds = true,
                 .solid = true,
                 .scene = true,
                 .voxelFormats = {V::rle, V::npy, V::npz, V::vox, V::qstack, V::bing},
                 .meshFormats = {F::ply, F::obj, F::glb, F::stl, F::binm},
                 .points = {.count = 20},
                 .pointFormats = {P::ply, P::xyz, P::binp}});
  std::vector<std::vector<std::string>> files;
  for (const Target& target : targets()) {
    files.push_back(target.handmade);
    if (*target.written == '\0') continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file() || !entry.path().string().ends_with(target.written)) continue;
      files.back().push_back(bytesOf(entry.path()));
    }
  }
  fs::remove_all(folder);
  // Files that once went wrong, in a folder for each target.
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(SHERD_REGRESS_DIR)) {
    const std::string name = entry.path().parent_path().filename().string();
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (name == targets()[i].name) files[i].push_back(bytesOf(entry.path()));
    }
  }
  return files;
}

void writeCorpus(const fs::path& folder) {
  const auto files = startingFiles();
  for (std::size_t i = 0; i < files.size(); ++i) {
    const fs::path own = folder / targets()[i].name;
    fs::create_directories(own);
    for (std::size_t k = 0; k < files[i].size(); ++k) {
      std::ofstream(own / std::to_string(k), std::ios::binary) << files[i][k];
    }
  }
}

}  // namespace sherd::fuzz
