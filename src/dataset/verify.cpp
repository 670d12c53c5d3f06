// Verifies a finished dataset.
#include <sherd/dataset.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <tbb/parallel_for.h>
#include <zstd.h>

#include <map>
#include <mutex>
#include <optional>

#include "base/cancel_flag.h"
#include "base/files/below_folder.h"
#include "base/files/file_bytes.h"
#include "base/files/sha256.h"
#include "base/input_error.h"
#include "dataset/index.h"
#include "dataset/journal/journal.h"
#include "dataset/journal/object_folder.h"
#include "dataset/journal/own_sums.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/layouts/hdf5_verify.h"
#include "formats/arrays/zip_reader.h"
#include "formats/mesh_files/read_mesh.h"
#include "formats/voxels/parse_voxels.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void differs(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::input, name + ": " + what);
}

/// Reads the files of an object, loose or from its archive.
class StoredFiles {
 public:
  ///   archive  of the object, as recorded; null for loose files
  StoredFiles(const fs::path& out, const FileRecord* archive) : out_(out) {
    if (archive == nullptr) return;
    bytes_ = read(archive->name);
    if (bytes_.size() != archive->bytes || sha256(bytes_) != archive->sha256)
      differs(archive->name, "differs from what was written");
    for (ZipEntry& entry : zipEntries(bytes_, archive->name)) entries_.emplace(entry.name, entry);
    isArchive_ = true;
  }

  /// Returns the stored bytes; of an archive's entry, the unpacked ones.
  [[nodiscard]] std::string bytes(const std::string& name) const {
    if (!isArchive_) return read(name);
    const auto found = entries_.find(name);
    if (found == entries_.end()) {
      throw Error(ErrorCode::input, name + ": is missing from the archive");
    }
    return unpacked(found->second, name);
  }

  static std::string unpacked(const ZipEntry& entry, const std::string& name) {
    std::string all;
    unpack(entry, name, [&](std::string_view more) { all += more; });
    return all;
  }

 private:
  [[nodiscard]] std::string read(const std::string& name) const {
    if (!isOwnFile(out_, name))
      inputError(out_ / name, "is absent, or a symbolic link leads there");
    return readFileBytes(out_ / name);
  }

  fs::path out_;
  bool isArchive_ = false;
  std::string bytes_;
  std::map<std::string, ZipEntry> entries_;
};

// Unpacks .zip and .zst; returns other bytes unchanged.
std::string contentOf(const std::string& name, std::string bytes) {
  if (name.ends_with(".zip")) {
    const std::vector<ZipEntry> entries = zipEntries(bytes, name);
    if (entries.size() != 1)
      throw Error(ErrorCode::input,
                  name + ": contains " + std::to_string(entries.size()) + " files, expected 1");
    return StoredFiles::unpacked(entries.front(), name);
  }
  if (name.ends_with(".zst")) {
    const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
    if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN) {
      throw Error(ErrorCode::input, name + ": is not a zstd file of known size");
    }
    std::string out(size, '\0');
    const std::size_t made = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
    if (ZSTD_isError(made) != 0 || made != size) {
      throw Error(ErrorCode::input, name + ": is damaged");
    }
    return out;
  }
  return bytes;
}

fs::path withoutPacking(const std::string& name) {
  fs::path path(name);
  if (path.extension() == ".zip" || path.extension() == ".zst") path.replace_extension();
  return path;
}

// Compares voxel counts by label with the journal.
void checkLabels(const std::string& name, const std::string& bytes, const Json& line) {
  if (withoutPacking(name).extension() != ".rle") return;
  std::map<std::uint16_t, std::uint64_t> counts;
  for (const Run& run : parseRle(bytes, name).runs) counts[run.label] += run.length;
  const bool isWhole = line.at("fracture") == kWholeName;
  for (const Json& fragment : line.at("fragments")) {
    if (fragment.value("withheld", false)) continue;
    const auto label = static_cast<std::uint16_t>(isWhole ? 1 : fragment.at("id").get<int>() + 1);
    if (counts[label] == fragment.at("voxels").get<std::uint64_t>()) continue;
    differs(name, "fragment " + fragment.at("id").dump() + " has " + std::to_string(counts[label]) +
                      " voxels, not " + fragment.at("voxels").dump());
  }
}

