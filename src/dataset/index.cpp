// The index of a dataset.
#include "dataset/index.h"

#include <sherd/error.h>

#include <algorithm>
#include <map>
#include <span>

#include "base/cancel_flag.h"
#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/files/sha256.h"
#include "base/version.h"
#include "dataset/journal/journal.h"
#include "dataset/journal/object_folder.h"
#include "dataset/layouts/bb_lists.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/layouts/hdf5_join.h"
#include "dataset/layouts/hdf5_lists.h"
#include "dataset/layouts/hdf5_part.h"
#include "dataset/layouts/split_of.h"
#include "dataset/recipe/recipe.h"
#include "dataset/report/thumbnails.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

/// Writes a file line by line.
class LineWriter {
 public:
  explicit LineWriter(const fs::path& file) : file_(file) {}
  void add(const std::string& line) {
    bytes_ += line;
    bytes_ += '\n';
    if (bytes_.size() < (std::size_t{1} << 20)) return;
    file_.write(bytes_);
    bytes_.clear();
  }
  void commit() {
    file_.write(bytes_);
    file_.commit();
  }

 private:
  AtomicFile file_;
  std::string bytes_;
};

std::string textOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// A field of a CSV file (RFC 4180).
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

std::string joinedBy(const Json& list, const char* separator) {
  std::string all;
  for (const Json& one : list) {
    if (!all.empty()) all += separator;
    all += one.is_string()  ? one.get<std::string>()
           : one.is_array() ? joinedBy(one, ":")
                            : textOf(one);
  }
  return all;
}

// The columns of index.csv, each a key of a row.  The last is present only if an object has it.
constexpr std::array kColumns{
    "object",         "fracture",          "id",     "pieces", "repeat", "attempt",  "seed",
    "split",          "options",           "voxels", "share",  "volume", "vertices", "faces",
    "contacts",       "withheld",          "labels", "files",  "sha256", "rotation", "center",
    "truth_rotation", "truth_translation", "folder"};

// Those that the rows of assemblages have besides.
constexpr std::array kAssemblageColumns{"mesh",     "mesh_number", "mesh_seed",
                                        "intruder", "scale",       "translation"};

bool hasAssemblages(const DatasetPlan& plan) {
  return std::any_of(plan.objects.begin(), plan.objects.end(),
                     [](const auto& object) { return !object.parts.empty(); });
}

std::vector<const char*> columnsOf(const DatasetPlan& plan) {
  const bool hasRenamed = std::any_of(plan.objects.begin(), plan.objects.end(), isRenamed);
  std::vector<const char*> columns(kColumns.begin(), kColumns.end() - (hasRenamed ? 0 : 1));
  if (hasAssemblages(plan)) {
    columns.insert(columns.end(), kAssemblageColumns.begin(), kAssemblageColumns.end());
  }
  return columns;
}

std::string csvHead(std::span<const char* const> columns) {
  std::string head;
  for (const char* column : columns) head += (head.empty() ? "" : ",") + std::string(column);
  return head;
}

std::string csvOf(const Json& row, std::span<const char* const> columns) {
  std::string line;
  for (const char* column : columns) {
    if (column != columns.front()) line += ',';
    const auto found = row.find(column);
    if (found == row.end() || found->is_null()) continue;
    if (std::string_view(column) == "options") {
      if (!found->empty()) line += quoted(textOf(*found));
    } else if (found->is_array()) {
      line += quoted(joinedBy(*found, ";"));
    } else {
      line += found->is_string() ? quoted(found->get<std::string>()) : textOf(*found);
    }
  }
  return line;
}

// Where a fragment is in the HDF5 file of its fracture: the parts are removed.
std::string hdf5Piece(const LibraryObject& object, const Json& line, const Json& fragment) {
  std::string path = hdf5Group(object) + "/" + hdf5Name(line);
  if (line.at("fracture") == kWholeName) return path;
  // Ids ascend, and those of fragments that are withheld are the last.
  const auto index = fragment.at("id").get<std::size_t>() - 1;
  return path + "/pieces/" + hdf5Key(index, hdf5Kept(line));
}

// Adds the object of an assemblage that a fragment is of.
void addObjectOfFragment(Json& row, const Json& line, const Json& number) {
  const Json& object = line.at("objects").at(number.get<std::size_t>());
  row["mesh"] = object.at("mesh");
  row["mesh_number"] = number;
  row["mesh_seed"] = object.at("seed");
  row["intruder"] = object.value("intruder", false);
  row["scale"] = object.at("scale");
  row["translation"] = object.at("translation");
}

