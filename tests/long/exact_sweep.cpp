// Fractures of random shapes and of real meshes with Surface::exact, each checked.
//
// usage: sherd_exact_sweep COUNT SEED [MESH...]    (SHERD_TEST_DATA's closed meshes, by default)
//
// Prints the share of fall-backs by class of input, their reasons and all faults; ends with status
// 1 where there is a fault.
#include <openvdb/openvdb.h>
#include <sherd/sherd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "exact_checks.h"
#include "intersect/self_crossings.h"
#include "mesh/positions.h"
#include "mesh/repair/repair.h"
#include "remesh/bodies.h"
#include "remesh/parts/part_edges.h"
#include "shapes.h"
#include "voxelize/shell_mesh.h"

namespace {

using namespace sherd;

// A mesh as exact surfaces cut it.
struct Input {
  std::string name;
  TriangleMesh mesh;
  TriangleMesh clean{};  // repaired
  bool crossesItself = false;
  double unionVolume = 0.0;           // of several bodies; 0: one surface
  std::vector<std::uint32_t> body{};  // [triangles] of bodies that are kept; empty: they are united
  std::vector<double> volumes{};      // [bodies]
};

Input inputOf(std::string name, TriangleMesh mesh) {
  Input input{std::move(name), std::move(mesh), {}};
  const Repaired repair = repaired(input.mesh);
  input.clean = {input.mesh.vertices, input.mesh.triangles};
  for (std::size_t t = 0; t < repair.source.size(); ++t) {
    input.clean.triangles[repair.source[t]] = repair.mesh.triangles[t];
  }
  input.crossesItself = !selfCrossings(repair.mesh.vertices, repair.mesh.triangles).empty();
  return input;
}

struct Tally {
  int runs = 0, fallBacks = 0, partly = 0, faults = 0;
  std::map<std::string, int> reasons;
};

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
int whole(std::mt19937_64& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

TriangleMesh randomShape(std::mt19937_64& random, std::string& name) {
  switch (whole(random, 0, 5)) {
    case 0:
      name = "cube";
      return shapes::cube(uniform(random, 0.5, 3.0));
    case 1:
      name = "ball";
      return shapes::ball(1.0, whole(random, 1, 5));
    case 2:
      name = "torus";
      return shapes::torus(2.0, uniform(random, 0.2, 1.0), whole(random, 12, 96),
                           whole(random, 8, 48));
    case 3:
      name = "cup";
      return shapes::cup(1.0, uniform(random, 0.03, 0.3), uniform(random, 0.5, 3.0), 0.2,
                         whole(random, 8, 96));
    case 4:
      name = "hollow ball";
      return shapes::hollowBall(1.0, uniform(random, 0.3, 0.9), whole(random, 2, 4));
    default:
      name = "two parts";
      return shapes::append(shapes::ball(1.0, 3, {-1.5, 0, 0}), shapes::cube(1.2, {1, 0, 0}));
  }
}

TriangleMesh boxAt(const glm::dvec3& low, const glm::dvec3& sides) {
  return shapes::transformed(shapes::box(sides), 1.0, low + sides / 2.0);
}

// A row or a wall of equal boxes.
TriangleMesh boxes(const glm::dvec3& sides, const glm::dvec3& gap, const glm::ivec3& count) {
  TriangleMesh all;
  for (int i = 0; i < count.x * count.y * count.z; ++i) {
    const glm::dvec3 cell(i % count.x, i / count.x % count.y, i / count.x / count.y);
    all = shapes::append(all, boxAt(cell * (sides + gap), sides));
  }
  return all;
}

TriangleMesh turned(TriangleMesh mesh, std::mt19937_64& random) {
  const glm::dquat turn =
      glm::normalize(glm::dquat(uniform(random, 0.1, 1), uniform(random, -1, 1),
                                uniform(random, -1, 1), uniform(random, -1, 1)));
  for (glm::dvec3& v : mesh.vertices) v = turn * v;
  return mesh;
}

// Open meshes, with the volume that they have once they are closed.
Input randomOpen(std::mt19937_64& random, int resolution) {
  const double a = uniform(random, 0.1, 0.9), b = uniform(random, 0.1, 0.9), side = 3.0;
  if (whole(random, 0, 1) == 0) {
    TriangleMesh open = turned(boxAt({0, 0, 0}, {1 + a, 1, 1 + b}), random);
    open.triangles.resize(open.triangles.size() - 2);  // without one of its sides
    return {.name = "an open box", .mesh = std::move(open), .unionVolume = (1 + a) * (1 + b)};
  }
  // A shell, 2.5 voxels thick, but for a fold so sharp that its miter is cut off.
  const double below = std::hypot(a, b), above = std::hypot(1 - a, b);  // of the fold
  const double cosine = (b * b - a * (1 - a)) / (below * above);        // of the angle between them
  const double atFold = std::min(1.0, kMostMiter * std::sqrt((1 - cosine) / 2));
  const double mean = (1 + atFold) / 2 * 2.5 * side / resolution;
  return {.name = "a fold",
          .mesh = {{{0, 0, 0}, {side, 0, 0}, {side, a, b}, {0, a, b}, {0, 1, 0}, {side, 1, 0}},
                   {{0, 1, 2}, {0, 2, 3}, {3, 2, 5}, {3, 5, 4}}},
          .unionVolume = side * (below + above) * mean};
}

// Bodies that touch, overlap, lie within each other, or have gaps of 0.01 to 2 voxels, with the
// volume of their union.
Input randomBodies(std::mt19937_64& random, int resolution) {
  const double a = uniform(random, 0.1, 0.9), b = uniform(random, 0.1, 0.9);
  const double voxel = 3.0 / resolution;
  const double gap = voxel * std::exp(uniform(random, std::log(0.01), std::log(2.0)));
  const TriangleMesh unit = boxAt({0, 0, 0}, {1, 1, 1});
  switch (whole(random, 0, 9)) {
    case 0:
      return {.name = "near boxes",
              .mesh = turned(boxes({1, 1, 1}, glm::dvec3(gap), {3, 2, 1}), random),
              .unionVolume = 6.0};
    case 1:
      return {.name = "near cards",
              .mesh = turned(boxes({3, 3, 3 * voxel}, {0, 0, gap}, {1, 1, 5}), random),
              .unionVolume = 5 * 27 * voxel};
    case 2:
      return {.name = "a ball in a hollow one",
              .mesh = shapes::append(shapes::hollowBall(1.5, 1.1, 3), shapes::ball(1.1 - gap, 3)),
              .unionVolume =
                  volume(shapes::hollowBall(1.5, 1.1, 3)) + volume(shapes::ball(1.1 - gap, 3))};
    case 3:
      return {.name = "touching boxes",
              .mesh = boxes({1, 0.5, a}, {0, 0, 0}, {3, 2, 2}),
              .unionVolume = 6 * a};
    case 4:
      return {.name = "overlapping boxes",
              .mesh = turned(shapes::append(unit, boxAt({a, b, 0.5 * a}, {1, 1, 1})), random),
              .unionVolume = 2.0 - (1 - a) * (1 - b) * (1 - 0.5 * a)};
    case 5:
      return {
          .name = "a leg on a seat",
          .mesh = shapes::append(boxAt({0, 0, 1}, {2, 2, 0.3}), boxAt({a, b, 0}, {0.4, 0.4, 1})),
          .unionVolume = 1.2 + 0.16};
    case 6:
      return {.name = "a box within another",
              .mesh = turned(shapes::append(unit, boxAt(glm::dvec3(0.3 * a), glm::dvec3(0.6 * b))),
                             random),
              .unionVolume = 1.0};
    case 7:
      return {.name = "equal boxes", .mesh = shapes::append(unit, unit), .unionVolume = 1.0};
    case 8:
      return {.name = "boxes at an edge",
              .mesh = shapes::append(unit, boxAt({1, 1, 0}, {1, 1, 1})),
              .unionVolume = 2.0};
    default:
      return {.name = "boxes at a vertex",
              .mesh = shapes::append(unit, boxAt({1, 1, 1}, {1, 1, 1})),
              .unionVolume = 2.0};
  }
}

// Gives vertices at one position one number.
TriangleMesh merged(TriangleMesh mesh) {
  const std::vector<std::uint32_t> first = firstAtPosition(mesh.vertices);
  for (glm::uvec3& t : mesh.triangles) t = {first[t.x], first[t.y], first[t.z]};
  return mesh;
}

// What is wrong with a fragment alone, which is one body.
std::string faultsOfPiece(const Fragment& fragment) {
  const TriangleMesh& mesh = fragment.mesh;
  const std::string id = "fragment " + std::to_string(fragment.id);
  std::string faults;
  if (openEdges(mesh) > 0) faults += id + " is open; ";
  if (nonManifoldEdges(mesh) > 0) faults += id + " is not manifold; ";
  if (bodiesOf(mesh).size() != 1) faults += id + " is several bodies; ";
  if (!selfCrossings(mesh.vertices, merged(mesh).triangles).empty()) {
    faults += id + " crosses itself; ";
  }
  return faults;
}

// What is wrong with the fragments of bodies: each is one body, and all are the union.
//   isWorn    whether cracks were eroded, which takes volume away
//   isParted  whether the union touches itself along edges
std::string faultsOfBodies(const Input& input, const std::vector<Fragment>& fragments, bool isWorn,
                           bool isParted) {
  double sum = 0.0;
  std::string faults;
  for (const Fragment& fragment : fragments) {
    const TriangleMesh& mesh = fragment.mesh;
    faults += faultsOfPiece(fragment);
    sum += volume(mesh);
  }
  // Sheets of a union that touch along edges are parted.
  const double tolerance = isParted ? 1e-4 : 1e-9;
  if (!isWorn && !(std::abs(sum - input.unionVolume) <= tolerance * input.unionVolume)) {
    faults += "the volume is " + std::to_string(sum) + " of " + std::to_string(input.unionVolume);
  }
  return faults;
}

// Sets the bodies of a mesh whose components share no vertices: those oriented outwards, each with
// the cavities that come after it.  Volumes are sums of tetrahedra.
void setBodies(Input& input) {
  const MeshComponents components = meshComponents(input.mesh);
  std::vector<long double> volumes(components.count, 0.0L);
  for (std::size_t t = 0; t < input.mesh.triangles.size(); ++t) {
    const glm::uvec3& c = input.mesh.triangles[t];
    const std::vector<glm::dvec3>& v = input.mesh.vertices;
    volumes[components.ofTriangle[t]] +=
        static_cast<long double>(glm::dot(v[c.x], glm::cross(v[c.y], v[c.z]))) / 6.0L;
  }
  std::vector<std::uint32_t> number;
  for (const long double own : volumes) {
    if (own > 0.0L) input.volumes.push_back(0.0);
    number.push_back(static_cast<std::uint32_t>(input.volumes.size() - 1));
    input.volumes.back() += static_cast<double>(own);
  }
  for (const std::uint32_t c : components.ofTriangle) input.body.push_back(number[c]);
}

// The faces of fragments towards others that the others do not have bit for bit.
std::size_t unsharedCracks(const std::vector<Fragment>& fragments) {
  using Point = std::tuple<double, double, double>;
  std::map<std::tuple<int, int, std::array<Point, 3>>, int> faces;
  for (const Fragment& fragment : fragments) {
    const TriangleMesh& mesh = fragment.mesh;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const int other = mesh.neighbor[t];
      if (other == 0) continue;
      const bool isLower = fragment.id < other;  // the other has the face reversed
      std::array<Point, 3> corners;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3& v = mesh.vertices[mesh.triangles[t][isLower ? k : 2 - k]];
        corners[static_cast<std::size_t>(k)] = {v.x, v.y, v.z};
      }
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      faces[{std::min(fragment.id, other), std::max(fragment.id, other), corners}] +=
          isLower ? 1 : -1;
    }
  }
  return static_cast<std::size_t>(
      std::ranges::count_if(faces, [](const auto& face) { return face.second != 0; }));
}

