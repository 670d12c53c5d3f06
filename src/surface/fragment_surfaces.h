// The surfaces of all fragments, without their meshes.
#pragma once

#include <sherd/fragments.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "mesh/surface_by_area.h"
#include "surface/contacts.h"
#include "surface/cut.h"
#include "surface/intact.h"
#include "surface/interface_surface.h"
#include "voxelize/leaf_blocks.h"

namespace sherd {

/// The triangles that extractFragments would make with Surface::smooth and Interface::shared, not
/// assembled to a mesh for each fragment.  Those of leaves that no crack passes through are the
/// intact solid's, whose areas and integrals are there already, so only the others cost time.
class FragmentSurfaces {
 public:
  ///   uneroded  labels before erosion, or null
  ///   intact    of the solid, or null: then every fracture meshes the whole surface
  ///   throws    as extractFragments; Error(cancelled)
  FragmentSurfaces(const Solid& solid, const Labels& labels, const Labels* uneroded,
                   std::shared_ptr<const IntactSurface> intact, const Progress* progress);

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

  /// Returns the part of a fragment's mesh that the intact solid does not have, with neighbors: all
  /// fracture faces, and all faces that touch them.
  [[nodiscard]] TriangleMesh changedMesh(std::uint16_t id) const;

 private:
  // What is known of the triangles of a leaf's quads, two of each.
  struct ChangedLeaf {
    std::vector<double> areaSums;         // restarted for each label
    std::vector<std::uint16_t> neighbor;  // found before erosion; else empty
  };

  // Triangles of gaps, likewise.
  using ChangedGaps = ChangedLeaf;

  void measureLeaf(std::size_t leaf, NeighborSearch* search);
  void measureGaps(std::uint16_t id, NeighborSearch* search);

  // The triangle `half` 0 or 1 of a quad of a leaf.
  SurfaceTriangle triangle(std::size_t leaf, const InterfaceQuad& quad, std::size_t half,
                           const std::array<std::uint32_t, 3>& vertex) const;
  SurfaceTriangle gap(std::uint16_t id, std::size_t i) const;

  // Calls `visit` with the triangles of a fragment that the intact solid does not have, and their
  // vertices.
  template <class Visit>
  void forEachChanged(std::uint16_t id, const Visit& visit) const;

  GridFrame frame_;
  std::size_t count_ = 0;
  std::shared_ptr<const IntactSurface> intact_;
  std::vector<LeafNeighbors> ownNeighborhoods_;  // without an intact surface
  std::span<const LeafNeighbors> neighborhoods_;
  Creases ownCreases_;  // without an intact surface
  Cut cut_;
  InterfaceSurface surface_;
  glm::dvec3 reference_;              // of the integrals
  std::vector<ChangedLeaf> changed_;  // [leaf]
  std::vector<ChangedGaps> gaps_;     // [labels + 1]
};

}  // namespace sherd
