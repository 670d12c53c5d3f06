// The faces of a mesh, for formats that hold polygons.
#include "formats/mesh/faces.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "formats/mesh/triangulate.h"

namespace sherd {
namespace {

// A triangle of the piece that is one of the input's.
struct Whole {
  std::uint32_t source, triangle;
  std::array<std::uint32_t, 3> corner;  // of the source, at each corner of the triangle

  bool isFlipped() const { return corner[1] != (corner[0] + 1) % 3; }
};

// Returns the triangles that are whole, in the input's order.
std::vector<Whole> wholeTriangles(const TriangleMesh& mesh, const SourceMesh& input) {
  std::vector<Whole> out;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.source[t] == TriangleMesh::kNoSource) continue;
    const glm::uvec3& source = input.mesh.triangles[mesh.source[t]];
    Whole whole{mesh.source[t], t, {}};
    bool isWhole = true;
    for (int k = 0; k < 3; ++k) {
      std::uint32_t c = 0;
      const glm::dvec3& at = mesh.vertices[mesh.triangles[t][k]];
      while (c < 3 && input.mesh.vertices[source[static_cast<int>(c)]] != at) ++c;
      whole.corner[static_cast<std::size_t>(k)] = c;
      isWhole &= c < 3;
    }
    if (isWhole) out.push_back(whole);
  }
  std::sort(out.begin(), out.end(), [](const Whole& a, const Whole& b) {
    return std::pair(a.source, a.triangle) < std::pair(b.source, b.triangle);
  });
  return out;
}

// Whether these are all triangles of a polygon of the input.
bool areComplete(std::span<const Whole> own, const std::vector<PolygonPart>& parts) {
  const std::uint32_t first = own.front().source, last = own.back().source;
  const std::uint32_t polygon = parts[first].polygon;
  if (last - first + 1 != own.size()) return false;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (own[i].source != first + i || own[i].isFlipped() != own.front().isFlipped()) return false;
  }
  return (first == 0 || parts[first - 1].polygon != polygon) &&
         (last + 1 == parts.size() || parts[last + 1].polygon != polygon);
}

// A corner of the piece, and of which corner of the polygon it is.
struct Ranked {
  std::uint32_t rank, corner;
};

// Returns the corners of all triangles in the polygon's order.
std::vector<Ranked> rankedCorners(std::span<const Whole> own,
                                  const std::vector<PolygonPart>& parts) {
  std::vector<Ranked> out;
  for (const Whole& whole : own) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto c = static_cast<int>(whole.corner[k]);
      out.push_back({parts[whole.source].corner[c], 3 * whole.triangle + k});
    }
  }
  std::sort(out.begin(), out.end(), [](const Ranked& a, const Ranked& b) {
    return std::pair(a.rank, a.corner) < std::pair(b.rank, b.corner);
  });
  return out;
}

std::array<std::uint32_t, 3> ascending(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  std::array<std::uint32_t, 3> out{a, b, c};
  std::sort(out.begin(), out.end());
  return out;
}

// Whether a reader that triangulates a polygon finds the triangles that it has.
//   ranked    the corners of these triangles
//   polygon   its corners; isFlipped: with the ranks backwards from the second on
bool isTriangulatedAlike(const TriangleMesh& mesh, std::span<const Whole> own,
                         std::span<const Ranked> ranked, std::span<const std::uint32_t> polygon) {
  std::vector<std::uint32_t> vertices;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> positionOf;  // of a corner of the piece
  for (const std::uint32_t corner : polygon) {
    vertices.push_back(mesh.triangles[corner / 3][static_cast<int>(corner % 3)]);
  }
  const bool isFlipped = own.front().isFlipped();
  std::uint32_t position = 0;
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    if (i > 0 && ranked[i].rank != ranked[i - 1].rank) ++position;
    const auto count = static_cast<std::uint32_t>(polygon.size());
    positionOf.emplace_back(ranked[i].corner,
                            isFlipped && position > 0 ? count - position : position);
  }
  std::sort(positionOf.begin(), positionOf.end());
  std::vector<std::array<std::uint32_t, 3>> expected, found;
  for (std::size_t i = 0; i < positionOf.size(); i += 3) {
    expected.push_back(
        ascending(positionOf[i].second, positionOf[i + 1].second, positionOf[i + 2].second));
  }
  std::vector<glm::uvec3> triangles;
  triangulate(mesh.vertices, vertices, triangles);
  for (const glm::uvec3& t : triangles) found.push_back(ascending(t.x, t.y, t.z));
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  return expected == found;
}

