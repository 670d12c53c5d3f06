// Reads every format from files that the test writes itself, and sees every kind of broken file
// refused.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/mesh.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "formats/mesh/contradictions.h"
#include "shapes.h"
#include "unit/formats/mesh_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

class ReadMesh : public MeshFolder {};

// ---- Writers, one per format. ----

std::string objText(const TriangleMesh& mesh) {
  std::ostringstream out;
  for (const glm::dvec3& v : mesh.vertices) out << "v " << v.x << ' ' << v.y << ' ' << v.z << '\n';
  for (const glm::uvec3& t : mesh.triangles)
    out << "f " << t.x + 1 << ' ' << t.y + 1 << ' ' << t.z + 1 << '\n';
  return out.str();
}

std::string offText(const TriangleMesh& mesh) {
  std::ostringstream out;
  out << "OFF\n" << mesh.vertices.size() << ' ' << mesh.triangles.size() << " 0\n";
  for (const glm::dvec3& v : mesh.vertices) out << v.x << ' ' << v.y << ' ' << v.z << '\n';
  for (const glm::uvec3& t : mesh.triangles) out << "3 " << t.x << ' ' << t.y << ' ' << t.z << '\n';
  return out.str();
}

std::string plyHeader(const std::string& format, const TriangleMesh& mesh) {
  return "ply\nformat " + format + " 1.0\ncomment by a test\nelement vertex " +
         std::to_string(mesh.vertices.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar quality\nelement "
         "face " +
         std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string plyText(const TriangleMesh& mesh) {
  std::ostringstream out;
  out << plyHeader("ascii", mesh);
  for (const glm::dvec3& v : mesh.vertices) out << v.x << ' ' << v.y << ' ' << v.z << " 7\n";
  for (const glm::uvec3& t : mesh.triangles) out << "3 " << t.x << ' ' << t.y << ' ' << t.z << '\n';
  return out.str();
}

std::string plyBinary(const TriangleMesh& mesh, bool bigEndian) {
  std::string out = plyHeader(bigEndian ? "binary_big_endian" : "binary_little_endian", mesh);
  for (const glm::dvec3& v : mesh.vertices) {
    for (int i = 0; i < 3; ++i) put(out, static_cast<float>(v[i]), bigEndian);
    put(out, std::uint8_t{7});
  }
  for (const glm::uvec3& t : mesh.triangles) {
    put(out, std::uint8_t{3});
    for (int i = 0; i < 3; ++i) put(out, static_cast<std::int32_t>(t[i]), bigEndian);
  }
  return out;
}

std::string stlText(const TriangleMesh& mesh) {
  std::ostringstream out;
  out << "solid test\n";
  for (const glm::uvec3& t : mesh.triangles) {
    out << " facet normal 0 0 0\n  outer loop\n";
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3& v = mesh.vertices[t[i]];
      out << "   vertex " << v.x << ' ' << v.y << ' ' << v.z << '\n';
    }
    out << "  endloop\n endfacet\n";
  }
  out << "endsolid test\n";
  return out.str();
}

std::string stlBinary(const TriangleMesh& mesh, const std::string& header = "by a test") {
  std::string out = header;
  out.resize(80, '\0');
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const glm::uvec3& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) put(out, 0.0f);
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) put(out, static_cast<float>(mesh.vertices[t[i]][k]));
    put(out, std::uint16_t{0});
  }
  return out;
}

// A glTF buffer: positions, then indices.
std::string gltfBuffer(const TriangleMesh& mesh) {
  std::string out;
  for (const glm::dvec3& v : mesh.vertices)
    for (int i = 0; i < 3; ++i) put(out, static_cast<float>(v[i]));
  for (const glm::uvec3& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) put(out, static_cast<std::uint16_t>(t[i]));
  return out;
}

constexpr const char* kOneNode = R"([{"mesh":0}])";

