// Joins the fractures of the layout hdf5 to one file.
#include "dataset/layouts/hdf5_join.h"

#include <fcntl.h>
#include <sherd/error.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "base/cancel_flag.h"
#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/files/file_bytes.h"
#include "base/files/sha256.h"
#include "base/input_error.h"
#include "dataset/journal/json_fields.h"
#include "dataset/journal/object_folder.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/layouts/hdf5_lists.h"
#include "dataset/layouts/hdf5_part.h"
#include "dataset/layouts/hdf5_record.h"
#include "dataset/layouts/identity.h"
#include "dataset/layouts/split_of.h"
#include "formats/arrays/hdf5_file.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// Waits until a file, or the names in a folder, are on the disk.
void requireOnDisk(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const int failed = descriptor < 0 || ::fsync(descriptor) != 0 ? errno : 0;
  if (descriptor >= 0) ::close(descriptor);
  if (failed == 0 || failed == EINVAL) return;  // some file systems cannot wait for folders
  throw Error(ErrorCode::output, path.string() + ": cannot be written: " + reasonOf(failed));
}

/// A finished object with its journal's lines of fractures.
struct Finished {
  const LibraryObject* object;
  std::string meshSum;
  std::vector<Json> lines;
};

std::optional<Finished> finished(const fs::path& out, const LibraryObject& object) {
  JournalText journal = readJournal(out, object);
  if (!journal.done) return {};
  try {
    for (const Json& line : journal.fractures) {
      (void)hdf5Name(line);
      if (hdf5Kept(line) == 0) fields::damaged("a fracture has no fragment");
    }
  } catch (const Error& e) {
    inputError(out / journalName(object),
               std::string("is damaged: ") + e.what() +
                   "; remove the file, and a resumed run breaks its object again",
               OptionNames{"resume"});
  }
  return Finished{&object, std::move(journal.sha256), std::move(journal.fractures)};
}

std::size_t redundantOf(const fs::path& out, const DatasetPlan& plan) try {
  return optionsOfIdentity(plan.text).redundantPieces;
} catch (const Error& e) {
  inputError(out / kPlanName, std::string("is damaged: ") + e.what());
}

Hdf5Arrays arraysIn(const fs::path& part, std::string_view bytes) try {
  return parsedHdf5Part(bytes);
} catch (const Error& e) {
  inputError(part, e.what());
}

class Joining {
 public:
  Joining(const fs::path& out, const DatasetPlan& plan, std::vector<JoinedFile> joined)
      : out_(out), plan_(plan), redundant_(redundantOf(out, plan)), joined_(std::move(joined)) {}

  void write(const std::vector<const LibraryObject*>& objects, const std::string& stem,
             const Progress* progress) {
    const std::string name = stem + ".hdf5";
    AtomicFile file(out_ / name);
    JoinedFile record{name, 0, {}, {}};
    {
      Hdf5Lists lists(plan_.seed, redundant_);
      for (const LibraryObject* object : objects) {
        throwIfCancelled(progress);
        if (const auto done = finished(out_, *object)) {
          lists.add(hdf5Group(*object), splitOf(*object, plan_.split), countsOf(*done));
        }
      }
      Hdf5Writer writer(file.temporary(), (out_ / name).string());
      for (const LibraryObject* object : objects) {
        const auto done = finished(out_, *object);
        if (!done) continue;
        addObject(*done, lists, writer, progress);
        record.objects.emplace(object->key, done->meshSum);
      }
      lists.writeSplits(stem, writer);
      writer.close();
    }
    readers_.clear();
    requireOnDisk(file.temporary());
    record.bytes = fs::file_size(file.temporary());
    record.sha256 = sha256OfFile(file.temporary());
    replace(file, record);
  }

 private:
  // [fractures] the numbers of fragments, without the intact object.
  static std::vector<std::pair<std::string, std::size_t>> countsOf(const Finished& done) {
    std::vector<std::pair<std::string, std::size_t>> counts;
    for (const Json& line : done.lines) {
      if (line.at("fracture") != kWholeName) counts.emplace_back(hdf5Name(line), hdf5Kept(line));
    }
    return counts;
  }

  void addObject(const Finished& done, const Hdf5Lists& lists, Hdf5Writer& writer,
                 const Progress* progress) {
    const std::string group = hdf5Group(*done.object);
    for (const Json& line : done.lines) {
      throwIfCancelled(progress);
      const std::string fracture = group + "/" + hdf5Name(line) + "/";
      for (const auto& [path, array] : arraysOf(done, line, fracture)) {
        writer.add(fracture + path, array);
      }
      if (line.at("fracture") == kWholeName) continue;
      if (const auto redundant = lists.redundantPieces(group, hdf5Name(line))) {
        writer.add(fracture + "redundant_pieces", *redundant);
      }
    }
  }

  // At every moment a record fits the file.
  void replace(AtomicFile& file, const JoinedFile& record) const {
    std::vector<JoinedFile> states{record};
    for (const JoinedFile& before : joined_) {
      if (before.name == record.name) states.push_back(before);
    }
    writeRecord(out_, states);
    requireOnDisk(out_ / recordName(record.name));
    file.commit();
    requireOnDisk(out_);
    writeRecord(out_, {record});
  }

