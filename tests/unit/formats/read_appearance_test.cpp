// Reads the look of meshes from files that the test writes itself: every corner must have the
// color and texture coordinate that a known function gives its place.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/mesh.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/common.hpp>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "shapes.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

const std::string kPngImage = "\x89PNG\r\n\x1a\n of no use";

class ReadAppearance : public TempFolder {
 protected:
  fs::path write(const std::string& name, const std::string& bytes) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  SourceMesh read(const std::string& name, const std::string& bytes) const {
    return readMesh(write(name, bytes));
  }
};

// The functions, on the cube whose corners are (+-0.5, +-0.5, +-0.5).
glm::u8vec3 colorAt(const glm::dvec3& p) {
  return {p.x > 0 ? 250 : 10, p.y > 0 ? 200 : 0, p.z > 0 ? 255 : 128};
}
glm::vec2 texcoordAt(const glm::dvec3& p) { return {p.x * 0.5 + 0.25 * p.z, 0.75 * p.y + p.z}; }

void expectColors(const SourceMesh& source) {
  const auto& colors = source.mesh.attributes.colors;
  ASSERT_EQ(colors.size(), source.mesh.triangles.size());
  for (std::size_t t = 0; t < colors.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3& at = source.mesh.vertices[source.mesh.triangles[t][k]];
      EXPECT_EQ(colors[t][static_cast<std::size_t>(k)], colorAt(at)) << t << " " << k;
    }
  }
}
void expectTexcoords(const SourceMesh& source, float tolerance = 0.0f) {
  const auto& texcoords = source.mesh.attributes.texcoords;
  ASSERT_EQ(texcoords.size(), source.mesh.triangles.size());
  for (std::size_t t = 0; t < texcoords.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3& at = source.mesh.vertices[source.mesh.triangles[t][k]];
      const glm::vec2 apart = texcoords[t][static_cast<std::size_t>(k)] - texcoordAt(at);
      EXPECT_LE(std::max(std::abs(apart.x), std::abs(apart.y)), tolerance) << t << " " << k;
    }
  }
}

const TriangleMesh kCube = shapes::cube(1.0);

// ---- PLY

TEST_F(ReadAppearance, PlainMeshesHaveNone) {
  std::ostringstream obj;
  for (const glm::dvec3& v : kCube.vertices) obj << "v " << v.x << ' ' << v.y << ' ' << v.z << '\n';
  for (const glm::uvec3& t : kCube.triangles)
    obj << "f " << t.x + 1 << ' ' << t.y + 1 << ' ' << t.z + 1 << '\n';
  const SourceMesh source = read("plain.obj", obj.str());
  EXPECT_TRUE(source.mesh.attributes.empty());
  EXPECT_TRUE(source.appearance.materials.empty());
  EXPECT_TRUE(source.warnings.empty());
}

std::string plyOf(const std::string& format, const std::string& colorType, double most) {
  const bool ascii = format == "ascii", big = format == "binary_big_endian";
  std::ostringstream out;
  out << "ply\nformat " << format << " 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
      << "property float z\nproperty " << colorType << " red\nproperty " << colorType
      << " green\nproperty " << colorType << " blue\nproperty uchar alpha\nproperty float s\n"
      << "property float t\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n";
  const auto put = [&](const std::string& type, double value) {
    if (ascii) {
      out << value << ' ';
      return;
    }
    std::string bytes;
    const auto add = [&](auto number) {
      bytes.assign(reinterpret_cast<const char*>(&number), sizeof number);
    };
    if (type == "float") add(static_cast<float>(value));
    if (type == "uchar") add(static_cast<std::uint8_t>(value));
    if (type == "ushort") add(static_cast<std::uint16_t>(value));
    if (type == "int") add(static_cast<std::int32_t>(value));
    if (big) std::reverse(bytes.begin(), bytes.end());
    out << bytes;
  };
  for (const glm::dvec3& v : kCube.vertices) {
    for (int i = 0; i < 3; ++i) put("float", v[i]);
    const glm::u8vec3 color = colorAt(v);
    for (int i = 0; i < 3; ++i) put(colorType, color[i] * most / 255.0);
    put("uchar", 77);
    for (int i = 0; i < 2; ++i) put("float", texcoordAt(v)[i]);
    if (ascii) out << '\n';
  }
  for (const glm::uvec3& t : kCube.triangles) {
    put("uchar", 3);
    for (int i = 0; i < 3; ++i) put("int", t[i]);
    if (ascii) out << '\n';
  }
  return out.str();
}

