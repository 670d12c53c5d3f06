// Counts the faces, vertices and corners of a fragment.
#include "evaluate/cracks/fragment_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>

#include "mesh/plane_moments.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

// Facets.  The relief of real contacts is 3 to 5 % of the root of their area, two equal squares at
// an angle of 27 degrees are 5 % of theirs off a common plane.
constexpr double kFacetTolerance = 0.05;  // of the root of the fragment's area of cracks
constexpr double kFacetShare = 0.02;      // least area, of that area

constexpr double kLineShare = 0.5;  // of the fragment's thickness, for a line across a plate

std::array<glm::dvec3, 3> cornersOf(const TriangleMesh& mesh, std::size_t triangle) {
  return positionsOf(mesh.vertices, mesh.triangles[triangle]);
}

/// Returns whether the rms distance of an area from its plane is within the tolerance.
std::vector<char> evenAreas(const DividedMesh& divided, double tolerance) {
  const Box box = bounds(*divided.mesh);
  const glm::dvec3 center = 0.5 * (box.min + box.max);
  std::vector<PlaneMoments> moments(divided.planes.size.size());
  for (std::size_t i = 0; i < divided.neighbor.size(); ++i) {
    std::array<glm::dvec3, 3> corners = cornersOf(*divided.mesh, i);
    for (glm::dvec3& corner : corners) corner -= center;
    moments[divided.planes.ofTriangle[i]].add(corners);
  }
  std::vector<char> even;
  for (const PlaneMoments& m : moments) {
    even.push_back(m.meanSquare(m.plane()) <= tolerance * tolerance);
  }
  return even;
}

/// Adds up areas by neighbor, and how much of each is in one plane.
void addAreas(DividedMesh& divided, double tolerance) {
  const std::vector<char> even = evenAreas(divided, tolerance);
  std::map<int, double> contacts;
  std::map<std::pair<std::uint32_t, int>, double> parts;  // of a plane and a neighbor
  for (std::size_t i = 0; i < divided.neighbor.size(); ++i) {
    const double size = areaOf(cornersOf(*divided.mesh, i));
    divided.area += size;
    if (divided.neighbor[i] == 0) continue;
    divided.crackArea += size;
    contacts[divided.neighbor[i]] += size;
    parts[{divided.planes.ofTriangle[i], divided.neighbor[i]}] += size;
  }
  divided.neighborArea.assign(contacts.begin(), contacts.end());
  for (const auto& [part, size] : parts) {
    if (size > 0.0 && even[part.first]) divided.onePlane += size * size / contacts[part.second];
  }
}

double leastFacet(const DividedMesh& divided) { return kFacetShare * divided.crackArea; }

/// The faces of a rule.  But by planes, a connected part of the original surface is one.
CountedFaces facesOf(const DividedMesh& divided, FaceRule rule, double least) {
  if (rule == FaceRule::facets) {
    return countedFaces(*divided.mesh, divided.edges, divided.facets,
                        std::max(least, leastFacet(divided)));
  }
  if (rule == FaceRule::planes) {
    return countedFaces(*divided.mesh, divided.edges, divided.planes, least);
  }
  const bool bySplits = rule == FaceRule::splits && !divided.split.empty();
  const std::vector<std::uint32_t> group =
      bySplits ? divided.split
               : std::vector<std::uint32_t>(divided.neighbor.begin(), divided.neighbor.end());
  return countedFaces(*divided.mesh, divided.edges,
                      connectedAreas(*divided.mesh, divided.edges, group), least);
}

/// Returns the faces of cracks alone.
std::vector<std::uint32_t> ofCracks(const CountedFaces& faces) {
  std::vector<std::uint32_t> face = faces.ofTriangle;
  for (std::uint32_t& f : face) {
    if (f != kNoFace && faces.original[f]) f = kNoFace;
  }
  return face;
}

bool hasRim(const DividedMesh& divided, int axis, double leastArea) {
  double size = 0.0;
  for (std::size_t i = 0; i < divided.neighbor.size(); ++i) {
    if (divided.neighbor[i] != 0) continue;
    const glm::dvec3 normal = areaNormal(cornersOf(*divided.mesh, i));
    if (std::abs(normal[axis]) < std::sqrt(0.5) * glm::length(normal)) {
      size += 0.5 * glm::length(normal);
    }
  }
  return size >= leastArea;
}

}  // namespace

DividedMesh divided(const TriangleMesh& mesh, std::vector<std::uint16_t> neighbor,
                    const ShapeLimits& limits, const Progress* progress) {
  DividedMesh result;
  result.mesh = &mesh;
  result.neighbor = std::move(neighbor);
  result.edges = sharedEdges(mesh);
  result.planes =
      planarAreas(mesh, result.edges, result.neighbor,
                  {.tolerance = limits.planeTolerance, .leastArea = limits.leastArea}, progress);
  addAreas(result, limits.planeTolerance);
  return result;
}

void divideIntoFacets(DividedMesh& mesh, const Progress* progress) {
  if (!(mesh.crackArea > 0.0)) {
    mesh.facets = mesh.planes;
    return;
  }
  mesh.facets = planarAreas(*mesh.mesh, mesh.edges, mesh.neighbor,
                            {.tolerance = kFacetTolerance * std::sqrt(mesh.crackArea),
                             .leastArea = leastFacet(mesh),
                             .beginWithContacts = false},
                            progress);
}

void measureShape(FragmentShape& shape, const DividedMesh& divided, FaceRule rule,
                  const ShapeLimits& limits) {
  shape.hasMesh = true;
  const CountedFaces faces = facesOf(divided, rule, limits.leastArea);
  const auto original = std::count(faces.original.begin(), faces.original.end(), 1);
  shape.flatFaces = faces.original.size();
  shape.faces = shape.flatFaces - static_cast<std::size_t>(original);
  shape.flatVertices = countVertices(*divided.mesh, faces.ofTriangle, limits.vertexRadius);
  shape.vertices = countVertices(*divided.mesh, ofCracks(faces), limits.vertexRadius);
  shape.interior = divided.area - divided.crackArea < limits.leastArea;
  shape.breakShare = divided.area > 0.0 ? divided.crackArea / divided.area : 0.0;
  for (const auto& [id, size] : divided.neighborArea) shape.neighbors += size >= limits.leastArea;
}

std::optional<std::size_t> cornersOf(const DividedMesh& divided, FaceRule rule, int axis,
                                     const ShapeLimits& limits) {
  const Box box = bounds(*divided.mesh);
  const double thickness = box.max[axis] - box.min[axis];
  if (hasRim(divided, axis, limits.leastArea)) return {};
  const CountedFaces faces = facesOf(divided, rule, limits.leastArea);
  return countLines(*divided.mesh, divided.edges, ofCracks(faces), axis, kLineShare * thickness);
}

}  // namespace sherd
