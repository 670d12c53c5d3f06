// The meshes of fragments in their files, read back: the surface stays closed, and the look is what
// went in.
#include <gtest/gtest.h>
#include <sherd/folder.h>
#include <sherd/mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "formats/gltf/glb.h"
#include "formats/mesh/materials.h"
#include "formats/mesh/piece_mesh.h"
#include "formats/obj/obj.h"
#include "formats/ply/ply.h"
#include "mesh/vertex_normals.h"
#include "shapes.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

const std::string kPng = "\x89PNG\r\n\x1a\n of no use";

// A cube whose sides are faces 0, 0, 7, 7, 9, 9 of two triangles each in the order of `cube`.
struct Piece {
  TriangleMesh mesh = shapes::cube(2.0, {10.0, 20.0, 30.0});
  SurfaceAttributes look{};
  Appearance input{};
  MaterialTable table{};
  std::string name = "vase_001";

  explicit Piece(bool looks) {
    mesh.neighbor = {0, 0, 0, 0, 7, 7, 7, 7, 9, 9, 9, 9};
    if (looks) {
      for (std::size_t t = 0; t < 12; ++t) {
        const bool inside = mesh.neighbor[t] != 0;
        const auto u = static_cast<float>(t);
        look.texcoords.push_back({});
        look.colors.push_back({kInsideColor, kInsideColor, kInsideColor});
        for (std::size_t k = 0; k < 3 && !inside; ++k) {
          const auto v = static_cast<float>(k);
          look.texcoords[t][k] = {u / 16.0f, v / 4.0f};
          // One for each vertex, or formats with a color for a vertex would lose some.
          const std::uint32_t vertex = mesh.triangles[t][static_cast<int>(k)];
          look.colors[t][k] = {vertex * 30, 255 - vertex, vertex};
        }
        look.material.push_back(inside ? 2 : static_cast<std::uint32_t>(t / 2));
      }
      input.materials = {{"gl aze", {0.5f, 0.25f, 1.0f}, 0}, {"inside", glm::vec3(1.0f), -1}};
      input.textures = {{"some/where/glaze one.jpeg", kPng}};
    }
    table = materialTable(input);
  }
  PieceMesh piece() const { return {name, mesh, look, table}; }
};

