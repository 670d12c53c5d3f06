// Files of Houdini's geometry with many pieces, and what interrupts them.
#include "formats/geo/geo.h"

#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/files.h>

#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "folder/files/split_levels.h"

namespace sherd {
namespace {

using Json = nlohmann::json;

constexpr int kMostIds = 65534;  // of the fragments of a fracture

// Keeps the last file, and the size of its largest chunk.
class Kept : public FileSink {
 public:
  void take(const std::string&, const Content& content) override {
    text_.clear();
    content([this](std::string_view bytes) {
      text_ += bytes;
      largest_ = std::max(largest_, bytes.size());
    });
  }

  // The member of a list of keys and values.
  static Json at(const Json& list, const std::string& key) {
    for (std::size_t i = 0; i + 1 < list.size(); i += 2) {
      if (list[i] == key) return list[i + 1];
    }
    return {};
  }

  Json json() const { return Json::parse(text_); }
  std::size_t largest() const { return largest_; }

 private:
  std::string text_;
  std::size_t largest_ = 0;
};

// A chain, each fragment in contact with the next one.
std::vector<Fragment> chain(int count) {
  std::vector<Fragment> fragments(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Fragment& own = fragments[static_cast<std::size_t>(i)];
    own.id = i + 1;
    own.mass.volume = 1.0;
    own.mass.centroid = {0.1 * i, 0.0, 0.0};
    if (i > 0)
      own.contacts.push_back({.fragment = i, .area = 0.5 * i, .normal = {}, .centroid = {}});
    if (i + 1 < count)
      own.contacts.push_back(
          {.fragment = i + 2, .area = 0.5 * (i + 1), .normal = {}, .centroid = {}});
    own.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    own.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    own.mesh.neighbor = {0, 1, 0, 1};
  }
  return fragments;
}

std::vector<GeoPiece> piecesOf(const std::vector<Fragment>& fragments, const std::string& name,
                               const MaterialTable& table) {
  static const SurfaceAttributes kNone;
  std::vector<GeoPiece> pieces;
  for (const Fragment& own : fragments) {
    pieces.push_back({.id = own.id, .piece = {name, own.mesh, kNone, table}});
  }
  return pieces;
}

TEST(Geo, HasAsManyPiecesAsAFracture) {
  const std::vector<Fragment> fragments = chain(kMostIds);
  const MaterialTable table = materialTable({});
  Kept kept;
  writeGeo(OutputFile(kept, "pieces.geo"), piecesOf(fragments, "a", table));
  const Json file = kept.json();
  EXPECT_EQ(Kept::at(file, "pointcount"), 4 * kMostIds);
  EXPECT_EQ(Kept::at(file, "primitivecount"), 4 * kMostIds);
  const Json name = Kept::at(Kept::at(file, "attributes"), "primitiveattributes")[0][1];
  EXPECT_EQ(Kept::at(name, "strings").back(), "piece65534");
  const Json corners = Kept::at(Kept::at(Kept::at(file, "topology"), "pointref"), "indices");
  EXPECT_EQ(corners.back(), 4 * kMostIds - 4);  // {2, 0, 3} is written as 2, 3, 0
  EXPECT_LT(kept.largest(), (1u << 16) + 1000) << "a chunk";

  writeConstraints(OutputFile(kept, "graph.geo"), fragments, 3.0);
  const Json graph = kept.json();
  EXPECT_EQ(Kept::at(graph, "pointcount"), kMostIds);
  EXPECT_EQ(Kept::at(graph, "primitivecount"), kMostIds - 1);
  const Json strength = Kept::at(Kept::at(graph, "attributes"), "primitiveattributes")[4];
  EXPECT_EQ(Kept::at(strength[0], "name"), "strength");
  const Json values = Kept::at(Kept::at(strength[1], "values"), "arrays")[0];
  for (const int i : {0, 1, kMostIds - 2}) {
    EXPECT_EQ(values[static_cast<std::size_t>(i)].get<float>(), static_cast<float>(1.5 * (i + 1)));
  }
  EXPECT_LT(kept.largest(), (1u << 16) + 1000);
}

TEST(Geo, IsWrittenOfNothing) {
  Kept kept;
  writeGeo(OutputFile(kept, "pieces.geo"), {});
  EXPECT_EQ(Kept::at(kept.json(), "primitives"), Json::array());
  writeConstraints(OutputFile(kept, "graph.geo"), {});
  EXPECT_EQ(Kept::at(kept.json(), "primitives"), Json::array());
}

TEST(Geo, IsCancelledBetweenBlocks) {
  const std::vector<Fragment> fragments = chain(20000);
  const MaterialTable table = materialTable({});
  std::atomic<int> questions{0};
  const Progress progress{.report = {}, .cancelled = [&] { return ++questions > 5; }};
  Kept kept;
  for (const bool isGraph : {false, true}) {
    questions = 0;
    try {
      if (isGraph) {
        writeConstraints(OutputFile(kept, "g"), fragments, 1.0, {}, &progress);
      } else {
        writeGeo(OutputFile(kept, "p"), piecesOf(fragments, "a", table), &progress);
      }
      FAIL() << "was not cancelled";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
    EXPECT_EQ(questions, 6);
  }
}

TEST(Geo, LevelsFollowSplits) {
  // 1 is split into 1 and 2, 2 into 2 and 3, 3 into 3 and 4; 5 is another component.
  const std::vector<Split> splits{
      {.fragment = 1, .added = 2}, {.fragment = 2, .added = 3}, {.fragment = 3, .added = 4}};
  const auto clusters = [&](int count) {
    const std::vector<Fragment> fragments = chain(count);
    const SplitLevels levels(parentsOf(splits, fragments.size()));
    std::vector<std::pair<int, int>> found;
    for (const UnrealCluster& own : unrealClusters(levels, fragments)) {
      found.emplace_back(own.level, own.cluster);
    }
    return found;
  };
  using Pairs = std::vector<std::pair<int, int>>;
  EXPECT_EQ(clusters(4), (Pairs{{1, -1}, {2, 2}, {3, 3}, {3, 3}}));
  EXPECT_EQ(clusters(5), (Pairs{{2, 1}, {3, 2}, {4, 3}, {4, 3}, {1, -1}}));
  const SplitLevels levels(parentsOf(splits, 4));
  EXPECT_EQ(levels.ofContact(1, 4), 1u);
  EXPECT_EQ(levels.ofContact(2, 4), 2u);
  EXPECT_EQ(levels.ofContact(3, 4), 3u);
  const SplitLevels apart(parentsOf(splits, 5));
  EXPECT_EQ(apart.ofContact(1, 5), 1u);
  EXPECT_EQ(apart.ofContact(1, 2), 2u);
}

TEST(Geo, LevelsEndAtTheDeepest) {
  std::vector<Split> splits;
  for (int i = 1; i <= 100; ++i) {
    splits.push_back(
        {.fragment = static_cast<std::uint16_t>(i), .added = static_cast<std::uint16_t>(i + 1)});
  }
  const SplitLevels levels(parentsOf(splits, 101));
  EXPECT_EQ(levels.ofFragment(101), kDeepestLevel);
  EXPECT_EQ(levels.ofContact(100, 101), kDeepestLevel);
  EXPECT_EQ(levels.ofContact(1, 101), 1u);
}

}  // namespace
}  // namespace sherd
