// What assemblages are made of: objects, pieces and intruders.
#include "dataset/assemblage/draw.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <utility>

#include "base/files/sha256.h"
#include "dataset/layouts/split_of.h"

namespace sherd {
namespace {

// Returns a number that looks random: the same for the same arguments.
std::uint64_t hashed(const std::string& purpose, std::uint64_t seed, const std::string& key,
                     std::size_t a = 0, std::size_t b = 0) {
  return sha256Number(purpose + " " + std::to_string(seed) + " " + key + " " + std::to_string(a) +
                      " " + std::to_string(b));
}

// Returns first..last drawn by a number that looks random.
int drawn(int first, int last, std::uint64_t hash) {
  return first + static_cast<int>(hash % static_cast<std::uint64_t>(last - first + 1));
}

std::vector<int> piecesOf(const DatasetOptions& options, const std::string& key,
                          std::size_t objects, std::size_t repeat) {
  std::vector<int> pieces;
  for (std::size_t k = 0; k < objects; ++k) {
    pieces.push_back(drawn(options.schedule.fewest, options.schedule.most,
                           hashed("pieces", options.seed, key, repeat, k)));
  }
  return pieces;
}

std::size_t intrudersOf(const DatasetOptions& options, const std::vector<int>& pieces) {
  const double given = options.assemblage.intruders;
  if (given >= 1.0) return static_cast<std::size_t>(given);
  return static_cast<std::size_t>(
      std::floor(given * std::accumulate(pieces.begin(), pieces.end(), 0.0) + 0.5));
}

// Returns the most intruders that a fracture of an assemblage has.
std::size_t mostIntruders(const DatasetOptions& options, const std::string& key,
                          std::size_t objects) {
  std::size_t most = 0;
  for (int repeat = 0; repeat < options.schedule.repeatsOfFewest; ++repeat) {
    const auto pieces = piecesOf(options, key, objects, static_cast<std::size_t>(repeat));
    most = std::max(most, intrudersOf(options, pieces));
  }
  return most;
}

/// The objects among which those of an assemblage are drawn.
struct Pool {
  std::vector<const LibraryObject*> all;
  std::map<std::string, std::vector<const LibraryObject*>> bySplit;
};

Pool poolOf(const std::vector<LibraryObject>& objects, const DatasetOptions& options) {
  Pool pool;
  for (const LibraryObject& object : objects) {
    pool.bySplit[splitOf(object, options.split)].push_back(&object);
  }
  const std::size_t least = static_cast<std::size_t>(options.assemblage.fewest) +
                            (options.assemblage.intruders > 0.0 ? 1 : 0);
  std::string counts;
  for (const auto& [split, own] : pool.bySplit) {
    counts += (counts.empty() ? "" : ", ") + split + " has " + std::to_string(own.size());
    if (own.size() >= least) pool.all.insert(pool.all.end(), own.begin(), own.end());
  }
  if (!pool.all.empty()) return pool;
  throw Error(ErrorCode::input,
              "an assemblage needs " + std::to_string(least) +
                  " objects of one split, those of intruders included, and " + counts +
                  "; ask for fewer objects, give more meshes, or other shares of the splits",
              OptionNames{"objects", "split"});
}

/// Draws objects of a split, none twice, by the first steps of Fisher and Yates' shuffle: a library
/// of many objects is not shuffled for each assemblage.
class Drawing {
 public:
  explicit Drawing(const std::vector<const LibraryObject*>& from) : from_(from) {}

  [[nodiscard]] std::size_t left() const { return from_.size() - taken_; }

  /// Takes one of those that are left.
  ///   number  below left(); of the first one that is taken, its index
  const LibraryObject* take(std::size_t number) {
    const std::size_t place = taken_ + number;
    const std::size_t index = at(place);
    moved_[place] = at(taken_++);
    return from_[index];
  }

 private:
  [[nodiscard]] std::size_t at(std::size_t place) const {
    const auto found = moved_.find(place);
    return found == moved_.end() ? place : found->second;
  }