class MeshFiles : public TempFolder {
 protected:
  std::string bytesOf(const std::string& name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void writeAll(const Piece& piece) const {
    writePiecePly(folder_ / "vase_001.ply", piece.piece());
    writePieceObj(folder_ / "vase_001.obj", piece.piece(), "vase.mtl");
    writePieceGlb(folder_ / "vase_001.glb", piece.piece());
    std::ofstream(folder_ / "vase.mtl") << mtlText(piece.table);
    for (const MaterialTable::Image& picture : piece.table.textures) {
      std::ofstream(folder_ / picture.file, std::ios::binary) << picture.bytes;
    }
  }
};

using Place = std::array<double, 3>;
Place placeOf(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

// Triangles by their corners' places, so that files may number and order them as they like.
std::map<std::set<Place>, std::size_t> byPlaces(const TriangleMesh& mesh) {
  std::map<std::set<Place>, std::size_t> out;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::set<Place> places;
    for (int k = 0; k < 3; ++k) places.insert(placeOf(mesh.vertices[mesh.triangles[t][k]]));
    out[places] = t;
  }
  return out;
}

TEST_F(MeshFiles, EveryFormatIsTheSameClosedSurface) {
  for (const bool looks : {false, true}) {
    const Piece piece(looks);
    writeAll(piece);
    for (const char* name : {"vase_001.ply", "vase_001.obj", "vase_001.glb"}) {
      SCOPED_TRACE(name);
      const SourceMesh back = readMesh(folder_ / name);
      EXPECT_EQ(nonManifoldEdges(back.mesh), 0u);
      EXPECT_EQ(back.mesh.vertices.size(), 8u);
      EXPECT_DOUBLE_EQ(volume(back.mesh), 8.0);
      EXPECT_TRUE(back.warnings.empty());
      const auto here = byPlaces(piece.mesh), there = byPlaces(back.mesh);
      ASSERT_EQ(here.size(), 12u);
      for (const auto& [places, t] : here) EXPECT_TRUE(there.contains(places));
    }
  }
}

TEST_F(MeshFiles, EveryFormatHoldsTheLook) {
  const Piece piece(true);
  writeAll(piece);
  for (const char* name : {"vase_001.ply", "vase_001.obj", "vase_001.glb"}) {
    SCOPED_TRACE(name);
    const bool isGlb = std::string(name).ends_with("glb");
    const SourceMesh back = readMesh(folder_ / name);
    const Appearance& look = back.appearance;
    const SurfaceAttributes& attributes = back.mesh.attributes;
    const auto there = byPlaces(back.mesh);
    for (const auto& [places, t] : byPlaces(piece.mesh)) {
      const std::size_t u = there.at(places);
      const Material& material = look.materials.at(attributes.material.at(u));
      EXPECT_EQ(material.name, piece.mesh.neighbor[t] != 0 ? "inside"
                               : t < 2                     ? "gl_aze"
                                                           : "inside_2");
      EXPECT_EQ(material.texture, t < 2 ? 0 : -1);
      if (t < 2 && isGlb) {
        EXPECT_EQ(material.color, glm::vec3(0.5f, 0.25f, 1.0f));
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const Place at = placeOf(piece.mesh.vertices[piece.mesh.triangles[t][static_cast<int>(k)]]);
        std::size_t j = 0;
        while (placeOf(back.mesh.vertices[back.mesh.triangles[u][static_cast<int>(j)]]) != at) ++j;
        if (piece.mesh.neighbor[t] == 0) {
          const glm::vec2 apart = attributes.texcoords[u][j] - piece.look.texcoords[t][k];
          EXPECT_LE(std::abs(apart.x) + std::abs(apart.y), 1e-6f);
        }
        // Vertices at the rim have the original surface's color where they have one only.
        if (isGlb || piece.mesh.neighbor[t] == 0) {
          EXPECT_EQ(attributes.colors[u][j], piece.look.colors[t][k]);
        }
      }
    }
    ASSERT_EQ(look.textures.size(), 1u);
    EXPECT_EQ(look.textures[0].bytes, kPng);
  }
}

TEST_F(MeshFiles, ObjNamesItsPieceMaterialsAndTextures) {
  const Piece piece(true);
  writeAll(piece);
  const std::string text = bytesOf("vase_001.obj"), library = bytesOf("vase.mtl");
  EXPECT_TRUE(text.starts_with("mtllib vase.mtl\no vase_001\nv 9 19 29 0 1 0\n"));
  for (const char* line : {"\nusemtl gl_aze\n", "\nusemtl inside_2\n", "\nusemtl inside\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
  EXPECT_NE(library.find("newmtl gl_aze\nKd 0.5 0.25 1\nillum 1\nmap_Kd glaze_one.png\n"),
            std::string::npos);
  EXPECT_NE(library.find("newmtl inside\n"), std::string::npos);
}

TEST_F(MeshFiles, NamesOfMaterialsAndTexturesAreSafeAndUnique) {
  Appearance input;
  input.materials = {{"", glm::vec3(1.0f), -1},
                     {"outside", glm::vec3(1.0f), -1},
                     {"a/b\nc", glm::vec3(1.0f), -1},
                     {"\xff", glm::vec3(1.0f), -1}};
  input.textures = {
      {"../../x.png", kPng}, {"x.png", kPng}, {"vase_001.ply", "?"}, {"", "?"}, {"y.tga", "?"}};
  const MaterialTable table = materialTable(input);
  std::vector<std::string> names, files;
  for (const auto& material : table.materials) names.push_back(material.name);
  for (const auto& picture : table.textures) files.push_back(picture.file);
  EXPECT_EQ(names, (std::vector<std::string>{"outside", "outside_2", "a_b_c", "_", "inside"}));
  EXPECT_EQ(files, (std::vector<std::string>{"x.png", "x_2.png", "vase_001.image", "texture.image",
                                             "y.tga"}));
}

TEST(VertexNeighbor, IsWhatTheMostAngleFaces) {
  const Piece piece(false);
  // Every corner of a cube has a right angle for each of its three sides, in one or two triangles;
  // sides are 0, 0, 7, 7, 9, 9, opposite ones alike.
  for (const std::uint16_t neighbor : vertexNeighbor(piece.mesh)) EXPECT_EQ(neighbor, 7);
  std::vector<std::uint16_t> neighbor = piece.mesh.neighbor;
  std::fill(neighbor.begin() + 8, neighbor.end(), std::uint16_t{7});
  for (const std::uint16_t id : vertexNeighbor(shapes::withNeighbor(piece.mesh, neighbor)))
    EXPECT_EQ(id, 7);
  std::fill(neighbor.begin(), neighbor.end(), std::uint16_t{0});
  neighbor[3] = 5;
  const std::vector<std::uint16_t> one = vertexNeighbor(shapes::withNeighbor(piece.mesh, neighbor));
  for (std::uint32_t v = 0; v < 8; ++v) {
    const glm::uvec3& t = piece.mesh.triangles[3];
    EXPECT_EQ(one[v], v == t.x || v == t.y || v == t.z ? 5 : 0);
  }
  // A pyramid's top: two narrow faces of 4 against a wide one of 3.
  TriangleMesh fan;
  fan.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 0.1, 0}, {1, 0.2, 0}, {-1, 1, 0}};
  fan.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  EXPECT_EQ(vertexNeighbor(shapes::withNeighbor(fan, {4, 4, 3}))[0], 3);
  EXPECT_EQ(vertexNeighbor(shapes::withNeighbor(fan, {4, 0, 0}))[0], 4);
}

TEST(VertexNormals, WeighFacesByTheirAngles) {
  // However a cube's sides are cut into triangles, its corners' normals are its diagonals, to what
  // an angle is known to.
  const TriangleMesh cube = shapes::cube(2.0);
  const std::vector<glm::dvec3> normals = vertexNormals(cube);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_LT(glm::length(normals[i] - cube.vertices[i] / std::sqrt(3.0)), 1e-7);
  }
  const TriangleMesh ball = shapes::ball(1.0, 4);
  const std::vector<glm::dvec3> outwards = vertexNormals(ball);
  for (std::size_t i = 0; i < outwards.size(); ++i) {
    EXPECT_LT(glm::length(outwards[i] - ball.vertices[i]), 0.01);
    EXPECT_NEAR(glm::length(outwards[i]), 1.0, 1e-12);
  }
}

