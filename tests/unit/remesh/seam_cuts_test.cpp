// Borders of attributes on fragments against the seams of the input, which are known lines.
#include "remesh/seam_cuts.h"

#include <gtest/gtest.h>
#include <sherd/fracture.h>
#include <sherd/growth.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "appearance/transfer.h"
#include "kernels/device_fixture.h"
#include "mesh/attributes/charts.h"
#include "mesh/attributes/seams.h"
#include "mesh/search/triangle_tree.h"
#include "points/sample_surface.h"
#include "shapes.h"

namespace sherd {
namespace {

constexpr double kPi = std::numbers::pi;

// A rotation whose entries are exact to rounding, so that nothing is aligned with the voxels.
glm::dvec3 turned(const glm::dvec3& p) {
  return {0.36 * p.x + 0.48 * p.y - 0.8 * p.z, -0.8 * p.x + 0.6 * p.y,
          0.48 * p.x + 0.64 * p.y + 0.6 * p.z};
}

void addQuad(TriangleMesh& mesh, const std::array<std::uint32_t, 4>& v,
             const std::array<glm::vec2, 4>& uv, std::uint32_t material) {
  for (const auto& [a, b, c] : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
    const auto corner = [](int k) { return static_cast<std::size_t>(k); };
    mesh.triangles.emplace_back(v[corner(a)], v[corner(b)], v[corner(c)]);
    mesh.attributes.texcoords.push_back({uv[corner(a)], uv[corner(b)], uv[corner(c)]});
    mesh.attributes.material.push_back(material);
  }
}

// A torus whose texture goes once round both ways, in `parts` charts side by side.
TriangleMesh torus(int parts) {
  constexpr int kAround = 64, kAcross = 32;
  TriangleMesh out;
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const double a = 2.0 * kPi * i / kAround, b = 2.0 * kPi * j / kAcross;
      const double radius = 1.0 + 0.4 * std::cos(b);
      out.vertices.push_back(
          turned({radius * std::cos(a), radius * std::sin(a), 0.4 * std::sin(b)}));
    }
  }
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      std::array<std::uint32_t, 4> v{};
      std::array<glm::vec2, 4> uv{};
      for (int k = 0; k < 4; ++k) {
        const int x = i + (k == 1 || k == 2 ? 1 : 0), y = j + (k >= 2 ? 1 : 0);
        const auto at = static_cast<std::size_t>(k);
        v[at] = static_cast<std::uint32_t>(x % kAround * kAcross + y % kAcross);
        uv[at] = {static_cast<float>(x) / kAround + static_cast<float>(i * parts / kAround),
                  static_cast<float>(y) / kAcross};
      }
      addQuad(out, v, uv, 0);
    }
  }
  return out;
}

// A cube with a material on each side, and a texture in islands of a third of a side.
TriangleMesh box() {
  constexpr int kIslands = 3;
  TriangleMesh out;
  std::map<std::array<int, 3>, std::uint32_t> number;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    for (int i = 0; i < kIslands; ++i) {
      for (int j = 0; j < kIslands; ++j) {
        std::array<std::uint32_t, 4> v{};
        std::array<glm::vec2, 4> uv{};
        for (int k = 0; k < 4; ++k) {
          const int dx = k == 1 || k == 2 ? 1 : 0, dy = k >= 2 ? 1 : 0;
          std::array<int, 3> grid{};
          grid[static_cast<std::size_t>(axis)] = side % 2 == 1 ? kIslands : 0;
          grid[static_cast<std::size_t>((axis + 1) % 3)] =
              side % 2 == 1 ? i + dx : kIslands - i - dx;
          grid[static_cast<std::size_t>((axis + 2) % 3)] = j + dy;
          const auto [found, isNew] =
              number.try_emplace(grid, static_cast<std::uint32_t>(out.vertices.size()));
          if (isNew) {
            out.vertices.push_back(
                turned(2.0 / kIslands * glm::dvec3(grid[0], grid[1], grid[2]) - 1.0));
          }
          v[static_cast<std::size_t>(k)] = found->second;
          uv[static_cast<std::size_t>(k)] = {
              10.0f * static_cast<float>(9 * side + 3 * i + j) + static_cast<float>(dx),
              static_cast<float>(dy)};
        }
        addQuad(out, v, uv, static_cast<std::uint32_t>(side));
      }
    }
  }
  return out;
}

