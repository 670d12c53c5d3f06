// Voxelization of a mesh to a solid.
#include "voxelize/voxelize.h"

#include <sherd/error.h>
#include <sherd/solid.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <sstream>
#include <utility>
#include <vector>

#include "base/cancel_flag.h"
#include "base/text/formatted.h"
#include "mesh/attributes/seams.h"
#include "mesh/joined.h"
#include "mesh/repair/bodies_apart.h"
#include "mesh/repair/repair.h"
#include "voxelize/bodies/body_layers.h"
#include "voxelize/bodies/bridges.h"
#include "voxelize/bodies/kept_bodies.h"
#include "voxelize/distance.h"
#include "voxelize/fill/fill.h"
#include "voxelize/fill/walls.h"
#include "voxelize/fill/work_limit.h"
#include "voxelize/region.h"
#include "voxelize/shell_mesh.h"

namespace sherd {
namespace {

constexpr int kLargestResolution = 4096;

// A mesh in the index space of a grid.
struct MeshInGrid {
  GridFrame frame;
  TriangleMesh mesh;                  // before repair
  SearchedMesh clean;                 // after repair, with shells of sheets
  std::vector<std::uint32_t> source;  // [triangles of clean] index before repair
  std::vector<SheetFace> sheets;      // of which shells are made
  SheetsApart apart;                  // of a mesh with sheets
  SolidReport report;                 // defects, volume and walls

  // The mesh by which a fill is chosen.
  [[nodiscard]] const SearchedMesh& rest() const { return sheets.empty() ? clean : apart.rest; }
};

// Returns the vertices and triangles, without attributes.
TriangleMesh inIndexSpace(const TriangleMesh& mesh, const GridFrame& frame) {
  TriangleMesh out{mesh.vertices, mesh.triangles};
  for (glm::dvec3& v : out.vertices) v = frame.indexFromWorld(v);
  return out;
}

// Gives a group of flat faces, on the side that shows their others, the triangles of these.
//   first  of the faces, in the order of the shells
void useOthers(SolidMesh& shells, std::span<const SheetFace> faces, std::size_t first,
               const TriangleMesh& mesh) {
  std::map<std::uint32_t, std::uint32_t> at;  // vertices of that side by those of the mesh
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const std::size_t front = 2 * (first + i);
    const glm::uvec3 c = shells.mesh.triangles[front];
    const bool isTurned = faces[i].corners != mesh.triangles[faces[i].front];
    const std::uint32_t away = isTurned ? 0 : shells.mesh.triangles[front + 1].x - c.x;
    for (int k = 0; k < 3; ++k) {
      if (at.try_emplace(faces[i].corners[k], c[k] + away).first->second != c[k] + away) return;
    }
    shown.push_back(isTurned ? front : front + 1);
  }
  for (const SheetFace& face : faces) {
    for (int k = 0; k < 3; ++k) {
      if (!at.contains(mesh.triangles[face.other][k])) return;
    }
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[faces[i].other];
    shells.mesh.triangles[shown[i]] = {at[t.x], at[t.y], at[t.z]};
    shells.source[shown[i]] = faces[i].other;
  }
}

// The same for all groups of which no face was left out.
void useOthers(SolidMesh& shells, const std::vector<SheetFace>& faces, const TriangleMesh& mesh) {
  for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
    end = i + 1;
    while (end < faces.size() && faces[end].group == faces[i].group) ++end;
    const bool isWhole = faces[i].group != 0 && end - i == faces[i].groupSize;
    if (isWhole) useOthers(shells, std::span(faces).subspan(i, end - i), i, mesh);
  }
}

// Sets the mesh of what is left by repair, with shells of its sheets.
void setClean(MeshInGrid& out, Repaired&& repaired, const SolidOptions& options) {
  out.source = std::move(repaired.source);
  out.sheets = std::move(repaired.sheets);
  if (out.sheets.empty()) {
    out.clean = searched(std::move(repaired.mesh));
    return;
  }
  const double thickness = shellVoxels(options, out.frame.voxelSize);
  out.report.sheetThickness = thickness * out.frame.voxelSize;
  SolidMesh sheets{{repaired.mesh.vertices, {}}, {}};
  for (const SheetFace& face : out.sheets) {
    sheets.mesh.triangles.push_back(face.corners);
    sheets.source.push_back(face.front);
    sheets.back.push_back(face.back);
  }
  SolidMesh shells = shellMesh(sheets, thickness);
  useOthers(shells, out.sheets, out.mesh);
  out.source.insert(out.source.end(), shells.source.begin(), shells.source.end());
  out.clean = searched(joined(repaired.mesh, std::move(shells.mesh)));
  out.apart = {searched(std::move(repaired.mesh)), std::move(sheets.mesh)};
}