// A glTF text; `uri` is empty for the buffer of a GLB file.  Node 0 is the scene's root.
std::string gltfJson(const TriangleMesh& mesh, const std::string& nodes, const std::string& uri) {
  const std::size_t positions = 12 * mesh.vertices.size(), indices = 6 * mesh.triangles.size();
  std::ostringstream out;
  out << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" << nodes
      << R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
      << R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)"
      << mesh.vertices.size()
      << R"(},{"bufferView":1,"componentType":5123,"type":"SCALAR","count":)"
      << 3 * mesh.triangles.size() << R"(}],"bufferViews":[{"buffer":0,"byteLength":)" << positions
      << R"(},{"buffer":0,"byteOffset":)" << positions << R"(,"byteLength":)" << indices
      << R"(}],"buffers":[{)" << (uri.empty() ? "" : R"("uri":")" + uri + R"(",)")
      << R"("byteLength":)" << positions + indices << "}]}";
  return out.str();
}

std::string glb(std::string json, std::string buffer) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
  std::string out = "glTF";
  put(out, std::uint32_t{2});
  put(out, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
  put(out, static_cast<std::uint32_t>(json.size()));
  out += "JSON" + json;
  put(out, static_cast<std::uint32_t>(buffer.size()));
  out += std::string("BIN\0", 4) + buffer;
  return out;
}

std::string gzip(const std::string& bytes) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

// ---- What is read. ----

TEST_F(ReadMesh, GivesTheSameMeshFromEveryFormat) {
  const TriangleMesh cube = shapes::cube(2.0, {3.0, -1.0, 0.5});
  write("cube.bin", gltfBuffer(cube));
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.obj", objText(cube)},
      {"b.off", offText(cube)},
      {"c.ply", plyText(cube)},
      {"d.ply", plyBinary(cube, false)},
      {"e.ply", plyBinary(cube, true)},
      {"f.stl", stlText(cube)},
      {"g.stl", stlBinary(cube)},
      {"h.STL", stlBinary(cube, "solid although binary")},
      {"i.gltf", gltfJson(cube, kOneNode, "cube.bin")},
      {"j.glb", glb(gltfJson(cube, kOneNode, ""), gltfBuffer(cube))}};
  for (const auto& [name, bytes] : files) {
    SCOPED_TRACE(name);
    const SourceMesh source = read(name, bytes);
    expectSameSurface(source.mesh, cube);
    EXPECT_EQ(source.fileVertices, name.ends_with("stl") || name.ends_with("STL") ? 36u : 8u);
    EXPECT_EQ(source.degenerateTriangles, 0u);
    const SourceMesh packed = read(name + ".gz", gzip(bytes));
    EXPECT_EQ(packed.mesh.vertices, source.mesh.vertices);
    EXPECT_EQ(packed.mesh.triangles, source.mesh.triangles);
  }
}

TEST_F(ReadMesh, NamesAFileByItsStem) {
  const SourceMesh source = read("my.bowl.STL.gz", gzip(stlBinary(tetrahedron())));
  EXPECT_EQ(source.name, "my.bowl.STL.gz");
  EXPECT_EQ(source.stem, "my.bowl");
}

TEST_F(ReadMesh, HashesTheFilesBytes) {
  // The digest of this text by coreutils' sha256sum.
  EXPECT_EQ(read("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").sha256,
            "697b00ab13410c52a542d2e9c63711fcc04e9cbf6c0d3439a9b43cc812e6e713");
}

TEST_F(ReadMesh, KeepsTheOrderOfVerticesAndTriangles) {
  const TriangleMesh cube = shapes::cube(2.0);
  const SourceMesh source = read("cube.ply", plyBinary(cube, false));
  EXPECT_EQ(source.mesh.vertices, cube.vertices);
  EXPECT_EQ(source.mesh.triangles, cube.triangles);
}

