// Statistics of a fracture, to be compared with real ones.
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "base/cancel_flag.h"
#include "base/text/formatted.h"
#include "evaluate/cracks/coincident_vertices.h"
#include "evaluate/cracks/contact_graph.h"
#include "evaluate/cracks/crack_roughness.h"
#include "evaluate/cracks/fragment_shape.h"
#include "evaluate/cracks/grid_trace.h"
#include "evaluate/cracks/joint_gaps.h"
#include "evaluate/distance_neighbors.h"
#include "evaluate/parting_splits.h"
#include "mesh/flipped_orientation.h"
#include "mesh/plane_moments.h"
#include "mesh/symmetric_eigen.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

constexpr double kUnitsOfForeign = 128.0;  // along the longest side, without a voxel size
constexpr double kVertexRadius = 0.5;      // units
constexpr double kOnePlane = 0.5;          // of FractureStatistics::planeShare: faces by planes
constexpr double kPlateShare = 0.25;       // of a plate's thickness to its middle side
constexpr double kSampleUnits = 4.0;       // between points of triangles without neighbors
constexpr double kCoincident = 2e-6;       // of the diagonal, as in fit(): the rounding of floats
constexpr double kMostDeep = 0.01;         // of all surface, in assembled positions
constexpr double kFlatShare = 0.9;         // of the original surface, in planes
constexpr double kFlatPlane = 0.1;         // of a fragment's original surface, of such a plane
constexpr std::size_t kMostSimulations = 1000000;
constexpr int kMostIds = 65535;  // of neighbors

/// The fragments with a mesh.
struct Meshes {
  std::vector<std::size_t> fragment;  ///< index in the set
  std::vector<int> ids;
  std::vector<FragmentMesh> flipped;  ///< [fragment] copies, where neighbors are unknown
  std::vector<DividedMesh> divided;
  Box box{glm::dvec3(std::numeric_limits<double>::infinity()),
          glm::dvec3(-std::numeric_limits<double>::infinity())};
};

void check(const StatisticsOptions& o) {
  const auto require = [](bool valid, const char* what, double value, const char* expected) {
    if (!valid) {
      throw Error(ErrorCode::usage,
                  formatted("statistics: %s is %g, expected %s", what, value, expected));
    }
  };
  // Squares of lengths and products of both stay finite, and above 0.
  require(o.unit == 0.0 || (o.unit >= 1e-100 && o.unit <= 1e100), "the unit", o.unit,
          "0 or 1e-100 to 1e100");
  require(o.planeTolerance >= 1e-9 && o.planeTolerance <= 1e9, "the tolerance of planes",
          o.planeTolerance, "1e-9 to 1e9");
  require(o.leastFace >= 0.0 && o.leastFace <= 1e9, "the least face", o.leastFace, "0 to 1e9");
  require(o.tolerance > 0.0 && std::isfinite(o.tolerance), "the tolerance", o.tolerance, "above 0");
  require(o.simulations >= 1 && o.simulations <= kMostSimulations, "the number of simulations",
          static_cast<double>(o.simulations), "1 to 1000000");
  if (!o.propagation) return;
  const double length = glm::length(*o.propagation);
  require(length > 0.0 && std::isfinite(length), "the length of the direction of propagation",
          length, "above 0");
}

Meshes meshesOf(const FragmentSet& set) {
  Meshes meshes;
  for (std::size_t i = 0; i < set.fragments.size(); ++i) {
    const TriangleMesh& mesh = set.fragments[i].mesh.mesh;
    if (mesh.triangles.empty() || !(area(mesh) > 0.0)) continue;
    meshes.fragment.push_back(i);
    meshes.ids.push_back(set.fragments[i].mesh.id);
    const Box box = bounds(mesh);
    meshes.box.min = glm::min(meshes.box.min, box.min);
    meshes.box.max = glm::max(meshes.box.max, box.max);
  }
  return meshes;
}

bool knowsNeighbors(const FragmentSet& set, const Meshes& meshes) {
  return std::all_of(meshes.fragment.begin(), meshes.fragment.end(),
                     [&](std::size_t i) { return !set.fragments[i].mesh.mesh.neighbor.empty(); });
}

ShapeLimits limitsOf(const FractureStatistics& statistics) {
  return {statistics.planeTolerance, statistics.leastArea, kVertexRadius * statistics.unit};
}

void setUnit(FractureStatistics& result, const FragmentSet& set, const Meshes& meshes,
             const StatisticsOptions& options) {
  result.unit = options.unit > 0.0 ? options.unit : set.voxelSize;
  if (!(result.unit > 0.0) && !meshes.fragment.empty()) {
    result.unit = longestSide(meshes.box) / kUnitsOfForeign;
  }
  result.leastArea = options.leastFace * result.unit * result.unit;
  result.planeTolerance = options.planeTolerance * result.unit;
}