MeshInGrid inGrid(const TriangleMesh& source, double voxelSize, const SolidOptions& options,
                  const Progress* progress = nullptr) {
  MeshInGrid out;
  out.frame.voxelSize = voxelSize;
  out.frame.origin = bounds(source).min + 0.5 * voxelSize;
  out.mesh = inIndexSpace(source, out.frame);
  Repaired clean = repaired(out.mesh, progress);
  out.report.defects = clean.defects;
  throwIfCancelled(progress);
  setClean(out, std::move(clean), options);
  throwIfCancelled(progress);
  const SearchedMesh& rest = out.rest();
  if (rest.mesh.triangles.empty()) return out;
  // As one mesh: the volume of an open part depends on the point that it is taken about.
  const double volumeVoxels = volume(joined(rest.mesh, rest.caps));
  if (out.sheets.empty()) {
    out.report.meshVolume = volumeVoxels * (voxelSize * voxelSize * voxelSize);
  }
  out.report.walls = wallThickness(rest, longestSide(bounds(out.mesh)), volumeVoxels);
  return out;
}

// Returns the vertices of the mesh with shells of its sheets, world units.
std::vector<glm::dvec3> worldVertices(const MeshInGrid& in, const TriangleMesh& source) {
  std::vector<glm::dvec3> out = source.vertices;
  const std::vector<glm::dvec3>& all = in.clean.mesh.vertices;
  for (std::size_t v = out.size(); v < all.size(); ++v) {
    out.push_back(in.frame.worldFromIndex(all[v]));
  }
  return out;
}

// The solid's mesh for exact surfaces, but for layers and bodies.
//   source  world units
SolidMesh exactMesh(MeshInGrid&& in, const TriangleMesh& source, bool isShell) {
  SolidMesh out{{source.vertices, in.clean.mesh.triangles}, std::move(in.source)};
  if (in.sheets.empty()) return out;
  if (!isShell) {
    out.mesh.vertices = worldVertices(in, source);
    return out;
  }
  // Both sides of all of it are made of the middles.
  out.mesh.triangles = std::move(in.apart.rest.mesh.triangles);
  out.source.resize(out.mesh.triangles.size());
  out.back = out.source;
  for (const SheetFace& face : in.sheets) {
    out.mesh.triangles.push_back(face.corners);
    out.source.push_back(face.front);
    out.back.push_back(face.back);
  }
  return out;
}

// Returns the longest side of a mesh's box.
//   throws  Error(input) unless it is in the range of lengths
double checkedLongestSide(const TriangleMesh& mesh) {
  const double longest = longestSide(bounds(mesh));
  if (!(longest > 0.0) || !std::isfinite(longest)) {
    throw Error(ErrorCode::input,
                "the longest side of the mesh's box is not a finite number above 0");
  }
  if (longest >= kShortestMesh && longest <= kLongestMesh) return longest;
  std::ostringstream text;
  text << "the longest side of the mesh's box is " << longest << ", supported are " << kShortestMesh
       << " to " << kLongestMesh << " (scale it)";
  throw Error(ErrorCode::input, text.str());
}

// Checks the thickness only where the fill may be a shell.
void checkShellThickness(double longest, const SolidOptions& options) {
  const double thickness = options.shellThickness;
  if (options.fill == Fill::parity || options.fill == Fill::flood) return;
  if (thickness >= 0.0 && thickness <= longest) return;
  std::ostringstream text;
  text << "a shell thickness of " << thickness << " is out of range; expected 0 (2.5 voxels) to "
       << longest << ", the mesh's longest side";
  throw Error(ErrorCode::usage, text.str());
}

bool isAutomatic(const SolidOptions& options) {
  return options.voxelSize == 0.0 && options.resolution == kAutoResolution;
}