// A line feed there is no part of the header's last line.
TEST_F(ReadMesh, TakesAnyByteForTheFirstOfABinaryPly) {
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    for (const bool bigEndian : {false, true}) {
      TriangleMesh mesh = tetrahedron();
      const std::uint32_t bits = bigEndian ? byte << 24 | 0x001234 : 0x3fc00000 | byte;
      mesh.vertices[0].x = std::bit_cast<float>(bits);
      if (std::abs(mesh.vertices[0].x) > 1e36) continue;  // refused for its size
      const std::string bytes = plyBinary(mesh, bigEndian);
      const std::size_t body = bytes.find("end_header\n") + 11;
      ASSERT_EQ(static_cast<unsigned char>(bytes[body]), byte);
      std::string windows;  // the same with the other kind of line end
      for (const char c : bytes.substr(0, body)) windows += c == '\n' ? "\r\n" : std::string(1, c);
      windows += bytes.substr(body);
      for (const std::string& file : {bytes, windows}) {
        const SourceMesh source = read("t.ply", file);
        EXPECT_EQ(source.mesh.vertices, mesh.vertices) << byte;
        EXPECT_EQ(source.mesh.triangles, mesh.triangles) << byte;
      }
    }
  }
}

TEST_F(ReadMesh, TakesZeroAndMinusZeroForEqual) {
  const SourceMesh source =
      read("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 -0.0 0\nv 0 0 1\nf 1 2 3\nf 4 3 5\n");
  EXPECT_EQ(source.mesh.vertices.size(), 4u);
  EXPECT_EQ(source.fileVertices, 5u);
}

TEST_F(ReadMesh, DropsUnusedVerticesAndDegenerateTriangles) {
  const SourceMesh source = read("t.off",
                                 "OFF\n6 3 0\n9 9 9\n0 0 0\n1 0 0\n0 1 0\n1 0 0\n8 8 8\n"
                                 "3 1 2 3\n3 1 2 4\n3 5 5 1\n");
  EXPECT_EQ(source.mesh.vertices.size(), 3u);
  EXPECT_EQ(source.mesh.triangles.size(), 1u);
  EXPECT_EQ(source.degenerateTriangles, 2u);
  EXPECT_EQ(source.fileVertices, 6u);
}

constexpr const char* kCubeCorners =
    "v 0 0 0\nv 0 0 1\nv 0 1 0\nv 0 1 1\nv 1 0 0\nv 1 0 1\nv 1 1 0\nv 1 1 1\n";

TEST_F(ReadMesh, TriangulatesQuadsWithPositiveAndNegativeIndices) {
  for (const char* faces : {"f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n",
                            "f -8 -7 -5 -6\nf -4 -2 -1 -3\nf -8 -4 -3 -7\nf -6 -5 -1 -2\nf -8 -6 "
                            "-2 -4\nf -7 -3 -1 -5\n"}) {
    const TriangleMesh mesh = read("cube.obj", std::string(kCubeCorners) + faces).mesh;
    EXPECT_EQ(mesh.triangles.size(), 12u);
    EXPECT_EQ(openEdges(mesh), 0u);
    EXPECT_DOUBLE_EQ(volume(mesh), 1.0);
    EXPECT_DOUBLE_EQ(area(mesh), 6.0);
  }
}

TEST_F(ReadMesh, ReadsAnObjFileWithAllItsOrnaments) {
  const std::string text =
      "# comment\r\nmtllib absent.mtl\r\no thing\r\ng left right\r\nusemtl red\r\ns off\r\nvt 0 "
      "0\r\nvn 0 0 1\r\n" +
      replaced(std::string(kCubeCorners), "v 1 1 1\n", "v 1 1 1 1\r\n") +
      "f 1/1/1 2/1/1 4/1/1 3/1/1\r\nf 5//1 7//1 8//1 6//1\r\nusemtl blue\r\nf 1/1 5/1 6/1 2/1\r\ng "
      "other\r\n"
      "f 3 4 \\\r\n 8 7\r\nf  1\t3 7 5 \r\nf 2 6 8 4";
  const TriangleMesh mesh = read("cube.obj", text).mesh;
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(openEdges(mesh), 0u);
  EXPECT_DOUBLE_EQ(volume(mesh), 1.0);
}

