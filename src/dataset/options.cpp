// The options of a dataset beyond those of its fractures: one row each.
#include <sherd/dataset.h>
#include <sherd/error.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "base/text/option_names.h"
#include "base/text/option_text.h"
#include "options/values.h"

namespace sherd {
namespace {

using V = ValuesOf<DatasetOptions>;
using Row = DatasetOptionRow;
using D = const DatasetOptions&;

constexpr auto kDataset = [](auto& o) -> auto& { return o; };
constexpr auto kSchedule = [](auto& o) -> auto& { return o.schedule; };
constexpr auto kAssemblage = [](auto& o) -> auto& { return o.assemblage; };
constexpr auto kLibrary = [](auto& o) -> auto& { return o.library; };

std::string rangeText(int first, int last) {
  return std::to_string(first) + (first == last ? "" : ".." + std::to_string(last));
}

// "A" or "A..B"
std::pair<int, int> rangeFrom(const std::string& text, int least, int most) {
  const auto number = [&](const std::string& part) {
    try {
      return wholeFrom(part, least, most);
    } catch (const Error&) {
      refuseValue(text, "A or A..B of whole numbers in " + rangeText(least, most));
    }
  };
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) return {number(text), number(text)};
  return {number(text.substr(0, dots)), number(text.substr(dots + 2))};
}

std::pair<int, int> ascendingFrom(const std::string& text, int low, int high) {
  const std::pair<int, int> range = rangeFrom(text, low, high);
  if (range.first > range.second) refuseValue(text, "a range that ascends");
  return range;
}

void setPieces(DatasetOptions& o, const std::string& text) {
  std::tie(o.schedule.fewest, o.schedule.most) = ascendingFrom(text, 1, kMaxFragments);
}

void setRepeats(DatasetOptions& o, const std::string& text) {
  std::tie(o.schedule.repeatsOfFewest, o.schedule.repeatsOfMost) = rangeFrom(text, 0, 65535);
}

void setObjects(DatasetOptions& o, const std::string& text) {
  std::tie(o.assemblage.fewest, o.assemblage.most) = ascendingFrom(text, 1, kMostObjects);
}

void setIntruders(DatasetOptions& o, const std::string& text) {
  const auto value = numberIn(text);
  const bool good = value && *value >= 0.0 && *value <= kMostObjects &&
                    (*value < 1.0 || *value == std::floor(*value));
  if (!good) refuseValue(text, "a whole number of fragments up to 1000, or a share below 1");
  o.assemblage.intruders = *value;
}

void setSplit(DatasetOptions& o, const std::string& text) {
  const auto numbers = numbersIn(split(text, text.find('/') == std::string::npos ? ',' : '/'));
  std::array<int, 3> shares{};
  bool good = numbers && numbers->size() == shares.size();
  for (std::size_t i = 0; good && i < shares.size(); ++i) {
    const double share = (*numbers)[i];
    good = share >= 0.0 && share <= 1e6 && share == std::floor(share);
    if (good) shares[i] = static_cast<int>(share);
  }
  if (!good || shares == std::array<int, 3>{})
    refuseValue(text, "three whole shares, such as 80/10/10");
  o.split = shares;
}

void setShard(DatasetOptions& o, const std::string& text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto number = numberIn(text.substr(0, slash));
  const auto of = slash < text.size() ? numberIn(text.substr(slash + 1)) : std::nullopt;
  const bool good = number && of && *of >= 1 && *of <= 1'000'000 && *number >= 1 &&
                    *number <= *of && *number == std::floor(*number) && *of == std::floor(*of);
  if (!good) refuseValue(text, "i/N with i in 1..N");
  o.shard = {static_cast<int>(*number), static_cast<int>(*of)};
}

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();

const std::vector<Row> kScheduleRows{
    {.name = "pieces",
     .group = "Schedule",
     .value = V::custom(OptionType::text, "A..B", setPieces,
                        [](D o) { return rangeText(o.schedule.fewest, o.schedule.most); }),
     .help = "Number of fragments: every number of a range",
     .details = "every number of pieces",
     .key = "pieces"},
    {.name = "repeats",
     .group = "Schedule",
     .value = V::custom(
         OptionType::text, "A..B", setRepeats,
         [](D o) { return rangeText(o.schedule.repeatsOfFewest, o.schedule.repeatsOfMost); }),
     .help = "Fractures with the fewest pieces and with the most; in proportion between.  1 where "
             "--pieces is one number",
     .details = "fractures into the fewest pieces, and into the most; 1 where `--pieces` is one "
                "number, but with `--preset paper`",
     .key = "repeats"},
    {.name = "max-fragments",
     .group = "Schedule",
     .value = V::whole(kSchedule, &Schedule::maxFragments, 1, kUnlimited),
     .help = "Maximum number of fragments of one object",
     .details = "limit per object; the first fracture that would exceed it ends the "
                "object's schedule",
     .key = "max_fragments"},
    {.name = "seed",
     .group = "Schedule",
     .value =
         V::whole(kDataset, &DatasetOptions::seed, 0, std::numeric_limits<std::uint64_t>::max()),
     .help = "Seed of the run; fractures' own seeds are made from it and the mesh's content",
     .details = "seed of the run. The seed of a fracture is derived from it, the mesh "
                "file's content, the number of pieces, the repeat and the attempt, and is "
                "in the index: `sherd fracture` with it makes the same files",
     .key = "seed"},
    {.name = "distinct",
     .group = "Schedule",
     .value = V::number(kDataset, &DatasetOptions::distinct, between(0.0, 0.99, "0..0.99")),
     .help = "Least share of voxels in which fractures of one object differ; others are drawn "
             "again",
     .details = "least share of voxels in which two fractures of one object differ, with "
                "fragments matched greedily by overlap (on 131,072 evenly spaced voxels). "
                "A fracture below it is drawn again, at most 20 times; then the object "
                "fails",
     .key = "distinct"},
    {.name = "poses",
     .group = "Schedule",
     .value = V::flag(kDataset, &DatasetOptions::poses),
     .help = "A random pose of each fragment in the index",
     .key = "poses"},
    {.name = "split",
     .group = "Schedule",
     .value = V::custom(OptionType::text, "A/B/C", setSplit,
                        [](D o) {
                          return std::to_string(o.split[0]) + "/" + std::to_string(o.split[1]) +
                                 "/" + std::to_string(o.split[2]);
                        }),
     .help = "Shares of objects for train.txt, val.txt and test.txt",
     .details = "shares of objects in `train.txt`, `val.txt`, `test.txt`; by a hash of "
                "the path, so an object keeps its split when others are added",
     .key = "split"},
};

const std::vector<Row> kAssemblageRows{
    {.name = "objects",
     .group = "Assemblages",
     .value = V::custom(OptionType::text, "A..B", setObjects,
                        [](D o) { return rangeText(o.assemblage.fewest, o.assemblage.most); }),
     .help = "Objects that are mixed: a number, or a range of which one is drawn for each "
             "assemblage; 1: none are, with sherd assemblage 2..5",
     .details = "objects of each assemblage, drawn for each. 1: the library's objects are broken "
                "one by one. `sherd assemblage` has `2..5`",
     .key = "objects"},
    {.name = "items",
     .group = "Assemblages",
     .value = V::whole(kAssemblage, &AssemblageOptions::items, 0, 1'000'000),
     .help = "Assemblages; 0: as many as the library has meshes",
     .key = "items"},
    {.name = "intruders",
     .group = "Assemblages",
     .value = V::custom(OptionType::text, "k|share", setIntruders,
                        [](D o) { return shortestText(o.assemblage.intruders); }),
     .help = "Fragments of further objects, of like size: a number, or below 1 a share of the "
             "pieces",
     .details = "fragments of further objects, one of each: a number (from 1) or a share (below 1) "
                "of the pieces asked for. Each is the one whose volume is nearest to that of a "
                "fragment of the assemblage, which is drawn, within a factor of two where that "
                "can be; the ratio is in the manifest",
     .key = "intruders"},
};

const std::vector<Row> kRunRows{
    {.name = "match",
     .group = "Run",
     .value = V::string(kLibrary, &LibraryOptions::match, "PATTERN"),
     .help = "Only meshes whose path in the library matches a pattern, such as '*.ply'",
     .details = "only meshes whose path in the library matches the shell pattern; `*` "
                "also matches `/`"},
    {.name = "limit",
     .group = "Run",
     .value =
         V::whole(kLibrary, &LibraryOptions::limit, 1, std::numeric_limits<std::size_t>::max()),
     .help = "Only the first so many of these",
     .details = "only the first N of these"},
    {.name = "layout",
     .group = "Run",
     .value = V::choice(kDataset, &DatasetOptions::layout, names::kDatasetLayout),
     .help = "Files: a folder for each fracture, a ZIP file for each object, the paper's layout, "
             "Breaking Bad's, one HDF5 file, PuzzleFusion++'s",
     .key = "layout"},
    {.name = "compress",
     .group = "Run",
     .value = V::choice(kDataset, &DatasetOptions::compression, names::kFileCompression),
     .help = "How each file is packed; with --layout packed within the archive",
     .details = "each file separately; with `--layout packed` `none`, otherwise deflated "
                "within the archive",
     .key = "compress"},
    {.name = "removal",
     .group = "Run",
     .value = V::flag(kDataset, &DatasetOptions::removal),
     .help = "With --layout hdf5: an order in which fragments may be taken away",
     .details = "with `--layout hdf5`: `removal_masks` and `removal_order`, by which GARF takes "
                "fragments away (`num_removal`)",
     .key = "removal"},
    {.name = "redundant-pieces",
     .group = "Run",
     .value = V::whole(kDataset, &DatasetOptions::redundantPieces, 0, kMaxRedundantPieces),
     .help = "With --layout hdf5: fragments of other objects listed for each fracture",
     .details = "with `--layout hdf5`: fragments of other objects of the same split listed for "
                "each fracture, which GARF adds (`num_redundancy`)",
     .key = "redundant_pieces"},
    {.name = "resume",
     .group = "Run",
     .value = V::flag(kDataset, &DatasetOptions::resume),
     .help = "Continue an interrupted dataset",
     .details = "continue DIR. Options must be the same as before, except `--match`, "
                "`--limit`, `--shard`, `--verify`, `--device`, `--threads`, "
                "`--max-memory`, `--object-timeout` and output options"},
    {.name = "replace",
     .group = "Run",
     .value = V::flag(kDataset, &DatasetOptions::replace),
     .help = "Make the dataset in DIR anew, also with other options; the one that is there stays "
             "until the new one is complete, and an interrupted run is continued by the same "
             "command",
     .details = "make a dataset in place of the one in DIR, also with other options. It is made in "
                "`DIR/.sherd-replacing`, and takes the old one's place by renaming once it is "
                "complete: until then the old one stays as it is, whatever ends the run. Then the "
                "files of the old one are removed, and no others. The same command continues an "
                "interrupted run. Absent and empty folders are filled as without it; a folder with "
                "other files and no dataset is refused"},
    {.name = "viewers",
     .group = "Run",
     .value = V::flag(kDataset, &DatasetOptions::viewers),
     .help = "Link the report's images to pages that show the fracture",
     .details = "a page of the viewer ([viewer.md](viewer.md)) for each fracture of which "
                "`report.html` shows an image, at most 16, each of at most 4 MB; the image links "
                "to it"},
    {.name = "shard",
     .group = "Run",
     .value = V::custom(
         OptionType::text, "i/N", setShard,
         [](D o) { return std::to_string(o.shard.number) + "/" + std::to_string(o.shard.of); }),
     .help = "This machine's share of the work; sherd merge joins all shares",
     .details = "the i-th of N shards of about equal size in bytes; any number of "
                "machines may write below one DIR, and `sherd merge` makes the index"},
    {.name = "object-timeout",
     .group = "Run",
     .value = V::number(kDataset, &DatasetOptions::objectTimeout, aboveZero()),
     .help = "Seconds after which an object counts as failed; default never",
     .details = "time limit per object; default: never",
     .unit = "s"},
};

}  // namespace

std::span<const DatasetOptionRow> datasetOptionTable() {
  static const std::vector<Row> kTable = [] {
    std::vector<Row> all = kScheduleRows;
    all.insert(all.end(), kAssemblageRows.begin(), kAssemblageRows.end());
    all.insert(all.end(), kRunRows.begin(), kRunRows.end());
    return all;
  }();
  return kTable;
}

}  // namespace sherd