TEST_F(ReadAppearance, PlyVerticesInAllEncodingsAndTypes) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (const auto& [type, most] : std::vector<std::pair<std::string, double>>{
             {"uchar", 255}, {"ushort", 65535}, {"float", 1}}) {
      SCOPED_TRACE(format + (" " + type));
      const std::string bytes = plyOf(format, type, most);
      const SourceMesh source = read("cube.ply", bytes);
      EXPECT_EQ(openEdges(source.mesh), 0u);
      EXPECT_EQ(source.mesh.vertices.size(), 8u);
      EXPECT_EQ(source.fileVertices, 8u);
      expectColors(source);
      expectTexcoords(source);
      for (std::size_t cut : {5u, 40u, 200u}) {
        EXPECT_THROW((void)read("cut.ply", bytes.substr(0, bytes.size() - cut)), Error);
      }
    }
  }
}

// Two quads of a strip bent over an edge: MeshLab's texture coordinates of corners, with a seam.
TEST_F(ReadAppearance, PlyCornersKeepTheirSeams) {
  write("bark of oak.png", kPngImage);
  const SourceMesh source = read(
      "strip.ply",
      "ply\nformat ascii 1.0\ncomment TextureFile bark of oak.png\ncomment TextureFile gone.png\n"
      "element vertex 6\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\n"
      "property int texnumber\nend_header\n0 0 0\n1 0 0\n2 0 0\n0 1 0\n1 1 0\n2 1 0\n"
      "4 0 1 4 3 8 0 0 1 0 1 1 0 1 0\n4 1 2 5 4 8 5 5 6 5 6 6 5 6 1\n");
  EXPECT_EQ(source.mesh.vertices.size(), 6u);
  ASSERT_EQ(source.mesh.triangles.size(), 4u);
  for (std::size_t t = 0; t < 4; ++t) {
    EXPECT_EQ(source.mesh.attributes.material[t], t / 2);
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3& at = source.mesh.vertices[source.mesh.triangles[t][k]];
      const glm::vec2 expected = t < 2 ? glm::vec2(at.x, at.y) : glm::vec2(at.x + 4, at.y + 5);
      EXPECT_EQ(source.mesh.attributes.texcoords[t][static_cast<std::size_t>(k)], expected);
    }
  }
  ASSERT_EQ(source.appearance.materials.size(), 2u);
  EXPECT_EQ(source.appearance.materials[0].name, "bark of oak");
  EXPECT_EQ(source.appearance.materials[0].texture, 0);
  EXPECT_EQ(source.appearance.materials[1].texture, -1);
  ASSERT_EQ(source.appearance.textures.size(), 1u);
  EXPECT_EQ(source.appearance.textures[0].bytes, kPngImage);
  ASSERT_EQ(source.warnings.size(), 1u);
  EXPECT_NE(source.warnings[0].find("gone.png"), std::string::npos);
}

TEST_F(ReadAppearance, PlyFacesHaveColors) {
  const SourceMesh source =
      read("two.ply",
           "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
           "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
           "0 0 0\n1 0 0\n0 1 0\n1 1 1\n3 0 1 2 9 8 7\n3 1 3 2 1 2 3\n");
  ASSERT_EQ(source.mesh.attributes.colors.size(), 2u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(source.mesh.attributes.colors[0][k], glm::u8vec3(9, 8, 7));
    EXPECT_EQ(source.mesh.attributes.colors[1][k], glm::u8vec3(1, 2, 3));
  }
}

// ---- OBJ

// The cube with a texture coordinate for each vertex; the lower six triangles are of `a`.
std::string objOf(const std::string& head, bool colors) {
  std::ostringstream out;
  out << head;
  for (const glm::dvec3& v : kCube.vertices) {
    out << "v " << v.x << ' ' << v.y << ' ' << v.z;
    const glm::dvec3 color = glm::dvec3(colorAt(v)) / 255.0;
    if (colors) out << ' ' << color.x << ' ' << color.y << ' ' << color.z;
    out << "\nvt " << texcoordAt(v).x << ' ' << texcoordAt(v).y << '\n';
  }
  for (std::size_t t = 0; t < 12; ++t) {
    if (t == 0) out << "usemtl a\n";
    if (t == 6) out << "usemtl b c\nf 1/1 1/1 2/2\n";  // without area: dropped
    out << 'f';
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<int>(kCube.triangles[t][k]);
      t % 2 == 0 ? out << ' ' << i + 1 << '/' << i + 1 : out << ' ' << i - 8 << '/' << i - 8;
    }
    out << '\n';
  }
  return out.str();
}