// A prism over a polygon that isn't convex: a fan about any one corner would leave it.
TEST_F(ReadMesh, TriangulatesConcavePolygons) {
  const std::vector<glm::dvec2> comb{{0, 0}, {7, 0}, {7, 3}, {6, 3}, {6, 1}, {4, 1},
                                     {4, 3}, {3, 3}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
  const double combArea = 7 * 1 + 3 * (1 * 2), combLength = 2 * 7 + 2 * 3 + 4 * 2;
  std::ostringstream out;
  const std::size_t n = comb.size();
  for (int z = 0; z < 2; ++z)
    for (const glm::dvec2& p : comb) out << "v " << p.x << ' ' << z << ' ' << p.y << '\n';
  out << 'f';
  for (std::size_t i = 1; i <= n; ++i) out << ' ' << i;
  out << "\nf";
  for (std::size_t i = 2 * n; i > n; --i) out << ' ' << i;
  out << '\n';
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = (i + 1) % n;
    out << "f " << next + 1 << ' ' << i + 1 << ' ' << n + i + 1 << ' ' << n + next + 1 << '\n';
  }
  const TriangleMesh mesh = read("comb.obj", out.str()).mesh;
  EXPECT_EQ(mesh.triangles.size(), 2 * (n - 2) + 2 * n);
  EXPECT_EQ(openEdges(mesh), 0u);
  EXPECT_DOUBLE_EQ(volume(mesh), combArea);
  EXPECT_DOUBLE_EQ(area(mesh), 2 * combArea + combLength);
}

TEST_F(ReadMesh, ReadsOffWithCommentsColorsAndEdgesLeftOut) {
  const std::string plain = offText(tetrahedron());
  const TriangleMesh mesh = tetrahedron();
  expectSameSurface(read("a.off", replaced(plain, "OFF\n", "OFF # header\n\n# counts\n")).mesh,
                    mesh);
  expectSameSurface(read("b.off", replaced(plain, "OFF\n4 4 0", "OFF 4 4")).mesh, mesh);
  expectSameSurface(
      read("c.off", replaced(plain, "3 0 2 1\n", "\n# faces\n3 0 2 1 255 0 0 # red\n")).mesh, mesh);
}

TEST_F(ReadMesh, JoinsAllSolidsOfATextStl) {
  const TriangleMesh far = shapes::transformed(tetrahedron(), 1.0, {5.0, 0.0, 0.0});
  const TriangleMesh mesh = read("two.stl", stlText(tetrahedron()) + stlText(far)).mesh;
  EXPECT_EQ(meshComponents(mesh).count, 2u);
  EXPECT_NEAR(volume(mesh), 2.0 / 6.0, 1e-15);
}

TEST_F(ReadMesh, AppliesNodeTransformsToEveryInstance) {
  // A node that moves, with three children: scaled, turned by 90 degrees about z and moved, and
  // mirrored.
  const std::string nodes = R"([{"children":[1,2,3],"translation":[10,20,30]},)"
                            R"({"mesh":0,"scale":[2,2,2]},)"
                            R"({"mesh":0,"matrix":[0,1,0,0, -1,0,0,0, 0,0,1,0, 4,0,0,1]},)"
                            R"({"mesh":0,"scale":[-1,1,1],"translation":[-4,0,0]}])";
  const TriangleMesh t = tetrahedron();
  TriangleMesh turned = t, mirrored = shapes::inverted(t);
  for (glm::dvec3& v : turned.vertices) v = glm::dvec3(-v.y + 4.0, v.x, v.z);
  for (glm::dvec3& v : mirrored.vertices) v = glm::dvec3(-v.x - 4.0, v.y, v.z);
  const TriangleMesh expected = shapes::transformed(
      shapes::append(shapes::append(shapes::transformed(t, 2.0, glm::dvec3(0.0)), turned),
                     mirrored),
      1.0, {10, 20, 30});
  const SourceMesh source = read("t.glb", glb(gltfJson(t, nodes, ""), gltfBuffer(t)));
  expectSameSurface(source.mesh, expected);
  EXPECT_EQ(source.fileVertices, 12u);
  EXPECT_NEAR(volume(source.mesh), (8.0 + 1.0 + 1.0) / 6.0, 1e-12);
}