// A ball with a material on each side of a circle.
TriangleMesh ball() {
  constexpr int kAround = 64, kRings = 32;
  TriangleMesh out;
  const auto at = [&](int i, int j) {
    if (j == 0 || j == kRings) return static_cast<std::uint32_t>(j == 0 ? 0 : 1);
    return static_cast<std::uint32_t>(2 + (j - 1) * kAround + i % kAround);
  };
  out.vertices = {turned({0, 0, 1}), turned({0, 0, -1})};
  for (int j = 1; j < kRings; ++j) {
    for (int i = 0; i < kAround; ++i) {
      const double a = 2.0 * kPi * i / kAround, b = kPi * j / kRings;
      out.vertices.push_back(
          turned({std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b)}));
    }
  }
  for (int j = 0; j < kRings; ++j) {
    for (int i = 0; i < kAround; ++i) {
      const std::uint32_t a = at(i, j), b = at(i, j + 1), c = at(i + 1, j + 1), d = at(i + 1, j);
      const std::uint32_t material = j < 12 ? 0 : 1;
      if (j + 1 < kRings) {
        out.triangles.emplace_back(a, b, c);
        out.attributes.material.push_back(material);
      }
      if (j > 0) {
        out.triangles.emplace_back(a, c, d);
        out.attributes.material.push_back(material);
      }
    }
  }
  return out;
}

using Segment = std::array<glm::dvec3, 2>;

std::vector<Segment> seamsOf(const TriangleMesh& mesh) {
  std::vector<Segment> out;
  for (const Charts::Seam& seam : charts(mesh).seams) {
    const glm::uvec3& t = mesh.triangles[seam.triangle[0]];
    out.push_back({mesh.vertices[t[seam.corner[0]]], mesh.vertices[t[(seam.corner[0] + 1) % 3]]});
  }
  return out;
}

// Edges between faces of the original surface whose attributes differ.
std::vector<Segment> bordersOf(const TriangleMesh& mesh, const AttributeSource& source) {
  TriangleMesh original{mesh.vertices, {}};
  const SurfaceAttributes all = source.transferTo(mesh, 99);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.neighborOf(t) != 0) continue;
    original.triangles.push_back(mesh.triangles[t]);
    if (!all.texcoords.empty()) original.attributes.texcoords.push_back(all.texcoords[t]);
    if (!all.material.empty()) original.attributes.material.push_back(all.material[t]);
  }
  return seamsOf(original);
}

TriangleTree treeOf(const std::vector<Segment>& segments) {
  TriangleMesh lines;
  for (const Segment& s : segments) {
    const auto v = static_cast<std::uint32_t>(lines.vertices.size());
    lines.vertices.insert(lines.vertices.end(), s.begin(), s.end());
    lines.triangles.emplace_back(v, v + 1, v + 1);
  }
  return TriangleTree(lines);
}

