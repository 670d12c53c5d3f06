// Noise on the surfaces of fragments.
#include "surface/surface_noise.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "base/random.h"
#include "mesh/vertex_normals.h"
#include "surface/boundary_distance.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

// Waves shorter than this are not made: meshes have vertices about a voxel apart.
constexpr double kShortestVoxels = 1.0;

// At the contact boundary the mismatch falls to nothing over this many voxels, and this many times
// its rms: between a boundary's vertices and the next ones, and never steeper than that.
constexpr double kFadeVoxels = 1.0, kFadeOfRms = 3.0;

double diagonalVoxels(const Solid& solid) {
  if (solid.region) return glm::length(solid.region->sides());
  const openvdb::Coord dims = solid.box.dims();
  return glm::length(glm::dvec3(dims.x(), dims.y(), dims.z()));
}

std::optional<SelfAffineShape> shapeOf(const NoiseOptions& noise, double diagonal) {
  if (noise.rms == 0.0) return {};
  return SelfAffineShape{.rms = noise.rms / 100.0 * diagonal,
                         .hurst = noise.hurst,
                         .longest = noise.wavelength / 100.0 * diagonal,
                         .shortest = kShortestVoxels};
}

// Corners of a triangle move apart by at most these shares of its height, in its plane and across.
constexpr double kMostShear = 0.25, kMostSlope = 2.0;
constexpr int kMostPasses = 32;

// Whether displacements move the corners of a triangle too far apart.
bool isTorn(const TriangleMesh& mesh, const glm::uvec3& t, const std::vector<glm::dvec3>& by) {
  const glm::dvec3 a = mesh.vertices[t.y] - mesh.vertices[t.x],
                   b = mesh.vertices[t.z] - mesh.vertices[t.y], c = a + b;
  const double longest = std::sqrt(std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)}));
  const glm::dvec3 across = glm::cross(a, b);
  const double area = glm::length(across);
  const auto isFar = [&](const glm::dvec3& way) {
    if (area == 0.0) return way != glm::dvec3(0.0);
    const double along = glm::dot(way, across);
    const double within =
        std::sqrt(std::max(glm::dot(way, way) * area * area - along * along, 0.0));
    return longest * within > kMostShear * area * area ||
           longest * std::abs(along) > kMostSlope * area * area;
  };
  return isFar(by[t.y] - by[t.x]) || isFar(by[t.z] - by[t.y]) || isFar(by[t.x] - by[t.z]);
}

// Moves vertices. Where the corners of a triangle would move too far apart, as of one whose height
// is less than what noise moves it by, they move alike, by the mean, so that hardly any turns over.
//   by  [vertices] displacements; where they are 0 a vertex stays, and those beside it move less
void moveUnfolded(TriangleMesh& mesh, std::vector<glm::dvec3> by) {
  std::vector<bool> stays(by.size());
  for (std::size_t v = 0; v < by.size(); ++v) stays[v] = by[v] == glm::dvec3(0.0);
  for (int pass = 0; pass < kMostPasses; ++pass) {
    std::vector<glm::dvec3> sum(by.size());
    std::vector<int> count(by.size());
    for (const glm::uvec3& t : mesh.triangles) {
      if (!isTorn(mesh, t, by)) continue;
      const glm::dvec3 mean = (by[t.x] + by[t.y] + by[t.z]) / 3.0;
      for (int k = 0; k < 3; ++k) {
        sum[t[k]] += mean;
        ++count[t[k]];
      }
    }
    bool isAny = false;
    for (std::size_t v = 0; v < by.size(); ++v) {
      if (count[v] == 0 || stays[v]) continue;
      by[v] = sum[v] / static_cast<double>(count[v]);
      isAny = true;
    }
    if (!isAny) break;
  }
  for (std::size_t v = 0; v < by.size(); ++v) mesh.vertices[v] += by[v];
}

// Returns 0 at 0, 1 from 1 on, with a continuous slope.
double faded(double x) { return x >= 1.0 ? 1.0 : x * x * (3.0 - 2.0 * x); }

// Returns its derivative.
double slopeOfFaded(double x) { return x >= 1.0 ? 0.0 : 6.0 * x * (1.0 - x); }

// Moves a point along its normal, which becomes that of the moved surface.
//   height  voxels, with its gradient in voxels, which has no unit
void displace(SurfacePoint& point, const SlopedValue& height, double voxelSize) {
  const glm::dvec3 normal = point.normal;
  point.position += height.value * voxelSize * normal;
  const glm::dvec3 along = height.gradient - glm::dot(height.gradient, normal) * normal;
  point.normal = glm::normalize(normal - along);
}

}  // namespace