TEST_F(ReadMesh, FindsAGltfBufferWhoseNameIsEncoded) {
  const TriangleMesh t = tetrahedron();
  fs::create_directory(folder_ / "parts");
  write("parts/my data.bin", gltfBuffer(t));
  expectSameSurface(read("t.gltf", gltfJson(t, kOneNode, "parts/my%20data.bin")).mesh, t);
}

TEST_F(ReadMesh, UnpacksAFileOfSeveralGzipStreams) {
  const std::string text = objText(tetrahedron());
  expectSameSurface(read("t.obj.gz", gzip(text.substr(0, 20)) + gzip(text.substr(20))).mesh,
                    tetrahedron());
}

// ---- What is refused. ----

TEST_F(ReadMesh, RefusesAnAbsentFileAFolderAndAnEmptyFile) {
  EXPECT_NE(refusal(folder_ / "absent.obj").find("absent.obj: there is no such file"),
            std::string::npos);
  EXPECT_NE(refusal(folder_).find("is a directory"), std::string::npos);
  EXPECT_EQ(refusal("empty.obj", ""), "empty.obj: the file is empty");
  EXPECT_EQ(refusal("empty.ply.gz", gzip("")), "empty.ply.gz: the file is empty");
}

TEST_F(ReadMesh, RefusesAnUnknownExtension) {
  EXPECT_NE(refusal("spider.usd", "x").find("'.usd' is not known"), std::string::npos);
  EXPECT_NE(refusal("spider", "x").find("'' is not known"), std::string::npos);
  EXPECT_NE(refusal("spider.gz", "x").find("'' is not known"), std::string::npos);
}

TEST_F(ReadMesh, RefusesACutBinaryStlWithBothCounts) {
  const std::string bytes = stlBinary(shapes::cube(1.0));
  EXPECT_EQ(refusal("bowl.stl", bytes.substr(0, bytes.size() - 120)),
            "bowl.stl: cut short: the header announces 12 triangles, the file holds 9");
  EXPECT_EQ(refusal("bowl.stl", bytes + bytes.substr(84)),
            "bowl.stl: the header announces 12 triangles, the file has room for 24");
}

TEST_F(ReadMesh, RefusesAFileWithoutTriangles) {
  EXPECT_EQ(refusal("a.stl", stlBinary({})), "a.stl: holds no triangle");
  EXPECT_EQ(refusal("b.stl", stlText({})), "b.stl: holds no triangle");
  EXPECT_EQ(refusal("c.ply", plyText({})), "c.ply: holds no triangle");
  EXPECT_EQ(refusal("d.off", offText({})), "d.off: holds no triangle");
  EXPECT_EQ(refusal("e.obj", "v 0 0 0\n"), "e.obj: holds no triangle");
  EXPECT_EQ(refusal("f.obj", "v 0 0 0\nv 1 0 0\nv 0 0 0\nf 1 2 3\n"),
            "f.obj: holds no triangle with three different corners");
}

TEST_F(ReadMesh, DropsTrianglesOfVerticesThatAreNotFinite) {
  for (const double value : {std::numeric_limits<double>::infinity(), std::nan("")}) {
    TriangleMesh t = tetrahedron();
    t.vertices[1].x = value;  // which three of the four triangles use
    for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{
             {"a.ply", plyBinary(t, true)},
             {"b.stl", stlBinary(t)},
             {"c.stl", stlText(t)},
             {"d.obj", objText(t)},
             {"e.off", offText(t)},
             {"f.ply", plyText(t)},
             {"g.glb", glb(gltfJson(t, kOneNode, ""), gltfBuffer(t))}}) {
      SCOPED_TRACE(name);
      const SourceMesh source = read(name, bytes);
      EXPECT_EQ(source.droppedTriangles, 3u);
      EXPECT_EQ(source.droppedVertices, name.ends_with("stl") ? 3u : 1u);
      EXPECT_EQ(source.degenerateTriangles, 0u);
      EXPECT_EQ(source.mesh.triangles.size(), 1u);
      EXPECT_EQ(source.mesh.vertices.size(), 3u);
      ASSERT_EQ(source.warnings.size(), 1u);
      EXPECT_NE(source.warnings[0].find("not finite; the 3 triangles"), std::string::npos);
    }
    for (int i : {0, 2, 3}) t.vertices[static_cast<std::size_t>(i)].z = value;
    EXPECT_EQ(refusal("a.obj", objText(t)).find("a.obj: all 4 vertices are not finite"), 0u);
  }
}