// Sets the voxels, with how they were filled, which may be none.  Returns the layers and bodies of
// triangles, see BodyLayers.
//   source  the mesh, world units
BodyLayers fill(Solid& solid, const Filling& filling, const MeshInGrid& in,
                const TriangleMesh& source, const SolidOptions& options, const Progress* progress) {
  const double voxelSize = solid.frame.voxelSize;
  SolidReport& report = solid.report;
  report.fill = filling.fill;
  report.fillReason = filling.reason;
  if (filling.fill == Fill::shell) {
    report.shellThickness = 2.0 * filling.halfThickness * voxelSize;
    report.meshVolume = report.sheetThickness = 0.0;
  }
  reportProgress(progress, "voxelize", 0.3);
  if (filling.surface->empty()) return {};
  const FloatGridPtr distance = levelSetOf(filling, solid.frame, progress);
  LeafBlocks blocks = leafBlocks(*distance);
  const std::vector<std::size_t> bridges = bridgesOf(blocks, filling, progress);
  addVoxels(*distance, blocks, bridges);
  BodyLayers layers;
  const bool areKnown = filling.fill == Fill::winding && report.defects.closed();
  report.lacksBodies = options.bodies == MeetingBodies::keep && !areKnown;
  if (areKnown) {
    if (options.bodies == MeetingBodies::keep) layers = keptLayers(blocks, in.clean, progress);
    if (layers.kept == 0) {
      const bool areJoined = layers.areJoined;
      layers = bodyLayers(blocks, in.clean, worldVertices(in, source), progress);
      layers.areJoined = layers.areJoined || areJoined;
    }
    blocks.layers = std::move(layers.voxels);
    report.nearBodies = layers.bodies;
    report.hasJoinedBodies = layers.areJoined;
    report.keptBodies = layers.kept;
    report.hiddenBodies = layers.hidden;
  }
  solid.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  report.bridges = bridges.size();
  solid.distance = distance;
  const Box box = bounds(source);
  const bool isAsVoxels = filling.fill != Fill::shell || options.shellThickness > 0.0;
  solid.region = std::make_shared<const SolidRegion>(
      (box.max - box.min) / voxelSize, filling.surface, filling.contains,
      isAsVoxels ? filling.halfThickness : 0.0, isAsVoxels, filling.firstClosing);
  measureVoxels(solid);
  return layers;
}

// A solid, and the layers and bodies of its mesh's triangles.
struct Filled {
  Solid solid{};
  BodyLayers layers{};
};

// Returns the solid of a mesh in a grid, with its report, which may have no voxels.
//   throws  TooMuchWork, if the choice is limited
Filled filled(const MeshInGrid& in, const FillChoice& choice, const TriangleMesh& source,
              const SolidOptions& options, const Progress* progress) {
  Filled out;
  out.solid.frame = in.frame;
  out.solid.report = in.report;
  const Filling filling = fillingOf(choice, in.clean, in.mesh, options, in.frame.voxelSize,
                                    progress, in.sheets.empty() ? nullptr : &in.apart);
  out.layers = fill(out.solid, filling, in, source, options, progress);
  return out;
}

FillChoice shellInstead(const MeshDefects& defects) {
  return {Fill::shell, "to close " + std::to_string(defects.boundaryEdges) +
                           " boundary edges by winding numbers would take too long"};
}

}  // namespace

int automaticResolution(const TriangleMesh& mesh, const SolidOptions& options) {
  const double longest = checkedLongestSide(mesh);
  checkShellThickness(longest, options);
  if (options.fill == Fill::shell) return kLeastAutoResolution;
  const MeshInGrid coarse = inGrid(mesh, longest / kLeastAutoResolution, options);
  return chosenFill(coarse.rest(), options).fill == Fill::shell
             ? kLeastAutoResolution
             : automaticResolutionOf(coarse.report.walls);
}

double voxelSizeFor(const TriangleMesh& mesh, const SolidOptions& options) {
  const double longest = checkedLongestSide(mesh);
  checkShellThickness(longest, options);
  if (isAutomatic(options)) return longest / automaticResolution(mesh, options);
  if (options.voxelSize == 0.0) {
    if (options.resolution < 8 || options.resolution > kLargestResolution) {
      throw Error(ErrorCode::usage, "a resolution of " + std::to_string(options.resolution) +
                                        " is out of range; expected 8 to " +
                                        std::to_string(kLargestResolution));
    }
    return longest / options.resolution;
  }
  if (!(options.voxelSize > 0.0) || !(longest / options.voxelSize <= kLargestResolution)) {
    std::ostringstream text;
    text << "a voxel size of " << options.voxelSize << " is out of range; the mesh is " << longest
         << " long, so expected " << longest / kLargestResolution << " or more";
    throw Error(ErrorCode::usage, text.str());
  }
  if (options.voxelSize > kLargestVoxel) {
    std::ostringstream text;
    text << "a voxel size of " << options.voxelSize << " is out of range; expected at most "
         << kLargestVoxel;
    throw Error(ErrorCode::usage, text.str());
  }
  return options.voxelSize;
}

