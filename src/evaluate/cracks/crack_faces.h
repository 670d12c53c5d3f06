// Faces of a mesh: connected areas of one plane, or of one group of triangles.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// An edge of two triangles.
struct SharedEdge {
  std::uint32_t a = 0, b = 0;       ///< triangles
  std::uint32_t low = 0, high = 0;  ///< vertices
};

/// Returns the edges at which two triangles meet; one of k triangles counts as k - 1 edges.
[[nodiscard]] std::vector<SharedEdge> sharedEdges(const TriangleMesh& mesh);

/// A partition of a mesh's triangles into connected areas.
struct Areas {
  std::vector<std::uint32_t> ofTriangle;  ///< [m] below size.size()
  std::vector<double> size;               ///< world units squared
  std::vector<std::uint32_t> group;       ///< that of its triangles
};

/// What is one plane.
struct PlaneLimits {
  double tolerance = 0.0;  ///< world units, > 0
  double leastArea = 0.0;  ///< areas of less have no direction that counts, world units squared
  bool beginWithContacts = true;  ///< a planar contact with one neighbor begins as one area
};

/// Returns connected areas of one plane.  A contact with one neighbor is one area if its rms
/// distance from a plane is within three times the tolerance, else each of its triangles is one.
/// The two areas nearest to a common plane are then merged, again and again, while both have an rms
/// distance from it within the tolerance.  Areas that face away from each other, such as both
/// sides of a thin splinter, stay apart.
///   contact    [m] id of the neighbor; 0 for the original surface, which is in areas of its own
///   return     sizes are those of the areas' projections onto their planes, which are small for
///   the
///              narrow sides of a splinter together; groups are 1 for cracks, else 0
///   throws     Error(cancelled)
[[nodiscard]] Areas planarAreas(const TriangleMesh& mesh, std::span<const SharedEdge> edges,
                                std::span<const std::uint16_t> contact, const PlaneLimits& limits,
                                const Progress* progress);

/// Returns the connected areas of each group.
[[nodiscard]] Areas connectedAreas(const TriangleMesh& mesh, std::span<const SharedEdge> edges,
                                   std::span<const std::uint32_t> group);

/// Numbers sets of triangles as areas.
///   set  [m] a triangle of the set
[[nodiscard]] Areas areasOf(const TriangleMesh& mesh, std::span<const std::uint32_t> set,
                            std::span<const std::uint32_t> group);

inline constexpr std::uint32_t kNoFace = 0xffffffffu;

/// The areas that count as faces.
struct CountedFaces {
  std::vector<std::uint32_t> ofTriangle;  ///< [m] below size.size(), or kNoFace
  std::vector<double> size;               ///< world units squared, without what it was given
  std::vector<char> original;             ///< whether it is original surface
};

/// Returns the areas of at least `least`.  Smaller ones become part of the neighbor with the
/// longest common boundary; original surface, which is group 0, and cracks get nothing of each
/// other.
[[nodiscard]] CountedFaces countedFaces(const TriangleMesh& mesh, std::span<const SharedEdge> edges,
                                        const Areas& areas, double least);

/// Counts points where at least three faces meet.
///   face    [m] number of the face of a triangle, or kNoFace
///   radius  points nearer than this are one; four times as far if they have three faces in common
[[nodiscard]] std::size_t countVertices(const TriangleMesh& mesh,
                                        std::span<const std::uint32_t> face, double radius);

/// Counts the lines at which two faces meet, and that are at least so long along an axis.
[[nodiscard]] std::size_t countLines(const TriangleMesh& mesh, std::span<const SharedEdge> edges,
                                     std::span<const std::uint32_t> face, int axis, double length);

}  // namespace sherd