// What is wrong with the fragments of bodies that are kept.
std::string faultsOfKept(const Input& input, const FractureResult& result, bool isWorn) {
  std::string faults;
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<double> sums(input.volumes.size(), 0.0);
  std::vector<std::uint32_t> bodyOf(result.fragments.size() + 1, kNone);
  for (const Fragment& fragment : result.fragments) {
    const TriangleMesh& mesh = fragment.mesh;
    faults += faultsOfPiece(fragment);
    std::set<std::uint32_t> own;
    for (const std::uint32_t source : mesh.source) {
      if (source != TriangleMesh::kNoSource) own.insert(input.body[source]);
    }
    if (own.size() > 1) {
      faults += "fragment " + std::to_string(fragment.id) + " is of several bodies; ";
    }
    if (!own.empty()) {
      bodyOf[static_cast<std::size_t>(fragment.id)] = *own.begin();
      sums[*own.begin()] += volume(mesh);
    }
  }
  for (bool isAny = true; std::exchange(isAny, false);) {  // those bounded by cracks alone
    for (const Fragment& fragment : result.fragments) {
      std::uint32_t& own = bodyOf[static_cast<std::size_t>(fragment.id)];
      for (std::size_t t = 0; own == kNone && t < fragment.mesh.neighbor.size(); ++t) {
        own = bodyOf[fragment.mesh.neighbor[t]];
        if (own == kNone) continue;
        sums[own] += volume(fragment.mesh);
        isAny = true;
      }
    }
  }
  const SolidReport& report = result.solid.report;
  std::size_t missing = 0;
  for (std::size_t b = 0; b < sums.size(); ++b) {
    if (sums[b] == 0.0) ++missing;
    if (isWorn || sums[b] == 0.0) continue;
    if (std::abs(sums[b] - input.volumes[b]) <= 1e-9 * input.volumes[b]) continue;
    faults += "the volume of body " + std::to_string(b) + " is " + std::to_string(sums[b]) +
              " of " + std::to_string(input.volumes[b]) + "; ";
  }
  if (report.keptBodies != sums.size()) faults += "the bodies are not known; ";
  if (missing > report.hiddenBodies + result.solid.smallComponents)
    faults += std::to_string(missing) + " bodies are missing; ";
  if (!isWorn && unsharedCracks(result.fragments) > 0) faults += "cracks are not shared; ";
  return faults;
}