TEST_F(ReadAppearance, ObjHasColorsTexturesAndMaterials) {
  write("skin.mtl",
        "newmtl a\nKd 0.5 0.25 1\nmap_Kd -s 1 1 1 -clamp on my skin.png\nnewmtl b c\nKd what\n");
  write("my skin.png", kPngImage);
  const SourceMesh source = read("cube.obj", objOf("mtllib skin.mtl\n", true));
  EXPECT_EQ(openEdges(source.mesh), 0u);
  EXPECT_EQ(source.degenerateTriangles, 1u);
  expectColors(source);
  expectTexcoords(source);
  const Appearance& look = source.appearance;
  EXPECT_TRUE(source.warnings.empty());
  for (std::size_t t = 0; t < 12; ++t) EXPECT_EQ(source.mesh.attributes.material[t], t / 6);
  ASSERT_EQ(look.materials.size(), 2u);
  EXPECT_EQ(look.materials[0].name, "a");
  EXPECT_EQ(look.materials[0].color, glm::vec3(0.5f, 0.25f, 1.0f));
  EXPECT_EQ(look.materials[0].texture, 0);
  EXPECT_EQ(look.materials[1].name, "b c");
  EXPECT_EQ(look.materials[1].color, glm::vec3(1.0f));
  EXPECT_EQ(look.materials[1].texture, -1);
  ASSERT_EQ(look.textures.size(), 1u);
  EXPECT_EQ(look.textures[0].bytes, kPngImage);
}

TEST_F(ReadAppearance, TilingOfObjIsInTheCoordinates) {
  write("skin.mtl",
        "newmtl a\nmap_Kd -s 2 4 1 -o 0.5 -t 1 1 1 my skin.png\n"
        "newmtl b c\nmap_Kd -s 1e300 my skin.png\nKe 1e300 0 0\nmap_Ke -s 3 my skin.png\n");
  write("my skin.png", kPngImage);
  const SourceMesh source = read("cube.obj", objOf("mtllib skin.mtl\n", false));
  for (std::size_t t = 0; t < 12; ++t) {
    const bool isTiled = source.mesh.attributes.material[t] == 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& p =
          source.mesh.vertices[source.mesh.triangles[t][static_cast<glm::length_t>(k)]];
      const glm::vec2 plain = texcoordAt(p);
      const glm::vec2 tiled(0.5f + 2.0f * plain.x, 4.0f * plain.y);
      EXPECT_EQ(source.mesh.attributes.texcoords[t][k], isTiled ? tiled : plain) << t;
    }
  }
  ASSERT_EQ(source.warnings.size(), 1u);
  EXPECT_NE(source.warnings[0].find("'b c'"), std::string::npos);
}

TEST_F(ReadAppearance, PolypaintOfObjIsItsColors) {
  std::ostringstream out;
  for (const glm::dvec3& v : kCube.vertices) out << "v " << v.x << ' ' << v.y << ' ' << v.z << '\n';
  const auto lines = [](std::size_t first, std::size_t end) {
    std::string text = "#MRGB ";
    for (std::size_t i = first; i < end; ++i) {
      const glm::u8vec3 color = colorAt(kCube.vertices[i]);
      char digits[9];
      std::snprintf(digits, sizeof digits, "ff%02x%02X%02x", color.x, color.y, color.z);
      text += digits;
    }
    return text + "\n";
  };
  std::ostringstream faces;
  for (const glm::uvec3& t : kCube.triangles) {
    faces << "f " << t.x + 1 << ' ' << t.y + 1 << ' ' << t.z + 1 << '\n';
  }
  expectColors(read("cube.obj", out.str() + lines(0, 5) + lines(5, 8) + faces.str()));
  for (const std::string& other : {lines(0, 7), lines(0, 8) + "#MRGB ff\n#MRGB comment\n",
                                   std::string("#MRGB\n#MRGB zz000000\n")}) {
    const SourceMesh source = read("cube.obj", out.str() + other + faces.str());
    EXPECT_EQ(source.mesh.attributes.colors.empty(), other.size() < 70u) << other;
  }
}

