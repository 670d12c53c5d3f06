// Which files below a folder are a dataset's.
#include "dataset/replaced_files.h"

#include <fnmatch.h>
#include <sherd/error.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/files/file_bytes.h"
#include "base/files/folders.h"
#include "dataset/journal/journal.h"
#include "dataset/journal/object_folder.h"
#include "dataset/journal/own_sums.h"
#include "dataset/layouts/bb_lists.h"
#include "dataset/layouts/identity.h"
#include "dataset/layouts/pfpp.h"
#include "dataset/stored_object.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr std::array kTop{kPlanName,   kIndexCsv,   kIndexJsonl,      kFailuresName,
                          kReportName, kRecipeName, "train.txt",      "val.txt",
                          "test.txt",  "run.json",  "run_*_of_*.json"};
constexpr std::array kTopOfHdf5{"fractures.hdf5", "fractures.hdf5.json", "fractures_*_of_*.hdf5",
                                "fractures_*_of_*.hdf5.json"};
constexpr const char* kRunName = "run.json";
constexpr std::array kRunRecords{kRunName, "run_*_of_*.json"};
constexpr const char* kKept = "kept";

bool isPresent(const fs::path& path) { return typeOf(path) != fs::file_type::not_found; }

template <class Patterns>
bool isOneOf(const Patterns& patterns, const std::string& name) {
  return std::any_of(patterns.begin(), patterns.end(), [&](const char* pattern) {
    return ::fnmatch(pattern, name.c_str(), FNM_PERIOD) == 0;
  });
}

// Returns all files below a folder, relative to it, without following links.
std::vector<fs::path> filesBelow(const fs::path& root) {
  std::vector<fs::path> files;
  if (!isFolder(root)) return files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
    if (!isFolder(entry.path())) files.push_back(entry.path().lexically_relative(root));
  }
  return files;
}

/// An object of a dataset, and its journal if it was finished.
struct JournaledObject {
  LibraryObject object;
  std::optional<JournalText> finished;
};

// Returns the objects that journals record; also those that a later run left out of the plan.
std::vector<JournaledObject> journaledObjects(const fs::path& folder, const DatasetPlan& plan) {
  std::map<std::string, LibraryObject> planned;
  for (const LibraryObject& object : plan.objects) planned[object.folder] = object;
  std::vector<JournaledObject> all;
  for (const fs::path& file : filesBelow(folder / kJournalFolder)) {
    const std::string name = std::string(kJournalFolder) + "/" + file.generic_string();
    if (file.extension() != ".jsonl" || !isOwnFile(folder, name)) continue;
    const std::string stem = fs::path(file).replace_extension().generic_string();
    const auto known = planned.find(stem);
    try {
      JournalText text = parsedJournal(readFileBytes(folder / name), name);
      if (text.object.empty() && known == planned.end()) continue;  // of another
      JournaledObject& one = all.emplace_back();
      one.object = known == planned.end() ? LibraryObject{text.object, stem, {}, 0} : known->second;
      if (text.done) one.finished = std::move(text);
    } catch (const Error&) {  // of another, unless the plan has it
      if (known != planned.end()) all.push_back({known->second, {}});
    }
  }
  return all;
}

DatasetOptions optionsOf(const DatasetPlan& plan) {
  DatasetOptions options;
  try {
    options = optionsOfIdentity(plan.text);
  } catch (const Error&) {  // of another version: only the names of unfinished files are at stake
  }
  options.layout = plan.layout;
  options.split = plan.split;
  return options;
}

// Returns the dataset's own files, those of objects aside, relative to its folder.
std::set<std::string> ownNames(const fs::path& folder, const DatasetPlan& plan,
                               const std::vector<JournaledObject>& objects) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool isOfHdf5 = plan.layout == DatasetLayout::hdf5 && isOneOf(kTopOfHdf5, name);
    if (isOfHdf5 || isOneOf(kTop, name)) names.insert(name);
  }
  if (plan.layout == DatasetLayout::bb) {
    std::vector<std::string> folders;
    for (const JournaledObject& one : objects)
      folders.push_back(objectFolder(plan.layout, one.object));
    for (std::string& name : bbListNames(folders)) names.insert(std::move(name));
  }
  names.insert(kSumsName);
  std::set<std::string> ofObjects;
  for (const JournaledObject& one : objects) {
    names.insert(journalName(one.object));
    ofObjects.insert(one.object.folder);
  }
  for (const fs::path& file : filesBelow(folder / kJournalFolder)) {  // thumbnails and pages
    const std::string name = file.generic_string();
    if (file.extension() != ".png" && file.extension() != ".html") continue;
    const std::string stem = fs::path(file).replace_extension().generic_string();
    if (ofObjects.contains(stem.substr(0, stem.rfind('.'))))
      names.insert(std::string(kJournalFolder) + "/" + name);
  }
  return names;
}

