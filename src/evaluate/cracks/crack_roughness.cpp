// Correlates the heights of all cracks along given directions.
#include "evaluate/cracks/crack_roughness.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "base/cancel_flag.h"
#include "evaluate/cracks/contact_plane.h"
#include "evaluate/cracks/heights.h"

namespace sherd {
namespace {

constexpr double kInPlane = 0.8;  // cosine of the largest angle between a direction and a crack

/// One contact.
struct Crack {
  const TriangleMesh* mesh = nullptr;
  std::vector<std::uint32_t> triangles{};
  ContactPlane fitted{};
};

/// A direction, of all cracks or of one whose normal is known.
struct Direction {
  const char* name;
  glm::dvec3 axis;
  bool across;  ///< at right angles to the axis, in the crack
};

std::vector<Crack> cracksOf(const DividedMesh& mesh, int id, std::span<const int> ids) {
  std::map<int, Crack> cracks;
  for (std::uint32_t t = 0; t < mesh.neighbor.size(); ++t) {
    const int other = mesh.neighbor[t];
    if (other == 0) continue;
    // Its other side is measured instead, where there is one
    if (other < id && std::binary_search(ids.begin(), ids.end(), other)) continue;
    Crack& crack = cracks[other];
    crack.mesh = mesh.mesh;
    crack.triangles.push_back(t);
  }
  std::vector<Crack> result;
  for (auto& [other, crack] : cracks) {
    crack.fitted = contactPlane(*crack.mesh, crack.triangles);
    result.push_back(std::move(crack));
  }
  return result;
}

/// Returns the direction in a crack's plane, unless it is too far off.
std::optional<glm::dvec3> directionIn(const Direction& direction, const FittedPlane& plane) {
  const glm::dvec3 flat = direction.axis - glm::dot(direction.axis, plane.normal) * plane.normal;
  if (glm::length(flat) < kInPlane) return {};
  const glm::dvec3 unit = glm::normalize(flat);
  return direction.across ? glm::cross(plane.normal, unit) : unit;
}

std::vector<Direction> directionsOf(const std::optional<glm::dvec3>& propagation) {
  if (!propagation) {
    return {{"x", {1, 0, 0}, false}, {"y", {0, 1, 0}, false}, {"z", {0, 0, 1}, false}};
  }
  const glm::dvec3 axis = glm::normalize(*propagation);
  return {{"propagation", axis, false}, {"front", axis, true}};
}

/// One crack's correlation along a direction.
struct Measured {
  double area = 0.0;
  Correlation correlation{};
};

RoughnessAlong summed(const char* name, const std::vector<Measured>& measured) {
  RoughnessAlong result;
  result.direction = name;
  double area = 0.0;
  std::map<double, std::pair<double, double>> squares;  // by lag: sums of squares and of areas
  for (const Measured& m : measured) {
    if (!m.correlation.slope) continue;
    ++result.cracks;
    area += m.area;
    result.hurst += m.area * *m.correlation.slope;
    for (std::size_t i = 0; i < m.correlation.lags.size(); ++i) {
      auto& [sum, weight] = squares[m.correlation.lags[i]];
      sum += m.area * m.correlation.values[i] * m.correlation.values[i];
      weight += m.area;
    }
  }
  if (result.cracks == 0) return result;
  result.hurst /= area;
  for (const Measured& m : measured) {
    if (!m.correlation.slope) continue;
    const double apart = *m.correlation.slope - result.hurst;
    result.deviation += m.area / area * apart * apart;
  }
  const auto count = static_cast<double>(result.cracks);
  result.deviation = count > 1.0 ? std::sqrt(result.deviation * count / (count - 1.0)) : 0.0;
  for (const auto& [lag, sums] : squares) {
    result.lags.push_back(lag);
    result.correlation.push_back(std::sqrt(sums.first / sums.second));
  }
  return result;
}

}  // namespace

CrackRoughness roughnessOf(std::span<const DividedMesh> meshes, std::span<const int> ids,
                           const std::optional<glm::dvec3>& propagation, double spacing,
                           const Progress* progress) {
  std::vector<int> sorted(ids.begin(), ids.end());
  std::sort(sorted.begin(), sorted.end());
  std::vector<Crack> cracks;
  double squares = 0.0, area = 0.0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    throwIfCancelled(progress);
    for (Crack& crack : cracksOf(meshes[i], ids[i], sorted)) {
      squares += crack.fitted.area * crack.fitted.meanSquare;
      area += crack.fitted.area;
      cracks.push_back(std::move(crack));
    }
  }
  CrackRoughness result;
  if (area > 0.0) result.rms = std::sqrt(squares / area);
  for (const Direction& direction : directionsOf(propagation)) {
    std::vector<Measured> measured(cracks.size());
    tbb::parallel_for(std::size_t{0}, cracks.size(), [&](std::size_t i) {
      throwIfCancelled(progress);
      const Crack& crack = cracks[i];
      const std::optional<glm::dvec3> u = directionIn(direction, crack.fitted.plane);
      if (!u) return;
      const std::optional<HeightGrid> grid =
          heightsOver(*crack.mesh, crack.triangles, crack.fitted.plane, *u, spacing);
      if (grid) measured[i] = {crack.fitted.area, correlationAlong(*grid)};
    });
    const RoughnessAlong sum = summed(direction.name, measured);
    if (sum.cracks > 0) result.along.push_back(sum);
  }
  return result;
}

}  // namespace sherd