// A binary STL of the cube, with two bytes for each triangle.
std::string stlOf(const std::string& header, const std::vector<std::uint16_t>& values) {
  std::string bytes = header + std::string(80 - header.size(), ' ');
  const auto add = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(static_cast<std::uint32_t>(kCube.triangles.size()));
  for (std::size_t t = 0; t < kCube.triangles.size(); ++t) {
    add(glm::vec3(0.0f));
    for (int k = 0; k < 3; ++k) add(glm::vec3(kCube.vertices[kCube.triangles[t][k]]));
    add(values[t]);
  }
  return bytes;
}

TEST_F(ReadAppearance, StlHasColorsOfFacets) {
  constexpr std::uint16_t kSet = 0x8000, kOrange = 31 << 10 | 16 << 5 | 1;  // red high
  std::vector<std::uint16_t> values(12, 0);
  EXPECT_TRUE(read("cube.stl", stlOf("", values)).mesh.attributes.colors.empty());
  values[3] = kSet | kOrange;
  SourceMesh source = read("cube.stl", stlOf("", values));
  ASSERT_EQ(source.mesh.attributes.colors.size(), 12u);
  for (std::size_t t = 0; t < 12; ++t) {
    const glm::u8vec3 expected = t == 3 ? glm::u8vec3(255, 132, 8) : glm::u8vec3(255);
    for (const glm::u8vec3& color : source.mesh.attributes.colors[t]) EXPECT_EQ(color, expected);
  }
  values[5] = 12;  // not of colors
  EXPECT_TRUE(read("cube.stl", stlOf("", values)).mesh.attributes.colors.empty());
  // Magics: red is low, and a set bit is the color of the whole.
  source = read("cube.stl", stlOf(std::string("COLOR=\x0a\x14\x1e\xff", 10), values));
  ASSERT_EQ(source.mesh.attributes.colors.size(), 12u);
  EXPECT_EQ(source.mesh.attributes.colors[3][0], glm::u8vec3(10, 20, 30));
  EXPECT_EQ(source.mesh.attributes.colors[5][0], glm::u8vec3(99, 0, 0));
  EXPECT_EQ(source.mesh.attributes.colors[0][0], glm::u8vec3(0));
}

TEST_F(ReadAppearance, ObjWithoutItsLibraryKeepsNames) {
  const SourceMesh source = read("cube.obj", objOf("mtllib gone.mtl\n", false));
  expectTexcoords(source);
  EXPECT_TRUE(source.mesh.attributes.colors.empty());
  ASSERT_EQ(source.appearance.materials.size(), 2u);
  EXPECT_EQ(source.appearance.materials[0].name, "a");
  EXPECT_EQ(source.warnings,
            (std::vector<std::string>{
                "cube.obj: its material library 'gone.mtl' is not there, so it is left out"}));
}

TEST_F(ReadAppearance, FilesOutsideTheFolderAreNotRead) {
  write("secret.png", kPngImage);
  write("secret.mtl", "newmtl a\nKd 0 0 0\n");
  const std::string outside = (folder_ / "secret.png").string();
  for (const std::string& name :
       {std::string("../secret.png"), outside, std::string("x/../../secret.png"),
        std::string("..\\secret.png")}) {
    write("in/skin.mtl", "newmtl a\nmap_Kd " + name + "\n");
    const SourceMesh source = read("in/cube.obj", objOf("mtllib skin.mtl\n", false));
    EXPECT_TRUE(source.appearance.textures.empty()) << name;
    ASSERT_EQ(source.warnings.size(), 1u) << name;
    EXPECT_NE(source.warnings[0].find("does not lie in or below"), std::string::npos);
  }
  const SourceMesh source = read("in/cube.obj", objOf("mtllib ../secret.mtl\n", false));
  EXPECT_EQ(source.appearance.materials[0].color, glm::vec3(1.0f));
  EXPECT_EQ(source.warnings.size(), 1u);
}

