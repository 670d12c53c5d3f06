// Reads what glTF 2.0 and its extensions allow, from files that the test writes itself: each must
// give the tetrahedron where mathematics puts it.
#include <gtest/gtest.h>
#include <sherd/files.h>
#include <sherd/mesh.h>

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "draco_stream.h"
#include "shapes.h"
#include "unit/formats/mesh_folder.h"

namespace sherd {
namespace {

using Json = nlohmann::json;

class ReadGltf : public MeshFolder {};

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
              kUnsigned = 5125, kFloat = 5126;

// A .glb under construction.
struct Glb {
  std::string buffer{};
  Json json = {{"asset", {{"version", "2.0"}}},
               {"nodes", {{{"mesh", 0}}}},
               {"bufferViews", Json::array()},
               {"accessors", Json::array()},
               {"meshes", {{{"primitives", Json::array()}}}}};

  // The number of a new view of the bytes from `from` on.
  std::size_t view(std::size_t from) {
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", from}, {"byteLength", buffer.size() - from}});
    buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
    return json["bufferViews"].size() - 1;
  }
  void putAs(int type, double value) {
    if (type == kByte) put(buffer, static_cast<std::int8_t>(value));
    if (type == kUnsignedByte) put(buffer, static_cast<std::uint8_t>(value));
    if (type == kShort) put(buffer, static_cast<std::int16_t>(value));
    if (type == kUnsignedShort) put(buffer, static_cast<std::uint16_t>(value));
    if (type == kUnsigned) put(buffer, static_cast<std::uint32_t>(value));
    if (type == kFloat) put(buffer, static_cast<float>(value));
  }
  std::size_t viewOf(int type, const std::vector<double>& values) {
    const std::size_t from = buffer.size();
    for (const double value : values) putAs(type, value);
    return view(from);
  }
  // The number of a new accessor; `more` is added to it.
  std::size_t accessor(int type, const std::string& kind, const std::vector<double>& values,
                       const Json& more = Json::object()) {
    const std::size_t components = kind == "SCALAR" ? 1 : kind[3] - '0';
    Json out = {{"bufferView", viewOf(type, values)},
                {"componentType", type},
                {"count", values.size() / components},
                {"type", kind}};
    out.update(more);
    json["accessors"].push_back(out);
    return json["accessors"].size() - 1;
  }
  Json& primitive() {
    Json& all = json["meshes"][0]["primitives"];
    all.push_back({{"attributes", Json::object()}});
    return all.back();
  }
  std::string bytes() {
    json["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string out = "glTF";
    put(out, std::uint32_t{2});
    put(out, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + buffer.size()));
    put(out, static_cast<std::uint32_t>(text.size()));
    out += "JSON" + text;
    put(out, static_cast<std::uint32_t>(buffer.size()));
    return out + std::string("BIN\0", 4) + buffer;
  }
};

std::vector<double> positionsOf(const TriangleMesh& mesh, double scale = 1.0) {
  std::vector<double> out;
  for (const glm::dvec3& v : mesh.vertices)
    for (int i = 0; i < 3; ++i) out.push_back(v[i] * scale);
  return out;
}
std::vector<double> indicesOf(const TriangleMesh& mesh) {
  std::vector<double> out;
  for (const glm::uvec3& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) out.push_back(t[i]);
  return out;
}

// The tetrahedron with indices of a type.
Glb indexed(int type = kUnsignedShort) {
  Glb out;
  Json& primitive = out.primitive();
  primitive["attributes"]["POSITION"] = out.accessor(kFloat, "VEC3", positionsOf(tetrahedron()));
  primitive["indices"] = out.accessor(type, "SCALAR", indicesOf(tetrahedron()));
  return out;
}

TEST_F(ReadGltf, TakesIndicesOfEveryTypeAndNone) {
  for (const int type : {kUnsignedByte, kUnsignedShort, kUnsigned})
    expectSameSurface(read("a.glb", indexed(type).bytes()).mesh, tetrahedron());
  EXPECT_NE(refusal("b.glb", indexed(kFloat).bytes()).find("not unsigned whole numbers"),
            std::string::npos);
  Glb plain;
  std::vector<double> corners;
  for (const glm::uvec3& t : tetrahedron().triangles)
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) corners.push_back(tetrahedron().vertices[t[i]][k]);
  plain.primitive()["attributes"]["POSITION"] = plain.accessor(kFloat, "VEC3", corners);
  const SourceMesh source = read("c.glb", plain.bytes());
  expectSameSurface(source.mesh, tetrahedron());
  EXPECT_EQ(source.fileVertices, 12u);
}

TEST_F(ReadGltf, TakesStripsAndFansAndLeavesPointsAndLines) {
  // The strip 0 2 1 3 0 2 is all four faces: its second and fourth triangle are turned.
  Glb strip = indexed();
  Json& primitive = strip.json["meshes"][0]["primitives"][0];
  primitive["mode"] = 5;
  primitive["indices"] = strip.accessor(kUnsignedByte, "SCALAR", {0, 2, 1, 3, 0, 2});
  expectSameSurface(read("a.glb", strip.bytes()).mesh, tetrahedron());

  // Three faces about vertex 0, and the fourth as a list.
  Glb fan = indexed();
  const Json attributes = fan.json["meshes"][0]["primitives"][0]["attributes"];
  fan.json["meshes"][0]["primitives"] = {
      {{"attributes", attributes},
       {"mode", 6},
       {"indices", fan.accessor(kUnsignedByte, "SCALAR", {0, 2, 1, 3, 2})}},
      {{"attributes", attributes}, {"indices", fan.accessor(kUnsignedByte, "SCALAR", {1, 2, 3})}},
      {{"attributes", attributes}, {"mode", 0}},
      {{"attributes", attributes}, {"mode", 3}}};
  const SourceMesh source = read("b.glb", fan.bytes());
  expectSameSurface(source.mesh, tetrahedron());
  EXPECT_EQ(source.warnings,
            (std::vector<std::string>{
                "b.glb: 2 of its primitives are points or lines, which are left out"}));
  fan.json["meshes"][0]["primitives"][0]["mode"] = 7;
  EXPECT_NE(refusal("c.glb", fan.bytes()).find("'mode' is 7"), std::string::npos);
}

TEST_F(ReadGltf, TakesQuantizedPositions) {
  for (const auto& [type, most] : std::vector<std::pair<int, double>>{
           {kByte, 127}, {kUnsignedByte, 255}, {kShort, 32767}, {kUnsignedShort, 65535}}) {
    for (const bool normalized : {false, true}) {
      SCOPED_TRACE(type);
      Glb glb = indexed();
      glb.json["extensionsRequired"] = {"KHR_mesh_quantization"};
      glb.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = glb.accessor(
          type, "VEC3", positionsOf(tetrahedron(), most), {{"normalized", normalized}});
      const double scale = normalized ? 1.0 : most;
      expectSameSurface(read("a.glb", glb.bytes()).mesh,
                        shapes::transformed(tetrahedron(), scale, glm::dvec3(0.0)));
    }
  }
}

TEST_F(ReadGltf, TakesSparseAndInterleavedArrays) {
  Glb sparse = indexed();
  Json& accessor = sparse.json["accessors"][0];
  accessor.erase("bufferView");  // all zeros, but for three
  accessor["sparse"] = {
      {"count", 3},
      {"indices",
       {{"bufferView", sparse.viewOf(kUnsignedShort, {1, 2, 3})},
        {"componentType", kUnsignedShort}}},
      {"values", {{"bufferView", sparse.viewOf(kFloat, {1, 0, 0, 0, 1, 0, 0, 0, 1})}}}};
  expectSameSurface(read("a.glb", sparse.bytes()).mesh, tetrahedron());
  accessor["sparse"]["count"] = 4;
  EXPECT_NE(refusal("b.glb", sparse.bytes()).find("beyond its buffer view"), std::string::npos);
  accessor["sparse"]["count"] = 3;
  accessor["count"] = 3;
  EXPECT_NE(refusal("c.glb", sparse.bytes()).find("an element that it does not have"),
            std::string::npos);
  accessor["count"] = 4000000000u;
  EXPECT_NE(refusal("d.glb", sparse.bytes()).find("4000000000 elements without data"),
            std::string::npos);

  Glb strided = indexed();
  std::vector<double> values;
  for (const glm::dvec3& v : tetrahedron().vertices)
    for (const double value : {9.0, v.x, v.y, v.z, 9.0}) values.push_back(value);
  strided.json["accessors"][0]["bufferView"] = strided.viewOf(kFloat, values);
  strided.json["accessors"][0]["byteOffset"] = 4;
  strided.json["bufferViews"].back()["byteStride"] = 20;
  expectSameSurface(read("e.glb", strided.bytes()).mesh, tetrahedron());
}

TEST_F(ReadGltf, PutsInstancesWhereTheirNodeAndTheirArraysSay) {
  Glb glb = indexed();
  const double half = std::numbers::sqrt2 / 2.0;  // a quarter of a turn about z
  glb.json["nodes"][0]["translation"] = {0, 0, 100};
  glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", glb.accessor(kFloat, "VEC3", {10, 0, 0, 0, 20, 0})},
      {"ROTATION", glb.accessor(kFloat, "VEC4", {0, 0, 0, 1, 0, 0, half, half})},
      {"SCALE", glb.accessor(kFloat, "VEC3", {2, 2, 2, 1, 1, -1})}};
  const TriangleMesh mesh = read("a.glb", glb.bytes()).mesh;
  TriangleMesh second = shapes::inverted(tetrahedron());  // mirrored, so turned inside out
  for (glm::dvec3& v : second.vertices) v = glm::dvec3(-v.y, v.x + 20.0, 100.0 - v.z);
  const TriangleMesh expected =
      shapes::append(shapes::transformed(tetrahedron(), 2.0, {10, 0, 100}), second);
  ASSERT_EQ(mesh.vertices.size(), expected.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    EXPECT_LT(glm::distance(mesh.vertices[i], expected.vertices[i]), 1e-6) << i;
  EXPECT_EQ(openEdges(mesh), 0u);
  EXPECT_NEAR(volume(mesh), 9.0 / 6.0, 1e-6);
  glb.json["accessors"].back()["count"] = 1;
  EXPECT_NE(refusal("b.glb", glb.bytes()).find("differ in length"), std::string::npos);
}

TEST_F(ReadGltf, ReadsTheDefaultSceneOnly) {
  Glb glb = indexed();
  glb.json["nodes"] = {{{"mesh", 0}, {"name", "pot"}},
                       {{"mesh", 0}, {"translation", {5, 0, 0}}},
                       {{"children", {1}}, {"translation", {0, 5, 0}}},
                       {{"camera", 0}}};
  glb.json["meshes"][0]["name"] = "clay";
  const auto read0 = [&] { return read("a.glb", glb.bytes()); };
  const SourceMesh all = read0();  // no scenes: all roots
  EXPECT_EQ(meshComponents(all.mesh).count, 2u);
  EXPECT_EQ(all.objects, (std::vector<std::string>{"pot", "clay"}));
  EXPECT_EQ(all.objectOfTriangle, (std::vector<std::uint32_t>{0, 0, 0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(bounds(all.mesh).max, glm::dvec3(6, 6, 1));

  glb.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {2, 2, 3}}}};
  EXPECT_EQ(bounds(read0().mesh).max, glm::dvec3(1, 1, 1));
  EXPECT_TRUE(read0().objects.empty());
  glb.json["scene"] = 1;
  EXPECT_EQ(bounds(read0().mesh).min, glm::dvec3(5, 5, 0));
  EXPECT_EQ(read0().mesh.triangles.size(), 4u);
  glb.json["scene"] = 2;
  EXPECT_NE(refusal("b.glb", glb.bytes()).find("number 2 of 'scenes'"), std::string::npos);
}

TEST_F(ReadGltf, WarnsOfSkinsAndMorphTargets) {
  Glb glb = indexed();
  glb.json["nodes"][0]["skin"] = 0;
  glb.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
  const SourceMesh source = read("a.glb", glb.bytes());
  expectSameSurface(source.mesh, tetrahedron());
  ASSERT_EQ(source.warnings.size(), 2u);
  EXPECT_NE(source.warnings[0].find("skins"), std::string::npos);
  EXPECT_NE(source.warnings[1].find("morph targets"), std::string::npos);
}

// A small file whose nodes and instances stand for more than any machine holds.
TEST_F(ReadGltf, RefusesAFileThatMultipliesItself) {
  Glb glb = indexed();
  const std::size_t count = 60000;
  glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      glb.accessor(kFloat, "VEC3", std::vector<double>(3 * count, 1.0));
  const Json node = glb.json["nodes"][0];
  glb.json["nodes"] = std::vector<Json>(600, node);
  EXPECT_NE(refusal("a.glb", glb.bytes()).find("more than is read"), std::string::npos);
}

TEST_F(ReadGltf, BuffersMayLieInTheTextOrBesideIt) {
  Glb glb = indexed(kUnsigned);
  (void)glb.bytes();
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string base64;
  ASSERT_EQ(glb.buffer.size() % 3, 0u);
  for (std::size_t i = 0; i < glb.buffer.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | static_cast<unsigned char>(glb.buffer[i + k]);
    for (int shift = 18; shift >= 0; shift -= 6) base64 += kDigits[bits >> shift & 63];
  }
  glb.json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64;
  expectSameSurface(read("a.gltf", glb.json.dump()).mesh, tetrahedron());
  write("in/b.bin", glb.buffer);
  glb.json["buffers"][0]["uri"] = "b.bin";
  expectSameSurface(read("in/b.gltf", "\xef\xbb\xbf" + glb.json.dump()).mesh, tetrahedron());
  for (const char* uri : {"../in/b.bin", "/etc/passwd", "x\\..\\..\\b.bin", ""}) {
    glb.json["buffers"][0]["uri"] = uri;
    EXPECT_NE(refusal("in/c.gltf", glb.json.dump()).find("below the file's folder"),
              std::string::npos)
        << uri;
  }
  namespace fs = std::filesystem;
  write("outside.bin", glb.buffer);
  fs::create_symlink("../outside.bin", folder_ / "in/out.bin");
  fs::create_directory_symlink("..", folder_ / "in/up");
  for (const char* uri : {"out.bin", "up/outside.bin", "up/in/../outside.bin"}) {
    glb.json["buffers"][0]["uri"] = uri;
    EXPECT_NE(refusal("in/c.gltf", glb.json.dump()).find("symbolic link"), std::string::npos)
        << uri;
  }
  fs::create_symlink("b.bin", folder_ / "in/link.bin");
  glb.json["buffers"][0]["uri"] = "link.bin";
  expectSameSurface(read("in/d.gltf", glb.json.dump()).mesh, tetrahedron());
}

// ---- Draco

// The mesh packed, with colors.
Glb packed(const TriangleMesh& mesh, int method, draco::DataType bytes = draco::DT_UINT8) {
  const std::size_t count = mesh.vertices.size();
  Glb glb;
  glb.buffer = dracoStream(mesh, method, bytes);
  glb.json["accessors"] = {
      {{"componentType", kFloat}, {"count", count}, {"type", "VEC3"}},
      {{"componentType", kUnsignedByte}, {"count", count}, {"type", "VEC4"}, {"normalized", true}},
      {{"componentType", kUnsigned}, {"count", 3 * mesh.triangles.size()}, {"type", "SCALAR"}}};
  Json& primitive = glb.primitive();
  primitive = {{"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}, {"indices", 2}};
  primitive["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", glb.view(0)},
      {"attributes", {{"POSITION", kDracoPositions}, {"COLOR_0", kDracoColors}}}};
  glb.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return glb;
}

TEST_F(ReadGltf, UnpacksDraco) {
  const TriangleMesh cube = shapes::cube(2.0);
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const SourceMesh source = read("a.glb", packed(cube, method).bytes());
    EXPECT_EQ(source.mesh.vertices.size(), 8u);
    EXPECT_EQ(source.mesh.triangles.size(), 12u);
    EXPECT_EQ(openEdges(source.mesh), 0u);
    EXPECT_NEAR(volume(source.mesh), 8.0, 1e-2);
    ASSERT_EQ(source.mesh.attributes.colors.size(), 12u);
    EXPECT_EQ(source.mesh.attributes.colors[0][0].y, 255);
    EXPECT_EQ(source.mesh.attributes.colors[0][0].z, 0);
  }
}

// Others may be of any number, and each would take as much as the positions.
TEST_F(ReadGltf, UnpacksOfDracoOnlyWhatItUses) {
  Glb glb = packed(shapes::cube(2.0), draco::MESH_SEQUENTIAL_ENCODING);
  Json& extension =
      glb.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
  extension["attributes"]["_OTHER"] = 77;  // which the stream does not have
  EXPECT_EQ(read("a.glb", glb.bytes()).mesh.attributes.colors.size(), 12u);
  extension["attributes"]["TEXCOORD_0"] = 77;
  EXPECT_NE(refusal("b.glb", glb.bytes()).find("has no attribute for 'TEXCOORD_0'"),
            std::string::npos);
}

TEST_F(ReadGltf, RefusesDracosTruthValues) {
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    Glb glb = packed(shapes::cube(2.0), method, draco::DT_BOOL);
    EXPECT_NE(refusal("a.glb", glb.bytes()).find("holds truth values, not numbers"),
              std::string::npos);
  }
}