  const std::vector<const LibraryObject*>& from_;
  std::size_t taken_ = 0;
  std::map<std::size_t, std::size_t> moved_;  // index at a place, where it is another
};

LibraryObject drawnAssemblage(const Pool& pool, const DatasetOptions& options, std::size_t number) {
  const AssemblageOptions& asked = options.assemblage;
  char name[32];
  std::snprintf(name, sizeof name, "assemblage_%06zu", number);
  LibraryObject assemblage{.key = name, .folder = name, .file = {}, .bytes = 0};
  const LibraryObject* const first =
      pool.all[hashed("first", options.seed, name) % pool.all.size()];
  const std::vector<const LibraryObject*>& split = pool.bySplit.at(splitOf(*first, options.split));
  Drawing drawing(split);
  const auto takeNext = [&] {
    return drawing.take(hashed("other", options.seed, name, drawing.left()) % drawing.left());
  };
  const std::size_t most = split.size() - (asked.intruders > 0.0 ? 1 : 0);
  const auto count =
      std::min(most, static_cast<std::size_t>(
                         drawn(asked.fewest, asked.most, hashed("objects", options.seed, name))));
  const auto place = std::ranges::lower_bound(split, first);  // both are of one list
  assemblage.parts.push_back(*drawing.take(static_cast<std::size_t>(place - split.begin())));
  while (assemblage.parts.size() < count) assemblage.parts.push_back(*takeNext());
  assemblage.intruders = mostIntruders(options, name, count);
  const std::size_t further = std::min(assemblage.intruders, drawing.left());
  for (std::size_t k = 0; k < assemblage.intruders; ++k) {
    assemblage.parts.push_back(k < further ? *takeNext() : assemblage.parts[count + k % further]);
  }
  for (const LibraryObject& part : assemblage.parts) assemblage.bytes += part.bytes;
  return assemblage;
}

}  // namespace

std::vector<LibraryObject> drawnAssemblages(const std::vector<LibraryObject>& objects,
                                            const DatasetOptions& options) {
  const Pool pool = poolOf(objects, options);
  const std::size_t items =
      options.assemblage.items > 0 ? options.assemblage.items : objects.size();
  std::vector<LibraryObject> all;
  for (std::size_t i = 0; i < items; ++i) all.push_back(drawnAssemblage(pool, options, i));
  return all;
}

std::vector<AssemblageFracture> assemblageFractures(const LibraryObject& object,
                                                    const DatasetOptions& options) {
  std::vector<AssemblageFracture> all;
  std::size_t fragments = 0;
  const std::size_t objects = object.parts.size() - object.intruders;
  for (int repeat = 0; repeat < options.schedule.repeatsOfFewest; ++repeat) {
    AssemblageFracture own;
    own.pieces = piecesOf(options, object.key, objects, static_cast<std::size_t>(repeat));
    own.planned = {std::accumulate(own.pieces.begin(), own.pieces.end(), 0), repeat};
    fragments += static_cast<std::size_t>(own.planned.pieces);
    if (fragments > options.schedule.maxFragments) break;
    const std::size_t intruders = std::min(object.intruders, intrudersOf(options, own.pieces));
    for (std::size_t k = 0; k < intruders; ++k) {
      // At least two, so that an intruder is a fragment and no whole object.
      own.pieces.push_back(drawn(std::max(options.schedule.fewest, 2),
                                 std::max(options.schedule.most, 2),
                                 hashed("pieces", options.seed, object.key,
                                        static_cast<std::size_t>(repeat), objects + k)));
    }
    all.push_back(std::move(own));
  }
  return all;
}

std::vector<PlannedFracture> fracturesOf(const LibraryObject& object,
                                         const DatasetOptions& options) {
  if (object.parts.empty()) return fracturesOf(options.schedule);
  std::vector<PlannedFracture> planned;
  for (AssemblageFracture& own : assemblageFractures(object, options)) {
    planned.push_back(own.planned);
  }
  return planned;
}

std::vector<LibraryObject> plannedObjects(const std::vector<LibraryObject>& found,
                                          const DatasetOptions& options) {
  return options.assemblage.most > 1 ? drawnAssemblages(found, options) : found;
}

}  // namespace sherd