// Compares the face count of a fragment's mesh with the journal.
void checkMesh(const std::string& name, std::string bytes, const Json& fragment) {
  const fs::path path = withoutPacking(name);
  const std::string extension = path.extension().string();
  if (extension != ".ply" && extension != ".obj" && extension != ".binm") return;
  const TriangleMesh mesh = meshFromBytes(path, std::move(bytes)).mesh;
  if (mesh.triangles.size() == fragment.at("faces").get<std::size_t>()) return;
  differs(name, "has " + std::to_string(mesh.triangles.size()) + " faces, not " +
                    fragment.at("faces").dump());
}

void checkFracture(const StoredFiles& files, const Json& line) {
  std::map<std::string, const Json*> meshOf;  // a fragment's first file is its mesh
  for (const Json& fragment : line.at("fragments")) {
    if (!fragment.at("files").empty()) meshOf[fragment.at("files").front()] = &fragment;
  }
  for (const FileRecord& record : filesOf(line)) {
    std::string bytes = files.bytes(record.name);
    if (bytes.size() != record.bytes || sha256(bytes) != record.sha256) {
      differs(record.name, "differs from what was written");
    }
    const auto mesh = meshOf.find(record.name);
    const bool isLabels = std::any_of(line.at("labels").begin(), line.at("labels").end(),
                                      [&](const Json& name) { return name == record.name; });
    if (isLabels)
      checkLabels(record.name, contentOf(record.name, std::move(bytes)), line);
    else if (mesh != meshOf.end()) {
      checkMesh(record.name, contentOf(record.name, std::move(bytes)), *mesh->second);
    }
  }
}

}  // namespace

DatasetCheck verifyDataset(const fs::path& out, const Progress* progress, Shard shard) {
  const DatasetPlan plan = readPlan(out);
  DatasetCheck check;
  std::mutex mutex;
  const auto problem = [&](const std::string& sentence) {
    const std::lock_guard lock(mutex);
    check.problems.push_back(sentence);
  };
  for (const std::string& sentence : changedOwnFiles(out, true)) problem(sentence);
  std::optional<JoinedFractures> joined;
  if (plan.layout == DatasetLayout::hdf5) {
    joined.emplace(out);
    for (const std::string& sentence : joined->problems()) problem(sentence);
  }
  for (const LibraryObject& object : shardOf(plan.objects, shard)) {
    try {
      const JournalText journal = readJournal(out, object);
      if (journal.failed) continue;
      if (!journal.done) {
        problem(object.key + ": is not done");
        continue;
      }
      const bool isHdf5 = plan.layout == DatasetLayout::hdf5;
      const bool isPacked = plan.layout == DatasetLayout::packed;
      if (isPacked && (journal.files.size() != 1 ||
                       journal.files.front().name != objectFolder(plan.layout, object) + ".zip"))
        differs(journalName(object), "lists another file than the object's archive");
      const StoredFiles files(out, isPacked ? &journal.files.front() : nullptr);
      tbb::parallel_for(std::size_t{0}, journal.fractures.size(), [&](std::size_t i) {
        throwIfCancelled(progress);
        try {
          if (isHdf5) {
            joined->check(object, journal.sha256, journal.fractures[i]);
          } else {
            checkFracture(files, journal.fractures[i]);
          }
        } catch (const Error& e) {
          if (e.code() == ErrorCode::cancelled) throw;
          problem(e.what());
        }
      });
      for (const Json& line : journal.fractures) {
        check.files += line.at("files").size();
        for (const FileRecord& file : filesOf(line)) check.bytes += file.bytes;
      }
    } catch (const Error& e) {
      if (e.code() == ErrorCode::cancelled) throw;
      problem(e.what());
    }
  }
  std::sort(check.problems.begin(), check.problems.end());
  return check;
}

}  // namespace sherd
