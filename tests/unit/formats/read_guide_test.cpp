// Guides: lines of OBJ and PLY files, and meshes; damaged files are refused.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/fracture.h>

#include "formats/mesh/polylines.h"
#include "unit/formats/mesh_folder.h"

namespace sherd {
namespace {

using Lines = std::vector<std::vector<glm::dvec3>>;

class ReadGuide : public MeshFolder {
 protected:
  Guide guide(const std::string& name, const std::string& bytes) const {
    return readGuide(write(name, bytes));
  }

  std::string guideRefusal(const std::string& name, const std::string& bytes) const {
    try {
      (void)guide(name, bytes);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input);
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      return e.what();
    }
    ADD_FAILURE() << bytes << " was read";
    return "";
  }
};

const glm::dvec3 kA{0, 0, 0}, kB{1, 0, 0}, kC{0, 1, 0}, kD{0, 0, 1};

TEST(Polylines, EndWhereNotTwoEdgesMeet) {
  const std::vector<glm::dvec3> points{kA, kB, kC, kD, kB};  // the last is the second
  const auto joined = [&](std::vector<std::array<std::uint32_t, 2>> edges) {
    return joinedPolylines(points, edges);
  };
  EXPECT_EQ(joined({{2, 1}, {0, 1}}), (Lines{{kA, kB, kC}}));
  EXPECT_EQ(joined({{2, 4}, {0, 1}}), (Lines{{kA, kB, kC}}));              // one position
  EXPECT_EQ(joined({{0, 1}, {1, 2}, {2, 0}}), (Lines{{kA, kB, kC, kA}}));  // a ring
  EXPECT_EQ(joined({{0, 1}, {1, 0}, {1, 4}}), (Lines{{kA, kB}}));          // twice, no length
  EXPECT_EQ(joined({{0, 1}, {1, 2}, {1, 3}}), (Lines{{kA, kB}, {kB, kC}, {kB, kD}}));
  EXPECT_EQ(joined({}), Lines{});
}

TEST_F(ReadGuide, OfObjLines) {
  const Guide read =
      guide("a.obj", "l 1 2\nv 0 0 0\nv 1 0 0\nv 0 1 0 # c\nv 0 0 1\nl -3/1 -2/2\nl 4 3 # d\n");
  EXPECT_EQ(read.polylines, (Lines{{kA, kB, kC, kD}}));
  EXPECT_TRUE(read.mesh.triangles.empty());
  EXPECT_EQ(std::filesystem::path(read.file).filename(), "a.obj");
}

TEST_F(ReadGuide, OfObjLinesAndFaces) {
  const Guide read = guide("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nl 1 4\nf 1 2 3\n");
  EXPECT_EQ(read.polylines, (Lines{{kA, kD}}));
  EXPECT_EQ(read.mesh.triangles.size(), 1u);
}

std::string plyLines(const char* format, bool bigEndian) {
  std::string text = std::string("ply\nformat ") + format +
                     " 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty "
                     "double z\nelement edge 2\nproperty int vertex1\nproperty int "
                     "vertex2\nproperty uchar red\nend_header\n";
  if (std::string(format) == "ascii") return text + "0 0 0\n1 0 0\n0 1 0\n0 1 9\n2 1 9\n";
  for (const glm::dvec3& v : {kA, kB, kC}) {
    for (int axis = 0; axis < 3; ++axis) put(text, v[axis], bigEndian);
  }
  for (const auto& [a, b] : {std::pair(0, 1), std::pair(2, 1)}) {
    put(text, a, bigEndian), put(text, b, bigEndian), put(text, std::uint8_t{9});
  }
  return text;
}

TEST_F(ReadGuide, OfPlyEdges) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const bool bigEndian = std::string(format) == "binary_big_endian";
    EXPECT_EQ(guide("a.ply", plyLines(format, bigEndian)).polylines, (Lines{{kA, kB, kC}}));
  }
}

TEST_F(ReadGuide, OfEveryMeshFormat) {
  const Guide read = guide("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 2 3\n");
  EXPECT_EQ(read.mesh.triangles.size(), 2u);
  EXPECT_TRUE(read.polylines.empty());
}

TEST_F(ReadGuide, DamagedFilesAreRefused) {
  EXPECT_EQ(guideRefusal("a.obj", "v 0 0 0\n"), "a.obj: holds neither lines nor faces");
  EXPECT_EQ(guideRefusal("a.obj", "v 0 0 0\nv 1 0 0\nl 1 3\n"),
            "a.obj:3: line uses vertex 3, the file has 2");
  EXPECT_EQ(guideRefusal("a.obj", "v 0 0 0\nv 1 0 0\nl 1 -3\n"),
            "a.obj:3: line has '-3', not a vertex number");
  EXPECT_EQ(guideRefusal("a.obj", "v 0 0 0\nv 1 0 0\nl 1 0\n"),
            "a.obj:3: line has '0', not a vertex number");
  EXPECT_EQ(guideRefusal("a.obj", "v 0 0 0\nv 1 0 0\nl 1\n"),
            "a.obj:3: line has less than 2 vertices");
  EXPECT_EQ(guideRefusal("a.obj", "v 0 0\n"), "a.obj:1: vertex has less than 3 coordinates");
  EXPECT_EQ(guideRefusal("a.obj", "v 0 nan 0\nv 1 0 0\nl 1 2\n"),
            "a.obj: vertex 1 of a line is not finite, or above 1e37");
  EXPECT_EQ(guideRefusal("a.obj", "v 0 1e300 0\nv 1 0 0\nl 1 2\n"),
            "a.obj: vertex 1 of a line is not finite, or above 1e37");
  EXPECT_EQ(guideRefusal("a.obj", "v 0 0 0\nv 0 0 0\nl 1 2\n"),
            "a.obj: holds neither lines nor faces");
  const std::string ply = plyLines("ascii", false);
  EXPECT_EQ(guideRefusal("a.ply", replaced(ply, "0 1 9", "0 7 9")),
            "a.ply: an edge uses vertex 7, the file has 3");
  EXPECT_EQ(guideRefusal("a.ply", replaced(ply, "vertex2", "vertex3")),
            "a.ply: its element 'edge' has no vertex2");
  EXPECT_NE(guideRefusal("a.ply", replaced(ply, "0 1 9", "0 -1 9")), "");
  const std::string binary = plyLines("binary_little_endian", false);
  for (std::size_t length = 0; length < binary.size(); ++length) {
    EXPECT_NE(guideRefusal("a.ply", binary.substr(0, length)), "");
  }
}

// A line of a million vertices takes more than a megabyte.
TEST_F(ReadGuide, TakesNoMoreMemoryThanAllowed) {
  std::string text = "v 0 0 0\nv 1 0 0\nl";
  for (int i = 0; i < 500000; ++i) text += " 1 2";
  const auto file = write("a.obj", text);
  EXPECT_THROW((void)readGuide(file, {.maxMemory = text.size() + 1000000}), Error);
  EXPECT_EQ(readGuide(file).polylines.size(), 1u);
}

}  // namespace
}  // namespace sherd
