// What text formats and their binary kin are found with in libraries: every variant is read, to the
// last bit of its numbers.
#include <gtest/gtest.h>
#include <sherd/files.h>
#include <sherd/mesh.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "shapes.h"
#include "unit/formats/mesh_folder.h"

namespace sherd {
namespace {

class ReadText : public MeshFolder {};

const std::string kTetrahedronObj =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string kTetrahedronOff =
    "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const std::string kTetrahedronStl =
    "solid a b\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\n"
    "endloop\nendfacet\nfacet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\n"
    "endloop\nendfacet\nendsolid a b\nsolid c\nfacet normal -1 0 0\nouter loop\nvertex 0 0 0\n"
    "vertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\nfacet normal 1 1 1\nouter loop\nvertex 1 0 0\n"
    "vertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid c\n";
const std::string kTetrahedronPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
    "property double z\nelement face 4\nproperty list uchar int vertex_index\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

std::string withLineEnds(const std::string& text, const std::string& end) {
  std::string out;
  for (const char c : text) out += c == '\n' ? end : std::string(1, c);
  return out;
}

TEST_F(ReadText, TakesEveryLineEndAndAByteOrderMark) {
  for (const auto& [name, text] :
       std::vector<std::pair<std::string, std::string>>{{"a.obj", kTetrahedronObj},
                                                        {"b.off", kTetrahedronOff},
                                                        {"c.stl", kTetrahedronStl},
                                                        {"d.ply", kTetrahedronPly}}) {
    for (const char* end : {"\n", "\r\n", "\r", "\n\n"}) {
      for (const char* mark : {"", "\xef\xbb\xbf"}) {
        SCOPED_TRACE(name + " " + std::to_string(static_cast<int>(end[0])));
        expectSameSurface(read(name, mark + withLineEnds(text, end)).mesh, tetrahedron());
      }
    }
  }
}

// One bit apart in double precision, far below a float's.
TEST_F(ReadText, KeepsDoublePrecision) {
  const std::string x = "4000000.0000000005", y = "4000000.0000000009", z = "-0.1";
  const std::vector<double> expected{4000000.0000000005, 4000000.0000000009, -0.1};
  ASSERT_NE(expected[0], expected[1]);
  const std::string far = x + " " + y + " " + z;
  std::string binary = replaced(kTetrahedronPly, "format ascii", "format binary_big_endian");
  binary.resize(binary.find("end_header\n") + 11);
  for (const glm::dvec3& v : {glm::dvec3(expected[0], expected[1], expected[2]),
                              glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}) {
    for (int i = 0; i < 3; ++i) put(binary, v[i], true);
  }
  for (const glm::uvec3& t : tetrahedron().triangles) {
    put(binary, std::uint8_t{3});
    for (int i = 0; i < 3; ++i) put(binary, t[i], true);
  }
  for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{
           {"a.obj", replaced(kTetrahedronObj, "v 0 0 0", "v " + far)},
           {"b.off", replaced(kTetrahedronOff, "\n0 0 0\n", "\n" + far + "\n")},
           {"c.stl", replaced(kTetrahedronStl, "vertex 0 0 0", "vertex " + far)},
           {"d.ply", replaced(kTetrahedronPly, "\n0 0 0\n", "\n" + far + "\n")},
           {"e.ply", binary}}) {
    const TriangleMesh mesh = read(name, bytes).mesh;
    EXPECT_EQ(mesh.vertices[0], glm::dvec3(expected[0], expected[1], expected[2])) << name;
  }
}

// ---- OBJ

TEST_F(ReadText, ObjTakesCommentsBehindDataAndContinuedLines) {
  const std::string text =
      "v 0 0 0 # the origin\nv 1 \\\n 0 0\nv 0 1 0# y\nv +0.0 -0 1e0\nf 1 3 2 # bottom\n"
      "f 1 2 \\\r\n4\nf 1 4 3#last\nf -3 -2 -1";
  expectSameSurface(read("a.obj", text).mesh, tetrahedron());
}

TEST_F(ReadText, ObjHasObjectsOrElseGroups) {
  const std::string vertices = kTetrahedronObj.substr(0, kTetrahedronObj.find('f'));
  const SourceMesh objects = read(
      "a.obj",
      vertices + "f 1 3 2\no lid\ng left\nf 1 2 4\no empty\no body\nf 1 4 3\no lid\nf 2 3 4\n");
  EXPECT_EQ(objects.objects, (std::vector<std::string>{"lid", "body", ""}));
  EXPECT_EQ(objects.objectOfTriangle, (std::vector<std::uint32_t>{2, 0, 1, 0}));
  const SourceMesh groups =
      read("b.obj", vertices + "g a b\nf 1 3 2\nf 1 2 4\ng c\nf 1 4 3\nf 2 3 4\n");
  EXPECT_EQ(groups.objects, (std::vector<std::string>{"a b", "c"}));
  EXPECT_EQ(groups.objectOfTriangle, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  const SourceMesh one = read("c.obj", "o all\n" + kTetrahedronObj);
  EXPECT_TRUE(one.objects.empty());
  EXPECT_TRUE(one.objectOfTriangle.empty());
}

TEST_F(ReadText, ObjectsSplitIntoMeshesOfTheirOwn) {
  const std::string vertices = kTetrahedronObj.substr(0, kTetrahedronObj.find('f'));
  const SourceMesh source =
      read("a.obj", vertices + "vt 0 0\nvt 1 0\nvt 0 1\no lid\nf 1/1 3/2 2/3\nf 1/1 2/2 4/3\n" +
                        "o body\nf 1/1 4/3 3/2\no lid\nf 2/3 3/1 4/2\n");
  const std::vector<SourceMesh> components = splitObjects(source);
  ASSERT_EQ(components.size(), 2u);
  EXPECT_EQ(components[0].objects, (std::vector<std::string>{"lid"}));
  EXPECT_EQ(components[1].objects, (std::vector<std::string>{"body"}));
  EXPECT_EQ(components[0].mesh.triangles.size(), 3u);
  EXPECT_EQ(components[0].mesh.vertices.size(), 4u);
  ASSERT_EQ(components[1].mesh.triangles.size(), 1u);
  EXPECT_EQ(components[1].mesh.vertices.size(), 3u);
  // Corner by corner the part is what the whole has there, looks too.
  for (int corner = 0; corner < 3; ++corner) {
    const auto c = static_cast<std::size_t>(corner);
    EXPECT_EQ(components[1].mesh.vertices[components[1].mesh.triangles[0][corner]],
              source.mesh.vertices[source.mesh.triangles[2][corner]]);
    EXPECT_EQ(components[1].mesh.attributes.texcoords[0][c],
              source.mesh.attributes.texcoords[2][c]);
  }
  EXPECT_EQ(splitObjects(read("b.obj", kTetrahedronObj)).size(), 1u);
}

// What is dropped takes its entries along.
TEST_F(ReadText, ObjectsFollowTheTrianglesThatAreLeft) {
  const SourceMesh source =
      read("a.obj",
           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv nan 0 0\no gone\nf 1 1 2\n"
           "f 1 2 5\no a\nf 1 3 2\nf 1 2 2\nf 1 2 4\no b\nf 1 4 3\nf 2 3 4\n");
  EXPECT_EQ(source.objects, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(source.objectOfTriangle, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  EXPECT_EQ(source.degenerateTriangles, 2u);
  EXPECT_EQ(source.droppedTriangles, 1u);
}

TEST_F(ReadText, ObjFacesMayComeBeforeTheirVertices) {
  const std::size_t faces = kTetrahedronObj.find('f');
  expectSameSurface(
      read("a.obj", kTetrahedronObj.substr(faces) + kTetrahedronObj.substr(0, faces)).mesh,
      tetrahedron());
}

// ---- STL

TEST_F(ReadText, StlSolidsAreObjects) {
  const SourceMesh source = read("a.stl", kTetrahedronStl);
  EXPECT_EQ(source.objects, (std::vector<std::string>{"a b", "c"}));
  EXPECT_EQ(source.objectOfTriangle, (std::vector<std::uint32_t>{0, 0, 1, 1}));
}

TEST_F(ReadText, StlTakesCapitalsBlanksAndAnyNormal) {
  std::string text = kTetrahedronStl;
  for (char& c : text) c = static_cast<char>(std::toupper(c));
  text = replaced(text, "FACET NORMAL 0 0 -1", "\t  FACET NORMAL -NAN(IND) -1.#QNAN 0");
  text = replaced(text, "VERTEX 0 1 0", "  VERTEX +0.0E+000\t1.000000E+00 -0e-5 ");
  expectSameSurface(read("a.stl", "\n " + text).mesh, tetrahedron());
}

TEST_F(ReadText, StlWithACountLeftOpenIsReadWithAWarning) {
  std::string bytes(80, 'x');
  put(bytes, std::uint32_t{0});
  for (const glm::uvec3& t : tetrahedron().triangles) {
    bytes += std::string(12, '\0');
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) put(bytes, static_cast<float>(tetrahedron().vertices[t[i]][k]));
    bytes += std::string(2, '\0');
  }
  for (const char byte : {'\0', '\xff'}) {
    for (std::size_t i = 80; i < 84; ++i) bytes[i] = byte;
    const SourceMesh source = read("a.stl", bytes);
    expectSameSurface(source.mesh, tetrahedron());
    ASSERT_EQ(source.warnings.size(), 1u);
    EXPECT_NE(source.warnings[0].find("the file holds 4, which are read"), std::string::npos);
    EXPECT_NE(refusal("b.stl", bytes.substr(0, bytes.size() - 1)), "");
  }
}

// ---- OFF

TEST_F(ReadText, OffTakesEveryHeader) {
  const std::string counts = "4 4 6\n";
  const std::string faces = kTetrahedronOff.substr(kTetrahedronOff.find("3 0 2 1"));
  const auto vertices = [](const std::string& behind) {
    std::string out;
    for (const char* v : {"0 0 0", "1 0 0", "0 1 0", "0 0 1"}) out += v + (" " + behind) + "\n";
    return out;
  };
  for (const auto& [keyword, behind] :
       std::vector<std::pair<std::string, std::string>>{{"OFF", ""},
                                                        {"NOFF", "0 0 1"},
                                                        {"COFF", "1 0.5 0 1"},
                                                        {"CNOFF", "0 0 1 255 128 0"},
                                                        {"STOFF", "0.25 0.75"},
                                                        {"STCNOFF", "0 0 1 1 0.5 0 1 0.25 0.75"}}) {
    SCOPED_TRACE(keyword);
    for (const std::string& header :
         {keyword + "\n" + counts, keyword + " " + counts, "# c\n" + keyword + "\n\n4 4\n"}) {
      const SourceMesh source = read("a.off", header + vertices(behind) + faces);
      expectSameSurface(source.mesh, tetrahedron());
      const SurfaceAttributes& look = source.mesh.attributes;
      ASSERT_EQ(look.colors.size(), keyword.find('C') != std::string::npos ? 4u : 0u);
      if (!look.colors.empty()) {
        EXPECT_EQ(look.colors[1][2], glm::u8vec3(255, 128, 0));
      }
      ASSERT_EQ(look.texcoords.size(), keyword.find('T') != std::string::npos ? 4u : 0u);
      if (!look.texcoords.empty()) {
        EXPECT_EQ(look.texcoords[1][2], glm::vec2(0.25f, 0.75f));
      }
    }
  }
  EXPECT_EQ(refusal("b.off", "OFF BINARY\n" + std::string(40, '\0')),
            "b.off: is a binary OFF, which is not supported; save it as text");
}

TEST_F(ReadText, OffFacesHaveColorsAndAnyNumberOfCorners) {
  const SourceMesh source = read("a.off",
                                 "OFF\n5 3\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n1 0.5 0\n"
                                 "5 0 4 1 2 3 255 0 0\n3 0 1 4 0 0 255 255\n2 0 1\n");
  ASSERT_EQ(source.mesh.triangles.size(), 4u);
  EXPECT_DOUBLE_EQ(area(source.mesh), 4.0);
  for (std::size_t t = 0; t < 4; ++t) {
    EXPECT_EQ(source.mesh.attributes.colors[t][0],
              t < 3 ? glm::u8vec3(255, 0, 0) : glm::u8vec3(0, 0, 255));
  }
  EXPECT_TRUE(read("b.off", kTetrahedronOff).mesh.attributes.empty());
}

// ---- PLY

TEST_F(ReadText, PlyTakesTriangleStrips) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  // 0 2 1, then 2 3 1 (turned), then 1 3 0; a new strip of the last triangle.
  const SourceMesh source = read("a.ply", text + "9 0 2 1 3 0 -1 0 3 2\n");
  expectSameSurface(source.mesh,
                    {tetrahedron().vertices, {{0, 2, 1}, {2, 3, 1}, {1, 3, 0}, {0, 3, 2}}});
  EXPECT_NE(refusal("b.ply", text + "3 0 2 4\n").find("uses vertex 4, the file has 4"),
            std::string::npos);
  EXPECT_NE(refusal("c.ply", text + "3 0 2 -2\n").find("uses vertex -2"), std::string::npos);
  EXPECT_EQ(refusal("d.ply", text + "5 0 2 -1 3 1\n"), "d.ply: holds no triangle");
}

TEST_F(ReadText, PlyPassesOverWhatItDoesNotKnow) {
  const std::string text = replaced(
      replaced(kTetrahedronPly, "element face",
               "property list uchar short flags\nelement material 2\nproperty int a\n"
               "property list uint double b\nelement face"),
      "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", "0 0 0 0\n1 0 0 2 5 6\n0 1 0 0\n0 0 1 1 -7\n3 1 0.5\n4 0\n");
  expectSameSurface(read("a.ply", text).mesh, tetrahedron());
}

TEST_F(ReadText, PlyOfPointsIsRefusedWithTheirNumber) {
  const std::string points =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n0 0 0\n1 0 0\n";
  EXPECT_EQ(refusal("a.ply", points), "a.ply: holds 2 points and no faces; a mesh is needed");
  EXPECT_EQ(refusal("b.ply", replaced(points, "end_header",
                                      "element face 0\nproperty list uchar int "
                                      "vertex_indices\nend_header")),
            "b.ply: holds 2 points and no faces; a mesh is needed");
}

TEST_F(ReadText, PlyFacesOfLessThanThreeCornersAreLeftOut) {
  const std::string text =
      replaced(replaced(kTetrahedronPly, "face 4", "face 6"), "3 0 2 1\n", "2 0 1\n3 0 2 1\n1 3\n");
  expectSameSurface(read("a.ply", text).mesh, tetrahedron());
}

// ---- Any

TEST_F(ReadText, EveryBeginningIsReadOrRefused) {
  for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
           {"a.obj", "mtllib a.mtl\no a\nvt 0 0\nusemtl b\n" + kTetrahedronObj},
           {"b.off", kTetrahedronOff},
           {"c.stl", kTetrahedronStl},
           {"d.ply", kTetrahedronPly}}) {
    for (std::size_t length = 0; length < text.size(); ++length) {
      const std::filesystem::path file = write(name, text.substr(0, length));
      try {
        EXPECT_GT(readMesh(file).mesh.triangles.size(), 0u);
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
      }
    }
  }
}

}  // namespace
}  // namespace sherd