/// Divides the meshes into planes; finds neighbors where they are unknown.
void divide(Meshes& meshes, const FractureStatistics& result, const FragmentSet& set,
            const StatisticsOptions& options, const Progress* progress) {
  std::vector<BehindTriangles> behind;
  if (!result.knownNeighbors) {
    if (set.fragments.size() > std::size_t{kMostIds}) {
      throw Error(ErrorCode::input,
                  formatted("statistics: %zu meshes without neighbors, at most %d "
                            "are measured",
                            set.fragments.size(), kMostIds));
    }
    for (const std::size_t i : meshes.fragment) {
      const FragmentMesh& given = set.fragments[i].mesh;
      const bool inwards = openEdges(given.mesh) == 0 && volume(given.mesh) < 0.0;
      meshes.flipped.push_back({given.id, inwards ? flippedOrientation(given.mesh) : given.mesh});
    }
    behind = neighborsByDistance(meshes.flipped, options.tolerance, kSampleUnits * result.unit,
                                 progress);
  }
  meshes.divided.resize(meshes.fragment.size());
  tbb::parallel_for(std::size_t{0}, meshes.fragment.size(), [&](std::size_t k) {
    const TriangleMesh& mesh = result.knownNeighbors ? set.fragments[meshes.fragment[k]].mesh.mesh
                                                     : meshes.flipped[k].mesh;
    meshes.divided[k] = divided(mesh, result.knownNeighbors ? mesh.neighbor : behind[k].neighbor,
                                limitsOf(result), progress);
    if (!result.knownNeighbors) meshes.divided[k].neighborArea = std::move(behind[k].areas);
    if (!set.splitParents.empty()) {
      meshes.divided[k].split = partingSplits(set, meshes.fragment[k], meshes.divided[k].neighbor);
    }
  });
}

bool isRough(const FractureStatistics& result) {
  return result.orientation && result.planeShare < kOnePlane;
}

void chooseRule(FractureStatistics& result, const FragmentSet& set, const Meshes& meshes,
                const StatisticsOptions& options) {
  double inPlane = 0.0, cracks = 0.0;
  for (const DividedMesh& mesh : meshes.divided) {
    inPlane += mesh.onePlane;
    cracks += mesh.crackArea;
  }
  result.planeShare = cracks > 0.0 ? inPlane / cracks : 0.0;
  if (options.faces == FaceRule::splits && set.splitParents.empty()) {
    throw Error(
        ErrorCode::usage,
        "statistics: the folder's manifest has no splits; choose planes, neighbors or facets");
  }
  const FaceRule found = !set.splitParents.empty() ? FaceRule::splits
                         : isRough(result)         ? FaceRule::facets
                                                   : FaceRule::planes;
  result.rule = options.faces.value_or(found);
}

std::optional<int> thinAxisOf(const Box& box) {
  const glm::dvec3 size = box.max - box.min;
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size[a] < size[b]; });
  if (!(size[order[0]] <= kPlateShare * size[order[1]])) return {};
  return order[0];
}

/// Returns whether nearly all of the original surface is in planes that are large on their
/// fragment.
bool originalIsFlat(const Meshes& meshes) {
  double flat = 0.0, all = 0.0;
  for (const DividedMesh& mesh : meshes.divided) {
    const double original = mesh.area - mesh.crackArea;
    all += original;
    for (std::size_t i = 0; i < mesh.planes.size.size(); ++i) {
      if (mesh.planes.group[i] == 0 && mesh.planes.size[i] >= kFlatPlane * original) {
        flat += mesh.planes.size[i];
      }
    }
  }
  return flat >= kFlatShare * all;
}

void measureShapes(FractureStatistics& result, Meshes& meshes, const FragmentSet& set,
                   const Progress* progress) {
  if (!meshes.fragment.empty()) result.thinAxis = thinAxisOf(meshes.box);
  tbb::parallel_for(std::size_t{0}, meshes.fragment.size(), [&](std::size_t k) {
    throwIfCancelled(progress);
    FragmentShape& shape = result.fragments[meshes.fragment[k]];
    if (result.rule == FaceRule::facets) divideIntoFacets(meshes.divided[k], progress);
    measureShape(shape, meshes.divided[k], result.rule, limitsOf(result));
    if (result.thinAxis) {
      shape.corners = cornersOf(meshes.divided[k], result.rule, *result.thinAxis, limitsOf(result));
    }
  });
  for (std::size_t i = 0; i < result.fragments.size(); ++i) {
    FragmentShape& shape = result.fragments[i];
    const EvaluatedFragment& known = set.fragments[i];
    if (!set.manifest) shape.contacts = shape.neighbors;
    if (set.manifest && known.area > 0.0) shape.breakShare = known.fractureArea / known.area;
  }
}

