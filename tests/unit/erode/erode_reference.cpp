// Erosion, the plain way.
#include "unit/erode/erode_reference.h"

#include <openvdb/tools/Morphology.h>

#include <algorithm>
#include <cmath>

namespace sherd::erode_reference {
namespace {

using openvdb::Coord;
using Voxels = std::map<Coord, int>;

constexpr int kOutside = -1;

// Labels of a box, because a map is too slow for 13^3 cells a voxel.
class Box {
 public:
  explicit Box(const Voxels& voxels) : labels_(kSide * kSide * kSide, kOutside) {
    for (const auto& [voxel, label] : voxels) labels_[voxelIndex(voxel)] = label;
  }
  int at(const Coord& voxel) const { return labels_[voxelIndex(voxel)]; }

 private:
  static constexpr std::size_t kSide = 32;  // solids within 9 of the origin, cells 6 further
  static std::size_t voxelIndex(const Coord& v) {
    const auto shifted = [](int c) { return static_cast<std::size_t>(c + 16); };
    return (shifted(v.x()) * kSide + shifted(v.y())) * kSide + shifted(v.z());
  }
  std::vector<int> labels_;
};

bool inShape(ErodeShape shape, int reach, const Coord& c) {
  const int axes = (c.x() != 0) + (c.y() != 0) + (c.z() != 0);
  if (shape == ErodeShape::cross) return axes < 2;
  if (shape == ErodeShape::ellipse) return c.asVec3i().lengthSqr() <= reach * reach;
  return true;
}

std::vector<Coord> cube(int reach) {
  std::vector<Coord> cells;
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      for (int z = -reach; z <= reach; ++z) cells.push_back({x, y, z});
    }
  }
  return cells;
}

// One list of cells, or three: the voxel is worn where one of them is filled too little.
std::vector<std::vector<Coord>> shapes(const ErodeOptions& options) {
  std::vector<std::vector<Coord>> all(options.planes ? 3 : 1);
  const int reach = static_cast<int>(options.size.voxels) / 2;
  for (const Coord& cell : cube(reach)) {
    if (!inShape(options.shape, reach, cell)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (options.planes && cell[axis] == 0) all[static_cast<std::size_t>(axis)].push_back(cell);
    }
    if (!options.planes) all[0].push_back(cell);
  }
  return all;
}

bool isTested(const Box& box, const Coord& voxel, int label, ErodeOn on) {
  static const std::vector<Coord> round = cube(1);
  for (const Coord& step : round) {
    const int other = box.at(voxel + step);
    if (other != label && (on == ErodeOn::all || other != kOutside)) return true;
  }
  return false;
}

bool isFilledTooLittle(const Box& box, const Coord& voxel, int label, const ErodeOptions& options,
                       const std::vector<Coord>& cells) {
  int filled = 0;
  for (const Coord& cell : cells) {
    const int other = box.at(voxel + cell);
    filled += other == label || (options.on == ErodeOn::fracture && other == kOutside);
  }
  // threshold is a whole number of hundredths in our tests
  return filled * 100 <
         static_cast<int>(std::lround(options.threshold * 100)) * static_cast<int>(cells.size());
}

std::set<Coord> erodedOnce(const Voxels& voxels, const Box& box, int fragment,
                           const ErodeOptions& options) {
  const std::vector<std::vector<Coord>> all = shapes(options);
  std::set<Coord> eroded;
  for (const auto& [voxel, label] : voxels) {
    if (label != fragment || !isTested(box, voxel, label, options.on)) continue;
    for (const std::vector<Coord>& cells : all) {
      if (isFilledTooLittle(box, voxel, label, options, cells)) eroded.insert(voxel);
    }
  }
  return eroded;
}

std::set<Coord> voxelsOf(const Voxels& voxels, int fragment) {
  std::set<Coord> own;
  for (const auto& [voxel, label] : voxels) {
    if (label == fragment) own.insert(voxel);
  }
  return own;
}

