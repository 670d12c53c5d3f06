// The surfaces of given cracks.
#include "pipeline/guide_surfaces.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/cancel_flag.h"
#include "base/finite.h"
#include "mesh/repair/repair.h"
#include "mesh/search/curtain.h"
#include "mesh/vertex_normals.h"
#include "voxelize/level_set_mesh.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

constexpr std::size_t kMostGuides = 256;

Error inputError(const Guide& guide, const std::string& what) {
  return Error(ErrorCode::input, (guide.file.empty() ? "a guide" : guide.file) + ": " + what);
}

void check(const Guide& guide) {
  bool isGood = areFinite(guide.mesh.vertices);
  for (const std::vector<glm::dvec3>& line : guide.polylines) {
    if (line.size() < 2) throw inputError(guide, "has a line of less than two points");
    isGood = isGood && areFinite(line);
  }
  if (!isGood) throw inputError(guide, "has a coordinate that is not finite");
  if (guide.polylines.empty() && guide.mesh.triangles.empty()) {
    throw inputError(guide, "has neither lines nor triangles");
  }
}

// The surface on which lines are drawn: of the mesh, or that of the voxels where there is none.
DrawnSurface drawnSurface(const Solid& solid) {
  const TriangleTree* const boundary = solid.region ? solid.region->boundary() : nullptr;
  if (boundary == nullptr) return DrawnSurface(meshInWorld(*solid.distance));
  TriangleMesh mesh = boundary->mesh();
  for (glm::dvec3& v : mesh.vertices) v = solid.frame.worldFromIndex(v);
  return DrawnSurface(std::move(mesh));
}

// Each crack is a pass over the voxels near it.
void requireFew(const Guide& guide, std::size_t cracks) {
  if (cracks <= kMostGuides) return;
  throw inputError(guide, "there are " + std::to_string(cracks) +
                              " lines and connected components to follow; at most " +
                              std::to_string(kMostGuides) + " are possible");
}

// Adds a surface for each connected component.
void addComponents(const Guide& guide, const Progress* progress, std::vector<SidedMesh>& surfaces) {
  const TriangleMesh mesh = repaired(guide.mesh, progress).mesh;
  const MeshComponents components = meshComponents(mesh);
  requireFew(guide, surfaces.size() + components.count);
  std::vector<TriangleMesh> parts(components.count);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    parts[components.ofTriangle[i]].triangles.push_back(mesh.triangles[i]);
  }
  std::vector<std::uint32_t> number(mesh.vertices.size());
  const std::size_t before = surfaces.size();
  for (TriangleMesh& part : parts) {
    throwIfCancelled(progress);
    double extent = 0.0;
    for (glm::uvec3& t : part.triangles) {
      extent = std::max(extent, cornersOf(mesh, t).twiceArea);
      for (int k = 0; k < 3; ++k) number[t[k]] = TriangleTree::kNone;
    }
    if (extent == 0.0) continue;
    for (glm::uvec3& t : part.triangles) {
      for (int k = 0; k < 3; ++k) {
        std::uint32_t& own = number[t[k]];
        if (own == TriangleTree::kNone) {
          own = static_cast<std::uint32_t>(part.vertices.size());
          part.vertices.push_back(mesh.vertices[t[k]]);
        }
        t[k] = own;
      }
    }
    surfaces.emplace_back(std::move(part));
  }
  if (surfaces.size() == before) throw inputError(guide, "its triangles have no area");
}

}  // namespace

GuideSurfaces guideSurfacesOf(std::span<const Guide> guides, const Solid& solid,
                              const Progress* progress) {
  std::optional<DrawnSurface> drawn;
  GuideSurfaces all;
  std::vector<SidedMesh>& surfaces = all.surfaces;
  for (const Guide& guide : guides) {
    check(guide);
    requireFew(guide, surfaces.size() + guide.polylines.size());
    for (const std::vector<glm::dvec3>& line : guide.polylines) {
      throwIfCancelled(progress);
      if (!drawn) drawn.emplace(drawnSurface(solid));
      try {
        surfaces.emplace_back(curtainOf(line, *drawn), SidedMesh::Shape::strip);
      } catch (const Error& e) {
        throw inputError(guide, e.what());
      }
    }
    if (!guide.mesh.triangles.empty()) addComponents(guide, progress, surfaces);
    all.guide.resize(surfaces.size(), static_cast<std::size_t>(&guide - guides.data()));
  }
  return all;
}

std::vector<std::string> guideWarnings(std::span<const Guide> guides,
                                       std::span<const std::size_t> guide,
                                       std::span<const std::size_t> guided, std::size_t splits) {
  const bool areAllTried = splits > guided.size();  // other splits come after all surfaces
  const std::string reason = areAllTried
                                 ? ": no piece has voxels on both sides"
                                 : ": there are no more pieces to make, or none has voxels on both "
                                   "sides";
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < guides.size(); ++i) {
    std::size_t all = 0, idle = 0;
    for (std::size_t surface = 0; surface < guide.size(); ++surface) {
      if (guide[surface] != i) continue;
      ++all;
      idle += std::find(guided.begin(), guided.end(), surface) == guided.end() ? 1 : 0;
    }
    if (idle == 0) continue;
    const std::string name = guides[i].file.empty() ? "a guide" : guides[i].file;
    warnings.push_back(name +
                       (idle == all
                            ? " splits nothing"
                            : ": " + std::to_string(idle) + " of its " + std::to_string(all) +
                                  " lines and connected components split nothing") +
                       reason);
  }
  return warnings;
}

}  // namespace sherd