// Distances along the surface of points on some lines from other lines, ascending, where the points
// lie on `surface` to `step` / 5: elsewhere, as on creases beside cracks, the surface itself is
// off.
std::vector<double> deviations(const std::vector<Segment>& of, const std::vector<Segment>& from,
                               const TriangleTree& surface, double step) {
  const TriangleTree tree = treeOf(from);
  std::vector<double> out;
  for (const auto& [a, b] : of) {
    const int steps = 1 + static_cast<int>(glm::length(b - a) / step);
    for (int i = 0; i <= steps; ++i) {
      const glm::dvec3 p = a + static_cast<double>(i) / steps * (b - a);
      const double above = surface.nearest(p, 0.2 * step).distance;
      if (!(above < 0.2 * step)) continue;
      const double apart = tree.nearest(p, 1e9).distance;
      out.push_back(std::sqrt(std::max(0.0, apart * apart - above * above)));
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

TriangleMesh joinedOriginal(const std::vector<Fragment>& fragments) {
  TriangleMesh out;
  for (const Fragment& fragment : fragments) {
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    out.vertices.insert(out.vertices.end(), fragment.mesh.vertices.begin(),
                        fragment.mesh.vertices.end());
    for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
      if (fragment.mesh.neighborOf(t) == 0)
        out.triangles.push_back(fragment.mesh.triangles[t] + first);
    }
  }
  return out;
}

struct Case {
  std::string name;
  TriangleMesh mesh;
};

std::vector<Case> cases() {
  return {{"one chart", torus(1)}, {"four charts", torus(4)}, {"box", box()}, {"ball", ball()}};
}

FractureOptions optionsOf(int resolution, int pieces = 8) {
  FractureOptions options;
  options.solid.resolution = resolution;
  options.pieces = pieces;
  options.seed = 3;
  options.surface.levelSets = false;
  options.surface.adaptivity = 0.0;
  return options;
}

class SeamCuts : public DeviceTest {
 protected:
  static FractureResult broken(const TriangleMesh& mesh, FractureOptions options,
                               bool keepSeams = true) {
    options.solid.keepSeams = keepSeams;
    return fracture(mesh, options, device());
  }
};

using Corners = std::array<glm::dvec3, 3>;

// The triangles of a fragment next to another one, first corner lowest.
std::multiset<std::array<double, 9>> facesNextTo(const Fragment& fragment, int neighbor,
                                                 bool isReversed) {
  std::multiset<std::array<double, 9>> out;
  for (std::size_t t = 0; t < fragment.mesh.triangles.size(); ++t) {
    if (fragment.mesh.neighborOf(t) != neighbor) continue;
    std::array<std::array<double, 3>, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& v = fragment.mesh.vertices[fragment.mesh.triangles[t][static_cast<int>(k)]];
      corner[isReversed ? 2 - k : k] = {v.x, v.y, v.z};
    }
    std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()), corner.end());
    std::array<double, 9> flat{};
    for (std::size_t k = 0; k < 9; ++k) flat[k] = corner[k / 3][k % 3];
    out.insert(flat);
  }
  return out;
}

void expectShared(const FractureResult& result) {
  for (const Fragment& fragment : result.fragments) {
    EXPECT_EQ(openEdges(fragment.mesh), 0u);
    EXPECT_EQ(nonManifoldEdges(fragment.mesh), 0u);
    for (const Contact& contact : fragment.contacts) {
      const Fragment& other = result.fragments[static_cast<std::size_t>(contact.fragment) - 1];
      EXPECT_EQ(facesNextTo(fragment, other.id, false), facesNextTo(other, fragment.id, true));
    }
  }
}

double share(const std::vector<double>& ascending, double part) {
  return ascending[static_cast<std::size_t>(part * static_cast<double>(ascending.size() - 1))];
}

struct Deviations {
  std::vector<double> borders, seams;  // of one from the other, voxels, ascending
};

Deviations deviationsOf(const FractureResult& result, const TriangleMesh& mesh) {
  const AttributeSource source(mesh);
  std::vector<Segment> borders;
  for (const Fragment& fragment : result.fragments) {
    const std::vector<Segment> own = bordersOf(fragment.mesh, source);
    borders.insert(borders.end(), own.begin(), own.end());
  }
  const double voxel = result.solid.frame.voxelSize;
  const std::vector<Segment> seams = seamsOf(mesh);
  Deviations out{
      deviations(borders, seams, TriangleTree(mesh), 0.25 * voxel),
      deviations(seams, borders, TriangleTree(joinedOriginal(result.fragments)), 0.25 * voxel)};
  for (double& d : out.borders) d /= voxel;
  for (double& d : out.seams) d /= voxel;
  return out;
}

// Vertices within kOnSeam of a seam count as on it.  Beside cracks, where the surface leaves the
// creases of the box, single faces have the attributes of the wrong side.
TEST_F(SeamCuts, BordersAreStraight) {
  for (const Case& of : cases()) {
    for (const int resolution : {48, 64}) {
      SCOPED_TRACE(of.name + " at " + std::to_string(resolution));
      const Deviations cut = deviationsOf(broken(of.mesh, optionsOf(resolution)), of.mesh);
      EXPECT_LT(share(cut.borders, 0.95), Seams::kOnSeam);
      EXPECT_LT(share(cut.seams, 0.95), Seams::kOnSeam);
      EXPECT_LT(cut.borders.back(), of.name == "box" ? 1.0 : 0.1);
      EXPECT_LT(cut.seams.back(), of.name == "box" ? 0.5 : 0.1);
      const Deviations plain = deviationsOf(broken(of.mesh, optionsOf(resolution), false), of.mesh);
      EXPECT_GT(share(plain.borders, 0.95), 0.3);
    }
  }
}