/// Names of fragments, and shares of the sum of their volumes.
void addShares(FractureStatistics& result, const FragmentSet& set) {
  double sum = 0.0;
  for (const EvaluatedFragment& fragment : set.fragments) {
    FragmentShape shape;
    shape.id = fragment.mesh.id;
    shape.name = fragment.name;
    shape.contacts = fragment.contacts;
    shape.share = set.manifest ? fragment.share : std::abs(volume(fragment.mesh.mesh));
    sum += shape.share;
    result.fragments.push_back(shape);
  }
  for (FragmentShape& shape : result.fragments) shape.share = sum > 0.0 ? shape.share / sum : 0.0;
}

/// Returns the mean over the fragments for which `value` returns one.
template <class Value>
std::optional<MeanFigure> meanOver(const std::vector<FragmentShape>& shapes, Value value) {
  std::vector<double> values;
  for (const FragmentShape& shape : shapes) {
    if (const std::optional<std::size_t> one = value(shape)) {
      values.push_back(static_cast<double>(*one));
    }
  }
  if (values.empty()) return {};
  MeanFigure figure{values.size()};
  const auto n = static_cast<double>(values.size());
  figure.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double v : values) squares += (v - figure.mean) * (v - figure.mean);
  figure.deviation = values.size() > 1 ? std::sqrt(squares / (n - 1.0)) : 0.0;
  return figure;
}

void addMeans(FractureStatistics& result, const Meshes& meshes) {
  const auto of = [&](auto member, auto&& condition) {
    return meanOver(result.fragments, [&](const FragmentShape& s) {
      return condition(s) ? std::optional<std::size_t>(s.*member) : std::nullopt;
    });
  };
  const auto all = [](const FragmentShape&) { return true; };
  const auto withMesh = [](const FragmentShape& s) { return s.hasMesh; };
  const auto interior = [](const FragmentShape& s) { return s.hasMesh && s.interior; };
  result.contacts = of(&FragmentShape::contacts, all);
  result.neighbors = of(&FragmentShape::neighbors, withMesh);
  result.faces = of(&FragmentShape::faces, withMesh);
  result.vertices = of(&FragmentShape::vertices, withMesh);
  result.interiorFaces = of(&FragmentShape::faces, interior);
  result.interiorVertices = of(&FragmentShape::vertices, interior);
  result.interiorNeighbors = of(&FragmentShape::neighbors, interior);
  if (result.rule == FaceRule::planes && originalIsFlat(meshes)) {
    result.flatFaces = of(&FragmentShape::flatFaces, withMesh);
    result.flatVertices = of(&FragmentShape::flatVertices, withMesh);
  }
  result.corners = meanOver(result.fragments, [](const FragmentShape& s) { return s.corners; });
  std::vector<double> shares;
  for (const FragmentShape& s : result.fragments) shares.push_back(s.breakShare);
  std::sort(shares.begin(), shares.end());
  const std::size_t n = shares.size();
  result.breakShare = 0.5 * (shares[(n - 1) / 2] + shares[n / 2]);
}

void addOrientation(FractureStatistics& result, const Meshes& meshes) {
  glm::dmat3 sum(0.0);
  double cracks = 0.0;
  for (const DividedMesh& mesh : meshes.divided) {
    for (std::size_t i = 0; i < mesh.neighbor.size(); ++i) {
      if (mesh.neighbor[i] == 0) continue;
      const glm::uvec3& t = mesh.mesh->triangles[i];
      const glm::dvec3 normal = areaNormal(
          {mesh.mesh->vertices[t.x], mesh.mesh->vertices[t.y], mesh.mesh->vertices[t.z]});
      const double length = glm::length(normal);
      if (!(length > 0.0)) continue;
      sum += glm::outerProduct(normal, normal / length);
      cracks += length;
    }
  }
  if (!(cracks > 0.0)) return;
  const SymmetricEigen eigen = eigenOf(sum / cracks);
  result.orientation = eigen.values;
  result.orientationAxes = eigen.vectors;
}

/// Returns the share of the area of cracks whose neighbor is none of the meshes.
double unmatchedShare(const Meshes& meshes) {
  const std::set<int> ids(meshes.ids.begin(), meshes.ids.end());
  double unmatched = 0.0, all = 0.0;
  for (const DividedMesh& mesh : meshes.divided) {
    for (const auto& [id, size] : mesh.neighborArea) {
      all += size;
      if (!ids.contains(id)) unmatched += size;
    }
  }
  return all > 0.0 ? unmatched / all : 0.0;
}

