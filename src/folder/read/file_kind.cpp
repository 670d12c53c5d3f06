// Detection of a file's kind.
#include <sherd/folder.h>

#include <algorithm>

#include "base/files/file_bytes.h"
#include "base/text/lower_case.h"
#include "formats/arrays/npy_reader.h"
#include "formats/ply/ply_body.h"

namespace sherd {
namespace {

FileKind kindOfPly(const std::filesystem::path& file, MemoryBudget& memory) {
  const MeshFile mesh{file, file.string(), MeshFormat::ply, readFileBytes(file, &memory)};
  const PlyHeader header = readPlyHeader(mesh);
  const bool faces =
      std::any_of(header.elements.begin(), header.elements.end(), [](const PlyElement& element) {
        return element.count > 0 && (element.name == "face" || element.name == "tristrips");
      });
  return faces ? FileKind::mesh : FileKind::points;
}

// Distance samples and correspondences also have positions, but are not surface points.
FileKind kindOfNpz(const std::filesystem::path& file, MemoryBudget& memory) {
  const std::string bytes = readFileBytes(file, &memory);
  const std::vector<ZipEntry> entries = zipEntries(bytes, file.string());
  const auto has = [&](const char* array) { return entryOf(entries, array) != nullptr; };
  if (has("labels")) return FileKind::voxels;
  return has("positions") && !has("sdf") && !has("fragments") ? FileKind::points : FileKind::other;
}

}  // namespace

FileKind kindOf(const std::filesystem::path& file, const ReadOptions& options) {
  MemoryBudget memory(file.string(), options.maxMemory);
  const std::string extension = lowerCase(file.extension().string());
  if (extension == ".ply") return kindOfPly(file, memory);
  if (extension == ".npz") return kindOfNpz(file, memory);
  if (voxelFormatOf(file)) return FileKind::voxels;
  if (pointFormatOf(file)) return FileKind::points;
  return isMeshName(file) ? FileKind::mesh : FileKind::other;
}

}  // namespace sherd