TEST_F(SeamCuts, ChangeNothingElse) {
  for (const Case& of : cases()) {
    SCOPED_TRACE(of.name);
    const FractureResult cut = broken(of.mesh, optionsOf(40)),
                         plain = broken(of.mesh, optionsOf(40), false);
    expectShared(cut);
    ASSERT_NE(cut.solid.seams, nullptr);
    EXPECT_EQ(plain.solid.seams, nullptr);
    std::size_t cutFaces = 0;
    for (std::size_t i = 0; i < cut.fragments.size(); ++i) {
      const Fragment &a = cut.fragments[i], &b = plain.fragments[i];
      EXPECT_NEAR(a.mass.volume, b.mass.volume, 1e-12);
      EXPECT_NEAR(a.area, b.area, 1e-12 * 100);
      EXPECT_NEAR(a.fractureArea, b.fractureArea, 1e-12 * 100);
      const TriangleMesh whole = uncut(a);
      EXPECT_EQ(whole.triangles, b.mesh.triangles);
      EXPECT_EQ(whole.neighbor, b.mesh.neighbor);
      EXPECT_TRUE(
          std::equal(b.mesh.vertices.begin(), b.mesh.vertices.end(), whole.vertices.begin()));
      const PointOptions points{.count = 500, .seed = 4};
      EXPECT_EQ(samplePoints(whole, points).positions, samplePoints(b.mesh, points).positions);
      cutFaces += a.cutFaces.size();
      for (const glm::uvec3& t : a.mesh.triangles) {
        const glm::dvec3 &p = a.mesh.vertices[t.x], &q = a.mesh.vertices[t.y];
        EXPECT_GT(glm::length(glm::cross(q - p, a.mesh.vertices[t.z] - p)), 0.0);
      }
    }
    EXPECT_GT(cutFaces, 100u);
    const TriangleMesh intact = solidMesh(cut.solid, 0.0);
    EXPECT_EQ(nonManifoldEdges(intact), 0u);
    EXPECT_GT(intact.triangles.size(), solidMesh(plain.solid, 0.0).triangles.size());
  }
}

TEST_F(SeamCuts, OfEverySurfaceAreClosedAndShared) {
  const TriangleMesh mesh = box();
  std::vector<FractureOptions> ways(6, optionsOf(40));
  ways[0].grow.roughness = 2.0;
  ways[1].surface.smooth.iterations = {.count = 2};
  ways[2].surface.adaptivity = 0.1;
  ways[3].surface.triangles = {400};
  ways[4].grow.growth = growthNamed("flood");
  ways[5].surface.adaptivity = kAutoAdaptivity;
  for (const FractureOptions& options : ways) {
    const FractureResult result = broken(mesh, options);
    expectShared(result);
    for (const Fragment& fragment : result.fragments) {
      for (const TriangleMesh& coarse : fragment.coarse) EXPECT_EQ(nonManifoldEdges(coarse), 0u);
    }
  }
  FractureOptions alone = optionsOf(40), eroded = optionsOf(40);
  alone.surface.interface = Interface::independent;
  eroded.erode.iterations = 2;
  for (const FractureOptions& options : {alone, eroded}) {
    std::size_t faces = 0;
    for (const Fragment& fragment : broken(mesh, options).fragments) {
      EXPECT_EQ(nonManifoldEdges(fragment.mesh), 0u);
      faces += fragment.cutFaces.size();
    }
    EXPECT_GT(faces, 1000u);
  }
}

// Borders of charts are borders of regions, which decimation keeps, to its error; but not where a
// chart meets itself.
TEST_F(SeamCuts, StayWhenPlanesAreMerged) {
  FractureOptions options = optionsOf(48);
  std::size_t faces = 0, before = 0;
  for (const Fragment& fragment : broken(box(), options).fragments)
    before += fragment.mesh.triangles.size();
  options.surface.adaptivity = kAutoAdaptivity;
  const FractureResult merged = broken(box(), options);
  for (const Fragment& fragment : merged.fragments) faces += fragment.mesh.triangles.size();
  EXPECT_LT(faces, before / 5);
  const Deviations deviations = deviationsOf(merged, box());
  constexpr double kPromised = 0.1;  // voxels; merging moves a border within its plane and off it
  EXPECT_LT(share(deviations.borders, 0.95), kPromised);
  EXPECT_LT(share(deviations.seams, 0.95), Seams::kOnSeam + 2.0 * kPlanarTolerance);
}

