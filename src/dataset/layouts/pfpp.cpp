// Writes the layout pfpp.
//
// source  Wang et al., PuzzleFusion++, 2024, and its loaders: generate_pc_data.py,
//         denoiser/dataset/dataset.py; the matches as Jigsaw_matching's matching_base_model.py
#include "dataset/layouts/pfpp.h"

#include <sherd/error.h>

#include <algorithm>
#include <map>

#include "base/files/sha256.h"
#include "base/little_endian.h"
#include "base/random.h"
#include "base/text/lower_case.h"
#include "dataset/journal/object_folder.h"
#include "dataset/layouts/pfpp_matches.h"
#include "folder/files/write_points.h"
#include "formats/arrays/npy_objects.h"

namespace sherd {
namespace {

std::string groupOf(const LibraryObject& object) { return objectFolder(DatasetLayout::bb, object); }

NpyArray number(const char* name, std::uint64_t value) {
  NpyArray array{name, "<i8", {}, {}};
  storeLittle(array.bytes, value);
  return array;
}

NpyArray wholes(const char* name, const std::vector<std::size_t>& values) {
  NpyArray array{name, "<i8", {values.size()}, {}};
  for (const std::size_t value : values) {
    storeLittle(array.bytes, static_cast<std::uint64_t>(value));
  }
  return array;
}

// Text of NumPy's type <U, of which `type` keeps the name.
NpyArray text(const char* name, const std::string& utf8, std::string& type) {
  std::u32string points;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto lead = static_cast<unsigned char>(utf8[i]);
    const std::size_t more = lead < 0xc0 ? 0 : lead < 0xe0 ? 1 : lead < 0xf0 ? 2 : 3;
    char32_t point = more == 0 ? lead : lead & (0x3fU >> more);
    for (std::size_t k = 1; k <= more; ++k) {
      const char next = i + k < utf8.size() ? utf8[i + k] : '\x80';
      point = point << 6 | (static_cast<unsigned char>(next) & 0x3fU);
    }
    points += point;
    i += more + 1;
  }
  type = "<U" + std::to_string(std::max<std::size_t>(points.size(), 1));
  NpyArray array{name, type, {}, {}};
  for (const char32_t point : points) {
    storeLittle(array.bytes, static_cast<std::uint32_t>(point > 0x10ffff ? 0xfffd : point));
  }
  if (points.empty()) array.bytes.assign(4, '\0');
  return array;
}

NpyArray positions(const char* name, std::vector<std::size_t> shape,
                   const std::vector<glm::vec3>& points) {
  NpyArray array{name, "<f4", std::move(shape), {}};
  array.bytes.reserve(points.size() * 12);
  for (const glm::vec3& p : points) {
    for (int axis = 0; axis < 3; ++axis) storeLittle(array.bytes, p[axis]);
  }
  return array;
}

/// The points of all fragments, one after another, as they are stored.
struct PartPoints {
  std::vector<glm::vec3> positions;
  std::vector<std::uint16_t> neighbor;
};

PartPoints sampled(const PfppFracture& fracture, const FractureResult& result,
                   const std::vector<std::size_t>& counts, std::uint64_t seed) {
  PartPoints all;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    PointOptions options = fracture.points;
    options.count = counts[i];
    options.seed = seed;
    const SurfacePoints points = pointsOf(result, i, options);
    for (const glm::dvec3& p : points.positions) {
      all.positions.emplace_back((p - fracture.center) * fracture.scale);
    }
    all.neighbor.insert(all.neighbor.end(), points.neighbor.begin(), points.neighbor.end());
  }
  return all;
}

// The graph of contacts, 20 by 20.
NpyArray graphOf(const FractureResult& result) {
  NpyArray graph{"graph", "|b1", {kPfppParts, kPfppParts}, {}};
  graph.bytes.assign(kPfppParts * kPfppParts, '\0');
  const std::size_t parts = result.kept();
  for (std::size_t i = 0; i < parts; ++i) {
    for (const Contact& contact : result.fragments[i].contacts) {
      const auto j = static_cast<std::size_t>(contact.fragment) - 1;
      if (contact.fragment <= 0 || j >= parts) continue;
      graph.bytes[i * kPfppParts + j] = graph.bytes[j * kPfppParts + i] = 1;
    }
  }
  return graph;
}

// The part whose coordinates spread most, as the loaders choose it.
NpyArray referenceOf(const std::vector<glm::vec3>& points, std::size_t parts) {
  NpyArray reference{"ref_part", "|b1", {kPfppParts}, std::string(kPfppParts, '\0')};
  const std::size_t each = points.size() / parts;
  std::size_t best = 0;
  float most = -1.0F;
  for (std::size_t i = 0; i < parts; ++i) {
    float low = points[i * each].x, high = low;
    for (std::size_t k = i * each; k < (i + 1) * each; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        low = std::min(low, points[k][axis]);
        high = std::max(high, points[k][axis]);
      }
    }
    if (high - low <= most) continue;
    most = high - low;
    best = i;
  }
  reference.bytes[best] = 1;
  return reference;
}

