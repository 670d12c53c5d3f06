// Surface::exact: normals, polygons and objects of the input in the fragments.
#include <gtest/gtest.h>
#include <sherd/device.h>
#include <sherd/files.h>
#include <sherd/fracture.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "appearance/transfer.h"
#include "formats/mesh/materials.h"
#include "formats/mesh/piece_mesh.h"
#include "formats/obj/obj.h"
#include "formats/ply/ply.h"
#include "shapes.h"
#include "temp_folder.h"

namespace sherd {
namespace {

FractureResult brokenExactly(const TriangleMesh& mesh, int pieces) {
  FractureOptions options;
  options.pieces = pieces;
  options.seed = 7;
  options.solid.resolution = 40;
  options.surface = {.levelSets = false, .surface = Surface::exact};
  Device device("builtin");
  FractureResult result = fracture(mesh, options, device);
  EXPECT_EQ(result.exactFailure, "");
  return result;
}

// Gives the corners unit vectors that have nothing to do with the surface, other ones on each side.
void addNormals(TriangleMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<glm::vec3, 3>& corners = mesh.attributes.normals.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const double a = 0.9 * mesh.triangles[t][static_cast<int>(k)] + static_cast<double>(t / 2);
      corners[k] = glm::vec3(glm::normalize(glm::dvec3(std::cos(a), std::sin(a), 0.4)));
    }
  }
}

// The place of a point in a triangle, by areas.
glm::dvec3 areaWeights(const glm::dvec3& p, const std::array<glm::dvec3, 3>& c) {
  const auto areaOf = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& d) {
    return glm::length(glm::cross(b - a, d - a));
  };
  const glm::dvec3 areas(areaOf(p, c[1], c[2]), areaOf(c[0], p, c[2]), areaOf(c[0], c[1], p));
  return areas / (areas[0] + areas[1] + areas[2]);
}

// Compares a fragment's normals with those of `mesh`; `sign` of each triangle.
// Returns how many corners are the input's.
std::size_t expectNormals(const TriangleMesh& mesh, const TriangleMesh& fragment,
                          const SurfaceAttributes& found, const std::vector<float>& sign) {
  std::size_t same = 0;
  for (std::size_t t = 0; t < fragment.triangles.size(); ++t) {
    const std::uint32_t from = fragment.source[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3& normal = found.normals[t][k];
      if (from == TriangleMesh::kNoSource) {
        EXPECT_EQ(normal, glm::vec3(0.0f));
        continue;
      }
      const glm::dvec3 p = fragment.vertices[fragment.triangles[t][static_cast<int>(k)]];
      const std::array<glm::vec3, 3>& given = mesh.attributes.normals[from];
      std::array<glm::dvec3, 3> whole{};
      for (std::size_t c = 0; c < 3; ++c) {
        whole[c] = mesh.vertices[mesh.triangles[from][static_cast<int>(c)]];
        if (whole[c] != p) continue;
        ++same;
        EXPECT_EQ(normal, sign[from] * given[c]);
      }
      const glm::dvec3 weights = areaWeights(p, whole);
      const glm::dvec3 mean = weights[0] * glm::dvec3(given[0]) +
                              weights[1] * glm::dvec3(given[1]) + weights[2] * glm::dvec3(given[2]);
      const glm::dvec3 expected = static_cast<double>(sign[from]) * glm::normalize(mean);
      EXPECT_LT(glm::distance(glm::dvec3(normal), expected), 1e-6);
    }
  }
  return same;
}

TEST(ExactAttributes, NormalsAreTheInputsAndUnitBetween) {
  TriangleMesh mesh = shapes::cube(2.0, {0.1, 0.2, 0.3});
  addNormals(mesh);
  const std::vector<float> sign(mesh.triangles.size(), 1.0f);
  const AttributeSource source(mesh);
  std::size_t same = 0;
  for (const Fragment& fragment : brokenExactly(mesh, 5).fragments) {
    const SurfaceAttributes own = source.transferTo(fragment.mesh, 0);
    EXPECT_TRUE(own.hasOnlyNormals());
    same += expectNormals(mesh, fragment.mesh, own, sign);
  }
  EXPECT_GT(same, 20u);
}

TEST(ExactAttributes, FlippedTrianglesHaveFlippedNormals) {
  TriangleMesh mesh = shapes::ball(1.0, 2);
  addNormals(mesh);
  std::vector<float> sign(mesh.triangles.size(), 1.0f);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 5) {
    std::swap(mesh.triangles[t].y, mesh.triangles[t].z);
    sign[t] = -1.0f;
  }
  const AttributeSource source(mesh);
  for (const Fragment& fragment : brokenExactly(mesh, 6).fragments) {
    expectNormals(mesh, fragment.mesh, source.transferTo(fragment.mesh, 0), sign);
  }
}