/// Measures what the fragments' order, and the two sides of cracks, have in common.
void addJoints(FractureStatistics& result, const Meshes& meshes, double tolerance,
               const Progress* progress) {
  if (meshes.fragment.empty()) return;
  const ContactGraph graph = contactGraph(meshes.divided, meshes.ids, result.leastArea);
  result.objects = graph.objects;
  for (std::size_t k = 0; k < meshes.fragment.size(); ++k) {
    result.fragments[meshes.fragment[k]].object = graph.object[k] + 1;
  }
  result.consecutiveExcess = consecutiveExcess(graph, meshes.ids);
  result.coincident = coincidentShare(
      meshes.divided, kCoincident * glm::length(meshes.box.max - meshes.box.min), progress);
  result.unmatched = unmatchedShare(meshes);
  result.joints = jointsOf(
      {meshes.divided, meshes.ids, graph, result.unit, tolerance, result.knownNeighbors}, progress);
}

void addJointNotes(FractureStatistics& result) {
  if (result.objects > 1) {
    result.notes.push_back(formatted(
        "no contact joins %zu sets of fragments: they are of several objects, or fragments "
        "between them are missing, or not in assembled positions",
        result.objects));
  }
  if (result.joints && result.joints->deepShare > kMostDeep) {
    result.notes.push_back(
        formatted("%.1f %% of the surface is deep inside other fragments: they are of several "
                  "objects, or not in assembled positions",
                  100.0 * result.joints->deepShare));
  }
}

void addStatisticsNotes(FractureStatistics& result, const FragmentSet& set, const Meshes& meshes) {
  std::vector<std::string>& notes = result.notes;
  if (meshes.fragment.empty()) {
    notes.emplace_back("there are no meshes: faces, vertices and cracks are not measured");
    return;
  }
  if (meshes.fragment.size() < set.fragments.size()) {
    notes.push_back(formatted("%zu of %zu fragments have no mesh with an area",
                              set.fragments.size() - meshes.fragment.size(), set.fragments.size()));
  }
  const auto open =
      std::count_if(meshes.fragment.begin(), meshes.fragment.end(),
                    [&](std::size_t i) { return openEdges(set.fragments[i].mesh.mesh) > 0; });
  if (open > 0) {
    notes.push_back(formatted(
        "%zu fragments are open or inconsistently oriented: volumes and shares are unreliable",
        static_cast<std::size_t>(open)));
  }
  if (!result.knownNeighbors) {
    notes.emplace_back("the meshes record no neighbors: cracks are found by distance");
  }
  if (!result.interiorFaces) {
    notes.emplace_back("every fragment has original surface: no interior faces and vertices");
  }
  if (result.thinAxis && !result.corners) {
    notes.emplace_back("every fragment has a part of the plate's rim: no corners");
  }
  if (!isRough(result)) {
    notes.emplace_back("the cracks are not rough: no Hurst exponents");
  } else if (result.hurst.empty()) {
    notes.emplace_back("no crack is long enough for a Hurst exponent");
  }
}

}  // namespace

double MeanFigure::standardError() const {
  return deviation / std::sqrt(static_cast<double>(count));
}

FractureStatistics statistics(const FragmentSet& set, const StatisticsOptions& options,
                              const Progress* progress) {
  check(options);
  if (set.fragments.empty()) {
    throw Error(ErrorCode::input, "statistics: there are no fragments; at least one is needed");
  }
  FractureStatistics result;
  Meshes meshes = meshesOf(set);
  setUnit(result, set, meshes, options);
  addShares(result, set);
  result.knownNeighbors = knowsNeighbors(set, meshes);
  divide(meshes, result, set, options, progress);
  addOrientation(result, meshes);
  chooseRule(result, set, meshes, options);
  measureShapes(result, meshes, set, progress);
  addMeans(result, meshes);
  std::vector<double> shares;
  for (const FragmentShape& shape : result.fragments) shares.push_back(shape.share);
  result.sizes = fitSizes(shares, options.simulations, options.seed, progress);
  if (isRough(result)) {
    CrackRoughness rough =
        roughnessOf(meshes.divided, meshes.ids, options.propagation, result.unit, progress);
    result.roughness = rough.rms;
    result.hurst = std::move(rough.along);
  }
  addJoints(result, meshes, options.tolerance, progress);
  const bool hasVoxels = set.voxelSize > 0.0 || options.unit > 0.0;
  result.grid = gridTraceOf(meshes.divided, hasVoxels ? result.unit : 0.0, progress);
  addStatisticsNotes(result, set, meshes);
  addJointNotes(result);
  return result;
}

}  // namespace sherd