TEST_F(ReadMesh, RefusesABoxThatOverflows) {
  const auto wide = [](const std::string& x) {
    return "v -" + x + " 0 0\nv " + x + " 0 0\nv 0 1 0\nf 1 2 3\n";
  };
  EXPECT_EQ(refusal("a.obj", wide("1e37")),
            "a.obj: is 2e+37 long along x, at most 1e37 is supported (scale it)");
  EXPECT_EQ(refusal("b.obj", wide("1.7e308")).find("b.obj: is inf long along x"), 0u);
  EXPECT_EQ(read("c.obj", wide("5e36")).mesh.triangles.size(), 1u);
}

TEST_F(ReadMesh, RefusesIndicesOutOfRange) {
  const std::string obj = objText(tetrahedron()), off = offText(tetrahedron()),
                    ply = plyText(tetrahedron());
  EXPECT_EQ(refusal("a.obj", replaced(obj, "f 2 3 4", "f 2 3 9001")),
            "a.obj:8: face uses vertex 9001, the file has 4");
  EXPECT_EQ(refusal("b.obj", replaced(obj, "f 2 3 4", "f 2 3 -5")),
            "b.obj:8: face uses vertex -5, there are 4 before it");
  EXPECT_NE(refusal("c.obj", replaced(obj, "f 2 3 4", "f 2 3 0")).find("c.obj:8:"),
            std::string::npos);
  EXPECT_EQ(refusal("d.off", replaced(off, "3 1 2 3", "3 1 2 4")),
            "d.off:10: face uses vertex '4', the file has 4");
  EXPECT_NE(refusal("e.off", replaced(off, "3 1 2 3", "3 1 2 -1")).find("e.off:10:"),
            std::string::npos);
  EXPECT_EQ(refusal("f.ply", replaced(ply, "3 1 2 3", "3 1 2 -1")),
            "f.ply: face 3 uses vertex -1, the file has 4");
  TriangleMesh t = tetrahedron();
  t.triangles[2].y = 70000;
  EXPECT_EQ(refusal("g.ply", plyBinary(t, true)),
            "g.ply: face 2 uses vertex 70000, the file has 4");
  t.triangles[2].y = 4;
  EXPECT_EQ(refusal("h.glb", glb(gltfJson(t, kOneNode, ""), gltfBuffer(t))),
            "h.glb: face uses vertex 4, its mesh has 4");
}

// Whatever a reader misses must not be used as an index.
TEST(RawMesh, IsCheckedBeforeItIsUsed) {
  RawMesh good;
  good.vertices = tetrahedron().vertices;
  good.triangles = tetrahedron().triangles;
  good.appearance.materials.resize(2);
  good.appearance.textures.resize(1);
  good.appearance.materials[1].texture = 0;
  good.attributes.material = {0, 1, 1, 0};
  good.attributes.texcoords.resize(4);
  good.attributes.colors.resize(4);
  good.attributes.normals.resize(4);
  good.objects = {"a"};
  good.objectOfTriangle = {0, 0, 0, 0};
  EXPECT_EQ(contradictionIn(good), std::nullopt);
  const auto found = [&](const std::function<void(RawMesh&)>& change) {
    RawMesh bad = good;
    change(bad);
    return contradictionIn(bad).value_or("nothing");
  };
  EXPECT_EQ(found([](RawMesh& m) { m.triangles[2].z = 4; }),
            "triangle 3 uses vertex 4, there are 4");
  EXPECT_EQ(found([](RawMesh& m) { m.vertices.clear(); }), "triangle 1 uses vertex 2, there are 0");
  EXPECT_EQ(found([](RawMesh& m) { m.attributes.texcoords.pop_back(); }),
            "it has 3 texture coordinates for 4 triangles");
  EXPECT_EQ(found([](RawMesh& m) { m.attributes.colors.resize(5); }),
            "it has 5 colors for 4 triangles");
  EXPECT_EQ(found([](RawMesh& m) { m.attributes.normals.pop_back(); }),
            "it has 3 normals for 4 triangles");
  EXPECT_EQ(found([](RawMesh& m) { m.attributes.material[3] = 2; }),
            "triangle 4 has material 2, there are 2");
  EXPECT_EQ(found([](RawMesh& m) { m.objectOfTriangle[0] = 1; }),
            "triangle 1 has object 1, there are 1");
  EXPECT_EQ(found([](RawMesh& m) { m.appearance.materials[0].texture = 1; }),
            "one of its materials has texture 1, there are 1");
  EXPECT_EQ(found([](RawMesh& m) { m.attributes.texcoords[1][2].x = std::nanf(""); }),
            "one of its texture coordinates is not finite");
}