void removeObject(const fs::path& folder, const JournaledObject& one,
                  const DatasetOptions& options) {
  if (!one.finished) return discardStored(storeOf(folder, one.object, options));
  for (const Json& line : one.finished->fractures) {
    for (const FileRecord& file : filesOf(line)) removeOwnFile(folder, file.name);
  }
  for (const FileRecord& file : one.finished->files) removeOwnFile(folder, file.name);
}

bool isLink(const fs::path& path) { return typeOf(path) == fs::file_type::symlink; }

// Where a relative link leads, from the folder of the dataset.  The folders that its name has are
// no links, so that "out of a folder" at its beginning is the folder's parent.
fs::path targetOf(const fs::path& name, const fs::path& text) {
  fs::path at = name.parent_path(), rest;
  for (const fs::path& part : text) {
    if (rest.empty() && part == ".") continue;
    if (rest.empty() && part == ".." && !at.empty()) {
      at = at.parent_path();
    } else {
      rest /= part;
    }
  }
  return at / rest;
}

// The text of a link once it lies in "kept".
//   inKept  the files that lie there
fs::path textInKept(const fs::path& name, const fs::path& text, const std::set<fs::path>& inKept) {
  const fs::path target = targetOf(name, text);
  if (text.is_absolute() || inKept.contains(target)) return text;
  fs::path up = "..";
  for (fs::path at = name.parent_path(); !at.empty(); at = at.parent_path()) up /= "..";
  return up / target;
}

// Moves a link into "kept"; it leads to the same file from there.
bool moveLink(const fs::path& from, const fs::path& to, const fs::path& text) {
  const Uncut whole;
  std::error_code failed;
  // A process that was killed here has left both.
  const bool isThere = isLink(to) && fs::read_symlink(to, failed) == text;
  return (isThere || ::symlink(text.c_str(), to.c_str()) == 0) && ::unlink(from.c_str()) == 0;
}

// Moves a file to the same path below another folder, or to "kept" there.
//   inKept  what was moved there already
//   return  the path in "kept"; empty if it is the same
fs::path movedTo(const fs::path& from, const fs::path& others, const fs::path& name,
                 const std::set<fs::path>& inKept) {
  for (const fs::path& to : {others / name, others / kKept / name}) {
    const bool isSame = to == others / name;
    std::error_code failed;
    fs::create_directories(to.parent_path(), failed);
    if (failed) continue;
    if (!isSame && isLink(from)) {
      const fs::path text = fs::read_symlink(from, failed);
      requireOwnSubfolder(others, to.lexically_relative(others).string());
      if (!failed && moveLink(from, to, textInKept(name, text, inKept))) return to;
      continue;
    }
    if (isPresent(to)) continue;
    requireOwnSubfolder(others, to.lexically_relative(others).string());
    if (::rename(from.c_str(), to.c_str()) == 0) return isSame ? fs::path() : to;
  }
  throw Error(ErrorCode::output,
              from.string() + ": is no file of the dataset, and cannot be moved " + "back to " +
                  (others / name).string() + "; move it yourself and run the same command again");
}

void removeEmptyFolders(const fs::path& folder) {
  std::vector<fs::path> folders{folder};
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (isFolder(entry.path())) folders.push_back(entry.path());
  }
  std::sort(folders.rbegin(), folders.rend());               // inner ones first
  for (const fs::path& one : folders) ::rmdir(one.c_str());  // fails if it is not empty
}

}  // namespace

std::set<std::string> entriesOfObject(const DatasetPlan& plan, const LibraryObject& object) {
  if (plan.layout == DatasetLayout::pfpp) return {kPfppPointFolder, kPfppMatchFolder};
  const std::string path = objectFolder(plan.layout, object);
  return {path.substr(0, path.find('/'))};
}