// Returns the corners of a polygon of these triangles; empty if they cannot be joined.
std::vector<std::uint32_t> polygonOf(const TriangleMesh& mesh, std::span<const Whole> own,
                                     const std::vector<PolygonPart>& parts,
                                     const Faces::IsSame& isSame) {
  if (own.size() < 2 || !areComplete(own, parts)) return {};
  const std::vector<Ranked> ranked = rankedCorners(own, parts);
  std::vector<std::uint32_t> polygon;
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    if (i == 0 || ranked[i].rank != ranked[i - 1].rank) {
      polygon.push_back(ranked[i].corner);
    } else if (!isSame(ranked[i].corner, polygon.back())) {
      return {};
    }
  }
  if (polygon.size() != own.size() + 2) return {};  // its triangles were not all kept
  if (own.front().isFlipped()) std::reverse(polygon.begin() + 1, polygon.end());
  return isTriangulatedAlike(mesh, own, ranked, polygon) ? polygon : std::vector<std::uint32_t>();
}

}  // namespace

Faces::Faces(const PieceMesh& piece, const IsSame& isSame, std::size_t mostCorners)
    : triangles_(static_cast<std::uint32_t>(piece.mesh.triangles.size())), count_(triangles_) {
  const bool hasPolygons = piece.input != nullptr && !piece.input->source.polygons.empty();
  if (hasPolygons && !piece.mesh.source.empty()) join(piece, isSame, mostCorners);
}

std::span<const std::uint32_t> Faces::at(std::uint32_t triangle,
                                         std::array<std::uint32_t, 3>& own) const {
  const std::uint32_t polygon = joined_.empty() ? kAlone : joined_[triangle];
  if (polygon == kWithin) return {};
  if (polygon == kAlone) {
    std::iota(own.begin(), own.end(), 3 * triangle);
    return own;
  }
  const std::size_t begin = polygon == 0 ? 0 : ends_[polygon - 1];
  return std::span(corners_).subspan(begin, ends_[polygon] - begin);
}

void Faces::join(const PieceMesh& piece, const IsSame& isSame, std::size_t mostCorners) {
  const std::vector<PolygonPart>& parts = piece.input->source.polygons;
  const std::vector<Whole> whole = wholeTriangles(piece.mesh, piece.input->source);
  joined_.assign(triangles_, kAlone);
  for (std::size_t begin = 0, end = 0; begin < whole.size(); begin = end) {
    const std::uint32_t polygon = parts[whole[begin].source].polygon;
    while (end < whole.size() && parts[whole[end].source].polygon == polygon) ++end;
    const auto own = std::span(whole).subspan(begin, end - begin);
    const std::vector<std::uint32_t> corners = polygonOf(piece.mesh, own, parts, isSame);
    if (corners.empty() || corners.size() > mostCorners) continue;
    std::uint32_t first = own.front().triangle;
    for (const Whole& one : own) {
      first = std::min(first, one.triangle);
      joined_[one.triangle] = kWithin;
    }
    joined_[first] = static_cast<std::uint32_t>(ends_.size());
    corners_.insert(corners_.end(), corners.begin(), corners.end());
    ends_.push_back(static_cast<std::uint32_t>(corners_.size()));
    count_ -= own.size() - 1;
  }
}

}  // namespace sherd
