// Normals that files give: read as they are, of unit length, and complete.
#include <gtest/gtest.h>
#include <sherd/files.h>
#include <sherd/mesh.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "shapes.h"
#include "unit/formats/mesh_folder.h"

namespace sherd {
namespace {

class ReadNormals : public MeshFolder {};

const std::string kVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

// A mesh with its vertices' normals as text.
std::string plyWith(const TriangleMesh& mesh, const std::vector<glm::vec3>& normals,
                    const std::string& ofFaces = "", const std::string& faceValue = "") {
  std::ostringstream out;
  out.precision(9);
  out << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\n"
         "property float ny\nproperty float nz\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\n"
      << ofFaces << "end_header\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const glm::dvec3& v = mesh.vertices[i];
    const glm::vec3& n = normals[i];
    out << v.x << ' ' << v.y << ' ' << v.z << ' ' << n.x << ' ' << n.y << ' ' << n.z << '\n';
  }
  for (const glm::uvec3& t : mesh.triangles) {
    out << "3 " << t.x << ' ' << t.y << ' ' << t.z << faceValue << '\n';
  }
  return out.str();
}

// Unit vectors in single precision that have nothing to do with the surface.
std::vector<glm::vec3> anyNormals(const TriangleMesh& mesh) {
  std::vector<glm::vec3> out;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const double a = 0.7 * static_cast<double>(i), b = 0.3 + static_cast<double>(i);
    out.emplace_back(glm::dvec3(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)));
  }
  return out;
}

// Each corner has its vertex' normal, to the bit.
void expectNormalsOfVertices(const TriangleMesh& mesh, const std::vector<glm::vec3>& normals) {
  ASSERT_EQ(mesh.attributes.normals.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(mesh.attributes.normals[t][k], normals[mesh.triangles[t][static_cast<int>(k)]]);
    }
  }
}

TEST_F(ReadNormals, ObjHasThemAtCorners) {
  const SourceMesh source =
      read("a.obj", kVertices +
                        "vn 0 0 -1\nvn 0.6 0 0.8\nvn 0 3 4\nf 1//1 3//2 2//3\n"
                        "vn 1 0 0\nf 1//-1 2//-2 4//-4\nf 1 4 3\nf 2//4 3//4 4//4\n");
  const auto& normals = source.mesh.attributes.normals;
  ASSERT_EQ(normals.size(), 4u);
  const glm::vec3 a(0, 0, -1), b(0.6f, 0, 0.8f), c(0, 0.6f, 0.8f), d(1, 0, 0);
  EXPECT_EQ(normals[0], (std::array<glm::vec3, 3>{a, b, c}));
  EXPECT_EQ(normals[1], (std::array<glm::vec3, 3>{d, c, a}));
  EXPECT_EQ(normals[2], (std::array<glm::vec3, 3>{-d, -d, -d}));  // the face's own
  EXPECT_TRUE(source.mesh.attributes.texcoords.empty());
  EXPECT_TRUE(source.mesh.attributes.hasOnlyNormals());
  EXPECT_FALSE(source.mesh.attributes.empty());
}

