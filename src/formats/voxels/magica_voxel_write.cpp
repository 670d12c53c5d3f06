// Writes labels as a MagicaVoxel scene, `.vox`, byte for byte as the paper's authors do.
//
//     "VOX " i32 150 | MAIN | SIZE XYZI of each cube | nTRN nGRP | nTRN nSHP of each cube
//
// The scene is cut into cubes of 126 voxels.  MagicaVoxel's z is up, as y is in the paper's grids:
// voxel (x, y, z) lies at (x, z, y).
//
// source  https://github.com/ephtracy/voxel-model: MagicaVoxel-file-format-vox.txt and its
// extension
#include <sherd/error.h>
#include <sherd/files.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "base/little_endian.h"
#include "formats/voxels/voxel_encoders.h"
#include "formats/voxels/voxel_runs.h"
#include "render/palette.h"

namespace sherd {
namespace {

constexpr int kSide = 126;
constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 29;  // at 4 bytes each, 2 GiB
constexpr int kColors = 255;                                   // 1..255; 0 is empty

/// The color of each label.
using Colors = std::array<std::uint8_t, 65536>;

struct LabelsInUse {
  std::set<std::uint16_t> labels;  // without 0
  std::uint64_t voxels = 0;
};

LabelsInUse labelsIn(const RunLengthVoxels& voxels) {
  LabelsInUse used;
  for (const Run& run : voxels.runs) {
    if (run.label == 0) continue;
    used.labels.insert(run.label);
    used.voxels += run.length;
  }
  return used;
}

// The paper has no color for solid voxels without a fragment. In files with such voxels colors are
// labels, and a palette marks this layout for readers.
bool hasPalette(const LabelsInUse& used) { return used.labels.contains(1); }

bool sharesColors(const LabelsInUse& used) {
  return !used.labels.empty() && *used.labels.rbegin() - (hasPalette(used) ? 0 : 1) > kColors;
}

/// For each label, the lower labels that share a voxel face with it.
using Neighbors = std::map<std::uint16_t, std::set<std::uint16_t>>;

void addPair(Neighbors& neighbors, std::uint16_t a, std::uint16_t b) {
  if (a == b || a == 0 || b == 0) return;
  neighbors[std::max(a, b)].insert(std::min(a, b));
}

void addColumnPairs(Neighbors& neighbors, const Columns& columns, int x, int y, int x2, int y2) {
  const Columns::Interval *a = columns.at(x, y), *b = columns.at(x2, y2);
  const Columns::Interval *endA = a + columns.count(x, y), *endB = b + columns.count(x2, y2);
  while (a < endA && b < endB) {
    addPair(neighbors, a->label, b->label);
    const int end = std::min(a->end, b->end);
    if (a->end == end) ++a;
    if (b->end == end) ++b;
  }
}

Neighbors adjacentLabels(const RunLengthVoxels& voxels) {
  const openvdb::Coord& dims = voxels.dims;
  if (static_cast<std::uint64_t>(dims.x()) * static_cast<std::uint64_t>(dims.y()) >
      Columns::kMost) {
    throw Error(ErrorCode::output,
                "a .vox of more than 255 fragments holds up to 2^25 columns; try .rle");
  }
  const Columns columns(voxels);
  Neighbors neighbors;
  for (int x = 0; x < dims.x(); ++x) {
    for (int y = 0; y < dims.y(); ++y) {
      const Columns::Interval* column = columns.at(x, y);
      for (std::size_t i = 1; i < columns.count(x, y); ++i) {
        addPair(neighbors, column[i - 1].label, column[i].label);
      }
      if (x > 0) addColumnPairs(neighbors, columns, x - 1, y, x, y);
      if (y > 0) addColumnPairs(neighbors, columns, x, y - 1, x, y);
    }
  }
  return neighbors;
}

// Assigns each label, in ascending order, the lowest color that no neighbor has.
void shareColors(const RunLengthVoxels& voxels, const LabelsInUse& used, Colors& colors) {
  const Neighbors neighbors = adjacentLabels(voxels);
  const int first = hasPalette(used) ? 2 : 1;
  for (const std::uint16_t label : used.labels) {
    if (label == 1) {
      colors[label] = 1;
      continue;
    }
    std::array<bool, kColors + 2> taken{};
    const auto found = neighbors.find(label);
    if (found != neighbors.end()) {
      for (const std::uint16_t lower : found->second) taken[colors[lower]] = true;
    }
    int color = first;
    while (taken[static_cast<std::size_t>(color)]) ++color;
    if (color > kColors) {
      throw Error(ErrorCode::output, "a .vox has 255 colors, and fragment " +
                                         std::to_string(label - 1) +
                                         " touches fragments of all of them; try .rle");
    }
    colors[label] = static_cast<std::uint8_t>(color);
  }
}

Colors colorsOf(const RunLengthVoxels& voxels, const LabelsInUse& used) {
  Colors colors{};
  if (sharesColors(used)) {
    shareColors(voxels, used, colors);
    return colors;
  }
  for (const std::uint16_t label : used.labels) {
    colors[label] = static_cast<std::uint8_t>(hasPalette(used) ? label : label - 1);
  }
  return colors;
}

// ---- Chunks

void storeInt(std::string& bytes, int value) {
  storeLittle(bytes, static_cast<std::uint32_t>(value));
}

void storeText(std::string& bytes, const std::string& text) {
  storeInt(bytes, static_cast<int>(text.size()));
  bytes += text;
}

std::string chunk(const char* id, const std::string& content, std::uint32_t childBytes = 0) {
  std::string bytes(id, 4);
  storeLittle(bytes, static_cast<std::uint32_t>(content.size()));
  storeLittle(bytes, childBytes);
  return bytes + content;
}

std::string numbers(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) storeInt(bytes, value);
  return bytes;
}

std::string transformChunk(int node, int child, int layer, const std::string& translation) {
  std::string content = numbers({node, /*attributes*/ 0, child, /*reserved*/ -1, layer,
                                 /*frames*/ 1, translation.empty() ? 0 : 1});
  if (!translation.empty()) {
    storeText(content, "_t");
    storeText(content, translation);
  }
  return chunk("nTRN", content);
}

std::string shapeChunk(int node, int model) {
  std::string content = numbers({node, /*attributes*/ 0, /*models*/ 1, model, /*attributes*/ 1});
  storeText(content, "_f");
  storeText(content, "0");
  return chunk("nSHP", content);
}

std::string paletteChunk() {
  std::string content;
  for (int color = 1; color <= 256; ++color) {
    const glm::vec3 linear = color == 1 ? glm::vec3(0.2f) : fragmentColor(color - 2).outer;
    for (int i = 0; i < 3; ++i) content.push_back(static_cast<char>(byteFromLinear(linear[i])));
    content.push_back(static_cast<char>(255));
  }
  return chunk("RGBA", content);
}

// ---- The scene

struct Cube {
  std::array<int, 3> index{};  // in cubes
  std::string voxels;          // u8 x, y, z, color of each
};

struct WrittenScene {
  std::vector<Cube> cubes;           // in the order of their first voxels
  std::array<int, 3> low{}, high{};  // voxels
};

WrittenScene sceneOf(const RunLengthVoxels& voxels, const Colors& colors) {
  WrittenScene scene;
  std::map<std::array<int, 3>, std::size_t> cubeAt;
  walkRows(voxels, [&](int x, int y, int z, int length, std::uint16_t label) {
    if (label == 0) return;
    Cube* cube = nullptr;
    for (int i = z; i < z + length; ++i) {
      const std::array<int, 3> at{x, i, y};
      if (cube == nullptr || i % kSide == 0) {
        const std::array<int, 3> index{at[0] / kSide, at[1] / kSide, at[2] / kSide};
        const auto [found, fresh] = cubeAt.try_emplace(index, scene.cubes.size());
        if (fresh) {
          if (scene.cubes.empty()) scene.low = scene.high = at;
          scene.cubes.push_back({index, {}});
        }
        cube = &scene.cubes[found->second];
      }
      for (std::size_t axis = 0; axis < 3; ++axis) {
        scene.low[axis] = std::min(scene.low[axis], at[axis]);
        scene.high[axis] = std::max(scene.high[axis], at[axis]);
        cube->voxels.push_back(static_cast<char>(at[axis] % kSide));
      }
      cube->voxels.push_back(static_cast<char>(colors[label]));
    }
  });
  return scene;
}

// The offset that centers the scene on the floor.
std::string translationOf(const WrittenScene& scene, const Cube& cube) {
  std::string text;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double at = (cube.index[axis] + 0.5) * kSide;
    if (axis < 2) at -= scene.low[axis] + (scene.high[axis] - scene.low[axis]) * 0.5;
    if (axis > 0) text += ' ';
    text += std::to_string(static_cast<int>(std::floor(at)));
  }
  return text;
}

}  // namespace

