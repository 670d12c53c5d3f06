// Estimate of the memory that a fracture takes.
#include "pipeline/memory_estimate.h"

#include <sherd/fracture.h>
#include <sherd/growth.h>
#include <sherd/solid.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "pipeline/fracture_stages.h"
#include "remesh/smooth.h"
#include "voxelize/fill/fill.h"

namespace sherd {
namespace {

// Rates: docs/performance.md, Memory.
constexpr double kProgram = 200e6;          // the OpenCL device and its compiler
constexpr double kPerTriangle = 264.0;      // of the input: vertices twice, the tree, columns
constexpr double kPerSurfaceVoxel = 500.0;  // faces, meshes and the preview of fragments
constexpr double kOfSomeMeshes = 0.6;       // factor on it where only some meshes are held
constexpr double kPerInsideVoxel = 8.0;     // leaves, labels and growth
constexpr double kOfErosion = 9.0;          // additional: masks of fragments, labels before erosion
constexpr double kOfCost = 11.0;  // additional: four bytes on the device, the host and in the file
constexpr double kExactTriangle = 220.0;  // additional, of exact surfaces: parts and their edges
constexpr double kExactCut = 400.0;       // per voxel of cracks: their mesh, polygons and parts
constexpr double kExactRoughCut =
    1050.0;                               // the same of rough cracks, which stay as they are meshed
constexpr double kSimplified = 1.6;       // factor where meshes are decimated
constexpr double kMerged = 1.3;           // the same where triangles are merged in planes
constexpr double kPerWayToMiddle = 12.0;  // of each voxel of the leaves, host and device
constexpr double kPerGuideTriangle = 350.0;  // their mesh, its repair, tree and normals
constexpr double kPerPiece = 25e3;  // of any size: distances to the cut in every leaf it reaches,
                                    // its manifest entry

struct Extent {
  double area = 0.0, volume = 0.0, longest = 0.0;  // world units
  double components = 0.0;
  bool isOpen = false;
  bool hasLargeTriangles = false;  // most of the area: kAutoAdaptivity likely merges triangles
  glm::dvec3 box{0.0};
  double guideTriangles = 0.0, guideCracks = 0.0;  // of surfaces along guides
  bool hasGuideLines = false;
};

// Returns whether a triangle is high enough, as a share of the mesh's longest side, that the
// surface around most of its points is flat for kAutoAdaptivity.
bool isLarge(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double longest) {
  constexpr double kLeastHeight = 0.008;
  const double edge = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  return glm::length(glm::cross(b - a, c - a)) > kLeastHeight * longest * edge;
}

// Sums the absolute volumes of mesh components, so that inverted ones do not cancel.
Extent extentOf(const TriangleMesh& mesh) {
  const MeshComponents components = meshComponents(mesh);
  std::vector<double> volumes(components.count, 0.0);
  const glm::dvec3 origin = bounds(mesh).min;
  const double longest = longestSide(bounds(mesh));
  double area = 0.0, ofLarge = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corners = mesh.triangles[t];
    const glm::dvec3 a = mesh.vertices[corners.x] - origin, b = mesh.vertices[corners.y] - origin,
                     c = mesh.vertices[corners.z] - origin;
    const double own = 0.5 * glm::length(glm::cross(b - a, c - a));
    area += own;
    if (isLarge(a, b, c, longest)) ofLarge += own;
    volumes[components.ofTriangle[t]] += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  double volume = 0.0;
  for (const double v : volumes) volume += std::abs(v);
  const glm::dvec3 box = bounds(mesh).max - origin;
  return {.area = area,
          .volume = std::min(volume, box.x * box.y * box.z),
          .longest = longest,
          .components = static_cast<double>(components.count),
          .isOpen = openEdges(mesh) > 0,
          .hasLargeTriangles = ofLarge > 0.5 * area,
          .box = box};
}

// Adds what curtainOf and guideSurfacesOf make of guides.
void addGuides(Extent& extent, const std::vector<Guide>& guides) {
  constexpr double kSteps = 256.0, kMostSteps = 65536.0, kPerStep = 4.0;  // of curtainOf
  for (const Guide& guide : guides) {
    for (const std::vector<glm::dvec3>& line : guide.polylines) {
      double length = 0.0;
      for (std::size_t i = 1; i < line.size(); ++i) length += glm::distance(line[i - 1], line[i]);
      const double steps = std::min(length / extent.longest * kSteps, kMostSteps);
      extent.guideTriangles += kPerStep * (steps + static_cast<double>(line.size()));
      extent.guideCracks += 1.0;
      extent.hasGuideLines = true;
    }
    if (guide.mesh.triangles.empty()) continue;
    extent.guideTriangles += static_cast<double>(guide.mesh.triangles.size());
    extent.guideCracks += static_cast<double>(meshComponents(guide.mesh).count);
  }
}

// Surface area and volume of a solid, world units.
struct Amount {
  double area = 0.0, volume = 0.0;
};

// Returns the amount of a shell by Steiner's formula for the points within `r` of a set: of the
// mesh's bounding box, an upper bound, and of the mesh, whose curvature terms cancel between its
// two sides.  Overlap of sheets is estimated as for sheets at random positions in the box.
Amount shellOf(const Extent& mesh, double thickness) {
  constexpr double kPi = std::numbers::pi;
  const double r = 0.5 * thickness, sides = mesh.box.x + mesh.box.y + mesh.box.z;
  const double faces =
      2.0 * (mesh.box.x * mesh.box.y + mesh.box.y * mesh.box.z + mesh.box.z * mesh.box.x);
  const double ball = 4.0 / 3.0 * kPi * r * r * r, sphere = 4.0 * kPi * r * r;
  const Amount box{faces + 2.0 * kPi * r * sides + sphere,
                   mesh.box.x * mesh.box.y * mesh.box.z + faces * r + kPi * r * r * sides + ball};
  Amount sheet{2.0 * mesh.area + 2.0 * sphere * mesh.components,
               mesh.area * thickness + 2.0 * ball * mesh.components};
  if (mesh.isOpen) {  // along its boundary, assumed no longer than the box's edges
    sheet.area += 2.0 * kPi * r * sides;
    sheet.volume += kPi * r * r * sides;
  }
  const double apart = std::exp(-sheet.volume / box.volume);
  return {std::min(sheet.area, sheet.area * apart + box.area), std::min(sheet.volume, box.volume)};
}

// Returns the amount of the solid made from a mesh.  An open mesh may become a two-sided shell.
Amount solidAmount(const Extent& mesh, const SolidOptions& options, double voxelSize) {
  const bool isShell = options.fill == Fill::shell ||
                       (options.fill == Fill::automatic && options.shellThickness > 0.0);
  if (isShell) return shellOf(mesh, shellVoxels(options, voxelSize) * voxelSize);
  return {(mesh.isOpen ? 2.0 : 1.0) * mesh.area, mesh.volume};
}

double bytesForVoxels(double surface, double inside, double perInside = kPerInsideVoxel) {
  return kProgram + kPerSurfaceVoxel * surface + perInside * inside;
}

// Returns bytes per inside voxel for these options.
double perInsideVoxel(const FractureOptions& options) {
  return kPerInsideVoxel + ruleOf(options.grow.growth).bytesPerVoxel +
         (options.erode.iterations.isZero() ? 0.0 : kOfErosion) +
         (options.grow.keepCost ? kOfCost : 0.0);
}

// Returns the factor on the memory of meshes for these options.
//   resolution  voxels along the longest side
//   isFlat      whether kAutoAdaptivity likely merges triangles
double meshFactor(const SurfaceOptions& surface, MeshesHeld held, double resolution, bool isFlat) {
  const bool isMerged =
      surface.surface == Surface::smooth && surface.adaptivity == kAutoAdaptivity && isFlat;
  if (surface.adaptivity > 0.0 || !surface.triangles.empty()) return kSimplified;
  if (isMerged) return kMerged;
  if (movesAnything(surface.smooth, static_cast<int>(resolution))) return 1.0;
  if (held == MeshesHeld::some) return kOfSomeMeshes;
  if (held == MeshesHeld::all || resolution < kPreviewCubes) return 1.0;
  const double cube = resolution / kPreviewCubes;
  return kOfSomeMeshes + (1.0 - kOfSomeMeshes) / (cube * cube);
}

// Returns what exact surfaces take beyond smooth ones.
double bytesForExact(std::size_t triangles, double cuts, const FractureOptions& options) {
  if (surfaceOf(options) != Surface::exact) return 0.0;
  return kExactTriangle * static_cast<double>(triangles) +
         (options.grow.roughness.isZero() ? kExactCut : kExactRoughCut) * cuts;
}

// Returns what the solid takes on which cracks are decided.  It is gone when surfaces are cut.
double bytesForDeciding(std::size_t triangles, const FractureOptions& options) {
  const bool hasEnergy = std::any_of(options.seeds.impacts.begin(), options.seeds.impacts.end(),
                                     [](const Impact& impact) { return impact.energy > 0.0; });
  const bool decides = ruleOf(options.grow.growth).splits || hasEnergy;
  return decides ? kPerTriangle * static_cast<double>(triangles) : 0.0;
}

double voxelsOfLeaves(double surface, double inside) {
  return inside + 16.0 * surface;  // of which half are of the border
}

// Returns what guides take: their surfaces, a bit for each voxel of the leaves, and for lines the
// mesh again, on which they are drawn.
double bytesForGuides(const Extent& extent, std::size_t triangles, double surface, double inside) {
  const double leaves = voxelsOfLeaves(surface, inside) / 512.0;
  return kPerGuideTriangle * extent.guideTriangles + 64.0 * leaves * extent.guideCracks +
         (extent.hasGuideLines ? kPerTriangle * static_cast<double>(triangles) : 0.0);
}

// Returns what the ways to the middle of walls take.  A solid of twice its volume over its area in
// thickness, as a plate is, counts as one of walls where growth would: blocks and balls have 0.33
// and 0.41 of the side of a cube of their volume.
double bytesForWalls(const FractureOptions& options, double surface, double inside) {
  const SeedsOn on = options.seeds.on;
  const bool followsWalls = ruleOf(options.grow.growth).splits || givesCells(options.grow);
  if (!followsWalls || on == SeedsOn::volume || on == SeedsOn::surface) return 0.0;
  constexpr double kThin = 0.25;
  const double ofPiece = 1.0 / std::cbrt(static_cast<double>(std::max(options.pieces, 1)));
  const bool isThin = 2.0 * inside < std::min(kThin, ofPiece) * std::cbrt(inside) * surface;
  return on == SeedsOn::wall || isThin ? kPerWayToMiddle * voxelsOfLeaves(surface, inside) : 0.0;
}

double bytesFor(const Extent& extent, std::size_t triangles, const FractureOptions& options,
                MeshesHeld held, double voxelSize) {
  const Amount solid = solidAmount(extent, options.solid, voxelSize);
  const double surface = solid.area / (voxelSize * voxelSize);
  const double inside = solid.volume / (voxelSize * voxelSize * voxelSize);
  // A cube cut into n cubes has 3 (n^(1/3) - 1) cuts across it; each bounds two fragments.
  const double cuts =
      6.0 * (std::cbrt(static_cast<double>(options.pieces)) - 1.0) * std::cbrt(inside * inside);
  return kPerTriangle * static_cast<double>(triangles) +
         kPerPiece * static_cast<double>(options.pieces) +
         std::max(bytesForExact(triangles, cuts, options), bytesForDeciding(triangles, options)) +
         bytesForGuides(extent, triangles, surface, inside) +
         bytesForWalls(options, surface, inside) +
         bytesForVoxels(meshFactor(options.surface, held, extent.longest / voxelSize,
                                   extent.hasLargeTriangles) *
                            (surface + cuts),
                        inside, perInsideVoxel(options));
}

}  // namespace

std::uint64_t estimatedMemory(const TriangleMesh& mesh, const FractureOptions& options,
                              MeshesHeld held) {
  const double voxelSize = voxelSizeFor(mesh, options.solid);
  Extent extent = extentOf(mesh);
  addGuides(extent, options.guides);
  return static_cast<std::uint64_t>(
      bytesFor(extent, mesh.triangles.size(), options, held, voxelSize));
}

std::uint64_t estimatedMemoryWithin(const TriangleMesh& mesh, const FractureOptions& options,
                                    MeshesHeld held, std::uint64_t enough) {
  const SolidOptions& solid = options.solid;
  if (solid.voxelSize == 0.0 && solid.resolution == kAutoResolution) {
    FractureOptions highest = options;
    highest.solid.resolution = kMostAutoResolution;
    const std::uint64_t most = estimatedMemory(mesh, highest, held);
    if (most <= enough) return most;
  }
  return estimatedMemory(mesh, options, held);
}

std::uint64_t estimatedMemory(double surface, double inside) {
  return static_cast<std::uint64_t>(bytesForVoxels(surface, inside));
}

std::uint64_t estimatedMemory(const Solid& solid) {
  const auto inside = static_cast<double>(solid.voxels);
  const double side = std::cbrt(inside);
  return estimatedMemory(std::cbrt(36.0 * std::numbers::pi) * side * side, inside);
}

void requireMemory(const TriangleMesh& mesh, const FractureOptions& options, std::uint64_t limit,
                   MeshesHeld held) {
  SolidOptions solidOptions = options.solid;
  const bool isAutomatic =
      solidOptions.voxelSize == 0.0 && solidOptions.resolution == kAutoResolution;
  if (isAutomatic) solidOptions.resolution = kMostAutoResolution;
  double voxelSize = voxelSizeFor(mesh, solidOptions);
  const double longest = longestSide(bounds(mesh));
  Extent extent = extentOf(mesh);
  addGuides(extent, options.guides);
  const auto bytesOf = [&](double size, MeshesHeld of) {
    return static_cast<std::uint64_t>(bytesFor(extent, mesh.triangles.size(), options, of, size));
  };
  const auto bytes = [&](double size) { return bytesOf(size, held); };
  if (bytes(voxelSize) <= limit) return;
  if (isAutomatic) {  // takes as long as reading a mesh, so computed only here
    voxelSize = longest / automaticResolution(mesh, solidOptions);
    if (bytes(voxelSize) <= limit) return;
  }
  const int resolution = resolutionFor(mesh, voxelSize);
  int fits = 0;  // the highest resolution that fits, or 0
  for (int low = 8, high = resolution; low <= high;) {
    const int middle = low + (high - low) / 2;
    if (bytes(longest / middle) <= limit) {
      fits = middle;
      low = middle + 1;
    } else {
      high = middle - 1;
    }
  }
  OptionNames names{"resolution", "max-memory"};
  std::string advice = fits > 0 ? "a resolution of " + std::to_string(fits) + " fits"
                                : std::string("no resolution fits");
  if (bytesOf(voxelSize, MeshesHeld::some) <= limit) {
    advice += ", and this one without the preview image and other files of all pieces";
    names = OptionNames{"resolution", "write", "max-memory"};
  }
  throw memoryError(advice + "; one of " + std::to_string(resolution) +
                        (isAutomatic ? ", which the mesh's walls need," : ""),
                    bytes(voxelSize), limit, std::move(names));
}

}  // namespace sherd
