// Small files that would take much memory are refused before they do.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/mesh.h>
#include <zlib.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/memory_budget.h"
#include "draco_stream.h"
#include "formats/mesh/polygon_mesh.h"
#include "formats/points/parse_points.h"
#include "formats/voxels/parse_voxels.h"
#include "shapes.h"
#include "unit/formats/mesh_folder.h"

namespace sherd {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kMega = 1'000'000;

std::string gzipped(const std::string& bytes) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY),
            Z_OK);
  std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::string glbBytes(Json json, const std::string& buffer) {
  json["asset"] = {{"version", "2.0"}};
  json["buffers"] = {{{"byteLength", buffer.size()}}};
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string padded = buffer;
  padded.resize((buffer.size() + 3) / 4 * 4, '\0');
  std::string out = "glTF";
  put(out, std::uint32_t{2});
  put(out, static_cast<std::uint32_t>(28 + text.size() + padded.size()));
  put(out, static_cast<std::uint32_t>(text.size()));
  out += "JSON" + text;
  put(out, static_cast<std::uint32_t>(padded.size()));
  return out.append("BIN\0", 4) + padded;
}

// One triangle, and what shows it.
Json oneTriangle() {
  return {{"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}},
          {"bufferViews", {{{"buffer", 0}, {"byteLength", 36}}}},
          {"accessors",
           {{{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}}}};
}
std::string triangleBytes() {
  std::string out;
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) put(out, x);
  return out;
}

// The triangle as often as that, at places of a byte for each axis.
std::string instances(std::size_t count) {
  Json json = oneTriangle();
  json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", 36}, {"byteLength", 3 * count}, {"byteStride", 3}});
  json["accessors"].push_back(
      {{"bufferView", 1}, {"componentType", 5121}, {"count", count}, {"type", "VEC3"}});
  json["nodes"] = {
      {{"mesh", 0},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 1}}}}}}}}};
  return glbBytes(json, triangleBytes() + std::string(3 * count, '\1'));
}

std::string sentence(const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
    return e.what();
  }
  return "nothing";
}

class ReadMemory : public MeshFolder {
 protected:
  // The file is refused for its memory with that limit.
  void expectTooMuch(const std::string& name, const std::string& bytes, std::uint64_t limit) const {
    const auto file = write(name, bytes);
    const std::string said = sentence([&] { (void)readMesh(file, {.maxMemory = limit}); });
    EXPECT_NE(said.find(name + ": reading it takes "), std::string::npos) << said;
    EXPECT_NE(said.find(" may be used"), std::string::npos) << said;
  }
};

TEST(MemoryBudget, ChargesUpToItsLimit) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
  MemoryBudget memory("a", 100);
  memory.charge(10, 10);
  EXPECT_EQ(memory.left(), 0u);
  EXPECT_THROW(memory.charge(1), Error);
  memory.release(40);
  {
    const TransientMemory transient(&memory);
    memory.charge(40);
  }
  EXPECT_EQ(memory.taken(), 60u);
  EXPECT_THROW(memory.charge(kMost, kMost), Error);
  EXPECT_THROW(memory.charge(kMost - 30, 1), Error);
  EXPECT_EQ(memory.taken(), 60u);
  MemoryBudget endless("b", kMost);
  endless.charge(kMost / 2, 2);
  EXPECT_EQ(sentence([] { MemoryBudget("c.ply", 2'000'000'000).charge(16, 1'000'000'000); }),
            "c.ply: reading it takes 16 GB of memory or more, and 2 GB may be used");
}

TEST_F(ReadMemory, WhatFitsIsReadWithinALimitOfAFewTimesItsSize) {
  const TriangleMesh torus = shapes::torus(2.0, 1.0);
  std::string text;
  for (const glm::dvec3& v : torus.vertices) {
    text += "v " + std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
    text += "\n";
  }
  for (const glm::uvec3& t : torus.triangles) {
    text += "f " + std::to_string(t.x + 1) + " " + std::to_string(t.y + 1) + " " +
            std::to_string(t.z + 1) + "\n";
  }
  for (const bool packed : {false, true}) {
    const auto file = write(packed ? "t.obj.gz" : "t.obj", packed ? gzipped(text) : text);
    EXPECT_EQ(readMesh(file, {.maxMemory = 10 * text.size()}).mesh.triangles.size(),
              torus.triangles.size());
    expectTooMuch(packed ? "t.obj.gz" : "t.obj", packed ? gzipped(text) : text, text.size());
  }
}