std::set<std::string> entriesOfDataset(const fs::path& folder, const DatasetPlan& plan) {
  const std::vector<JournaledObject> objects = journaledObjects(folder, plan);
  std::set<std::string> all{kJournalFolder};
  for (const std::string& name : ownNames(folder, plan, objects))
    all.insert(name.substr(0, name.find('/')));
  for (const JournaledObject& one : objects) all.merge(entriesOfObject(plan, one.object));
  for (auto entry = all.begin(); entry != all.end();) {
    const fs::file_type type = typeOf(folder / *entry);
    if (type == fs::file_type::not_found) {
      entry = all.erase(entry);
      continue;
    }
    if (type != fs::file_type::directory && type != fs::file_type::regular) {
      throw Error(ErrorCode::output, (folder / *entry).string() +
                                         ": is neither a file nor a folder, so the dataset is not "
                                         "replaced; move it away");
    }
    ++entry;
  }
  return all;
}

Leftovers leftoversOf(const fs::path& folder, const DatasetPlan& plan, int shards) {
  Leftovers leftovers;
  std::set<std::string> planned;
  for (const LibraryObject& object : plan.objects) planned.insert(object.folder);
  for (const JournaledObject& one : journaledObjects(folder, readPlan(folder))) {
    if (!planned.contains(one.object.folder)) leftovers.objects.push_back(one.object);
  }
  const std::string own =
      shards == 1 ? kRunName : std::string("run_*_of_") + std::to_string(shards) + ".json";
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (isOneOf(kRunRecords, name) && !isOneOf(std::array{own.c_str()}, name))
      leftovers.records.push_back(name);
  }
  return leftovers;
}

void removeLeftovers(const fs::path& folder, const DatasetPlan& plan, const Leftovers& leftovers) {
  removeOwnFile(folder, kSumsName);
  for (const std::string& name : leftovers.records) removeOwnFile(folder, name);
  for (const LibraryObject& object : leftovers.objects) {
    discardStored(storeOf(folder, object, optionsOf(plan)));
    for (const fs::path& file : filesBelow(folder / kJournalFolder)) {  // thumbnails and pages
      const std::string stem = fs::path(file).replace_extension().generic_string();
      if (file.extension() != ".jsonl" && stem.substr(0, stem.rfind('.')) == object.folder)
        removeOwnFile(folder, std::string(kJournalFolder) + "/" + file.generic_string());
    }
    removeOwnFile(folder, journalName(object));  // last: it says what the others are
  }
  removeEmptyFolders(folder);
}

std::vector<std::string> removeDataset(const fs::path& folder, const fs::path& others) {
  std::vector<std::string> sentences;
  std::set<std::string> own;
  if (hasPlan(folder)) {  // else only what follows its removal is left
    const DatasetPlan plan = readPlan(folder);
    const std::vector<JournaledObject> objects = journaledObjects(folder, plan);
    const DatasetOptions options = optionsOf(plan);
    for (const JournaledObject& one : objects) removeObject(folder, one, options);
    own = ownNames(folder, plan, objects);
  }
  // All files of objects are gone: what is left is not the dataset's, or in `own`.
  std::vector<fs::path> names = filesBelow(folder);
  std::stable_partition(names.begin(), names.end(),  // links follow what they lead to
                        [&](const fs::path& name) { return !isLink(folder / name); });
  std::set<fs::path> inKept;
  for (const fs::path& name : names) {
    if (own.contains(name.generic_string())) continue;
    if (isTemporaryName(name.filename().string()) && isOwnFile(folder, name.string())) {
      removeOwnFile(folder, name.string());
      continue;
    }
    const fs::path kept = movedTo(folder / name, others, name, inKept);
    if (kept.empty()) continue;
    inKept.insert(name);
    sentences.push_back(name.string() + ": is no file of the dataset, and lies in " +
                        kept.string() + " now");
  }
  // The journals and then the plan last: they say what the others are.
  const auto isJournal = [](const std::string& name) { return name.ends_with(".jsonl"); };
  for (const bool journals : {false, true}) {
    for (const std::string& name : own) {
      if (name != kPlanName && isJournal(name) == journals) removeOwnFile(folder, name);
    }
  }
  removeOwnFile(folder, kPlanName);
  removeEmptyFolders(folder);
  return sentences;
}

}  // namespace sherd