void writePoints(FileSink& sink, const std::string& file, const PfppFracture& fracture,
                 const FractureResult& result) {
  const std::size_t parts = result.kept(), each = fracture.points.count;
  const PartPoints points =
      sampled(fracture, result, std::vector<std::size_t>(parts, each), fracture.seed);
  NpyArray valid{"part_valids", "<f4", {kPfppParts}, {}};
  for (std::size_t i = 0; i < kPfppParts; ++i) storeLittle(valid.bytes, i < parts ? 1.0F : 0.0F);
  const std::size_t slash = fracture.path.find('/') + 1;
  const std::string category =
      lowerCase(fracture.path.substr(slash, fracture.path.find('/', slash) - slash));
  std::string pathType, categoryType;
  const NpyArray arrays[] = {number("data_id", fracture.id),
                             valid,
                             number("num_parts", parts),
                             text("mesh_file_path", fracture.path, pathType),
                             graphOf(result),
                             text("category", category, categoryType),
                             positions("part_pcs_gt", {parts, each, 3}, points.positions),
                             referenceOf(points.positions, parts)};
  writeNpz(OutputFile(sink, file), arrays);
}

// Each fragment gets kLeast points, and the others by area, as Jigsaw samples them.
std::vector<std::size_t> countsByArea(const FractureResult& result) {
  constexpr std::size_t kLeast = 30;
  const std::size_t parts = result.kept();
  std::vector<std::size_t> counts = sharedCounts(result, parts, kPfppPointsShared - kLeast * parts);
  for (std::size_t& count : counts) count += kLeast;
  return counts;
}

void writeMatches(FileSink& sink, const std::string& file, const PfppFracture& fracture,
                  const FractureResult& result) {
  const std::vector<std::size_t> counts = countsByArea(result);
  const PartPoints points =
      sampled(fracture, result, counts, randomBits(fracture.seed, Stage::datasetMatches, 0));
  const PfppMatching matching = pfppMatching(points.positions, points.neighbor, counts);
  const auto padded = [](std::vector<std::size_t> values) {
    values.resize(kPfppParts);
    return values;
  };
  NpyArray edges = wholes("edges", matching.edges);
  edges.shape = {matching.tables.size(), 2};
  // NumPy makes one table an array of three axes, which the loader expects.
  NpyArray matches{"correspondence", "<i8", {matching.tables.size(), 0, 2}, {}};
  if (matching.tables.size() == 1) {
    const std::vector<std::int64_t>& only = matching.tables.front().numbers;
    matches.shape[1] = only.size() / 2;
    for (const std::int64_t index : only) {
      storeLittle(matches.bytes, static_cast<std::uint64_t>(index));
    }
  } else if (matching.tables.size() > 1) {
    matches = npyObjects("correspondence", matching.tables);
  }
  const NpyArray arrays[] = {std::move(edges),
                             std::move(matches),
                             positions("gt_pcs", {kPfppPointsShared, 3}, points.positions),
                             wholes("critical_pcs_idx", matching.critical),
                             wholes("n_pcs", padded(counts)),
                             wholes("n_critical_pcs", padded(matching.criticalCounts))};
  writeNpz(OutputFile(sink, file), arrays);
}

}  // namespace

std::uint64_t pfppId(const LibraryObject& object, std::size_t fracture) {
  return (sha256Number(groupOf(object)) >> 14) * kPfppFractures + fracture;
}

PfppNames pfppNames(const LibraryObject& object, const std::string& split, std::size_t fracture) {
  const std::string group = groupOf(object), subset = group.substr(0, group.find('/'));
  std::string id = std::to_string(pfppId(object, fracture));
  if (id.size() < 5) id.insert(0, 5 - id.size(), '0');
  return {std::string(kPfppPointFolder) + "/" + subset + "/" + split + "/" + id + ".npz",
          std::string(kPfppMatchFolder) + "/" + subset + "/" +
              std::to_string(pfppId(object, fracture)) + ".npz"};
}

std::vector<std::string> pfppFilesOf(const LibraryObject& object, const std::string& split,
                                     std::size_t fractures) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < fractures; ++i) {
    PfppNames own = pfppNames(object, split, i);
    names.push_back(std::move(own.points));
    names.push_back(std::move(own.matches));
  }
  return names;
}

void requirePfppIds(const std::vector<LibraryObject>& objects) {
  std::map<std::uint64_t, const LibraryObject*> taken;
  for (const LibraryObject& object : objects) {
    const auto [other, isNew] = taken.emplace(pfppId(object, 0), &object);
    if (isNew) continue;
    throw Error(ErrorCode::input, object.key + " and " + other->second->key +
                                      " have the same number in the layout pfpp; rename one");
  }
}

void writePfpp(FileSink& sink, const PfppNames& names, const PfppFracture& fracture,
               const FractureResult& result) {
  if (result.kept() > kPfppParts) {
    throw Error(ErrorCode::input, "a fracture has " + std::to_string(result.kept()) +
                                      " fragments; the layout pfpp holds at most 20");
  }
  writePoints(sink, names.points, fracture, result);
  writeMatches(sink, names.matches, fracture, result);
}

}  // namespace sherd
