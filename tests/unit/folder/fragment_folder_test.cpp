// Folders of fragments read back and measured.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <sherd/folder.h>

#include <algorithm>
#include <fstream>

#include "base/text/natural_order.h"
#include "shapes.h"
#include "temp_folder.h"

namespace sherd {
namespace {

using ReadNeighbors = TempFolder;
using ReadFragments = TempFolder;

TEST(NaturalOrder, TakesDigitsAsNumbers) {
  std::vector<std::string> names{"piece_10", "piece_2", "piece_1", "piece_02", "piece", "a10b2",
                                 "a9b30",    "a10b1",   "",        "10",       "9"};
  std::sort(names.begin(), names.end(), naturallyBefore);
  EXPECT_EQ(names, (std::vector<std::string>{"", "9", "10", "a9b30", "a10b1", "a10b2", "piece",
                                             "piece_1", "piece_02", "piece_2", "piece_10"}));
}

TEST_F(ReadNeighbors, GivesWhatWasWritten) {
  const TriangleMesh cube = shapes::cube(1.0);
  std::vector<std::uint16_t> neighbor(cube.triangles.size());
  for (std::size_t t = 0; t < neighbor.size(); ++t)
    neighbor[t] = static_cast<std::uint16_t>(5000 * t);
  const auto file = folder_ / "cube.ply";
  writePly(file, shapes::withNeighbor(cube, neighbor));
  EXPECT_EQ(readMesh(file).mesh.neighbor, neighbor);
  writePly(file, cube);
  EXPECT_TRUE(readMesh(file).mesh.neighbor.empty());
}

// Two vertices that single precision makes one: readMesh drops the triangle between them.
TEST_F(ReadNeighbors, FollowsTrianglesThatReadingDrops) {
  TriangleMesh cube = shapes::cube(1.0);
  const glm::uvec3 t = cube.triangles[4];
  cube.vertices.push_back(cube.vertices[t.x] + glm::dvec3(1e-12));
  cube.triangles.insert(cube.triangles.begin() + 4, {t.x, 8u, t.y});
  std::vector<std::uint16_t> neighbor{0, 1, 2, 3, 99, 4, 5, 6, 7, 8, 9, 10, 11};
  const auto file = folder_ / "cube.ply";
  writePly(file, shapes::withNeighbor(cube, neighbor));
  neighbor.erase(neighbor.begin() + 4);
  EXPECT_EQ(readMesh(file).mesh.neighbor, neighbor);
}

TEST_F(ReadNeighbors, PassesOverWhatElseIsThere) {
  const auto file = folder_ / "a.ply";
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment neighbor 3\nelement vertex 3\n"
      "property uchar red\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar float texcoord\nproperty list uchar int vertex_indices\n"
      "property int neighbor\nend_header\n";
  const auto put = [&](auto value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const float v : {0.0f, 1.0f, 2.0f}) {
    put(std::uint8_t{7});
    put(v), put(v * v), put(1.0f);
  }
  put(std::uint8_t{2}), put(0.5f), put(0.25f);
  put(std::uint8_t{3}), put(0), put(1), put(2), put(42);
  std::ofstream(file, std::ios::binary) << bytes;
  EXPECT_EQ(readMesh(file).mesh.neighbor, std::vector<std::uint16_t>{42});
}

// The property of another program, or faces of several kinds: no ids of fragments.
TEST_F(ReadNeighbors, LeavesOutWhatAreNoIds) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
      "property float neighbor\n";
  const std::string vertices = "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  const auto neighborsOf = [&](const std::string& text) {
    std::ofstream(folder_ / "a.ply") << text;
    return readMesh(folder_ / "a.ply").mesh.neighbor;
  };
  EXPECT_EQ(neighborsOf(head + vertices + "3 0 1 2 65535\n3 0 1 3 0\n").size(), 2u);
  // A square is two triangles of one neighbor.
  EXPECT_EQ(neighborsOf(head + vertices + "4 0 1 2 3 8\n3 0 1 3 0\n"),
            (std::vector<std::uint16_t>{8, 8, 0}));
  for (const char* bad : {"65536", "-1", "0.5", "nan"}) {
    EXPECT_TRUE(neighborsOf(head + vertices + "3 0 1 2 7\n3 0 1 3 " + bad + "\n").empty()) << bad;
    EXPECT_TRUE(neighborsOf(head + vertices + "3 0 1 2 " + bad + "\n3 0 1 3 7\n").empty()) << bad;
  }
  EXPECT_TRUE(neighborsOf(head + "element tristrips 1\nproperty list int int vertex_indices\n" +
                          vertices + "3 0 1 2 7\n3 0 1 3 7\n3 1 2 3\n")
                  .empty());
}

