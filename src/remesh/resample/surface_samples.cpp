// Dart throwing on faces, which look for others only in the faces around.
#include "remesh/resample/surface_samples.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "base/random.h"

namespace sherd {
namespace {

using Index = SampledMesh::Index;

// Darts for each square of the distance, in so many passes, and for each distance along an edge.
constexpr double kDarts = 4.5, kDartsOfEdges = 8.0;
constexpr int kPasses = 3;

// How far from an edge of its face a point stays, as a share of the height, and from an end of its
// edge, as a share of the length: more would leave a pattern of the faces.
constexpr double kInset = 0.003, kInsetOfEdges = 0.02;

class Darts {
 public:
  Darts(const SampledMesh& mesh, double distance, std::uint64_t seed)
      : mesh_(mesh),
        distance_(distance),
        seed_(seed),
        first_(std::bit_ceil(mesh.faces().size()), kNone) {
    normals_.reserve(mesh.faces().size());
    for (Index f = 0; f < mesh.faces().size(); ++f) {
      const glm::dvec3 &a = corner(f, 0), &b = corner(f, 1), &c = corner(f, 2);
      normals_.push_back(glm::cross(b - a, c - a));
    }
  }

  ///   isCorner  [vertices]
  std::vector<ResampledPoint> all(const std::vector<bool>& isCorner) {
    for (Index v = 0; v < mesh_.vertices().size(); ++v) {
      if (isCorner[v]) add({mesh_.around(v).front(), -1, 0.0, mesh_.vertices()[v]});
    }
    const auto corners = static_cast<std::ptrdiff_t>(samples_.size());
    std::vector<Index> order(mesh_.faces().size());
    std::iota(order.begin(), order.end(), Index{0});
    shuffle(order);
    for (const Index f : order) {
      for (int edge = 0; edge < 3; ++edge) throwAlong(f, edge);
    }
    for (int pass = 0; pass < kPasses; ++pass) {
      shuffle(order);
      for (const Index f : order) throwAt(f);
    }
    samples_.erase(samples_.begin(), samples_.begin() + corners);
    return std::move(samples_);
  }

 private:
  static constexpr Index kNone = SampledMesh::kNone;

  double unit() { return randomUnit(seed_, Stage::resample, drawn_++); }

  void shuffle(std::vector<Index>& order) {
    for (std::size_t i = order.size(); i > 1; --i) {
      std::swap(order[i - 1], order[randomBelow(i, seed_, Stage::resample, drawn_++)]);
    }
  }

  std::size_t countOf(double expected) {
    return static_cast<std::size_t>(std::floor(expected + unit()));
  }

  const glm::dvec3& corner(Index f, int k) const {
    return mesh_.vertices()[mesh_.faces()[f].corner[static_cast<std::size_t>(k % 3)]];
  }

  void throwAlong(Index f, int edge) {
    const SampledMesh::Face& face = mesh_.faces()[f];
    const auto k = static_cast<std::size_t>(edge);
    if (!face.isFeature[k] || face.corner[k] > face.corner[(k + 1) % 3]) return;
    const glm::dvec3 &a = corner(f, edge), &b = corner(f, edge + 1);
    const std::size_t count = countOf(kDartsOfEdges * glm::distance(a, b) / distance_);
    for (std::size_t i = 0; i < count; ++i) {
      const double along = kInsetOfEdges + (1.0 - 2.0 * kInsetOfEdges) * unit();
      const glm::dvec3 at = a + along * (b - a);
      if (isFree(f, at)) add({f, edge, along, at});
    }
  }

  void throwAt(Index f) {
    const glm::dvec3 &a = corner(f, 0), &b = corner(f, 1), &c = corner(f, 2);
    const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
    const std::size_t count = countOf(kDarts / kPasses * area / (distance_ * distance_));
    for (std::size_t i = 0; i < count; ++i) {
      const double root = std::sqrt(unit()), second = unit();
      const glm::dvec3 middle = (a + b + c) / 3.0;
      const glm::dvec3 at = (1.0 - root) * a + root * ((1.0 - second) * b + second * c);
      const glm::dvec3 inset = middle + (1.0 - 3.0 * kInset) * (at - middle);
      if (isFree(f, inset)) add({f, -1, 0.0, inset});
    }
  }

  // Whether no sample is nearer whose face looks to the same side.
  bool isFree(Index f, const glm::dvec3& at) const {
    const glm::ivec3 own = cellOf(at);
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          for (Index s = first_[slotOf(own + glm::ivec3(x, y, z))]; s != kNone; s = next_[s]) {
            const glm::dvec3 to = samples_[s].at - at;
            if (glm::dot(to, to) < distance_ * distance_ &&
                glm::dot(normals_[samples_[s].face], normals_[f]) > 0.0)
              return false;
          }
        }
      }
    }
    return true;
  }

  glm::ivec3 cellOf(const glm::dvec3& at) const {
    return {static_cast<int>(std::floor(at.x / distance_)),
            static_cast<int>(std::floor(at.y / distance_)),
            static_cast<int>(std::floor(at.z / distance_))};
  }

  // Cells may share a slot: then more samples are compared.
  std::size_t slotOf(const glm::ivec3& cell) const {
    const auto x = static_cast<std::uint32_t>(cell.x), y = static_cast<std::uint32_t>(cell.y),
               z = static_cast<std::uint32_t>(cell.z);
    const std::uint32_t hash = x * 0x9e3779b1u ^ y * 0x85ebca77u ^ z * 0xc2b2ae3du;
    return (hash ^ hash >> 15) & (first_.size() - 1);
  }

  void add(const ResampledPoint& sample) {
    Index& first = first_[slotOf(cellOf(sample.at))];
    next_.push_back(first);
    first = static_cast<Index>(samples_.size());
    samples_.push_back(sample);
  }

  const SampledMesh& mesh_;
  const double distance_;
  const std::uint64_t seed_;
  std::uint64_t drawn_ = 0;
  std::vector<ResampledPoint> samples_;
  std::vector<Index> first_;         // [slots] the last sample in a cell, or kNone
  std::vector<Index> next_;          // [samples] the one before in its slot
  std::vector<glm::dvec3> normals_;  // [faces] any length
};

}  // namespace

std::vector<ResampledPoint> surfaceSamples(const SampledMesh& mesh,
                                           const std::vector<bool>& isCorner, double distance,
                                           std::uint64_t seed) {
  return Darts(mesh, distance, seed).all(isCorner);
}

}  // namespace sherd