TEST_F(ReadGltf, RefusesDracoThatIsCutOrAnnouncesFarMoreThanItHolds) {
  const Glb whole = packed(shapes::cube(2.0), draco::MESH_SEQUENTIAL_ENCODING);
  const std::size_t length = whole.json["bufferViews"][0]["byteLength"];
  for (std::size_t cut = 0; cut < length; ++cut) {
    Glb glb = whole;
    glb.json["bufferViews"][0]["byteLength"] = cut;
    EXPECT_NE(refusal("a.glb", glb.bytes()).find("cannot be unpacked"), std::string::npos) << cut;
  }
  Glb huge = whole;
  huge.buffer.replace(11, 1, "\xff\xff\xff\x7f");  // 2^28 faces
  EXPECT_NE(refusal("b.glb", huge.bytes()).find("cannot be unpacked"), std::string::npos);
  // Any byte changed: read or refused.
  for (std::size_t i = 0; i < length; ++i) {
    Glb glb = whole;
    glb.buffer[i] = static_cast<char>(glb.buffer[i] ^ 0x55);
    const std::filesystem::path file = write("c.glb", glb.bytes());
    try {
      (void)readMesh(file);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
    }
  }
}

TEST_F(ReadGltf, RefusesDracoWhosePositionsAreElsewhereAndTooFew) {
  // Triangles of eight points, and positions of a plain accessor without data.
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    Glb glb = packed(shapes::cube(2.0), method);
    Json& primitive = glb.json["meshes"][0]["primitives"][0];
    primitive["attributes"].erase("COLOR_0");
    primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"] = Json::object();
    glb.json["accessors"][0]["count"] = 3;
    EXPECT_NE(refusal("a.glb", glb.bytes()).find(", its mesh has 3"), std::string::npos);
  }
}

}  // namespace
}  // namespace sherd
