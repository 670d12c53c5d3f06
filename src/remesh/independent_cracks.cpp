// Slides vertices over their faces and along edges of contacts.
#include "remesh/independent_cracks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "base/random.h"
#include "mesh/search/nearest_on_triangle.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

// Between two faces of one contact: above this angle of 60 degrees the edge stays an edge.
constexpr double kLeastCosineOfFaces = 0.5;
// Between the two parts of an edge at a vertex, of at most 60 degrees; else it is a corner.
constexpr double kMostCosineOfEdges = -0.5;

// How far vertices go along edges, voxels, and at most this share of an edge.
constexpr double kLeastSlide = 0.15, kMostSlide = 0.45, kMostEdgeShare = 0.45;

constexpr double kLeastCosine = 0.7;  // between a triangle and itself before
constexpr double kLeastArea = 0.05;   // square voxels
constexpr int kPasses = 2;
constexpr std::array kSteps{1.0, 0.5, 0.25, 0.1};

// Rounded, so that what is decided by positions does not depend on the frame.  Of single precision
// there are many numbers half way between two of the grid, which the offset keeps from flipping.
glm::dvec3 inVoxels(const GridFrame& frame, const glm::dvec3& world) {
  constexpr double kGrid = 0x1p-24, kOffset = 0.3183;
  return kGrid * glm::floor(frame.indexFromWorld(world) / kGrid + kOffset);
}

// Numbers 0..1 that are far apart for fragments with near ids.
//   source  Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018
double spreadUnit(const FragmentKey& key, unsigned axis) {
  constexpr std::array kStepsOfIds{0.8191725133961645, 0.6710436067037893, 0.5497004779019703,
                                   0.6180339887498949};
  const double at =
      randomUnit(key.seed, Stage::crackShift, axis) + key.fragment * kStepsOfIds[axis];
  return at - std::floor(at);
}

class CrackSliding {
 public:
  CrackSliding(LabeledMesh& mesh, const GridFrame& frame, const FragmentKey& key)
      : mesh_(mesh.mesh), frame_(frame) {
    for (unsigned k = 0; k < 3; ++k) shift_[static_cast<int>(k)] = spreadUnit(key, k) - 0.5;
    slide_ = kLeastSlide + (kMostSlide - kLeastSlide) * spreadUnit(key, 3);
    contactOf_.reserve(mesh.other.size());
    for (std::size_t t = 0; t < mesh.other.size(); ++t) {
      contactOf_.push_back(mesh.other[t] == 0 ? 0 : 1 + std::uint32_t{mesh_.neighborOf(t)});
    }
    gather();
  }

  void slide() {
    std::vector<glm::dvec3> target;
    target.reserve(moved_.size());
    for (std::uint32_t i = 0; i < moved_.size(); ++i) target.push_back(targetOf(i));
    const std::vector<glm::dvec3> before = at_;
    for (int pass = 0; pass < kPasses; ++pass) {
      for (std::uint32_t i = 0; i < moved_.size(); ++i) moveTowards(i, target[i]);
    }
    for (const std::uint32_t v : moved_) {
      if (at_[v] != before[v]) mesh_.vertices[v] = frame_.worldFromIndex(at_[v]);
    }
  }

 private:
  // A face at a vertex: the vertex, then the next ones counter-clockwise.
  struct Corner {
    std::uint32_t face, next, last;
  };

  // An edge at a vertex that must stay where it is.
  struct Edge {
    std::uint32_t end = kNone;
    bool isForward = false;  // the contact with the higher id is on its left
    bool isOfContacts = false;
  };