  // Returns the arrays of a fracture, from its part or a joined file.
  Hdf5Arrays arraysOf(const Finished& done, const Json& line, const std::string& group) {
    const FileRecord part = filesOf(line).front();  // hdf5Name has found it
    if (isOwnFile(out_, part.name)) {
      const std::string bytes = readFileBytes(out_ / part.name);
      if (bytes.size() == part.bytes && sha256(bytes) == part.sha256)
        return arraysIn(out_ / part.name, bytes);
      throw Error(ErrorCode::input,
                  (out_ / part.name).string() +
                      ": differs from what was written; remove it, and a resumed run breaks its "
                      "object again",
                  OptionNames{"resume"});
    }
    const Hdf5Reader& reader = readerOf(done);
    Hdf5Arrays arrays;
    std::vector<std::string> paths{"vertices", "faces"};
    if (line.at("fracture") != kWholeName) paths = hdf5Paths(hdf5Kept(line));
    for (const std::string& path : paths) {
      if (auto array = reader.read(group + path)) {
        arrays.emplace_back(path, std::move(*array));
      } else if (!path.starts_with("removal_")) {
        inputError(out_, group + path + " is missing from its HDF5 file");
      }
    }
    return arrays;
  }

  const Hdf5Reader& readerOf(const Finished& done) {
    for (const bool isLast : {false, true}) {
      for (const JoinedFile& file : joined_) {
        if (!file.holds(*done.object, done.meshSum)) continue;
        std::unique_ptr<Hdf5Reader>& reader = readers_[file.name];
        if (reader) return *reader;
        // Else a damaged file would be copied, under a checksum that fits.
        if (sha256OfFile(out_ / file.name) != file.sha256) {
          throw Error(ErrorCode::input, differs((out_ / file.name).string()),
                      OptionNames{"resume"});
        }
        reader = std::make_unique<Hdf5Reader>(out_ / file.name);
        return *reader;
      }
      if (!isLast) joined_ = joinedFiles(out_);  // another shard may have joined its parts by now
    }
    throw Error(
        ErrorCode::input,
        out_.string() + ": the fractures of " + done.object->key + " are missing; resume the run",
        OptionNames{"resume"});
  }

  const fs::path& out_;
  const DatasetPlan& plan_;
  const std::size_t redundant_;
  std::vector<JoinedFile> joined_;
  std::map<std::string, std::unique_ptr<Hdf5Reader>> readers_;
};

// Removes the parts of a finished object and its folder, also one that a killed run left empty.
//   above  and the folders above, which other shards may be about to write to
void removeParts(const fs::path& out, const LibraryObject& object, const JournalText& journal,
                 bool above) {
  for (const Json& line : journal.fractures) {
    for (const FileRecord& part : filesOf(line)) {
      if (part.name.ends_with(kHdf5Part) && isOwnFile(out, part.name))
        ::unlink((out / part.name).c_str());
    }
  }
  for (fs::path folder = objectFolder(DatasetLayout::hdf5, object); !folder.empty();
       folder = folder.parent_path()) {
    if ((::rmdir((out / folder).c_str()) != 0 && errno != ENOENT) || !above) break;
  }
}

bool hasAllParts(const fs::path& out, const JournalText& journal) {
  return std::all_of(journal.fractures.begin(), journal.fractures.end(), [&](const Json& line) {
    const std::vector<FileRecord> files = filesOf(line);
    return std::all_of(files.begin(), files.end(), [&](const FileRecord& part) {
      std::error_code failed;
      return isOwnFile(out, part.name) && fs::file_size(out / part.name, failed) == part.bytes;
    });
  });
}

// Whether a joined file has these objects, and none of them newer parts.
//   alone  and no others
bool isJoined(const fs::path& out, const std::vector<const LibraryObject*>& objects,
              const JoinedFile& file, bool alone) {
  std::size_t done = 0;
  for (const LibraryObject* object : objects) {
    const JournalText journal = readJournal(out, *object);
    if (!journal.done) continue;
    ++done;
    if (!file.holds(*object, journal.sha256) || hasAllParts(out, journal)) return false;
  }
  return !alone || done == file.objects.size();
}

}  // namespace

std::string hdf5Group(const LibraryObject& object) {
  return objectFolder(DatasetLayout::bb, object);
}

bool hasFractures(const fs::path& out, const LibraryObject& object, const JournalText& journal,
                  const std::vector<JoinedFile>& joined) {
  if (hasAllParts(out, journal)) return true;
  return journal.done && std::any_of(joined.begin(), joined.end(), [&](const JoinedFile& file) {
           return file.holds(object, journal.sha256);
         });
}

void joinHdf5(const fs::path& out, const DatasetPlan& plan, Shard shard, const Progress* progress) {
  const bool isWhole = shard.of == 1;
  const std::string stem =
      isWhole
          ? kHdf5Stem
          : kHdf5Stem + ("_" + std::to_string(shard.number) + "_of_" + std::to_string(shard.of));
  std::vector<const LibraryObject*> objects;
  std::set<std::string> wanted;
  if (!isWhole) {
    for (const LibraryObject& object : shardOf(plan.objects, shard)) wanted.insert(object.key);
  }
  for (const LibraryObject& object : plan.objects) {
    if (isWhole || wanted.contains(object.key)) objects.push_back(&object);
  }
  const std::vector<JoinedFile> joined = joinedFiles(out);
  const bool isDone = std::any_of(joined.begin(), joined.end(), [&](const JoinedFile& file) {
    // After `sherd merge` the whole dataset's file has what a shard's had.
    return file.name == stem + ".hdf5" ? isJoined(out, objects, file, true)
                                       : file.name == kHdf5Stem + std::string(".hdf5") &&
                                             isJoined(out, objects, file, false);
  });
  if (!isDone) Joining(out, plan, joined).write(objects, stem, progress);
  for (const LibraryObject* object : objects) {
    if (!fs::exists(out / kHdf5PartFolder)) break;
    const JournalText journal = readJournal(out, *object);
    if (journal.done) removeParts(out, *object, journal, isWhole);
  }
  if (isWhole) removeShardFiles(out);
}

}  // namespace sherd