// Whether a union touches itself along edges.
bool touches(const UnitedBodies& united) {
  if (united.before == 0) return false;
  LabeledMesh whole;
  whole.mesh = united.mesh->mesh;
  whole.other.assign(whole.mesh.triangles.size(), 0);
  return touchingEdges(whole) > 0;
}

// What is wrong with fragments some of which are smooth, as text.
std::string faultsOfKinds(const std::vector<Fragment>& fragments) {
  std::string faults;
  for (const Fragment& fragment : fragments) {
    const std::string name = "fragment " + std::to_string(fragment.id);
    if (openEdges(fragment.mesh) > 0) faults += name + " is open; ";
    if (!(fragment.mass.volume > 0.0)) faults += name + " is empty; ";
    for (const std::uint16_t neighbor : fragment.mesh.neighbor) {
      if (neighbor == 0 || fragments[neighbor - 1u].meshedAs == fragment.meshedAs) continue;
      faults += name + " has a neighbor of another kind; ";
      break;
    }
  }
  return faults;
}

// Takes components out of a mesh of which no fragment has a vertex: those that the solid lacks, as
// it drops what is small.  Triangles keep their numbers.
//   return  what is wrong with them, as text
std::string withoutDropped(TriangleMesh& mesh, const FractureResult& result) {
  std::set<std::array<double, 3>> there;
  for (const Fragment& fragment : result.fragments) {
    for (const glm::dvec3& v : fragment.mesh.vertices) there.insert({v.x, v.y, v.z});
  }
  const MeshComponents components = meshComponents(mesh);
  std::vector<bool> isThere(components.count, false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::dvec3& v = mesh.vertices[mesh.triangles[t].x];
    if (there.contains({v.x, v.y, v.z})) isThere[components.ofTriangle[t]] = true;
  }
  std::vector<TriangleMesh> dropped(components.count);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t c = components.ofTriangle[t];
    if (isThere[c]) continue;
    dropped[c].triangles.push_back(mesh.triangles[t]);
    mesh.triangles[t] = glm::uvec3(mesh.triangles[t].x);
  }
  // Twice the volume of as many voxels: what is thin has fewer centers inside than its volume has.
  const double most = 2.0 * kSmallComponentVoxels * std::pow(result.solid.frame.voxelSize, 3);
  std::uint64_t count = 0;
  std::string faults;
  for (TriangleMesh& component : dropped) {
    if (component.triangles.empty()) continue;
    component.vertices = mesh.vertices;
    ++count;
    if (std::abs(volume(component)) > most) faults += "a component is missing; ";
  }
  const std::uint64_t said =
      result.solid.smallComponents + result.solid.report.hiddenBodies + result.united.loose;
  if (count > said) faults += std::to_string(count - said) + " components are missing; ";
  return faults;
}