TEST(Srgb, ThereAndBackAgain) {
  for (int i = 0; i < 256; ++i) {
    const glm::u8vec3 gray(static_cast<std::uint8_t>(i));
    EXPECT_EQ(srgbFromLinear(linearFromSrgb(gray)), gray);
  }
  EXPECT_NEAR(linearFromSrgb(glm::u8vec3(188)).x, 0.5029, 1e-4);  // half the light
}

// A square of side 10 in the plane z = 0 and a small triangle at one of its corners, tilted by 20
// degrees: less than a crease.
TEST(SplitCorners, OfMergedPlanesKeepTheirNormals) {
  TriangleMesh mesh;
  const double tilt = std::tan(20.0 * std::numbers::pi / 180.0);
  mesh.vertices = {{0, 0, 0},  {10, 0, 0},   {10, 10, 0},
                   {0, 10, 0}, {10, 0.1, 0}, {10.1, 0, -0.1 * tilt}};
  mesh.triangles = {{0, 1, 4}, {0, 4, 2}, {0, 2, 3}, {1, 5, 4}};
  mesh.neighbor.assign(4, 0);
  const SurfaceAttributes none;
  const MaterialTable materials;
  const std::string name = "square";
  const auto tiltAtCorner = [&](bool isMerged) {
    mesh.isMerged = isMerged;
    const SplitCorners split = splitCorners({name, mesh, none, materials});
    const glm::dvec3& normal = split.normals[split.corners[split.ofTriangle[0][1]].normal];
    return std::acos(std::min(1.0, normal.z)) * 180.0 / std::numbers::pi;
  };
  EXPECT_GT(tiltAtCorner(false), 5.0);
  EXPECT_LT(tiltAtCorner(true), 1.0);
}

}  // namespace
}  // namespace sherd