TEST_F(ReadMemory, PackedZerosAreRefused) {
  const std::string zeros = gzipped(std::string(64 * kMega, '\0'));
  ASSERT_LT(zeros.size(), kMega);
  expectTooMuch("a.obj.gz", zeros, 32 * kMega);
  expectTooMuch("b.stl.gz", zeros + gzipped("x"), 32 * kMega);  // the length at its end is 1
  // What must begin in one way is not unpacked to its end.
  for (const char* name : {"c.ply.gz", "d.glb.gz", "e.gltf.gz"}) {
    const auto file = write(name, zeros);
    const std::string said = sentence([&] { (void)readMesh(file, {.maxMemory = 70 * kMega}); });
    EXPECT_EQ(said.find("memory"), std::string::npos) << said;
    EXPECT_NE(said, "nothing");
  }
}

TEST_F(ReadMemory, ManyPrimitivesOfOneAccessorAreRefused) {
  Json json = oneTriangle();
  json["accessors"][0] = {{"componentType", 5126}, {"count", 30'000}, {"type", "VEC3"}};
  json["nodes"] = {{{"mesh", 0}}};
  for (int i = 1; i < 300; ++i) {
    json["meshes"][0]["primitives"].push_back(json["meshes"][0]["primitives"][0]);
  }
  expectTooMuch("a.glb", glbBytes(json, std::string(40'000, '\0')), 100 * kMega);
}

TEST_F(ReadMemory, SparseAccessorsAndTexturesAreCharged) {
  Json json = oneTriangle();
  json["nodes"] = {{{"mesh", 0}}};
  json["accessors"].push_back({{"componentType", 5126}, {"count", 1'000'000}, {"type", "MAT4"}});
  json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 1;
  expectTooMuch("a.glb", glbBytes(json, triangleBytes() + std::string(kMega, '\0')), 100 * kMega);

  // A hundred pictures of one place.
  Json pictures = oneTriangle();
  pictures["nodes"] = {{{"mesh", 0}}};
  pictures["bufferViews"].push_back({{"buffer", 0}, {"byteLength", kMega}});
  pictures["accessors"].push_back(
      {{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC2"}});
  Json& primitives = pictures["meshes"][0]["primitives"];
  primitives[0]["attributes"]["TEXCOORD_0"] = 1;
  const Json primitive = primitives[0];
  primitives.clear();
  for (int i = 0; i < 100; ++i) {
    pictures["images"].push_back({{"bufferView", 1}});
    pictures["textures"].push_back({{"source", i}});
    pictures["materials"].push_back(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    primitives.push_back(primitive);
    primitives.back()["material"] = i;
  }
  const std::string file = glbBytes(pictures, triangleBytes() + std::string(kMega, '\0'));
  EXPECT_EQ(read("b.glb", file).appearance.textures.size(), 100u);
  expectTooMuch("c.glb", file, 20 * kMega);
}

TEST_F(ReadMemory, InstancesAreCountedBeforeThereIsRoomForThem) {
  const std::string file = instances(300'000);
  ASSERT_LT(file.size(), kMega);
  expectTooMuch("a.glb", file, 30 * kMega);
  EXPECT_EQ(sentence([&] { (void)read("b.glb", file); }), "nothing");
}

TEST_F(ReadMemory, NamesThatNodesTakeFromTheirMeshAreCharged) {
  Json json = oneTriangle();
  json["meshes"][0]["name"] = std::string(100'000, 'n');
  for (int i = 0; i < 1000; ++i) json["nodes"].push_back({{"mesh", 0}});
  const std::string file = glbBytes(json, triangleBytes());
  EXPECT_EQ(sentence([&] { (void)read("a.glb", file); }), "nothing");
  expectTooMuch("b.glb", file, 50 * kMega);
}

TEST_F(ReadMemory, InstancesStopOnRequest) {
  const auto file = write("a.glb", instances(300'000));
  int asked = 0;
  Progress progress;
  progress.cancelled = [&] { return ++asked > 100; };
  try {
    (void)readMesh(file, {}, &progress);
    FAIL() << asked;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(asked, 101);
}

// Each instance of nothing took its time: 2,000 nodes of 300,000.
TEST_F(ReadMemory, InstancesOfNothingTakeNoTime) {
  constexpr std::size_t kCount = 300'000;
  Json json = oneTriangle();
  json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 36}, {"byteLength", 3 * kCount}});
  json["accessors"].push_back(
      {{"bufferView", 1}, {"componentType", 5121}, {"count", kCount}, {"type", "VEC3"}});
  json["meshes"].push_back({{"primitives", Json::array()}});
  json["nodes"] = {{{"mesh", 0}}};
  for (int i = 0; i < 2000; ++i) {
    json["nodes"].push_back(
        {{"mesh", 1},
         {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 1}}}}}}}});
  }
  const std::string file = glbBytes(json, triangleBytes() + std::string(3 * kCount, '\1'));
  EXPECT_EQ(read("a.glb", file).mesh.triangles.size(), 1u);
}

TEST_F(ReadMemory, LongJsonIsChargedAndReadOnce) {
  Json json = oneTriangle();
  json["nodes"] = {{{"mesh", 0}}};
  json["extras"] = Json::array();
  for (int i = 0; i < 300'000; ++i) json["extras"].push_back(Json::object());
  const std::string file = glbBytes(json, triangleBytes());
  EXPECT_EQ(read("a.glb", file).mesh.triangles.size(), 1u);
  expectTooMuch("b.glb", file, 20 * kMega);
}

// ---- Text

// A face of a triangle's corners, again and again, and then something that is none.
struct LongFace {
  std::string name, text;
};
std::vector<LongFace> longFaces(std::size_t corners) {
  std::string counted, from0, from1;
  for (std::size_t i = 0; i < corners; ++i) {
    from0 += " " + std::to_string(i % 3);
    from1 += " " + std::to_string(i % 3 + 1);
  }
  const std::string count = std::to_string(corners), vertices = "0 0 0\n1 0 0\n0 1 0\n";
  return {{"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf" + from1 + " x\n"},
          {"a.off", "OFF\n3 1 0\n" + vertices + std::to_string(corners + 1) + from0 + " x\n"},
          {"a.ply",
           "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
           "float z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n" +
               vertices + std::to_string(corners + 1) + from0 + " x\n"}};
}

TEST_F(ReadMemory, OneLongFaceIsChargedAndAskedAsItGrows) {
  constexpr std::size_t kCorners = 500'000;
  for (const LongFace& face : longFaces(kCorners)) {
    SCOPED_TRACE(face.name);
    const auto file = write(face.name, face.text);
    int asked = 0;
    Progress progress;
    progress.cancelled = [&] {
      ++asked;
      return false;
    };
    EXPECT_NE(sentence([&] { (void)readMesh(file, {}, &progress); }).find("'x'"),
              std::string::npos);
    EXPECT_GE(asked, static_cast<int>(kCorners / 4096));
    expectTooMuch(face.name, face.text, 5 * kMega);
  }
}

TEST(PolygonMemory, TheLongestFaceIsChargedWhileItIsMadeTriangles) {
  constexpr std::uint32_t kCorners = 100'000;
  PolygonMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (std::uint32_t i = 0; i < kCorners; ++i) mesh.corners.push_back(i % 3);
  mesh.faceEnds = {kCorners};
  const auto chargedWithin = [&](std::uint64_t limit) {
    MemoryBudget memory("a", limit);
    const MeshFile file{"a", "a", MeshFormat::obj, "", &memory};
    RawMesh out;
    triangulateInto(file, PolygonMesh(mesh), out);
    return memory.taken();
  };
  const std::uint64_t kept = chargedWithin(100 * kMega);
  EXPECT_EQ(chargedWithin(kept + 16 * kCorners), kept);
  EXPECT_THROW((void)chargedWithin(kept + 16 * kCorners - 1), Error);
}

TEST_F(ReadMemory, AllMaterialLibrariesAreCharged) {
  std::string library, obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
  for (int i = 0; i < 10'000; ++i) library += "newmtl a" + std::to_string(i) + "\n";
  for (int i = 0; i < 10; ++i) {
    const std::string name = std::to_string(i) + ".mtl";
    write(name, library);
    obj += "mtllib " + name + "\n";
  }
  EXPECT_EQ(read("a.obj", obj).mesh.triangles.size(), 1u);
  expectTooMuch("b.obj", obj, 12 * kMega);
}

TEST_F(ReadMemory, PlyHeadersAreBoundedAndTheirCommentsCharged) {
  const auto ply = [](const std::string& more) {
    return "ply\nformat ascii 1.0\n" + more +
           "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  };
  const auto elements = [](int count) {
    std::string out;
    for (int i = 0; i < count; ++i) out += "element e" + std::to_string(i) + " 0\n";
    return out;
  };
  EXPECT_EQ(read("a.ply", ply(elements(998))).mesh.triangles.size(), 1u);
  EXPECT_EQ(refusal("a.ply", ply(elements(999))),
            "a.ply:1006: the header names more than 1000 elements");
  std::string properties = "element e 0\n";
  for (int i = 0; i < 996; ++i) properties += "property int p" + std::to_string(i) + "\n";
  EXPECT_EQ(read("b.ply", ply(properties)).mesh.triangles.size(), 1u);
  EXPECT_EQ(refusal("b.ply", ply(properties + "property int p\n")),
            "b.ply:1006: the header names more than 1000 properties");
  std::string comments;
  for (int i = 0; i < 50'000; ++i) comments += "comment\n";
  EXPECT_EQ(read("c.ply", ply(comments)).mesh.triangles.size(), 1u);
  expectTooMuch("c.ply", ply(comments), 20 * kMega);
}

// ---- Draco

//   length  of the stream, the rest of which lies behind it
std::string packedByDraco(const std::string& stream, std::size_t length) {
  Json json = oneTriangle();
  json["bufferViews"] = {{{"buffer", 0}, {"byteLength", length}}};
  json["accessors"] = {{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}};
  json["nodes"] = {{{"mesh", 0}}};
  json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", 0}, {"attributes", {{"POSITION", kDracoPositions}}}};
  return glbBytes(json, stream);
}
std::string packedByDraco(const std::string& stream) {
  return packedByDraco(stream, stream.size());
}

// The counts that lie behind these streams would be charged.
TEST_F(ReadMemory, DracosHeaderIsNotReadBeyondItsStream) {
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const std::string stream = dracoStream(shapes::torus(2.0, 1.0, 40, 30), method);
    for (std::size_t length = 0; length <= 12; ++length) {
      const auto file = write("a.glb", packedByDraco(stream, length));
      const std::string said = sentence([&] { (void)readMesh(file, {.maxMemory = kMega / 4}); });
      EXPECT_NE(said.find("cannot be unpacked"), std::string::npos) << length << ": " << said;
    }
  }
}

TEST_F(ReadMemory, DracoIsRefusedByWhatItAnnounces) {
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const std::string file = packedByDraco(dracoStream(shapes::torus(2.0, 1.0), method));
    EXPECT_EQ(read("a.glb", file).mesh.triangles.size(), shapes::torus(2.0, 1.0).triangles.size());
    expectTooMuch("b.glb", file, kMega);
  }
}

// An attribute of the same numbers everywhere takes next to nothing in the stream.
TEST_F(ReadMemory, DracosAttributesAreCountedBeforeThereIsRoomForThem) {
  constexpr std::uint8_t kNumbers = 120;
  const TriangleMesh mesh = shapes::torus(2.0, 1.0, 100, 100);
  const auto count = static_cast<std::uint32_t>(mesh.vertices.size());
  draco::Mesh source;
  source.set_num_points(count);
  draco::GeometryAttribute position, same;
  position.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
  same.Init(draco::GeometryAttribute::GENERIC, nullptr, kNumbers, draco::DT_UINT8, false, kNumbers,
            0);
  const int positions = source.AddAttribute(position, true, count);
  const int sames = source.AddAttribute(same, true, count);
  const std::vector<std::uint8_t> zeros(kNumbers, 0);
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec3 at(mesh.vertices[i]);
    source.attribute(positions)->SetAttributeValue(draco::AttributeValueIndex(i), &at);
    source.attribute(sames)->SetAttributeValue(draco::AttributeValueIndex(i), zeros.data());
  }
  source.SetNumFaces(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    source.SetFace(draco::FaceIndex(i),
                   {draco::PointIndex(t.x), draco::PointIndex(t.y), draco::PointIndex(t.z)});
  }
  draco::ExpertEncoder encoder(source);
  encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetAttributeQuantization(positions, 11);
  draco::EncoderBuffer out;
  ASSERT_TRUE(encoder.EncodeToBuffer(&out).ok());
  const std::string file = packedByDraco({out.data(), out.size()});
  ASSERT_LT(file.size(), kMega);
  EXPECT_EQ(read("a.glb", file).mesh.triangles.size(), mesh.triangles.size());
  expectTooMuch("b.glb", file, 20 * kMega);  // 10,000 points of 123 numbers
}

// ---- Voxels and points

std::string fileOf(const RunLengthVoxels& voxels, VoxelFormat format) {
  std::string bytes;
  encodeVoxels({voxels}, format, [&](std::string_view component) { bytes += component; });
  return bytes;
}

RunLengthVoxels byTurns(int side) {
  RunLengthVoxels voxels{{side, side, side}, {}};
  const int count = side * side * side;
  for (int i = 0; i < count; ++i) {
    voxels.runs.push_back({static_cast<std::uint16_t>(1 + i % 2), 1});
  }
  return voxels;
}

TEST(VoxelMemory, RunsAreCharged) {
  const RunLengthVoxels voxels = byTurns(100);  // a million runs of 8 bytes
  using Parse = std::function<RunLengthVoxels(std::string_view, const ReadOptions&)>;
  const std::vector<std::pair<VoxelFormat, Parse>> formats{
      {VoxelFormat::rle, [](auto bytes, auto o) { return parseRle(bytes, "x", o); }},
      {VoxelFormat::npy, [](auto bytes, auto o) { return parseNpyLabels(bytes, "x", o); }},
      {VoxelFormat::npz, [](auto bytes, auto o) { return parseNpzLabels(bytes, "x", o).voxels; }},
      {VoxelFormat::vox, [](auto bytes, auto o) { return parseMagicaVoxel(bytes, "x", o); }},
      {VoxelFormat::qstack, [](auto bytes, auto o) { return parseQuadStack(bytes, "x", o); }},
      {VoxelFormat::bing, [](auto bytes, auto o) { return parseBing(bytes, "x", o); }}};
  for (const auto& one : formats) {
    const auto format = one.first;
    const Parse& parse = one.second;
    SCOPED_TRACE(static_cast<int>(format));
    const std::string bytes = fileOf(voxels, format);
    EXPECT_EQ(parse(bytes, {.maxMemory = 80 * kMega}).runs.size(), voxels.runs.size());
    EXPECT_NE(sentence([&] { (void)parse(bytes, {.maxMemory = 7 * kMega}); }).find(" may be used"),
              std::string::npos);
  }
}

struct OneFile : FileSink {
  std::string bytes;
  void take(const std::string&, const Content& content) override {
    content([&](std::string_view component) { bytes += component; });
  }
};

TEST(PointMemory, PointsAreCharged) {
  SurfacePoints points;
  for (int i = 0; i < 50'000; ++i) points.positions.emplace_back(i % 40, i / 40 % 40, i / 1600);
  using Parse = std::function<SurfacePoints(std::string_view, const ReadOptions&)>;
  const std::vector<std::pair<PointFormat, Parse>> formats{
      {PointFormat::ply, [](auto bytes, auto o) { return parsePlyPoints(bytes, "x", o); }},
      {PointFormat::xyz, [](auto bytes, auto o) { return parseXyz(bytes, "x", o); }},
      {PointFormat::npz, [](auto bytes, auto o) { return parseNpzPoints(bytes, "x", o); }},
      {PointFormat::binp, [](auto bytes, auto o) { return parseBinp(bytes, "x", o); }}};
  for (const auto& one : formats) {
    const auto format = one.first;
    const Parse& parse = one.second;
    SCOPED_TRACE(static_cast<int>(format));
    OneFile file;
    writePoints(OutputFile(file, "x"), points, format);
    const std::string& bytes = file.bytes;
    EXPECT_EQ(parse(bytes, {.maxMemory = 8 * kMega}).positions.size(), points.positions.size());
    EXPECT_NE(sentence([&] { (void)parse(bytes, {.maxMemory = kMega}); }).find(" may be used"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace sherd