TEST_F(ReadAppearance, LinksAreFollowedWithinTheFolderOnly) {
  namespace fs = std::filesystem;
  write("secret.png", kPngImage);
  write("secret.mtl", "newmtl a\nKd 0 0 0\n");
  write("in/deep/own.png", kPngImage);
  write("in/own.mtl", "newmtl a\nKd 0 0 0\n");
  fs::create_symlink("../secret.png", folder_ / "in/out.png");
  fs::create_symlink(folder_ / "secret.png", folder_ / "in/absolute.png");
  fs::create_directory_symlink("..", folder_ / "in/up");
  fs::create_symlink("loop.png", folder_ / "in/loop.png");
  fs::create_symlink("../secret.mtl", folder_ / "in/out.mtl");
  fs::create_symlink("deep/own.png", folder_ / "in/inside.png");
  fs::create_symlink("own.mtl", folder_ / "in/inside.mtl");
  fs::create_directory_symlink("in", folder_ / "alias");
  for (const std::string name : {"out.png", "absolute.png", "up/secret.png", "loop.png"}) {
    write("in/skin.mtl", "newmtl a\nmap_Kd " + name + "\n");
    const SourceMesh source = read("in/cube.obj", objOf("mtllib skin.mtl\n", false));
    EXPECT_TRUE(source.appearance.textures.empty()) << name;
    ASSERT_EQ(source.warnings.size(), 1u) << name;
    EXPECT_NE(source.warnings[0].find(name == "loop.png" ? "cannot be read" : "symbolic link"),
              std::string::npos)
        << source.warnings[0];
  }
  const SourceMesh outside = read("in/cube.obj", objOf("mtllib out.mtl\n", false));
  EXPECT_EQ(outside.appearance.materials[0].color, glm::vec3(1.0f));
  EXPECT_EQ(outside.warnings.size(), 1u);
  const SourceMesh inside = read("in/cube.obj", objOf("mtllib inside.mtl\n", false));
  EXPECT_EQ(inside.appearance.materials[0].color, glm::vec3(0.0f));
  EXPECT_TRUE(inside.warnings.empty());
  write("in/skin.mtl", "newmtl a\nmap_Kd inside.png\n");
  for (const char* name : {"in/cube.obj", "alias/cube.obj"}) {
    EXPECT_EQ(read(name, objOf("mtllib skin.mtl\n", false)).appearance.textures.size(), 1u) << name;
  }
}

TEST_F(ReadAppearance, ObjWithSomeColoredVerticesIsReadWhole) {
  const SourceMesh source = read("some.obj", "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 0 1 0 1\nf 1 2 3\n");
  ASSERT_EQ(source.mesh.attributes.colors.size(), 1u);
  EXPECT_EQ(source.mesh.attributes.colors[0][0], glm::u8vec3(255, 0, 0));
  EXPECT_EQ(source.mesh.attributes.colors[0][1], glm::u8vec3(255, 255, 255));
  EXPECT_EQ(source.mesh.attributes.colors[0][2], glm::u8vec3(0, 255, 0));
}

TEST_F(ReadAppearance, ObjWithATexcoordThatDoesNotExistIsRefused) {
  for (const char* corner : {"1/4", "1/0", "1/-4", "1/x"}) {
    const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf " +
                             std::string(corner) + " 2/2 3/3\n";
    try {
      (void)read("bad.obj", text);
      ADD_FAILURE() << corner;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input);
    }
  }
}

// ---- glTF

// The cube twice, as two primitives of six triangles without indices; the node mirrors x.
struct Gltf {
  std::string buffer;
  nlohmann::json json;

  void put(const void* value, std::size_t size) {
    buffer.append(static_cast<const char*>(value), size);
  }
  int accessor(int component, const char* type, std::size_t count, std::size_t from) {
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", from}, {"byteLength", buffer.size() - from}});
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"count", count},
                                 {"type", type}});
    if (component == 5121) json["accessors"].back()["normalized"] = true;
    return static_cast<int>(json["accessors"].size()) - 1;
  }
};