TEST(ExactAttributes, SmoothSurfacesHaveNoneOfTheInputsNormals) {
  TriangleMesh mesh = shapes::cube(2.0);
  addNormals(mesh);
  EXPECT_TRUE(AttributeSource(mesh).transferTo(shapes::cube(2.0), 0).empty());
  mesh.attributes.material.assign(12, 0);
  const SurfaceAttributes own = AttributeSource(mesh).transferTo(shapes::cube(2.0), 0);
  EXPECT_TRUE(own.normals.empty());
  EXPECT_EQ(own.material.size(), 12u);
}

class ExactFiles : public TempFolder {
 protected:
  struct Object {
    explicit Object(SourceMesh read) : source(std::move(read)) {}

    SourceMesh source;
    std::vector<Fragment> fragments{};
    MaterialTable table{};
    PieceInput input{source, groupNames(source)};
    std::vector<SurfaceAttributes> attributes{};
  };

  // The input of an OBJ, broken.
  void breakObj(const std::string& text, int pieces) {
    std::ofstream(folder_ / "in.obj") << text;
    object_ = std::make_unique<Object>(readMesh(folder_ / "in.obj"));
    object_->fragments = brokenExactly(object_->source.mesh, pieces).fragments;
    object_->table = materialTable(object_->source.appearance);
    const AttributeSource from(object_->source.mesh);
    for (const Fragment& fragment : object_->fragments) {
      object_->attributes.push_back(from.transferTo(fragment.mesh, object_->table.inside()));
    }
  }
  PieceMesh piece(std::size_t i) const {
    return {
        name_,          object_->fragments[i].mesh, object_->attributes[i], object_->table, true,
        &object_->input};
  }

  std::string name_ = "piece";
  std::unique_ptr<Object> object_;
};

// The lines of a text file as words.
std::vector<std::vector<std::string>> linesOf(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    lines.emplace_back(std::istream_iterator<std::string>(words),
                       std::istream_iterator<std::string>());
  }
  return lines;
}