TEST_F(ReadMesh, RefusesCountsThatTheFileDoesNotHold) {
  const std::string off = offText(tetrahedron()), ply = plyText(tetrahedron()),
                    binary = plyBinary(tetrahedron(), false);
  EXPECT_EQ(refusal("a.off", replaced(off, "4 4 0", "4 5 0")),
            "a.off: cut short: the file ends before face 4 of 5");
  EXPECT_EQ(refusal("b.off", replaced(off, "4 4 0", "4000000000 4 0")).find("b.off"), 0u);
  EXPECT_EQ(refusal("c.off", off + "3 0 1 2\n"), "c.off:11: found '3 0 1 2' after the last face");
  EXPECT_EQ(refusal("d.ply", replaced(ply, "element face 4", "element face 5")),
            "d.ply: cut short: the header announces 5 of 'face', the file holds 4");
  EXPECT_EQ(refusal("e.ply", replaced(ply, "element face 4", "element face 3")),
            "e.ply: holds more than its header announces");
  EXPECT_EQ(refusal("f.ply", replaced(binary, "element vertex 4", "element vertex 4000000000"))
                .find("f.ply: cut short"),
            0u);
  EXPECT_EQ(refusal("g.ply", replaced(binary, "uchar int vertex_indices", "int int vertex_indices"))
                .find("g.ply"),
            0u);
  EXPECT_EQ(refusal("h.ply", replaced(ply, "3 1 2 3", "3 1 2")).find("h.ply:19:"), 0u);
  EXPECT_EQ(refusal("i.ply", replaced(ply, "1 0 0 7", "1 O 0 7")),
            "i.ply:13: found 'O' where a number is expected");
  EXPECT_EQ(refusal("j.ply", replaced(ply, "3 1 2 3", "-3 1 2 3")),
            "j.ply: face 3 has a list of negative length");
}

TEST_F(ReadMesh, RefusesATextStlWithoutItsEnd) {
  const std::string text = stlText(tetrahedron());
  EXPECT_EQ(refusal("a.stl", replaced(text, "endsolid test\n", "")),
            "a.stl: cut short: the last solid has no 'endsolid'");
  EXPECT_EQ(refusal("b.stl", replaced(text, "  endloop\n", "")),
            "b.stl:7: found ' endfacet' where a line with 'endloop' is expected");
}

TEST_F(ReadMesh, RefusesAnObjFileWhoseLastLineIsCut) {
  const std::string text = objText(tetrahedron());
  EXPECT_EQ(refusal("a.obj", text.substr(0, text.size() - 3)),
            "a.obj:8: face has less than 3 corners");
  EXPECT_EQ(refusal("b.obj", text + "f 1 2 3/"),
            "b.obj:9: face has the corner '3/', not a vertex number");
  EXPECT_EQ(refusal("c.obj", text + "v 1 2"), "c.obj:9: vertex has less than 3 coordinates");
}