TEST_F(ReadNormals, FilesWithoutAnyHaveNone) {
  EXPECT_TRUE(read("a.obj", kVertices + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
                  .mesh.attributes.normals.empty());
  EXPECT_TRUE(read("b.obj", kVertices + "vn 0 0 0\nvn nan 1 0\nf 1//1 3//2 2//1\nf 1 2 4\n"
                                        "f 1 4 3\nf 2 3 4\n")
                  .mesh.attributes.normals.empty());
}

TEST_F(ReadNormals, ThoseWithoutADirectionAreTheFaces) {
  const SourceMesh source =
      read("a.obj", kVertices +
                        "vn 0 0 0\nvn inf 0 0\nvn 1e-30 0 0\nvn 1e30 0 0\nf 1//1 3//2 2//3\n"
                        "f 1//4 2//4 4//4\nf 1 4 3\nf 2 3 4\n");
  const auto& normals = source.mesh.attributes.normals;
  EXPECT_EQ(normals[0][0], glm::vec3(0, 0, -1));
  EXPECT_EQ(normals[0][1], glm::vec3(0, 0, -1));
  EXPECT_EQ(normals[0][2], glm::vec3(1, 0, 0));
  EXPECT_EQ(normals[1][0], glm::vec3(1, 0, 0));
  EXPECT_LT(glm::distance(normals[3][0], glm::vec3(std::sqrt(1.0f / 3.0f))), 1e-6f);
}

TEST_F(ReadNormals, ObjRefusesThoseThatDoNotExist) {
  const std::string faces = "f 1 2 4\nf 1 4 3\nf 2 3 4\n";
  EXPECT_EQ(refusal("a.obj", kVertices + "vn 0 0 1\nf 1//1 3//2 2//1\n" + faces),
            "a.obj: face uses normal 2, the file has 1");
  EXPECT_EQ(refusal("b.obj", kVertices + "vn 0 0 1\nf 1//1 3//-2 2//1\n" + faces),
            "b.obj:6: face has the corner '3//-2', whose normal does not exist");
  EXPECT_EQ(refusal("c.obj", kVertices + "vt 0 0\nf 1/1/x 3/1 2/1\n" + faces),
            "c.obj:6: face has the corner '1/1/x', whose normal does not exist");
}

TEST_F(ReadNormals, PlyHasThemAtVertices) {
  const TriangleMesh mesh = shapes::ball(1.0, 4);  // many: to normalize again changes some
  expectNormalsOfVertices(read("a.ply", plyWith(mesh, anyNormals(mesh))).mesh, anyNormals(mesh));
  // Sherd's own, means over faces of cracks too, are left out.
  const std::string own = plyWith(mesh, anyNormals(mesh), "property int neighbor\n", " 0");
  EXPECT_TRUE(read("b.ply", own).mesh.attributes.normals.empty());
}

TEST_F(ReadNormals, OffHasThemAtVertices) {
  const TriangleMesh mesh = tetrahedron();
  const std::vector<glm::vec3> normals = anyNormals(mesh);
  std::ostringstream out;
  out.precision(9);
  out << "NOFF\n4 4 0\n";
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec3& v = mesh.vertices[i];
    out << v.x << ' ' << v.y << ' ' << v.z << ' ' << normals[i].x << ' ' << normals[i].y << ' '
        << normals[i].z << '\n';
  }
  for (const glm::uvec3& t : mesh.triangles) out << "3 " << t.x << ' ' << t.y << ' ' << t.z << '\n';
  expectNormalsOfVertices(read("a.off", out.str()).mesh, normals);
  EXPECT_NE(refusal("b.off", "NOFF\n4 4 0\n0 0 0 1 0 x\n").find("vertex has no normal"),
            std::string::npos);
}

// A ball's glTF with its exact normals, under a node with a matrix, column by column.
std::string ballGltf(const TriangleMesh& ball, const glm::dmat3& m) {
  std::string buffer;
  for (int attribute = 0; attribute < 2; ++attribute) {  // of the unit ball they are equal
    for (const glm::dvec3& v : ball.vertices) {
      for (int k = 0; k < 3; ++k) put(buffer, static_cast<float>(v[k]));
    }
  }
  const std::size_t vertices = buffer.size() / 2;
  for (const glm::uvec3& t : ball.triangles) {
    for (int k = 0; k < 3; ++k) put(buffer, t[k]);
  }
  const std::size_t n = ball.vertices.size(), indices = buffer.size() - 2 * vertices;
  nlohmann::json json = {
      {"asset", {{"version", "2.0"}}},
      {"nodes",
       {{{"mesh", 0},
         {"matrix",
          {m[0].x, m[0].y, m[0].z, 0.0, m[1].x, m[1].y, m[1].z, 0.0, m[2].x, m[2].y, m[2].z, 0.0,
           5.0, 6.0, 7.0, 1.0}}}}},
      {"meshes",
       {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}}}}}}},
      {"bufferViews",
       {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", vertices}},
        {{"buffer", 0}, {"byteOffset", vertices}, {"byteLength", vertices}},
        {{"buffer", 0}, {"byteOffset", 2 * vertices}, {"byteLength", indices}}}},
      {"accessors",
       {{{"bufferView", 0}, {"componentType", 5126}, {"count", n}, {"type", "VEC3"}},
        {{"bufferView", 1}, {"componentType", 5126}, {"count", n}, {"type", "VEC3"}},
        {{"bufferView", 2},
         {"componentType", 5125},
         {"count", 3 * ball.triangles.size()},
         {"type", "SCALAR"}}}},
      {"buffers", {{{"byteLength", buffer.size()}, {"uri", "ball.bin"}}}}};
  return json.dump() + '\0' + buffer;
}