TEST_F(ReadFragments, TakesEveryMeshInNaturalOrder) {
  for (const char* name : {"piece_10.ply", "piece_2.PLY", ".piece_3.ply"}) {
    writePly(folder_ / name, shapes::cube(1.0));
  }
  std::ofstream(folder_ / "notes.txt") << "no mesh";
  std::filesystem::create_directory(folder_ / "piece_4.ply");
  const FragmentSet set = readFragments(folder_);
  EXPECT_FALSE(set.manifest);
  ASSERT_EQ(set.fragments.size(), 2u);
  EXPECT_EQ(set.fragments[0].name, "piece_2.PLY");
  EXPECT_EQ(set.fragments[1].name, "piece_10.ply");
  EXPECT_EQ(set.fragments[1].mesh.id, 2);
  EXPECT_EQ(set.fragments[1].mesh.mesh.triangles.size(), 12u);
}

// Two cubes that touch at x = 0.5; those faces name the other one.
std::pair<TriangleMesh, TriangleMesh> twoCubes(std::uint16_t first, std::uint16_t second) {
  const TriangleMesh left = shapes::cube(1.0), right = shapes::cube(1.0, {1, 0, 0});
  const auto named = [](const TriangleMesh& cube, std::uint16_t id) {
    std::vector<std::uint16_t> neighbor;
    for (const glm::uvec3& t : cube.triangles) {
      const bool isShared =
          cube.vertices[t.x].x == 0.5 && cube.vertices[t.y].x == 0.5 && cube.vertices[t.z].x == 0.5;
      neighbor.push_back(isShared ? id : std::uint16_t{0});
    }
    return shapes::withNeighbor(cube, neighbor);
  };
  return {named(left, second), named(right, first)};
}

// The ids of the fragments with their neighbors' ids, 0 for none.
std::vector<std::pair<int, int>> contactsIn(const std::filesystem::path& folder) {
  std::vector<std::pair<int, int>> contacts;
  for (const EvaluatedFragment& fragment : readFragments(folder).fragments) {
    const std::vector<std::uint16_t>& neighbor = fragment.mesh.mesh.neighbor;
    contacts.emplace_back(
        fragment.mesh.id,
        neighbor.empty() ? 0 : *std::max_element(neighbor.begin(), neighbor.end()));
  }
  return contacts;
}

using Contacts = std::vector<std::pair<int, int>>;

TEST_F(ReadFragments, KeepsNeighborsThatAgree) {
  const auto [a, b] = twoCubes(3, 12);
  writePly(folder_ / "a_003.ply", a);
  writePly(folder_ / "a_012.ply", b);
  EXPECT_EQ(contactsIn(folder_), (Contacts{{3, 12}, {12, 3}}));
  std::filesystem::rename(folder_ / "a_003.ply", folder_ / "a_004.ply");  // neighbors are others
  EXPECT_EQ(contactsIn(folder_), (Contacts{{1, 0}, {2, 0}}));
}

