// Parts of HDF5 files, and matches of points.  tests/cli/training_layouts_test.py reads the
// layouts.
#include <gtest/gtest.h>
#include <sherd/error.h>

#include "base/files/file_bytes.h"
#include "dataset/layouts/hdf5_part.h"
#include "dataset/layouts/pfpp_matches.h"
#include "temp_folder.h"

namespace sherd {
namespace {

TEST(Hdf5Part, ReadsBack) {
  const OwnFolder folder;
  const Hdf5Arrays arrays{
      {"pieces/00/vertices", packedHdf5(Hdf5Type::float32, {10, 3}, std::string(120, 'x'))},
      {"pieces_names", packedHdf5({"piece_00"})}};
  writeHdf5Part(folder.path() / "a.part", arrays);
  const std::string bytes = readFileBytes(folder.path() / "a.part");
  const Hdf5Arrays read = parsedHdf5Part(bytes);
  ASSERT_EQ(read.size(), arrays.size());
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    EXPECT_EQ(read[i].first, arrays[i].first);
    EXPECT_EQ(read[i].second.type, arrays[i].second.type);
    EXPECT_EQ(read[i].second.shape, arrays[i].second.shape);
    EXPECT_EQ(read[i].second.packed, arrays[i].second.packed);
  }
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW((void)parsedHdf5Part(std::string_view(bytes).substr(0, size)), Error) << size;
  }
  EXPECT_THROW((void)parsedHdf5Part(bytes + "x"), Error);
}

TEST(Hdf5Part, WhatContradictsItselfIsRefused) {
  const auto part = [](const std::string& arrays) {
    return R"({"schema":"sherd-hdf5-part/1","arrays":[)" + arrays + "]}\n";
  };
  EXPECT_TRUE(parsedHdf5Part(part("")).empty());
  for (const char* array :
       {"3", "{}", R"({"path":"../a","type":"int32","item":4,"shape":[1],"bytes":0})",
        R"({"path":"/a","type":"int32","item":4,"shape":[1],"bytes":0})",
        R"({"path":"a","type":"int31","item":4,"shape":[1],"bytes":0})",
        R"({"path":"a","type":"int32","item":0,"shape":[1],"bytes":0})",
        R"({"path":"a","type":"int32","item":4,"shape":[],"bytes":0})",
        R"({"path":"a","type":"int32","item":4,"shape":[1,1,1,1],"bytes":0})",
        R"({"path":"a","type":"int32","item":4,"shape":[-1],"bytes":0})",
        R"({"path":"a","type":"int32","item":4,"shape":[1],"bytes":1})",
        R"({"path":"a","type":"int32","item":4,"shape":[1],"bytes":18446744073709551615})"}) {
    EXPECT_THROW((void)parsedHdf5Part(part(array)), Error) << array;
  }
}

TEST(PfppMatching, MatchesMutualNeighborsOfFacingPoints) {
  // Two parts on both sides of x = 0; a third is far away, and has points that face no other.
  std::vector<glm::vec3> positions;
  std::vector<std::uint16_t> neighbor;
  for (int i = 0; i < 5; ++i) positions.emplace_back(-0.01F, 0.1F * static_cast<float>(i), 0.0F);
  neighbor = {0, 2, 2, 2, 2};
  for (int i = 0; i < 4; ++i) positions.emplace_back(0.01F, 0.1F * static_cast<float>(i), 0.0F);
  neighbor.insert(neighbor.end(), {1, 1, 1, 1});
  for (int i = 0; i < 3; ++i) positions.emplace_back(5.0F, 0.0F, 0.0F);
  neighbor.insert(neighbor.end(), {0, 4, 65535});
  const std::size_t counts[] = {5, 4, 3};
  const PfppMatching matching = pfppMatching(positions, neighbor, counts);
  EXPECT_EQ(matching.edges, (std::vector<std::size_t>{1, 0}));
  EXPECT_EQ(matching.criticalCounts, (std::vector<std::size_t>{4, 4, 2}));
  EXPECT_EQ(matching.critical, (std::vector<std::size_t>{1, 2, 3, 4, 0, 0, 1, 2, 3, 1, 2, 0}));
  // Point 1 of part 0 is its critical point 0, across from point 1 of part 1; the last has no
  // partner.
  ASSERT_EQ(matching.tables.size(), 1U);
  EXPECT_EQ(matching.tables[0].numbers, (std::vector<std::int64_t>{0, 1, 1, 2, 2, 3}));
}

TEST(PfppMatching, FewerThanThreeMatchesAreNoEdge) {
  const std::vector<glm::vec3> positions(4, glm::vec3(0.0F));
  const std::size_t counts[] = {2, 2};
  const std::vector<std::uint16_t> neighbor{2, 2, 1, 1};
  EXPECT_TRUE(pfppMatching(positions, neighbor, counts).tables.empty());
}

}  // namespace
}  // namespace sherd