float linear(std::uint8_t srgb) {  // IEC 61966-2-1, written down once more
  const double c = srgb / 255.0;
  return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

Gltf gltfOf(const nlohmann::json& image) {
  Gltf out;
  out.json = {
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}, {"scale", {-1, 1, 1}}}}},
      {"images", {image}},
      {"textures", {{{"source", 0}}}},
      {"materials",
       {{{"name", "glaze"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}},
        {{"name", "clay"},
         {"pbrMetallicRoughness", {{"baseColorFactor", {0.25, 0.5, 0.75, 1.0}}}}}}}};
  nlohmann::json primitives = nlohmann::json::array();
  for (std::size_t half = 0; half < 2; ++half) {
    nlohmann::json attributes;
    const auto each = [&](const std::function<void(const glm::dvec3&)>& store) {
      const std::size_t from = out.buffer.size();
      for (std::size_t t = 6 * half; t < 6 * half + 6; ++t) {
        for (int k = 0; k < 3; ++k) store(kCube.vertices[kCube.triangles[t][k]]);
      }
      return from;
    };
    std::size_t from = each([&](const glm::dvec3& p) {
      const glm::vec3 at(p);
      out.put(&at, sizeof at);
    });
    attributes["POSITION"] = out.accessor(5126, "VEC3", 18, from);
    from = each([&](const glm::dvec3& p) {  // v runs downwards
      const glm::vec2 at(texcoordAt(p * glm::dvec3(-1, 1, 1)).x,
                         1.0f - texcoordAt(p * glm::dvec3(-1, 1, 1)).y);
      out.put(&at, sizeof at);
    });
    attributes["TEXCOORD_0"] = out.accessor(5126, "VEC2", 18, from);
    from = each([&](const glm::dvec3& p) {
      const glm::u8vec3 color = colorAt(p * glm::dvec3(-1, 1, 1));
      const glm::vec4 light(linear(color.x), linear(color.y), linear(color.z), 1.0f);
      out.put(&light, sizeof light);
    });
    attributes["COLOR_0"] = out.accessor(5126, "VEC4", 18, from);
    primitives.push_back({{"attributes", attributes}, {"material", half}});
  }
  out.json["meshes"] = {{{"primitives", primitives}}};
  return out;
}

std::string glbOf(Gltf& gltf) {
  gltf.json["buffers"] = {{{"byteLength", gltf.buffer.size()}}};
  std::string text = gltf.json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  gltf.buffer.resize((gltf.buffer.size() + 3) / 4 * 4, '\0');
  std::string out = "glTF";
  const auto word = [&](std::size_t value) {
    const auto bits = static_cast<std::uint32_t>(value);
    out.append(reinterpret_cast<const char*>(&bits), 4);
  };
  word(2), word(12 + 8 + text.size() + 8 + gltf.buffer.size());
  word(text.size()), word(0x4e4f534a);
  out += text;
  word(gltf.buffer.size()), word(0x004e4942);
  return out + gltf.buffer;
}

void expectGltfLook(const SourceMesh& source) {
  EXPECT_EQ(openEdges(source.mesh), 0u);
  EXPECT_GT(volume(source.mesh), 0.0);
  expectColors(source);
  expectTexcoords(source, 1e-6f);
  const Appearance& look = source.appearance;
  for (std::size_t t = 0; t < 12; ++t) EXPECT_EQ(source.mesh.attributes.material[t], t / 6);
  ASSERT_EQ(look.materials.size(), 2u);
  EXPECT_EQ(look.materials[0].name, "glaze");
  EXPECT_EQ(look.materials[1].name, "clay");
  EXPECT_EQ(look.materials[1].color, glm::vec3(0.25f, 0.5f, 0.75f));
  EXPECT_EQ(look.materials[1].texture, -1);
}

TEST_F(ReadAppearance, GlbWithAPictureInIt) {
  Gltf gltf = gltfOf({{"bufferView", 6}, {"mimeType", "image/png"}});
  gltf.json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", gltf.buffer.size()}, {"byteLength", kPngImage.size()}});
  gltf.buffer += kPngImage;
  const SourceMesh source = read("cube.glb", glbOf(gltf));
  expectGltfLook(source);
  ASSERT_EQ(source.appearance.materials[0].texture, 0);
  EXPECT_EQ(source.appearance.textures[0].bytes, kPngImage);
  EXPECT_TRUE(source.warnings.empty());
}

TEST_F(ReadAppearance, GltfWithAPictureBesideIt) {
  write("pictures/my glaze.png", kPngImage);
  Gltf gltf = gltfOf({{"uri", "pictures/my%20glaze.png"}});
  SourceMesh source = read("cube.glb", glbOf(gltf));
  expectGltfLook(source);
  ASSERT_EQ(source.appearance.materials[0].texture, 0);
  EXPECT_EQ(source.appearance.textures[0].bytes, kPngImage);

  gltf = gltfOf({{"uri", "../glaze.png"}});
  source = read("cube.glb", glbOf(gltf));
  expectGltfLook(source);
  EXPECT_EQ(source.appearance.materials[0].texture, -1);
  EXPECT_EQ(source.warnings.size(), 1u);
}

}  // namespace
}  // namespace sherd