TEST_F(SeamCuts, StayWhenFacesAreMerged) {
  for (const Case& of : {Case{"box", box()}, Case{"ball", ball()}}) {
    for (const Interface interface : {Interface::shared, Interface::independent}) {
      SCOPED_TRACE(of.name);
      FractureOptions options = optionsOf(48);
      options.surface.interface = interface;
      options.surface.adaptivity = 0.05;
      const FractureResult cut = broken(of.mesh, options), plain = broken(of.mesh, options, false);
      EXPECT_LT(share(deviationsOf(cut, of.mesh).borders, 0.95), 0.1);
      EXPECT_GT(share(deviationsOf(plain, of.mesh).borders, 0.95), 1.0);
      std::size_t faces = 0, before = 0;
      for (const Fragment& fragment : cut.fragments) faces += fragment.mesh.triangles.size();
      for (const Fragment& fragment : broken(of.mesh, optionsOf(48)).fragments)
        before += fragment.mesh.triangles.size();
      EXPECT_LT(faces, before / 2);
    }
  }
}

// Sheets that touch, edges around which many labels meet, and islands of single voxels.
TEST_F(SeamCuts, OfDustAreShared) {
  FractureOptions options = optionsOf(32, 300);
  options.grow.growth = growthNamed("flood");
  expectShared(broken(box(), options));
}

TEST(Seams, LieWhereAttributesDiffer) {
  const auto seamsOfMesh = [](const TriangleMesh& mesh) { return Seams(mesh, {}, 0.1); };
  EXPECT_TRUE(seamsOfMesh(shapes::ball(1.0, 3)).empty());
  EXPECT_FALSE(seamsOfMesh(torus(1)).empty());
  TriangleMesh colored = shapes::ball(1.0, 3);  // continuous
  for (const glm::uvec3& t : colored.triangles) {
    auto& corners = colored.attributes.colors.emplace_back();
    for (int k = 0; k < 3; ++k) {
      corners[static_cast<std::size_t>(k)] = glm::u8vec3(127.0 + 100.0 * colored.vertices[t[k]]);
    }
  }
  EXPECT_TRUE(seamsOfMesh(colored).empty());
  // Each triangle is a chart, of less than a square voxel and of more.
  TriangleMesh each = shapes::ball(1.0, 3);
  for (std::uint32_t t = 0; t < each.triangles.size(); ++t) {
    each.attributes.material.push_back(t);
  }
  EXPECT_TRUE(Seams(each, {}, 0.2).empty());
  EXPECT_FALSE(Seams(each, {}, 0.02).empty());
}

TEST(Seams, AreCrossedWhereTheyAre) {
  const Seams seams(box(), {}, 0.05);
  const auto at = [](double x, double y) { return turned({x, y, 1.0}) / 0.05; };
  const auto found = seams.crossing(at(0.3, 0.1), at(0.35, 0.12));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(*found, (1.0 / 3.0 - 0.3) / 0.05, 1e-9);
  const auto back = seams.crossing(at(0.35, 0.12), at(0.3, 0.1));
  ASSERT_TRUE(back.has_value());
  EXPECT_NEAR(*back, 1.0 - *found, 1e-9);
  EXPECT_FALSE(seams.crossing(at(0.28, 0.1), at(0.33, 0.12)).has_value());
  EXPECT_FALSE(seams.crossing(at(1.0 / 3.0, 0.1), at(1.0 / 3.0, 0.2)).has_value());  // along it
  EXPECT_FALSE(seams.crossing(at(1.0 / 3.0, 0.1), at(0.38, 0.12)).has_value());      // begins there
  EXPECT_NEAR(seams.distance(at(0.3, 0.1)), (1.0 / 3.0 - 0.3) / 0.05, 1e-9);
  EXPECT_TRUE(std::isinf(seams.distance(at(0.1, 0.1))));
  const auto corner = seams.cornerNear(at(0.32, 0.34), 1.0);
  ASSERT_TRUE(corner.has_value());
  EXPECT_NEAR(glm::length(*corner - at(1.0 / 3.0, 1.0 / 3.0)), 0.0, 1e-9);
}

}  // namespace
}  // namespace sherd
