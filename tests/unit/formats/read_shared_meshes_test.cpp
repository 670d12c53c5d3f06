// Reads a folder of real meshes and compares them with its stats.csv, whose figures come from other
// readers. The environment variable SHERD_TEST_DATA names the folder.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/mesh.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace sherd {
namespace {

namespace fs = std::filesystem;

using Row = std::map<std::string, std::string>;  // column name -> value

std::vector<std::string> splitCsvLine(const std::string& line) {
  std::vector<std::string> out(1);
  bool inQuotes = false;
  for (const char c : line) {
    if (c == '"')
      inQuotes = !inQuotes;
    else if (c == ',' && !inQuotes)
      out.emplace_back();
    else
      out.back() += c;
  }
  return out;
}

std::vector<Row> readCsv(const fs::path& file) {
  std::ifstream in(file);
  std::vector<Row> rows;
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = splitCsvLine(line);
  while (std::getline(in, line)) {
    const std::vector<std::string> values = splitCsvLine(line);
    EXPECT_EQ(values.size(), names.size()) << line;
    for (std::size_t i = 0; i < names.size() && i < values.size(); ++i) {
      if (i == 0) rows.emplace_back();
      rows.back()[names[i]] = values[i];
    }
  }
  return rows;
}

class SharedMeshes : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("SHERD_TEST_DATA");
    if (folder == nullptr)
      GTEST_SKIP() << "SHERD_TEST_DATA is not set: it names the folder of shared meshes";
    folder_ = folder;
    ::setenv("SHERD_ASSIMP", SHERD_ASSIMP_PROGRAM, 1);  // reads spider.fbx
    rows_ = readCsv(folder_ / "stats.csv");
    ASSERT_FALSE(rows_.empty()) << "no stats.csv in " << folder_;
  }

  std::string refusal(const std::string& name) const {
    try {
      (void)readMesh(folder_ / name);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::input);
      return e.what();
    }
    ADD_FAILURE() << name << " was read";
    return "";
  }

  fs::path folder_;
  std::vector<Row> rows_;
};

// Files that must be refused, and what the sentence says.
const std::map<std::string, std::string> kRefused{
    {"1147240_trumpet.stl",
     "cut short: the header announces 91440 triangles, the file holds 73070"},
    {"BoxWithInfinites.glb", "finite coordinates are needed"},
    {"stl_empty_bin.stl", "holds no triangle"},
    {"Lantern.bin", "the extension '.bin' is not known"}};

// How far single precision may move a vertex, which some writers of the figures read with.
double vertexError(const TriangleMesh& mesh) {
  const Box box = bounds(mesh);
  return std::max(glm::length(box.min), glm::length(box.max)) *
         std::numeric_limits<float>::epsilon();
}

// What that does to the area: each side of a triangle may turn its length times the error.
double areaError(const TriangleMesh& mesh) {
  double lengths = 0.0;
  for (const glm::uvec3& t : mesh.triangles)
    for (int i = 0; i < 3; ++i)
      lengths += glm::distance(mesh.vertices[t[i]], mesh.vertices[t[(i + 1) % 3]]);
  return lengths * vertexError(mesh);
}

TEST_F(SharedMeshes, HaveTheCountsThatOtherReadersFound) {
  std::size_t read = 0;
  for (const Row& row : rows_) {
    const std::string& name = row.at("file");
    if (kRefused.contains(name)) continue;
    SCOPED_TRACE(name);
    const SourceMesh source = readMesh(folder_ / name);
    const auto count = [&](const char* column) { return std::stoull(row.at(column)); };
    EXPECT_EQ(source.sha256, row.at("sha256"));
    // Assimp gives each corner of an FBX a vertex; the figure was taken after merging them.
    EXPECT_EQ(source.fileVertices, name.ends_with(".fbx") ? 3 * count("nt") : count("nv"));
    EXPECT_EQ(source.mesh.triangles.size() + source.degenerateTriangles, count("nt"));
    ++read;
    EXPECT_EQ(source.mesh.vertices.size(), count("nvm"));
    EXPECT_EQ(source.degenerateTriangles, count("deg_idx"));
    const double expectedArea = std::stod(row.at("area"));
    EXPECT_NEAR(area(source.mesh), expectedArea, areaError(source.mesh));
    if (source.degenerateTriangles == 0) {
      EXPECT_EQ(meshComponents(source.mesh).count, count("comp_v"));
    }
    if (row.at("watertight") == "True") {
      EXPECT_EQ(openEdges(source.mesh), 0u);
      EXPECT_NEAR(volume(source.mesh), std::stod(row.at("svol")),
                  expectedArea * vertexError(source.mesh));
    } else if (count("boundary") > 0 || count("misoriented") > 0) {
      EXPECT_GT(openEdges(source.mesh), 0u);
    } else {
      EXPECT_GE(nonManifoldEdges(source.mesh), count("nonman"));
    }
  }
  EXPECT_EQ(read, rows_.size() - kRefused.size());
}

TEST_F(SharedMeshes, AreRefusedWithASentenceWhereTheyCannotBeUsed) {
  for (const auto& [name, sentence] : kRefused)
    EXPECT_NE(refusal(name).find(sentence), std::string::npos) << refusal(name);
}

TEST_F(SharedMeshes, KeepDetailsFinerThanSinglePrecision) {
  // The folder's notes: a single-precision reader sees 26.
  EXPECT_EQ(nonManifoldEdges(readMesh(folder_ / "Offset1.obj").mesh), 4u);
}

}  // namespace
}  // namespace sherd
