// What shapes a dataset, as text: "--erode-iterations=0..3 --resolution=64".
#include "dataset/layouts/identity.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/text/option_text.h"
#include "dataset/layouts/pfpp.h"
#include "formats/arrays/hdf5_file.h"
#include "pipeline/fracture_stages.h"

namespace sherd {
namespace {

using Given = std::pair<std::string, std::string>;  // name and value

template <class Target>
void addRow(std::vector<Given>& given, const OptionRow<Target>& row, const Target& options,
            const Target& defaults) {
  const std::string text = row.value.text(options), usual = row.value.text(defaults);
  if (text == usual) return;
  if (!row.repeats) {
    given.emplace_back(row.name, text);
    return;
  }
  for (const std::string& one : split(text, ' ')) given.emplace_back(row.name, one);
}

DatasetOptions defaultsOf(DatasetLayout layout) {
  DatasetOptions defaults;
  if (layout == DatasetLayout::bb) defaults.each.write.meshFormats = {MeshFileFormat::obj};
  if (layout == DatasetLayout::pfpp) defaults.each.write.points.count = kPfppPointsEach;
  return defaults;
}

template <class Target>
bool sets(std::span<const OptionRow<Target>> rows, Target& options, const Given& given) {
  for (const OptionRow<Target>& row : rows) {
    if (row.hidden || row.name != given.first) continue;
    const bool isFlag = row.value.type == OptionType::flag;
    row.value.set(options, isFlag && given.second.empty() ? "true" : given.second);
    return true;
  }
  return false;
}

}  // namespace

DatasetOptions optionsOfIdentity(const std::string& identity) {
  std::vector<Given> all;
  for (const std::string& part : split(identity, ' ')) {
    const std::size_t equals = part.find('=');
    if (part.starts_with("--")) {
      all.emplace_back(part.substr(2, equals == std::string::npos ? equals : equals - 2),
                       equals == std::string::npos ? "" : part.substr(equals + 1));
    }
  }
  DatasetOptions options;
  const auto first = [](const Given& given) {
    return given.first == "preset" || given.first == "layout";
  };
  // The other options of a material are named where they are not those of no material.
  const auto setName = [&](const Given& given) {
    RunOptions named;
    fractureOption(given.first)->value.set(named, given.second);
    options.each.fracture.material = named.fracture.material;
  };
  std::stable_partition(all.begin(), all.end(), first);  // others override what these set
  for (const Given& given : all) {
    if (given.first == "layout") {
      (void)sets(datasetOptionTable(), options, given);
      const DatasetOptions defaults = defaultsOf(options.layout);
      options.each.write.meshFormats = defaults.each.write.meshFormats;
      options.each.write.points.count = defaults.each.write.points.count;
    } else if (given.first == "material") {
      setName(given);
    } else if (auto drawn = drawnOption(given.first, given.second)) {
      options.drawn.push_back(std::move(*drawn));
    } else if (!sets(datasetOptionTable(), options, given) &&
               !sets(fractureOptionTable(), options.each, given)) {
      throw Error(ErrorCode::usage, given.first + " is not an option");
    }
  }
  return options;
}

std::string datasetIdentity(const DatasetOptions& options) {
  std::vector<Given> given;
  const DatasetOptions defaults = defaultsOf(options.layout);
  for (const DatasetOptionRow& row : datasetOptionTable()) {
    if (*row.key != '\0') addRow(given, row, options, defaults);
  }
  for (const FractureOptionRow& row : fractureOptionTable()) {
    if (!row.hidden && !row.single) addRow(given, row, options.each, defaults.each);
  }
  for (const DrawnOption& option : options.drawn) given.emplace_back(option.name, option.text());
  std::stable_sort(given.begin(), given.end(),
                   [](const Given& a, const Given& b) { return a.first < b.first; });
  std::string text;
  for (const auto& [name, value] : given) {
    text += (text.empty() ? "--" : " --") + name + (value == "true" ? "" : "=" + value);
  }
  return text;
}

bool isIdentityOf(const DatasetOptions& options, const std::string& text) {
  const std::string own = datasetIdentity(options);
  if (text == own) return true;
  try {
    return datasetIdentity(optionsOfIdentity(text)) == own;
  } catch (const Error&) {
    return false;
  }
}

namespace {

void need(bool good, const char* sentence) {
  if (!good) throw Error(ErrorCode::usage, sentence);
}

void checkHdf5(const DatasetOptions& options) {
  constexpr int kMostLabels = 32767;  // of int16
  const std::string fault = hdf5Fault();
  if (!fault.empty()) {
    throw Error(ErrorCode::usage, "the layout hdf5 is not possible here: " + fault);
  }
  need(options.compression == FileCompression::none,
       "the layout hdf5 compresses arrays by itself; omit the other compression");
  need(options.each.fracture.surface.triangles.size() <= 1,
       "the layout hdf5 holds one mesh of each fragment; give one number of triangles");
  need(options.schedule.most <= kMostLabels, "the layout hdf5 holds at most 32767 pieces");
  need(options.redundantPieces <= kMaxRedundantPieces, "redundant pieces are in 0..64");
}

void checkPfpp(const DatasetOptions& options) {
  need(options.compression == FileCompression::none,
       "loaders of the layout pfpp read no compressed files; omit the compression");
  need(options.schedule.fewest >= 2 && options.schedule.most <= static_cast<int>(kPfppParts),
       "the layout pfpp holds 2 to 20 pieces; use a range within 2..20");
  need(options.each.write.points.count >= 1, "the layout pfpp holds points; ask for at least 1");
  need(fracturesOf(options.schedule).size() <= kPfppFractures,
       "the layout pfpp holds at most 8192 fractures of an object");
}

void checkAssemblages(const DatasetOptions& options) {
  const AssemblageOptions& asked = options.assemblage;
  need(asked.fewest >= 1 && asked.fewest <= asked.most && asked.most <= kMostObjects,
       "objects of an assemblage are a range within 1..1000");
  need(asked.intruders >= 0.0 && asked.intruders <= kMostObjects &&
           (asked.intruders < 1.0 || asked.intruders == std::floor(asked.intruders)),
       "intruders are a whole number up to 1000, or a share below 1");
  if (asked.most == 1) {
    need(asked.items == 0 && asked.intruders == 0.0,
         "items and intruders are those of assemblages, of two objects or more");
    return;
  }
  need(options.schedule.repeatsOfFewest == options.schedule.repeatsOfMost,
       "each assemblage is broken equally often; give one number of repeats");
  need(options.distinct == 0.0, "fractures of assemblages are not compared with each other");
  need(options.each.fracture.solid.voxelSize == 0.0,
       "objects of an assemblage have a longest side of 1; give a resolution");
  need(!options.each.recenter,
       "objects of an assemblage stand beside one another; recenter does not move them");
  const std::size_t most =
      static_cast<std::size_t>(options.schedule.most) * static_cast<std::size_t>(asked.most);
  need(most <= options.schedule.maxFragments,
       "an assemblage of the most objects, each in the most pieces, exceeds the most fragments of "
       "an object; ask for fewer, or give a greater max-fragments");
  const auto intruders = static_cast<std::size_t>(
      asked.intruders < 1.0 ? std::ceil(asked.intruders * static_cast<double>(most))
                            : asked.intruders);
  need(options.layout != DatasetLayout::pfpp || most + intruders <= kPfppParts,
       "the layout pfpp holds at most 20 pieces of all objects and intruders");
}

void check(const DatasetOptions& options) {
  const Schedule& schedule = options.schedule;
  need(schedule.fewest >= 1 && schedule.fewest <= schedule.most && schedule.most <= kMaxFragments,
       "pieces are a range from 1 up");
  need(schedule.repeatsOfFewest >= 0 && schedule.repeatsOfMost >= 0, "repeats are from 0 up");
  need(options.distinct >= 0.0 && options.distinct < 1.0,
       "the share in which fractures differ lies in 0..1");
  need(options.shard.of >= 1 && options.shard.number >= 1 &&
           options.shard.number <= options.shard.of,
       "a shard is i/N with i in 1..N");
  const auto& split = options.split;
  need(std::all_of(split.begin(), split.end(), [](int share) { return share >= 0; }) &&
           split[0] + split[1] + split[2] > 0,
       "a split is three shares, such as 80/10/10");
  need(options.layout != DatasetLayout::bb || options.each.write.meshFormats.size() == 1,
       "the layout bb takes one format of meshes");
  checkAssemblages(options);
  if (options.layout == DatasetLayout::hdf5) checkHdf5(options);
  if (options.layout == DatasetLayout::pfpp) checkPfpp(options);
  const FractureOptions& each = options.each.fracture;
  need(each.pieces == FractureOptions{}.pieces && each.seed == 0 && !each.seeds.given,
       "the pieces and seeds of a dataset are those of its schedule");
  checkOptions(each);
  for (const DrawnOption& option : options.drawn) checkDrawn(option, options.each);
}

}  // namespace

DatasetOptions checkedOptions(DatasetOptions options) {
  options.each.fracture.surface.surface = surfaceOfDataset(options.each.fracture);
  check(options);
  checkWriteOptions(options.each.write, optionsFor(options.each.fracture, options.each.write));
  WriteOptions& write = options.each.write;
  write.plainMeshes |= options.layout == DatasetLayout::bb;
  // Only what the layout holds is made.
  WriteOptions alone{.labels = false, .vdb = false, .mesh = false, .preview = false};
  alone.up = write.up;
  alone.metersPerUnit = write.metersPerUnit;
  if (options.layout == DatasetLayout::hdf5) {
    alone.mesh = true;
    write = alone;
  } else if (options.layout == DatasetLayout::pfpp) {
    alone.points = write.points;
    write = alone;
  }
  return options;
}

}  // namespace sherd