// A prism over an L of six corners, split along x: polygons of six corners, which are not convex,
// and quads, one of them not planar for `bend` other than 0.
std::string bentPrism(double bend) {
  constexpr int kSteps = 8;
  const double at[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  std::ostringstream out;
  for (int i = 0; i <= kSteps; ++i) {
    for (const auto& p : at) {
      out << "v " << i + (i % 2 == 1 ? bend * p[0] * p[1] : 0.0) << ' ' << p[0] << ' ' << p[1]
          << '\n';
    }
  }
  out << "f 4 3 2 1 6 5\nf";  // not from the first corner
  for (int k = 1; k <= 6; ++k) out << ' ' << 6 * kSteps + k;
  for (int i = 0; i < kSteps; ++i) {
    for (int k = 0; k < 6; ++k) {
      const int a = 6 * i + k + 1, b = 6 * i + (k + 1) % 6 + 1;
      out << "\nf " << b << ' ' << b + 6 << ' ' << a + 6 << ' ' << a;
    }
  }
  return out.str() + "\n";
}

using Place = std::array<double, 3>;

// The faces of an OBJ by the positions of their corners, with how often they are there.
std::map<std::vector<Place>, int> facesOf(const std::filesystem::path& file) {
  std::vector<Place> vertices;
  std::map<std::vector<Place>, int> faces;
  for (const auto& words : linesOf(file)) {
    if (words.empty()) continue;
    if (words[0] == "v")
      vertices.push_back({std::stod(words[1]), std::stod(words[2]), std::stod(words[3])});
    if (words[0] != "f") continue;
    std::vector<Place> corners;
    for (std::size_t k = 1; k < words.size(); ++k) {
      corners.push_back(vertices[static_cast<std::size_t>(std::stoi(words[k])) - 1]);
    }
    ++faces[corners];
  }
  return faces;
}

TEST_F(ExactFiles, WholePolygonsAreFacesAgain) {
  for (const double bend : {0.0, 0.25}) {
    breakObj(bentPrism(bend), 3);
    const auto input = facesOf(folder_ / "in.obj");
    ASSERT_EQ(input.size(), 50u);
    std::size_t whole = 0, hexagons = 0;
    for (std::size_t i = 0; i < object_->fragments.size(); ++i) {
      writePieceObj(folder_ / "out.obj", piece(i), "");
      for (const auto& [corners, count] : facesOf(folder_ / "out.obj")) {
        if (corners.size() == 3) continue;
        EXPECT_TRUE(input.contains(corners));  // from the same corner on
        EXPECT_EQ(count, 1);
        ++whole;
        hexagons += corners.size() == 6;
      }
      writePiecePly(folder_ / "out.ply", piece(i));
      const TriangleMesh& mesh = object_->fragments[i].mesh;
      for (const char* name : {"out.obj", "out.ply"}) {
        SCOPED_TRACE(name);
        const TriangleMesh back = readMesh(folder_ / name).mesh;
        const double rounding = std::string(name) == "out.ply" ? 1e-14 : 1e-6;
        EXPECT_EQ(back.triangles.size(), mesh.triangles.size());
        EXPECT_NEAR(volume(back), volume(mesh), rounding * 32);
        EXPECT_NEAR(area(back), area(mesh), rounding * 80);
        EXPECT_EQ(openEdges(back), 0u);
      }
      // The binary header counts faces.
      std::ifstream in(folder_ / "out.ply", std::ios::binary);
      std::string line;
      while (std::getline(in, line) && !line.starts_with("element face")) continue;
      EXPECT_LT(std::stoul(line.substr(13)), mesh.triangles.size());
    }
    EXPECT_GT(whole, 25u);
    EXPECT_GT(hexagons, 0u);
  }
}

TEST_F(ExactFiles, QuadsKeepTheirTextureCoordinates) {
  // All sides of a cube have other texture coordinates: quads stay quads.
  breakObj(
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvt 0 0\nvt 1 0\n"
      "vt 1 1\nvt 0 1\nf 1/1 4/2 3/3 2/4\nf 5/1 6/2 7/3 8/4\nf 1/1 2/2 6/3 5/4\n"
      "f 2/1 3/2 7/3 6/4\nf 3/1 4/2 8/3 7/4\nf 4/1 1/2 5/3 8/4\n",
      1);
  writePieceObj(folder_ / "out.obj", piece(0), "");
  writePiecePly(folder_ / "out.ply", piece(0));
  EXPECT_EQ(facesOf(folder_ / "out.obj"), facesOf(folder_ / "in.obj"));
  for (const char* name : {"out.obj", "out.ply"}) {
    const SourceMesh back = readMesh(folder_ / name);
    ASSERT_EQ(back.polygons.size(), 12u) << name;
    for (std::size_t t = 0; t < 12; ++t) {
      EXPECT_EQ(back.polygons[t].polygon, t / 2);
      EXPECT_EQ(back.mesh.attributes.texcoords[t], object_->source.mesh.attributes.texcoords[t]);
    }
  }
  // Where a triangle differs, its polygon stays two.
  object_->attributes[0].texcoords[3][0].x += 0.5f;
  writePieceObj(folder_ / "out.obj", piece(0), "");
  EXPECT_EQ(facesOf(folder_ / "out.obj").size(), 7u);
  writePiecePly(folder_ / "out.ply", piece(0));
  EXPECT_EQ(readMesh(folder_ / "out.ply").mesh.triangles.size(), 12u);
}

TEST_F(ExactFiles, ObjectsAreGroupsBesideTheInside) {
  std::string text = bentPrism(0.0);
  // The first 26 faces are one object, the others another, whose name is the inside's.
  std::size_t at = 0;
  for (int i = 0; i < 54; ++i) at = text.find('\n', at) + 1;
  text.insert(at, "g a b\n");
  for (int i = 0; i < 27; ++i) at = text.find('\n', at) + 1;
  text.insert(at, "g inside\n");
  breakObj(text, 4);
  ASSERT_EQ(object_->source.objects, (std::vector<std::string>{"a b", "inside"}));
  double areas[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < object_->fragments.size(); ++i) {
    writePieceObj(folder_ / "out.obj", piece(i), "");
    std::ifstream in(folder_ / "out.obj");
    std::string own;
    for (std::string line; std::getline(in, line);) {
      if (!line.starts_with("o ")) own += line + "\n";
    }
    std::ofstream(folder_ / "groups.obj") << own;
    const SourceMesh back = readMesh(folder_ / "groups.obj");
    for (const SourceMesh& group : splitObjects(back)) {
      const double amount = area(group.mesh);
      if (group.objects[0] == "a_b") areas[0] += amount;
      if (group.objects[0] == "inside_2") areas[1] += amount;
      if (group.objects[0] == "inside") {
        EXPECT_NEAR(amount, object_->fragments[i].fractureArea, 1e-5);
      }
    }
  }
  for (std::size_t object = 0; object < 2; ++object) {
    EXPECT_NEAR(areas[object], area(splitObjects(object_->source)[object].mesh), 1e-5);
  }
}

}  // namespace
}  // namespace sherd