  void gather() {
    number_.assign(mesh_.vertices.size(), kNone);
    for (std::size_t t = 0; t < contactOf_.size(); ++t) {
      const glm::uvec3& corner = mesh_.triangles[t];
      for (int k = 0; contactOf_[t] != 0 && k < 3; ++k) number_[corner[k]] = 0;
    }
    for (std::uint32_t v = 0; v < number_.size(); ++v) {
      if (number_[v] == kNone) continue;
      number_[v] = static_cast<std::uint32_t>(moved_.size());
      moved_.push_back(v);
    }
    first_.assign(moved_.size() + 1, 0);
    const auto forEachCorner = [&](const auto& visit) {
      for (std::uint32_t t = 0; t < contactOf_.size(); ++t) {
        const glm::uvec3& corner = mesh_.triangles[t];
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t i = number_[corner[k]];
          if (i != kNone) visit(i, Corner{t, corner[(k + 1) % 3], corner[(k + 2) % 3]});
        }
      }
    };
    forEachCorner([&](std::uint32_t i, const Corner&) { ++first_[i + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    corners_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    forEachCorner([&](std::uint32_t i, const Corner& corner) { corners_[next[i]++] = corner; });
    at_.resize(mesh_.vertices.size());
    for (const std::uint32_t v : moved_) {
      at_[v] = inVoxels(frame_, mesh_.vertices[v]);
      for (const Corner& corner : cornersOf(number_[v])) {
        for (const std::uint32_t u : {corner.next, corner.last})
          at_[u] = inVoxels(frame_, mesh_.vertices[u]);
      }
    }
    normals_.resize(corners_.size());
    for (std::uint32_t i = 0; i < moved_.size(); ++i) {
      for (std::size_t c = first_[i]; c < first_[i + 1]; ++c) {
        const glm::dvec3 n = areaNormal(moved_[i], corners_[c]);
        const double length = glm::length(n);
        normals_[c] = length > 0.0 ? n / length : glm::dvec3(0.0);
      }
    }
  }

  std::span<const Corner> cornersOf(std::uint32_t i) const {
    return std::span(corners_).subspan(first_[i], first_[i + 1] - first_[i]);
  }

  glm::dvec3 areaNormal(std::uint32_t v, const Corner& corner) const {
    return 0.5 * glm::cross(at_[corner.next] - at_[v], at_[corner.last] - at_[v]);
  }

  std::vector<Edge> edgesOf(std::uint32_t i) const {
    std::vector<Edge> edges;
    for (std::size_t left = first_[i]; left < first_[i + 1]; ++left) {
      for (std::size_t right = first_[i]; right < first_[i + 1]; ++right) {
        if (corners_[left].next != corners_[right].last) continue;
        const std::uint32_t one = contactOf_[corners_[left].face],
                            two = contactOf_[corners_[right].face];
        if (one == two && glm::dot(normals_[left], normals_[right]) >= kLeastCosineOfFaces)
          continue;
        edges.push_back({corners_[left].next, one > two, one != two});
      }
    }
    return edges;
  }

  glm::dvec3 targetOf(std::uint32_t i) const {
    const glm::dvec3& from = at_[moved_[i]];
    const std::vector<Edge> edges = edgesOf(i);
    if (edges.empty()) return nearestOnFaces(i, from + shift_);
    if (edges.size() != 2) return from;
    std::array<glm::dvec3, 2> way{at_[edges[0].end] - from, at_[edges[1].end] - from};
    const std::array length{glm::length(way[0]), glm::length(way[1])};
    if (!(glm::dot(way[0], way[1]) < kMostCosineOfEdges * length[0] * length[1])) return from;
    const bool isDirected =
        edges[0].isOfContacts && edges[1].isOfContacts && edges[0].isForward != edges[1].isForward;
    const bool isFirst =
        isDirected ? edges[0].isForward : glm::dot(way[0], shift_) >= glm::dot(way[1], shift_);
    const std::size_t k = isFirst ? 0 : 1;
    return from + std::min(slide_ / length[k], kMostEdgeShare) * way[k];
  }

  glm::dvec3 nearestOnFaces(std::uint32_t i, const glm::dvec3& to) const {
    const glm::dvec3& from = at_[moved_[i]];
    glm::dvec3 nearest = from;
    double least = glm::dot(to - from, to - from);
    for (const Corner& corner : cornersOf(i)) {
      const glm::dvec3 at = nearestOnTriangle(to, from, at_[corner.next], at_[corner.last]);
      const double squared = glm::dot(to - at, to - at);
      if (squared >= least) continue;
      least = squared;
      nearest = at;
    }
    return nearest;
  }

  // Of the worst triangle at a vertex: the cosine to its first normal, less if it is small, at most
  // kLeastCosine.
  double quality(std::uint32_t i) const {
    double least = kLeastCosine;
    for (std::size_t c = first_[i]; c < first_[i + 1]; ++c) {
      const glm::dvec3 n = areaNormal(moved_[i], corners_[c]);
      const double area = glm::length(n);
      if (area == 0.0) return -1.0;
      const double cosine = glm::dot(n, normals_[c]) / area;
      least = std::min(
          least, area < kLeastArea ? std::min(cosine, kLeastCosine * area / kLeastArea) : cosine);
    }
    return least;
  }

  void moveTowards(std::uint32_t i, const glm::dvec3& target) {
    glm::dvec3& at = at_[moved_[i]];
    const glm::dvec3 from = at;
    if (target == from) return;
    const double enough = quality(i);
    for (const double step : kSteps) {
      at = from + step * (target - from);
      if (quality(i) >= enough) return;
    }
    at = from;
  }

  TriangleMesh& mesh_;
  const GridFrame& frame_;
  glm::dvec3 shift_{0.0};                 // voxels
  double slide_ = 0.0;                    // voxels
  std::vector<std::uint32_t> contactOf_;  // [triangles] 0: the original surface
  std::vector<std::uint32_t> number_;     // [vertices] in moved_, or kNone
  std::vector<std::uint32_t> moved_;      // vertices of cracks
  std::vector<std::size_t> first_;        // [moved + 1] into corners_
  std::vector<Corner> corners_;
  std::vector<glm::dvec3> normals_;  // [corners] before any move
  std::vector<glm::dvec3> at_;       // [vertices] index space, of those around moved ones
};

}  // namespace

void slideCracks(LabeledMesh& mesh, const GridFrame& frame, const FragmentKey& key) {
  CrackSliding(mesh, frame, key).slide();
}

void jitterCracks(TriangleMesh& mesh, const GridFrame& frame, const FragmentKey& key) {
  std::vector<bool> isOnCrack(mesh.vertices.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corner = mesh.triangles[t];
    for (int k = 0; mesh.neighborOf(t) != 0 && k < 3; ++k) isOnCrack[corner[k]] = true;
  }
  for (std::size_t v = 0; v < isOnCrack.size(); ++v) {
    if (!isOnCrack[v]) continue;
    glm::dvec3 at = inVoxels(frame, mesh.vertices[v]);
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint64_t item = (std::uint64_t{key.fragment} << 34 | v) * 3 + k;
      at[static_cast<int>(k)] +=
          kCrackJitter * (2.0 * randomUnit(key.seed, Stage::crackJitter, item) - 1.0);
    }
    mesh.vertices[v] = frame.worldFromIndex(at);
  }
}

}  // namespace sherd
