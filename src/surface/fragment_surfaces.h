// The surfaces of all fragments, their measures and meshes.
#pragma once

#include <sherd/fragments.h>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "interface/contacts.h"
#include "interface/cut_solid.h"
#include "interface/interface_mesh.h"
#include "interface/interface_surface.h"
#include "mesh/surface_by_area.h"
#include "remesh/complex.h"
#include "surface/surface_noise.h"

namespace sherd {

/// The surfaces that extractFragments makes with Surface::smooth and Interface::shared, before they
/// are smoothed or simplified.  Quads away from cracks are the intact solid's, whose areas and
/// integrals are there already, so mostly the others cost time.  All sums are made leaf by
/// leaf, so that they do not depend on which leaves are the intact solid's.
class FragmentSurfaces {
 public:
  ///   uneroded  labels before erosion, or null
  ///   intact    of the solid, or null: then every fracture meshes the whole surface
  ///   throws    as extractFragments; Error(cancelled)
  FragmentSurfaces(const Solid& solid, const Labels& labels, const Labels* uneroded,
                   std::shared_ptr<const IntactSurface> intact, const Progress* progress);

  /// The same of a solid that has been cut.
  ///   vertices  all if meshes are wanted
  FragmentSurfaces(const Solid& solid, const Labels& labels, const Labels* uneroded,
                   std::shared_ptr<const CutSolid> cut, SurfaceVertices vertices,
                   const Progress* progress);

  /// Displaces the points of byArea() from now on, along normals that become those of the moved
  /// surface.  All else stays.
  ///   noise  of the fracture
  void displacePoints(const SurfaceNoise& noise, const Progress* progress);

  /// Returns the number of fragments.
  [[nodiscard]] std::size_t count() const { return count_; }

  FragmentSurfaces(const FragmentSurfaces&) = delete;
  FragmentSurfaces& operator=(const FragmentSurfaces&) = delete;

  /// Returns a fragment without voxels, mesh and contacts: its mass and areas.
  [[nodiscard]] Fragment measured(std::uint16_t id) const;

  /// Returns all contacts of each fragment.
  ///   labels  before erosion
  [[nodiscard]] std::vector<std::vector<Contact>> contacts(const Solid& solid,
                                                           const Labels& labels) const;

  /// Returns the triangles of a fragment, in the order of its mesh.  They refer to this object.
  [[nodiscard]] SurfaceByArea byArea(std::uint16_t id) const;

  /// Returns the box of a fragment's surface, world units.
  [[nodiscard]] Box box(std::uint16_t id) const;

  /// Returns the number of triangles of a fragment.
  [[nodiscard]] std::size_t triangles(std::uint16_t id) const;

  /// Returns [fragments + 1] the number of vertices of each.
  [[nodiscard]] std::vector<std::size_t> vertexCounts() const;

  /// Returns [fragments + 1] the length of the boundary of each contact by neighbor, world units.
  [[nodiscard]] std::vector<std::map<int, double>> boundaryLengths() const;

  /// Returns the mesh of a fragment, with the neighbor of each triangle.  Needs
  /// SurfaceVertices::all.
  [[nodiscard]] LabeledMesh meshOf(std::uint16_t id) const;

 private:
  // A triangle of a fragment: of a quad, or in a gap.
  struct TriangleIndex {
    const InterfaceQuad* quad = nullptr;  // null: in a gap
    std::size_t i = 0;                    // half of the quad, or index of the gap
  };

  // Triangles of a fragment in a leaf.
  struct Part {
    std::uint32_t leaf = 0;
    const InterfaceQuad* quads = nullptr;  // null: the intact solid's
  };

  // Returns SurfaceParts::displace.
  //   own  the parts but the last, which is that of gaps
  std::function<void(std::size_t part, std::size_t triangle, const std::array<double, 3>& shares,
                     SurfacePoint& point)>
  displacementOf(std::uint16_t id, const std::vector<Part>& own) const;

  std::array<std::uint32_t, 3> verticesOf(std::uint16_t id, const TriangleIndex& of) const;

  // Returns a point's distance from its contact's boundary, interpolated in its triangle.
  SlopedValue toBoundary(std::uint16_t id, const TriangleIndex& of,
                         const std::array<double, 3>& shares) const;
  // Sets those of one fragment.
  //   numbers  [vertices] kNoNumber, set for those of the fragment
  void findDistances(std::uint16_t id, double most, std::vector<std::uint32_t>& numbers);

  // Finds the neighbors before erosion.
  void findNeighbors(const Solid& solid, const Labels& uneroded, const Progress* progress);

  // The neighbor of the triangle `half`, 0 or 1, of a quad of a leaf; and the triangle.
  std::uint16_t neighborOf(std::size_t leaf, const InterfaceQuad& quad, std::size_t half) const;
  SurfaceTriangle triangle(std::size_t leaf, const InterfaceQuad& quad, std::size_t half) const;
  SurfaceTriangle gap(std::uint16_t id, std::size_t i) const;

  // Call visit(triangle, vertices) for a fragment's triangles of cracks: those of quads, of gaps.
  template <class Visit>
  void forEachCrackOfQuads(std::uint16_t id, const Visit& visit) const;
  template <class Visit>
  void forEachCrackOfGaps(std::uint16_t id, const Visit& visit) const;

  GridFrame frame_;
  std::size_t count_ = 0;
  std::shared_ptr<const CutSolid> cut_;
  InterfaceSurface surface_;
  std::optional<InterfaceMeshes> meshes_;  // with SurfaceVertices::all
  glm::dvec3 reference_;                   // of the integrals
  // Neighbors before erosion, two of each quad; empty without erosion.
  std::vector<std::vector<std::uint16_t>> neighbors_;     // [leaf]
  std::vector<std::vector<std::uint16_t>> gapNeighbors_;  // [labels + 1]
  std::optional<SurfaceNoise> noise_;                     // of points
  std::vector<double> toBoundary_;  // [vertices] with a mismatch: voxels, at most fadeVoxels()
};

}  // namespace sherd