// What is wrong with fragments of one surface, as text.
std::string faultsOfSurface(const Input& input, const FractureResult& result, bool isWorn) {
  // Of a body that crosses itself what lies within it is left out: the surface is the union's.
  const bool isUnited = result.united.before > 0;
  TriangleMesh expected = isUnited ? result.united.mesh->mesh : input.clean;
  std::string text = withoutDropped(expected, result);
  ExactFaults faults =
      exactFaults(isUnited ? input.clean : expected, result.fragments, isWorn || isUnited);
  if (isUnited) faults.unlikeInput = 0;  // faces of the union are parts of the input's, rounded
  if (isUnited && !isWorn) {
    double sum = 0.0;
    for (const Fragment& fragment : result.fragments) sum += volume(fragment.mesh);
    faults.volume = sum / volume(expected) - 1.0;
    if (unsharedCracks(result.fragments) > 0) text += "cracks are not shared; ";
  }
  if (input.crossesItself) faults.selfCrossings = 0;
  return text + (faults.any() ? faults.text() : "");
}

FractureOptions randomOptions(std::mt19937_64& random) {
  FractureOptions options;
  options.surface = {.levelSets = false, .surface = Surface::exact};
  options.pieces = whole(random, 2, 30);
  options.seed = random();
  options.solid.resolution = whole(random, 4, 16) * 8;
  if (whole(random, 0, 2) == 0) options.grow.roughness = uniform(random, 0.3, 3.0);
  if (whole(random, 0, 3) == 0) options.seeds.extraSeedsPerPiece = 2;
  if (whole(random, 0, 5) == 0) options.grow.growth = Growth::flood;
  if (whole(random, 0, 5) == 0) options.grow.anisotropy = {{1, 2, 3}, uniform(random, -0.7, 3.0)};
  if (whole(random, 0, 5) == 0) options.erode.iterations = whole(random, 1, 3);
  return options;
}