TEST_F(ReadMesh, RefusesAGltfFileWithoutItsBuffer) {
  const TriangleMesh t = tetrahedron();
  EXPECT_NE(
      refusal("a.gltf", gltfJson(t, kOneNode, "absent.bin")).find("its buffer cannot be read"),
      std::string::npos);
  write("short.bin", gltfBuffer(t).substr(1));
  EXPECT_EQ(refusal("b.gltf", gltfJson(t, kOneNode, "short.bin")),
            "b.gltf: cut short: buffer 0 announces 72 bytes, there are 71");
  EXPECT_NE(
      refusal("c.gltf", gltfJson(t, kOneNode, "../short.bin")).find("below the file's folder"),
      std::string::npos);
  EXPECT_NE(refusal("d.gltf", gltfJson(t, kOneNode, "parts/%2e%2e/../../x")).find("folder"),
            std::string::npos);
}

TEST_F(ReadMesh, RefusesAGltfFileThatContradictsItself) {
  const TriangleMesh t = tetrahedron();
  const std::string json = gltfJson(t, kOneNode, "");
  const auto refuse = [&](const std::string& from, const std::string& to) {
    return refusal("t.glb", glb(replaced(json, from, to), gltfBuffer(t)));
  };
  EXPECT_EQ(refuse(R"("count":12)", R"("count":13)"),
            "t.glb: accessor 1 reaches beyond its buffer view");
  EXPECT_EQ(refuse(R"("byteOffset":48)", R"("byteOffset":52)"),
            "t.glb: buffer view 1 reaches beyond its buffer");
  EXPECT_EQ(refuse(R"("mesh":0)", R"("mesh":1)"),
            "t.glb: refers to number 1 of 'meshes', the file has 1");
  EXPECT_EQ(refuse(R"("mesh":0)", R"("children":[0])"), "t.glb: a node lies within itself");
  EXPECT_EQ(refuse(R"("version":"2.0")", R"("version":"1.0")"),
            "t.glb: is glTF of version \"1.0\", version 2 is needed");
  EXPECT_NE(refuse(R"("count":4)", R"("count":1e999)").find("JSON"), std::string::npos);
  EXPECT_EQ(refuse(R"("scene":0)", R"("extensionsRequired":["EXT_meshopt_compression"])"),
            "t.glb: needs the extension EXT_meshopt_compression, which is not supported");
  std::string deep(100000, '[');
  EXPECT_EQ(refusal("deep.gltf", deep), "deep.gltf: its JSON is nested too deeply");
}

TEST_F(ReadMesh, RefusesACutGzipFile) {
  const std::string packed = gzip(stlBinary(shapes::cube(1.0)));
  for (std::size_t length = 1; length < packed.size(); ++length)
    EXPECT_EQ(refusal("a.stl.gz", packed.substr(0, length)),
              "a.stl.gz: cut short: its gzip stream has no end");
  EXPECT_EQ(refusal("b.stl.gz", stlBinary(shapes::cube(1.0))),
            "b.stl.gz: its gzip stream is damaged");
  EXPECT_EQ(refusal("c.stl.gz", packed + "more"), "c.stl.gz: its gzip stream is damaged");
}

TEST_F(ReadMesh, RefusesEveryBeginningOfAFile) {
  const TriangleMesh t = tetrahedron();
  expectEveryPrefixRefusedOrWhole("a.stl", stlBinary(t), t);
  expectEveryPrefixRefusedOrWhole("b.stl", stlBinary(t, "solid although binary"), t);
  expectEveryPrefixRefusedOrWhole("c.ply", plyBinary(t, false), t);
  expectEveryPrefixRefusedOrWhole("d.ply", plyBinary(t, true), t);
  expectEveryPrefixRefusedOrWhole("e.glb", glb(gltfJson(t, kOneNode, ""), gltfBuffer(t)), t);
  expectEveryPrefixRefusedOrWhole("f.off", offText(t), t, 1);
  expectEveryPrefixRefusedOrWhole("g.ply", plyText(t), t, 1);
  // The name after 'endsolid' may be missing.
  expectEveryPrefixRefusedOrWhole("h.stl", stlText(t), t, std::strlen(" test\n"));
  write("t.bin", gltfBuffer(t));
  expectEveryPrefixRefusedOrWhole("i.gltf", gltfJson(t, kOneNode, "t.bin"), t);
}

}  // namespace
}  // namespace sherd
