// The list files that loaders of Breaking Bad read.
#include "dataset/bb_lists.h"

#include <sherd/error.h>

#include <array>
#include <cstdio>
#include <map>
#include <set>

#include "base/atomic_file.h"
#include "base/below_folder.h"
#include "dataset/object_folder.h"

namespace sherd {

namespace fs = std::filesystem;

void writeBbLists(const fs::path& out, const std::vector<BbObject>& objects) {
  std::set<std::string> subsets;
  std::map<std::string, std::string> folders, fractures;  // by subset and split
  for (const BbObject& object : objects) {
    const std::string subset = object.folder.substr(0, object.folder.find('/'));
    subsets.insert(subset);
    folders[subset + "." + object.split] += object.folder + "\n";
    std::string& list = fractures[subset + "_" + object.split];
    for (std::size_t i = 0; i < object.fragmentCounts.size(); ++i) {
      std::array<char, 16> count{};
      std::snprintf(count.data(), count.size(), "%03zu ", object.fragmentCounts[i]);
      list += count.data() + object.folder + "/fractured_" + std::to_string(i) + "\n";
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
  // Empty lists too: a loader opens the file of each split.
  for (const std::string& subset : subsets) {
    for (const char* split : {"train", "val", "test"}) {
      const std::string name = subset + "." + split;
      writeWhole(out / (name + ".txt"), folders[name]);
      writeWhole(out / kBbSplitFolder / (name + ".txt"), folders[name]);
      const std::string list = subset + "_" + split;
      writeWhole(out / kBbListFolder / (list + ".txt"), fractures[list]);
    }
  }
}

}  // namespace sherd
