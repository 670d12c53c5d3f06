// The folders of objects, and reserved names.
#include "dataset/journal/object_folder.h"

#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "base/text/lower_case.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBbTop = "library";  // category of objects at the top of a library

constexpr unsigned bit(DatasetLayout layout) { return 1U << static_cast<unsigned>(layout); }
constexpr unsigned kPacked = bit(DatasetLayout::packed);
constexpr unsigned kPaper = bit(DatasetLayout::paper);
constexpr unsigned kBb = bit(DatasetLayout::bb);
constexpr unsigned kHdf5 = bit(DatasetLayout::hdf5);
constexpr unsigned kPfpp = bit(DatasetLayout::pfpp);
constexpr unsigned kTraining = kBb | kHdf5 | kPfpp;  // paths of SUBSET/CATEGORY/OBJECT
constexpr unsigned kAll = bit(DatasetLayout::sherd) | kPacked | kPaper | kTraining;

/// A reserved name, as a pattern in lower case.
struct Reserved {
  const char* pattern;
  unsigned layouts;
  bool atTop;  ///< reserved only as the first part of a path
};

constexpr std::array kReserved{
    Reserved{kPlanName, kPaper | kBb, true},
    Reserved{kIndexCsv, kPaper | kBb, true},
    Reserved{kIndexJsonl, kPaper | kBb, true},
    Reserved{kFailuresName, kPaper | kBb, true},
    Reserved{kReportName, kPaper | kBb, true},
    Reserved{kRecipeName, kPaper | kBb, true},
    Reserved{"train.txt", kPaper | kBb, true},
    Reserved{"val.txt", kPaper | kBb, true},
    Reserved{"test.txt", kPaper | kBb, true},
    Reserved{"run*.json", kPaper | kBb, true},
    Reserved{kJournalFolder, kPaper | kBb, true},
    Reserved{kBbTop, kTraining, true},
    Reserved{kBbSplitFolder, kBb | kHdf5, true},
    Reserved{"fractures*", kHdf5, true},  // the lists by the file's name
    Reserved{kBbListFolder, kBb, true},
    Reserved{"*.train.txt", kBb, true},
    Reserved{"*.val.txt", kBb, true},
    Reserved{"*.test.txt", kBb, true},
    // Files beside an object's folder that begin with its name: journal, thumbnails, pages of the
    // viewer, archive.
    Reserved{"*.jsonl", kAll, false},
    Reserved{"*.whole.png", kAll, false},
    Reserved{"*.[0-9]*f_[0-9]*.png", kAll, false},
    Reserved{"*.[0-9]*f_[0-9]*.html", kAll, false},
    Reserved{"*.zip", kPacked, false},
    Reserved{"*.zip.partial", kPacked, false},
    // Temporary files.
    Reserved{".sherd-*", kAll, false},
};

bool isReserved(DatasetLayout layout, const std::string& name, bool isTop) {
  const std::string plain = lowerCase(name.substr(0, name.find_last_not_of('_') + 1));
  return std::any_of(kReserved.begin(), kReserved.end(), [&](const Reserved& reserved) {
    return (reserved.layouts & bit(layout)) != 0 && (isTop || !reserved.atTop) &&
           ::fnmatch(reserved.pattern, plain.c_str(), 0) == 0;
  });
}

/// A path up to a reserved part: before and after renaming.
using Renamed = std::pair<std::string, std::string>;

std::string renamed(DatasetLayout layout, const std::string& folder,
                    std::vector<Renamed>& changes) {
  // Objects at the top of a library lie in kBbTop in the trees of training data.
  bool isTop = (kTraining & bit(layout)) == 0 || folder.find('/') != std::string::npos;
  fs::path before, after;
  for (const fs::path& part : fs::path(folder)) {
    std::string name = part.string();
    before /= part;
    const bool changed = isReserved(layout, name, std::exchange(isTop, false));
    after /= changed ? name + "_" : name;
    if (changed) changes.emplace_back(before.generic_string(), after.generic_string());
  }
  return after.generic_string();
}

}  // namespace

std::string objectFolder(DatasetLayout layout, const LibraryObject& object) {
  switch (layout) {
    case DatasetLayout::sherd:
    case DatasetLayout::packed:
      return "objects/" + object.folder;
    case DatasetLayout::paper:
      return object.folder;
    case DatasetLayout::bb:
      // Loaders read the second part of a path as the category.
      return object.folder.find('/') == std::string::npos
                 ? std::string(kBbTop) + "/" + object.folder
                 : object.folder;
    case DatasetLayout::hdf5:
      return std::string(kHdf5PartFolder) + "/" + objectFolder(DatasetLayout::bb, object);
    case DatasetLayout::pfpp:
      return std::string(kPfppPointFolder) + "/" + objectFolder(DatasetLayout::bb, object);
  }
  return object.folder;
}

std::vector<std::string> renameReserved(DatasetLayout layout, std::vector<LibraryObject>& objects) {
  struct Affected {
    std::string first;
    std::size_t count = 0;
  };
  std::map<Renamed, Affected> all;
  for (LibraryObject& object : objects) {
    std::vector<Renamed> changes;
    object.folder = renamed(layout, object.folder, changes);
    for (const Renamed& change : changes) {
      Affected& affected = all[change];
      if (affected.count++ == 0) affected.first = object.key;
    }
  }
  std::vector<std::string> sentences;
  for (const auto& [change, affected] : all) {
    const std::string more =
        affected.count == 1 ? " lies" : " and " + std::to_string(affected.count - 1) + " more lie";
    sentences.push_back(affected.first + more + " in '" + change.second +
                        "', because the dataset reserves the name '" + change.first + "'");
  }
  return sentences;
}

bool isRenamed(const LibraryObject& object) { return !object.key.starts_with(object.folder); }

}  // namespace sherd