int resolutionFor(const TriangleMesh& mesh, double voxelSize) {
  constexpr double kRounding = 1e-9;  // keeps a side of exactly n voxels from becoming n + 1
  return static_cast<int>(std::ceil(longestSide(bounds(mesh)) / voxelSize - kRounding));
}

FloatGridPtr levelSetIn(const TriangleMesh& mesh, const GridFrame& frame,
                        const Progress* progress) {
  const TriangleMesh own = inIndexSpace(mesh, frame);
  const SearchedMesh clean = searched(repaired(own, progress).mesh);
  const FillChoice choice{Fill::winding, {}};
  return levelSetOf(fillingOf(choice, clean, own, {}, frame.voxelSize, progress), frame, progress);
}

namespace {

// Checks that a thickness has an effect.
void requireSheets(const MeshInGrid& in, const FillChoice& choice, const SolidOptions& options) {
  if (options.shellThickness == 0.0 || choice.fill != Fill::winding || !in.sheets.empty()) return;
  throw Error(ErrorCode::usage,
              "a shell thickness with the fill winding is that of sheets with both sides, and the "
              "mesh has none; choose the fill shell, or omit the thickness",
              OptionNames{"shell-thickness", "fill"});
}

// As voxelizeAlone, of a mesh whose bodies share no vertices if they are kept.
Solid voxelizeApart(const TriangleMesh& source, const SolidOptions& options, double workShare,
                    const Progress* progress) {
  SolidOptions first = options;
  if (isAutomatic(options)) first.resolution = kLeastAutoResolution;
  MeshInGrid in = inGrid(source, voxelSizeFor(source, first), options, progress);
  reportProgress(progress, "voxelize", 0.1);
  FillChoice choice = chosenFill(in.rest(), options);
  choice.workShare = workShare;
  requireSheets(in, choice, options);
  if (isAutomatic(options) && choice.fill != Fill::shell) {
    const int resolution = automaticResolutionOf(in.report.walls);
    if (resolution != first.resolution) {
      in = inGrid(source, checkedLongestSide(source) / resolution, options, progress);
      reportProgress(progress, "voxelize", 0.2);
    }
  }
  Filled made;
  try {
    made = filled(in, choice, source, options, progress);
  } catch (const TooMuchWork&) {
    if (isAutomatic(options)) in = inGrid(source, voxelSizeFor(source, first), options, progress);
    made = filled(in, shellInstead(in.report.defects), source, options, progress);
    made.solid.report.tookTooLong = true;
  }
  Solid& solid = made.solid;
  SolidReport& report = solid.report;
  const double voxelSize = solid.frame.voxelSize;
  report.resolution = {resolutionFor(source, voxelSize), isAutomatic(options)};
  if (solid.voxels == 0 && options.keepMesh && choice.fill == Fill::winding &&
      report.defects.closed()) {
    // The voxels only decide where cracks run.
    report.isThinnerThanVoxels = true;
    const FillChoice shell{Fill::shell, "no voxel center lies inside the closed mesh"};
    made.layers = fill(solid, fillingOf(shell, in.clean, in.mesh, options, voxelSize, progress), in,
                       source, options, progress);
  }
  if (options.keepMesh) {
    const bool isShell = report.fill == Fill::shell && !report.isThinnerThanVoxels;
    SolidMesh mesh = exactMesh(std::move(in), source, isShell);
    mesh.layer = std::move(made.layers.ofTriangle);
    mesh.body = std::move(made.layers.bodyOfTriangle);
    solid.mesh = std::make_shared<const SolidMesh>(std::move(mesh));
  }
  if (options.keepSeams) {
    Seams seams(source, solid.frame.origin, voxelSize);
    solid.hasLinearAttributes = seams.areLinear();
    if (!seams.empty()) solid.seams = std::make_shared<const Seams>(std::move(seams));
  }
  if (solid.voxels == 0) {
    throw Error(ErrorCode::input,
                "no voxel center lies inside the mesh at a voxel size of " +
                    formatted("%g", solid.frame.voxelSize) + "; try a higher resolution",
                OptionNames{"resolution"});
  }
  reportProgress(progress, "voxelize", 1.0);
  return std::move(made.solid);
}

}  // namespace

namespace {}  // namespace

Solid voxelizeAlone(const TriangleMesh& source, const SolidOptions& options, double workShare,
                    const Progress* progress) {
  reportProgress(progress, "voxelize", 0.0);
  if (options.bodies == MeetingBodies::unite) {
    return voxelizeApart(source, options, workShare, progress);
  }
  return voxelizeApart(withBodiesApart(source, options.objects), options, workShare, progress);
}

}  // namespace sherd