// The row of a fragment.
Json rowOf(const DatasetPlan& plan, const LibraryObject& object, const std::string& split,
           const Json& line, const Json& fragment) {
  std::map<std::string, std::string> sums;
  for (const FileRecord& file : filesOf(line)) sums[file.name] = file.sha256;
  Json row = {{"object", object.key},
              {"fracture", line.at("fracture")},
              {"id", fragment.at("id")},
              {"pieces", line.at("pieces")},
              {"repeat", line.at("repeat")},
              {"attempt", line.at("attempt")},
              {"seed", line.at("seed")},
              {"split", split},
              {"options", line.at("options")},
              {"voxels", fragment.at("voxels")},
              {"share", fragment.at("share")},
              {"volume", fragment.at("volume")},
              {"vertices", fragment.at("vertices")},
              {"faces", fragment.at("faces")},
              {"contacts", fragment.at("contacts")},
              {"withheld", fragment.value("withheld", false)},
              {"labels", line.at("labels")},
              {"files", fragment.at("files")},
              {"sha256", Json::array()}};
  if (plan.layout == DatasetLayout::hdf5) {
    if (!fragment.at("files").empty()) row["files"] = {hdf5Piece(object, line, fragment)};
  } else {
    for (const Json& file : fragment.at("files")) row["sha256"].push_back(sums[file]);
  }
  if (fragment.contains("object")) addObjectOfFragment(row, line, fragment.at("object"));
  if (fragment.contains("pose")) row.update(fragment.at("pose"));
  if (line.contains("offset")) row["offset"] = line.at("offset");
  const bool isTree = plan.layout != DatasetLayout::hdf5 && plan.layout != DatasetLayout::pfpp;
  if (isRenamed(object))
    row["folder"] = objectFolder(isTree ? plan.layout : DatasetLayout::bb, object);
  return row;
}

std::string failureLine(const std::string& key, const std::string& reason) {
  return textOf({{"object", key}, {"reason", reason}});
}

}  // namespace

namespace {

// Layouts that programs of others read: an empty split gives no error there.
bool isForLoaders(DatasetLayout layout) {
  return layout == DatasetLayout::bb || layout == DatasetLayout::hdf5 ||
         layout == DatasetLayout::pfpp;
}

DatasetSummary summaryOf(const DatasetStatistics& statistics, bool complete) {
  DatasetSummary summary;
  summary.objects = statistics.objects;
  summary.failures = statistics.failures.size();
  summary.fractures = statistics.fractures;
  summary.fragments = statistics.fragments;
  for (const auto& [format, files] : statistics.byFormat) {
    summary.bytes += files.bytes;
    summary.bytesByFormat[format] = files.bytes;
  }
  summary.complete = complete;
  return summary;
}

}  // namespace

namespace {

// Adds the images of a fracture to those of the report.
void addThumbnail(const fs::path& out, const LibraryObject& object, const std::string& name,
                  DatasetStatistics& statistics) {
  const std::string image = thumbnailName(object, name);
  if (!isOwnFile(out, image)) return;
  const std::string viewer = viewerName(object, name);
  statistics.thumbnails.push_back(
      {object.key + ", " + name, out / image, isOwnFile(out, viewer) ? viewer : std::string()});
}

}  // namespace

DatasetIndex writeIndex(const fs::path& out, const DatasetPlan& plan, const Progress* progress) {
  DatasetStatistics statistics;
  bool complete = true;
  LineWriter csv(out / kIndexCsv), jsonl(out / kIndexJsonl), failures(out / kFailuresName);
  const std::vector<const char*> columns = columnsOf(plan);
  csv.add(csvHead(columns));
  std::map<std::string, std::string> lists;  // keys, by split
  std::vector<BbObject> bb;
  DatasetRecipe recipe{
      .program = SHERD_VERSION, .options = plan.text, .drawn = {}, .meshes = {}, .objects = {}};
  for (std::size_t i = 0; i < plan.objects.size(); ++i) {
    throwIfCancelled(progress);
    const LibraryObject& object = plan.objects[i];
    const JournalText journal = readJournal(out, object);
    addObject(recipe, object, journal);
    if (journal.failed) {
      failures.add(failureLine(object.key, journal.failed->reason));
      statistics.failures.emplace_back(object.key, journal.failed->reason);
      continue;
    }
    if (!journal.done) {
      complete = false;
      continue;
    }
    ++statistics.objects;
    const std::string split = splitOf(object, plan.split);
    lists[split] += object.key + "\n";
    BbObject own{objectFolder(plan.layout, object), split, {}};
    for (const Json& line : journal.fractures) {
      const std::size_t before = statistics.fragments;
      statistics.add(line);
      const std::string name = line.at("fracture");
      if (name != kWholeName) own.fragmentCounts.push_back(statistics.fragments - before);
      for (const Json& fragment : line.at("fragments")) {
        const Json row = rowOf(plan, object, split, line, fragment);
        csv.add(csvOf(row, columns));
        jsonl.add(textOf(row));
      }
      if (hasThumbnail(i, plan.objects.size())) addThumbnail(out, object, name, statistics);
    }
    bb.push_back(std::move(own));
  }
  const Uncut whole;  // these files belong together
  csv.commit();
  jsonl.commit();
  failures.commit();
  if (!hasAssemblages(plan)) {
    requireOwnFile(out, kRecipeName);
    writeWhole(out / kRecipeName, recipeText(recipe));
  }
  for (const char* split : {"train", "val", "test"}) {
    writeWhole(out / (std::string(split) + ".txt"), lists[split]);
  }
  DatasetSummary summary = summaryOf(statistics, complete);
  if (isForLoaders(plan.layout)) summary.warnings = fewObjects(bb, plan.split);
  if (plan.layout == DatasetLayout::bb) {
    for (std::string& kept : writeBbLists(out, bb)) summary.warnings.push_back(std::move(kept));
  }
  return {std::move(summary), std::move(statistics)};
}

}  // namespace sherd