SurfaceNoise::SurfaceNoise(const SurfaceOptions& options, const Solid& solid, std::uint64_t seed)
    : frame_(solid.frame), seed_(seed) {
  const double diagonal = diagonalVoxels(solid);
  cracks_ = shapeOf(options.mismatch, diagonal);
  all_ = shapeOf(options.scanNoise, diagonal);
  ownShare_ = std::sqrt(1.0 - options.mismatchCommon);
  commonShare_ = std::sqrt(options.mismatchCommon);
  if (cracks_ && commonShare_ > 0.0) {
    common_.emplace(*cracks_, randomBits(seed, Stage::mismatch, 0));
  }
}

double SurfaceNoise::fadeVoxels() const {
  return cracks_ ? std::max(kFadeVoxels, kFadeOfRms * cracks_->rms) : 0.0;
}

SurfaceNoise::OfPoints SurfaceNoise::ofPoints(std::uint16_t id) const {
  OfPoints noise{.id = id, .frame = frame_, .fade = fadeVoxels(), .common = common_};
  if (cracks_) noise.own.emplace(*cracks_, randomBits(seed_, Stage::mismatch, id));
  if (all_) noise.all.emplace(*all_, randomBits(seed_, Stage::scanNoise, id));
  noise.ownShare = ownShare_;
  noise.commonShare = commonShare_;
  return noise;
}

void SurfaceNoise::OfPoints::move(SurfacePoint& point, const SlopedValue& toBoundary) const {
  if (own && point.neighbor != 0) {
    const glm::dvec3 at = frame.indexFromWorld(point.position);
    SlopedValue height = own->slopedAt(at);
    height.value *= ownShare, height.gradient *= ownShare;
    if (common) {
      // Outwards for the one is inwards for the other.
      const double share = id < point.neighbor ? commonShare : -commonShare;
      const SlopedValue both = common->slopedAt(at);
      height.value += share * both.value, height.gradient += share * both.gradient;
    }
    const double x = toBoundary.value / fade;
    height.gradient =
        faded(x) * height.gradient + height.value * slopeOfFaded(x) / fade * toBoundary.gradient;
    height.value *= faded(x);
    displace(point, height, frame.voxelSize);
  }
  if (all) displace(point, all->slopedAt(frame.indexFromWorld(point.position)), frame.voxelSize);
}

void SurfaceNoise::move(TriangleMesh& mesh, std::uint16_t id) const {
  if (cracks_) moveCracks(mesh, id);
  if (all_) moveAll(mesh, id);
}

void SurfaceNoise::moveCracks(TriangleMesh& mesh, std::uint16_t id) const {
  const std::vector<std::uint16_t> contact = contactsOf(mesh);
  const double fade = fadeVoxels();
  const std::vector<double> distance = boundaryDistances(mesh, contact, frame_.voxelSize, fade);
  const SelfAffineNoise own(*cracks_, randomBits(seed_, Stage::mismatch, id));
  const std::vector<glm::dvec3> normals = vertexNormals(mesh);
  std::vector<glm::dvec3> by(contact.size());
  for (std::size_t v = 0; v < contact.size(); ++v) {
    if (contact[v] == kNoContact || contact[v] == kContactBoundary) continue;
    const glm::dvec3 at = frame_.indexFromWorld(mesh.vertices[v]);
    double height = ownShare_ * own.at(at);
    // Outwards for the one is inwards for the other.
    if (common_) height += (id < contact[v] ? 1.0 : -1.0) * commonShare_ * common_->at(at);
    by[v] = faded(distance[v] / fade) * height * frame_.voxelSize * normals[v];
  }
  moveUnfolded(mesh, std::move(by));
}

void SurfaceNoise::moveAll(TriangleMesh& mesh, std::uint16_t id) const {
  const SelfAffineNoise noise(*all_, randomBits(seed_, Stage::scanNoise, id));
  const std::vector<glm::dvec3> normals = vertexNormals(mesh);
  std::vector<glm::dvec3> by(mesh.vertices.size());
  for (std::size_t v = 0; v < by.size(); ++v) {
    const double height = noise.at(frame_.indexFromWorld(mesh.vertices[v]));
    by[v] = height * frame_.voxelSize * normals[v];
  }
  moveUnfolded(mesh, std::move(by));
}

}  // namespace sherd