bool sharesColors(const RunLengthVoxels& voxels) { return sharesColors(labelsIn(voxels)); }

void encodeMagicaVoxel(const RunLengthVoxels& voxels, const ByteSink& sink) {
  const LabelsInUse used = labelsIn(voxels);
  if (used.voxels == 0 || used.voxels > kMostVoxels) {
    throw Error(ErrorCode::output,
                "a .vox holds 1 to 2^29 voxels, not " + std::to_string(used.voxels) + "; try .rle");
  }
  const WrittenScene scene = sceneOf(voxels, colorsOf(voxels, used));

  std::string nodes = transformChunk(0, 1, -1, "");
  std::string group = numbers({1, /*attributes*/ 0, static_cast<int>(scene.cubes.size())});
  std::string shapes;
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < scene.cubes.size(); ++i) {
    const int model = static_cast<int>(i), transform = 2 + 2 * model;
    storeInt(group, transform);
    shapes += transformChunk(transform, transform + 1, 0, translationOf(scene, scene.cubes[i])) +
              shapeChunk(transform + 1, model);
    bytes += 24 + 16 + scene.cubes[i].voxels.size();  // SIZE, then XYZI
  }
  nodes += chunk("nGRP", group) + shapes;
  if (hasPalette(used)) nodes += paletteChunk();

  std::string head("VOX ");
  storeInt(head, 150);
  sink(head + chunk("MAIN", "", static_cast<std::uint32_t>(bytes + nodes.size())));
  for (const Cube& cube : scene.cubes) {
    std::string count;
    storeInt(count, static_cast<int>(cube.voxels.size() / 4));
    sink(chunk("SIZE", numbers({kSide, kSide, kSide})) + chunk("XYZI", count + cube.voxels));
  }
  sink(nodes);
}

}  // namespace sherd
