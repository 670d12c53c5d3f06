// The lists of fractures in an HDF5 file.
#include "dataset/layouts/hdf5_lists.h"

#include <sherd/error.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/files/sha256.h"
#include "base/random.h"
#include "dataset/journal/json_fields.h"
#include "dataset/layouts/hdf5_part.h"
#include "dataset/layouts/split_of.h"

namespace sherd {

std::string hdf5Name(const Json& line) {
  const std::vector<FileRecord> files = filesOf(line);
  if (files.size() != 1 || !files[0].name.ends_with(kHdf5Part))
    fields::damaged("a fracture has other files than a part of an HDF5 file");
  return std::filesystem::path(files[0].name).stem().string();
}

std::size_t hdf5Kept(const Json& line) {
  const Json& fragments = line.at("fragments");
  return static_cast<std::size_t>(
      std::count_if(fragments.begin(), fragments.end(),
                    [](const Json& fragment) { return !fragment.value("withheld", false); }));
}

void Hdf5Lists::add(const std::string& group, const std::string& split,
                    const std::vector<std::pair<std::string, std::size_t>>& fractures) {
  std::vector<Fracture>& all = fractures_[split];
  objects_[group] = {split, all.size(), all.size() + fractures.size()};
  for (const auto& [name, fragments] : fractures) all.push_back({group + "/" + name, fragments});
}

std::optional<Hdf5Array> Hdf5Lists::redundantPieces(const std::string& group,
                                                    const std::string& fracture) const {
  const Range& own = objects_.at(group);
  const std::vector<Fracture>& all = fractures_.at(own.split);
  const std::size_t others = all.size() - (own.end - own.begin);
  if (redundant_ == 0 || others == 0) return {};
  const std::uint64_t item = sha256Number(group + "/" + fracture);
  std::set<std::pair<std::size_t, std::size_t>> drawn;
  std::vector<std::string> texts;
  // Fragments differ while there are enough: a few tries find a new one.
  for (std::uint64_t k = 0, tries = 0; k < redundant_; ++tries) {
    const std::uint64_t draw = randomBits(seed_, Stage::datasetRedundant, item + tries);
    std::size_t at = draw % others;
    if (at >= own.begin) at += own.end - own.begin;
    const std::size_t fragment = (draw >> 32) % all[at].fragments;
    if (!drawn.emplace(at, fragment).second && tries < 16 * redundant_) continue;
    texts.push_back(all[at].path);
    texts.push_back(hdf5Key(fragment, all[at].fragments));
    ++k;
  }
  return packedHdf5(texts, 2);
}

void Hdf5Lists::writeSplits(const std::string& stem, Hdf5Writer& writer) const {
  std::map<std::string, std::map<std::string, std::vector<std::string>>> lists;
  for (const auto& [group, range] : objects_) lists[group.substr(0, group.find('/'))];
  for (const auto& [split, fractures] : fractures_) {
    for (const Fracture& fracture : fractures) {
      lists[fracture.path.substr(0, fracture.path.find('/'))][split].push_back(fracture.path);
      lists[stem][split].push_back(fracture.path + "/pieces");
    }
  }
  lists[stem];
  // Empty lists too: a loader reads the list of each split.
  for (auto& [name, bySplit] : lists) {
    for (const char* split : kSplits) {
      writer.add("data_split/" + name + "/" + split, packedHdf5(bySplit[split]));
    }
  }
}

}  // namespace sherd