TEST_F(ReadFragments, TakesNeighborsForPlacesInTheList) {
  const auto [a, b] = twoCubes(1, 2);
  writePly(folder_ / "left.ply", a);
  writePly(folder_ / "right.ply", b);
  EXPECT_EQ(contactsIn(folder_), (Contacts{{1, 2}, {2, 1}}));
  writePly(folder_ / "left.ply",
           twoCubes(1, 0).first);  // the left one does not know of the right one
  EXPECT_EQ(contactsIn(folder_), (Contacts{{1, 0}, {2, 0}}));
  writePly(folder_ / "left.ply", shapes::cube(1.0));  // without neighbors
  EXPECT_EQ(contactsIn(folder_), (Contacts{{1, 0}, {2, 0}}));
  writePly(folder_ / "left.ply", twoCubes(1, 1).first);  // its own neighbor
  EXPECT_EQ(contactsIn(folder_), (Contacts{{1, 0}, {2, 0}}));
}

TEST_F(ReadFragments, RefusesWhatHoldsNone) {
  EXPECT_THROW((void)readFragments(folder_), Error);
  EXPECT_THROW((void)readFragments(folder_ / "none"), Error);
  std::ofstream(folder_ / "a.obj") << "v 0 0 0\n";
  EXPECT_THROW((void)readFragments(folder_), Error);
  EXPECT_THROW((void)readFragments(folder_ / "a.obj"), Error);
}

EvaluatedFragment meshOf(int id, TriangleMesh mesh) {
  EvaluatedFragment fragment;
  fragment.name = "piece_" + std::to_string(id) + ".obj";
  fragment.mesh = {id, std::move(mesh)};
  return fragment;
}

TEST(Evaluate, MeasuresAnyMeshes) {
  TriangleMesh open = shapes::cube(1.0, {0, 0, 5});
  open.triangles.pop_back();
  FragmentSet set;
  set.fragments = {meshOf(1, shapes::cube(1.0)),
                   meshOf(2, shapes::inverted(shapes::cube(2.0, {5, 0, 0}))), meshOf(3, open),
                   meshOf(4, {{{0, 9, 0}, {1, 9, 0}, {0, 9, 1}}, {{0, 1, 2}, {0, 2, 1}}})};
  const Evaluation found = evaluate(set, nullptr, {.samples = 500});
  const std::vector<FragmentMetrics>& f = found.fragments;
  EXPECT_EQ(found.sound, 1u);
  EXPECT_EQ(found.open, 1u);
  EXPECT_NEAR(f[1].volume, 8.0, 1e-12);  // turned over
  EXPECT_FALSE(f[1].quality->outward());
  EXPECT_TRUE(f[0].convexity && f[1].convexity);
  EXPECT_NEAR(f[1].convexity->value, f[0].convexity->value, 1e-6);
  EXPECT_FALSE(f[2].convexity || f[3].convexity);
  EXPECT_NE(f[2].noConvexity.find("open"), std::string::npos);
  EXPECT_NE(f[3].noConvexity, "");
  EXPECT_NEAR(f[0].share + f[1].share + f[2].share + f[3].share, 1.0, 1e-12);
  EXPECT_EQ(found.contacts, 0u);
  EXPECT_EQ(found.notes.size(), 3u);  // open, inwards, flat
}

// Fragments that are not there have no figures of their mesh.
TEST(Evaluate, ReportsTheManifestWithoutMeshes) {
  FragmentSet set;
  set.manifest = true;
  set.fragments.resize(2);
  for (EvaluatedFragment& f : set.fragments) f.share = 0.5, f.contacts = 1, f.volume = 3.0;
  const Evaluation found = evaluate(set, nullptr);
  EXPECT_EQ(found.contacts, 1u);
  EXPECT_DOUBLE_EQ(found.effectiveFragments, 2.0);
  EXPECT_DOUBLE_EQ(found.volume, 6.0);
  EXPECT_FALSE(found.fragments[0].quality || found.convexity || found.fit.gap);
}

}  // namespace
}  // namespace sherd
