// The list files that loaders of Breaking Bad read.
#include "dataset/layouts/bb_lists.h"

#include <sherd/error.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "dataset/journal/object_folder.h"
#include "dataset/layouts/split_of.h"

namespace sherd {

namespace fs = std::filesystem;

namespace {

// The lists that a loader or converter opens whatever the library's folders are called.
constexpr std::array kKnownSubsets{"everyday", "artifact"};

// Fewer objects than this are no sample: a shape of the others may be missing.
constexpr std::size_t kFewObjects = 3;

// Jigsaw's list of fractures, which it makes of the lists once and reads ever after.
constexpr const char* kJigsawList = "all_piece_matching_metadata_";

std::string textAt(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> keptLists(const fs::path& out) {
  std::vector<std::string> sentences;
  std::error_code failed;
  for (fs::directory_iterator at(out, failed), end; !failed && at != end; at.increment(failed)) {
    const std::string name = at->path().filename().string();
    if (!name.starts_with(kJigsawList)) continue;
    sentences.push_back(at->path().string() +
                        ": a loader's list of the fractures that were here before; remove it, or "
                        "the new ones are not read");
  }
  std::sort(sentences.begin(), sentences.end());
  return sentences;
}

}  // namespace

std::vector<std::string> fewObjects(const std::vector<BbObject>& objects,
                                    const std::array<int, 3>& shares) {
  if (objects.empty()) return {};
  std::string few;
  for (std::size_t i = 0; i < kSplits.size(); ++i) {
    const auto count = static_cast<std::size_t>(
        std::count_if(objects.begin(), objects.end(),
                      [&](const BbObject& object) { return object.split == kSplits[i]; }));
    if (shares[i] == 0 || count >= kFewObjects) continue;
    few += (few.empty() ? "" : ", ") + std::string(kSplits[i]) + " has " + std::to_string(count);
  }
  if (few.empty()) return {};
  const std::string split =
      std::to_string(shares[0]) + "/" + std::to_string(shares[1]) + "/" + std::to_string(shares[2]);
  const std::string count =
      objects.size() == 1 ? "1 object" : std::to_string(objects.size()) + " objects";
  return {"of " + count + " split " + split + ", " + few +
          "; loaders read an empty list without an error"};
}

std::vector<std::string> bbListNames(const std::vector<std::string>& folders) {
  std::set<std::string> subsets(kKnownSubsets.begin(), kKnownSubsets.end());
  for (const std::string& folder : folders) subsets.insert(folder.substr(0, folder.find('/')));
  const std::string splits = std::string(kBbSplitFolder) + "/";
  const std::string lists = std::string(kBbListFolder) + "/";
  std::vector<std::string> names;
  for (const std::string split : kSplits) {
    names.push_back(splits + split + ".txt");
    for (const std::string& subset : subsets) {
      for (const std::string& prefix : {std::string(), splits})
        names.push_back(prefix + subset + "." + split + ".txt");
      names.push_back(lists + subset + "_" + split + ".txt");
    }
  }
  return names;
}

std::vector<std::string> writeBbLists(const fs::path& out, const std::vector<BbObject>& objects) {
  std::set<std::string> subsets(kKnownSubsets.begin(), kKnownSubsets.end());
  std::map<std::string, std::string> folders, counted, fractures;  // by subset and split
  for (const BbObject& object : objects) {
    const std::string subset = object.folder.substr(0, object.folder.find('/'));
    subsets.insert(subset);
    folders[subset + "." + object.split] += object.folder + "\n";
    for (std::size_t i = 0; i < object.fragmentCounts.size(); ++i) {
      std::array<char, 16> count{};
      std::snprintf(count.data(), count.size(), "%03zu ", object.fragmentCounts[i]);
      const std::string fracture = object.folder + "/fractured_" + std::to_string(i) + "\n";
      counted[subset + "_" + object.split] += count.data() + fracture;
      fractures[object.split] += fracture;
    }
  }
  std::error_code failed;
  for (const std::string folder : {kBbSplitFolder, kBbListFolder}) {
    requireOwnSubfolder(out, folder + "/file");
    fs::create_directories(out / folder, failed);
    if (!failed) continue;
    throw Error(ErrorCode::output,
                (out / folder).string() + ": cannot be made: " + reasonOf(failed.value()));
  }
  bool isChanged = false;
  // Empty lists too: a loader opens the file of each split.
  for (const char* split : kSplits) {
    const fs::path all = out / kBbSplitFolder / (std::string(split) + ".txt");
    isChanged = isChanged || textAt(all) != fractures[split];
    writeWhole(all, fractures[split]);
    for (const std::string& subset : subsets) {
      const std::string name = subset + "." + split;
      writeWhole(out / (name + ".txt"), folders[name]);
      writeWhole(out / kBbSplitFolder / (name + ".txt"), folders[name]);
      const std::string list = subset + "_" + split;
      writeWhole(out / kBbListFolder / (list + ".txt"), counted[list]);
    }
  }
  return isChanged ? keptLists(out) : std::vector<std::string>();
}

}  // namespace sherd
