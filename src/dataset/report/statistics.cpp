// Statistics from journals.
#include "dataset/report/statistics.h"

#include <set>

#include "dataset/journal/object_folder.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/layouts/hdf5_part.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// Without the packing suffix.
fs::path unpackedName(fs::path name) {
  if (name.extension() == ".zip" || name.extension() == ".zst") name.replace_extension();
  return name;
}

// In all layouts point files lie in a folder "points" or end in the count: M_4f_0_1024p.binp.
bool isOfPoints(const fs::path& name) {
  for (const fs::path& part : name.parent_path()) {
    if (part == "points" || part == kPfppPointFolder) return true;
  }
  const std::string stem = name.stem().string();
  const std::size_t digits = stem.find_last_of('_');
  return digits != std::string::npos && digits + 2 < stem.size() && stem.back() == 'p' &&
         stem.find_first_not_of("0123456789", digits + 1) == stem.size() - 1;
}

// The counter of a fragment's file, or null.
FileStatistics* kindOf(DatasetStatistics& statistics, const std::string& name) {
  static const std::set<std::string> kMeshes{".ply", ".obj", ".stl", ".glb", ".binm"};
  const fs::path plain = unpackedName(name);
  if (plain.extension() == ".vdb") return &statistics.voxels;
  if (isOfPoints(plain)) return &statistics.points;
  return kMeshes.contains(plain.extension().string()) ? &statistics.meshes : nullptr;
}

// "ply", "rle.zip"
std::string formatOf(const std::string& name) {
  const fs::path path(name), plain = unpackedName(path);
  if (plain.extension() == kHdf5Part) return "hdf5";
  const std::string format =
      plain.extension().string() + (plain == path ? "" : path.extension().string());
  return format.empty() ? format : format.substr(1);
}

}  // namespace

void DatasetStatistics::add(const Json& line) {
  std::map<std::string, std::uint64_t> bytes;
  for (const FileRecord& file : filesOf(line)) {
    bytes[file.name] = file.bytes;
    byFormat[formatOf(file.name)].add({1, file.bytes});
  }
  for (const Json& name : line.at("labels")) voxels.add({1, bytes[name]});
  const bool isWhole = line.at("fracture") == kWholeName;
  FragmentStatistics* const pieces = isWhole ? nullptr : &byPieces[line.at("pieces")];
  if (pieces) {
    ++pieces->fractures;
    ++fractures;
  }
  for (const Json& fragment : line.at("fragments")) {
    if (fragment.value("withheld", false)) continue;
    for (const Json& name : fragment.at("files")) {
      if (FileStatistics* const kind = kindOf(*this, name)) kind->add({1, bytes[name]});
    }
    if (!pieces) continue;
    ++fragments;
    pieces->faces.push_back(fragment.at("faces"));
    pieces->vertices.push_back(fragment.at("vertices"));
    pieces->share.push_back(fragment.at("share"));
  }
}

}  // namespace sherd