std::string described(const FractureOptions& o) {
  return std::to_string(o.pieces) + " pieces, seed " + std::to_string(o.seed) + ", " +
         std::to_string(o.solid.resolution) + " voxels, roughness " +
         std::to_string(o.grow.roughness.voxels);
}

void breakOne(const Input& input, const FractureOptions& options, Device& device, Tally& tally) {
  ++tally.runs;
  const auto fault = [&](const std::string& what) {
    ++tally.faults;
    std::printf("FAULT %s (%s): %s\n", input.name.c_str(), described(options).c_str(),
                what.c_str());
  };
  try {
    const FractureResult result = fracture(input.mesh, options, device);
    if (!result.exactFailure.empty()) {
      ++tally.fallBacks;
      ++tally.reasons[result.exactFailure];
      return;
    }
    if (!result.smooth.empty()) {
      ++tally.partly;
      for (const SmoothBodies& bodies : result.smooth) ++tally.reasons[bodies.reason];
      if (const std::string faults = faultsOfKinds(result.fragments); !faults.empty()) {
        fault(faults);
      }
      return;
    }
    const bool isWorn = !options.erode.iterations.isZero();
    if (!input.body.empty()) {
      const std::string faults = faultsOfKept(input, result, isWorn);
      if (!faults.empty()) fault(faults);
      return;
    }
    if (input.unionVolume > 0.0) {
      const std::string faults =
          faultsOfBodies(input, result.fragments, isWorn, touches(result.united));
      if (!faults.empty()) fault(faults);
      return;
    }
    const std::string faults = faultsOfSurface(input, result, isWorn);
    if (!faults.empty()) fault(faults);
  } catch (const Error& e) {  // others are refusals
    if (e.code() == ErrorCode::internal) fault(e.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  openvdb::initialize();
  const int count = argc > 1 ? std::atoi(argv[1]) : 100;
  std::mt19937_64 random(argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1);
  std::vector<Input> meshes;
  for (int i = 3; i < argc; ++i) {
    meshes.push_back(
        inputOf(std::filesystem::path(argv[i]).filename().string(), readMesh(argv[i]).mesh));
  }
  Device device("builtin");
  std::map<std::string, Tally> tallies;
  for (int i = 0; i < count; ++i) {
    const FractureOptions options = randomOptions(random);
    if (i % 3 == 0) {
      const int resolution = options.solid.resolution;
      const bool isOpen = i % 12 == 0;
      Input input = isOpen ? randomOpen(random, resolution) : randomBodies(random, resolution);
      Input kept = input;
      input.mesh = merged(std::move(input.mesh));
      breakOne(input, options, device, tallies[input.name]);
      if (isOpen) continue;
      setBodies(kept);
      kept.name += ", kept";
      kept.mesh = merged(std::move(kept.mesh));
      FractureOptions keeping = options;
      keeping.solid.bodies = MeetingBodies::keep;
      breakOne(kept, keeping, device, tallies[kept.name]);
    } else if (!meshes.empty() && i % 3 == 1) {
      const Input& input =
          meshes[static_cast<std::size_t>(whole(random, 0, static_cast<int>(meshes.size()) - 1))];
      breakOne(input, options, device, tallies[input.name]);
    } else {
      std::string name;
      TriangleMesh shape = randomShape(random, name);
      breakOne(inputOf(name, std::move(shape)), options, device, tallies[name]);
    }
  }
  int faults = 0;
  for (const auto& [name, tally] : tallies) {
    faults += tally.faults;
    std::printf("%-28s %4d runs, %3d fall-backs, %3d in part, %d faults\n", name.c_str(),
                tally.runs, tally.fallBacks, tally.partly, tally.faults);
    for (const auto& [reason, n] : tally.reasons) std::printf("    %3d %s\n", n, reason.c_str());
  }
  return faults > 0 ? 1 : 0;
}