// The surface |M^-1 (p - c)| = 1 has the gradient M^-T M^-1 (p - c).
TEST_F(ReadNormals, GltfNodesTransformThem) {
  const TriangleMesh ball = shapes::ball(1.0, 3);
  const glm::dmat3 shear(1.0, 0.2, 0.0, -0.4, 2.0, 0.3, 0.1, 0.0, 0.5);
  const glm::dmat3 mirror(-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
  for (const glm::dmat3& m : {shear, shear * mirror, shear * 1e-6}) {
    const std::string both = ballGltf(ball, m);
    write("ball.bin", both.substr(both.find('\0') + 1));
    const TriangleMesh mesh = read("a.gltf", both.substr(0, both.find('\0'))).mesh;
    ASSERT_EQ(mesh.attributes.normals.size(), ball.triangles.size());
    const glm::dmat3 back = glm::inverse(m);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 p =
            mesh.vertices[mesh.triangles[t][static_cast<int>(k)]] - glm::dvec3(5.0, 6.0, 7.0);
        const glm::dvec3 expected = glm::normalize(glm::transpose(back) * (back * p));
        EXPECT_LT(glm::distance(glm::dvec3(mesh.attributes.normals[t][k]), expected), 1e-6);
      }
    }
  }
}

TEST_F(ReadNormals, GltfRefusesAnotherNumberOfThem) {
  const TriangleMesh ball = shapes::ball(1.0, 1);
  const std::string both = ballGltf(ball, glm::dmat3(1.0));
  write("ball.bin", both.substr(both.find('\0') + 1));
  nlohmann::json json = nlohmann::json::parse(both.substr(0, both.find('\0')));
  json["accessors"][1]["count"] = ball.vertices.size() - 1;
  EXPECT_NE(refusal("a.gltf", json.dump()).find("'NORMAL' is not of 3 numbers"), std::string::npos);
}

TEST_F(ReadNormals, StayWithTheirTriangles) {
  const SourceMesh source =
      read("a.obj", kVertices +
                        "v nan 0 0\nvn 1 0 0\nvn 0 1 0\nvn 0 0 1\no a\nf 1//1 2//1 5//1\n"
                        "f 1//2 3//2 2//2\nf 1//1 1//1 2//1\no b\nf 1//3 2//3 4//3\n"
                        "f 1//3 4//3 3//3\no a\nf 2//2 3//2 4//2\n");
  ASSERT_EQ(source.mesh.attributes.normals.size(), 4u);
  EXPECT_EQ(source.mesh.attributes.normals[0][0], glm::vec3(0, 1, 0));
  EXPECT_EQ(source.mesh.attributes.normals[2][1], glm::vec3(0, 0, 1));
  const std::vector<SourceMesh> objects = splitObjects(source);
  ASSERT_EQ(objects.size(), 2u);
  for (const auto& corners : objects[0].mesh.attributes.normals)
    EXPECT_EQ(corners[1], glm::vec3(0, 1, 0));
  for (const auto& corners : objects[1].mesh.attributes.normals)
    EXPECT_EQ(corners[1], glm::vec3(0, 0, 1));
}

}  // namespace
}  // namespace sherd