// All but the largest 6-connected part; of equal ones that with the first voxel in leaf order
// stays.
std::set<Coord> islands(const std::set<Coord>& fragment) {
  const auto first = [](const std::set<Coord>& component) {
    return *std::min_element(component.begin(), component.end(), voxel_shapes::leafOrder);
  };
  std::set<Coord> rest = fragment, largest;
  while (!rest.empty()) {
    std::set<Coord> component;
    std::vector<Coord> open{*rest.begin()};
    while (!open.empty()) {
      const Coord voxel = open.back();
      open.pop_back();
      if (!rest.erase(voxel)) continue;
      component.insert(voxel);
      for (const Coord& n : voxel_shapes::neighbors(voxel)) open.push_back(n);
    }
    if (component.size() > largest.size() ||
        (component.size() == largest.size() &&
         voxel_shapes::leafOrder(first(component), first(largest)))) {
      largest = component;
    }
  }
  std::set<Coord> others;
  std::set_difference(fragment.begin(), fragment.end(), largest.begin(), largest.end(),
                      std::inserter(others, others.end()));
  return others;
}

}  // namespace

Labeled labeled(const voxel_shapes::VoxelSolid& solid, int fragments,
                const std::function<int(const Coord&)>& labelOf) {
  Labeled made{solid.name, {}, {}};
  made.labels.blocks = voxel_shapes::blocksOf(solid);
  made.labels.fragmentCount = fragments;
  made.labels.fragment.resize(made.labels.blocks->count() * 512);
  for (const Coord& voxel : solid.exteriorBand) {
    made.labels.fragment[voxel_shapes::voxelIndexOf(*made.labels.blocks, voxel)] = 1;
  }
  for (const Coord& voxel : solid.inside) {
    made.voxels[voxel] = labelOf(voxel);
    made.labels.fragment[voxel_shapes::voxelIndexOf(*made.labels.blocks, voxel)] =
        static_cast<std::uint16_t>(labelOf(voxel));
  }
  return made;
}

std::vector<Labeled> all() {
  // Blobs round points, then a salt of labels: 0 is a voxel that no seed reached.
  const auto blob = [](const Coord& v) {
    const std::vector<Coord> points{{-5, 1, 2}, {4, 4, -3}, {0, -6, 1}, {3, -2, 6}, {-1, 5, 5}};
    const auto nearest = std::min_element(points.begin(), points.end(), [&](auto& a, auto& b) {
      return (v - a).asVec3i().lengthSqr() < (v - b).asVec3i().lengthSqr();
    });
    return static_cast<int>(nearest - points.begin()) + 1;
  };
  const auto salt = [](const Coord& v) { return (v.x() * 7 + v.y() * 5 + v.z() * 3 + 500) % 4; };
  return {labeled(voxel_shapes::ball(6), 5, blob), labeled(voxel_shapes::cup(8, 3), 5, blob),
          labeled(voxel_shapes::sparseRandom(5, 80, 3), 5, blob),
          labeled(voxel_shapes::sparseRandom(5, 45, 4), 3, salt)};
}

Voxels erode(const Labeled& solid, const ErodeOptions& options) {
  Voxels voxels = solid.voxels;
  const auto take = [&](int fragment, const std::set<Coord>& eroded, Voxels& from) {
    if (eroded.size() == voxelsOf(voxels, fragment).size()) return;
    for (const Coord& voxel : eroded) from[voxel] = Labels::kEroded;
  };
  for (int iteration = 0; iteration < options.iterations.voxels; ++iteration) {
    const Box box(voxels);
    Voxels next = voxels;
    for (int id = 1; id <= solid.labels.fragmentCount; ++id)
      take(id, erodedOnce(voxels, box, id, options), next);
    voxels = next;
  }
  for (int id = 1; id <= solid.labels.fragmentCount && options.islands == Islands::eroded; ++id) {
    take(id, islands(voxelsOf(voxels, id)), voxels);
  }
  return voxels;
}

std::set<Coord> erodedByOpenVdb(const Labeled& solid, int fragment, bool by26) {
  openvdb::MaskTree tree;
  for (const Coord& voxel : voxelsOf(solid.voxels, fragment)) tree.setValueOn(voxel);
  openvdb::tools::erodeActiveValues(
      tree, 1, by26 ? openvdb::tools::NN_FACE_EDGE_VERTEX : openvdb::tools::NN_FACE);
  std::set<Coord> left;
  for (auto voxel = tree.cbeginValueOn(); voxel; ++voxel) left.insert(voxel.getCoord());
  return left;
}

}  // namespace sherd::erode_reference
