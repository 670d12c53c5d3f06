// Undoing collapses that depend on each other.
#include "remesh/collapse_log.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace sherd {
namespace {

// Records a change of some faces, and makes it: their corners become the collapse's number.
void change(CollapseLog& log, std::vector<ComplexFace>& faces, std::uint32_t number,
            std::initializer_list<std::uint32_t> changed) {
  log.add(std::vector<std::uint32_t>(changed), faces);
  for (const std::uint32_t face : changed) faces[face].corner = glm::uvec3(number);
}

std::vector<std::uint32_t> cornersOf(const std::vector<ComplexFace>& faces) {
  std::vector<std::uint32_t> all;
  for (const ComplexFace& face : faces) all.push_back(face.corner.x);
  return all;
}

TEST(CollapseLog, UndoesWhatDependsOnACollapseAndNothingElse) {
  std::vector<ComplexFace> faces(6);
  CollapseLog log(faces.size());
  change(log, faces, 1, {0, 1});
  change(log, faces, 2, {4, 5});
  change(log, faces, 3, {1, 2});
  change(log, faces, 4, {2, 3});
  EXPECT_TRUE(log.isChanged(3));
  // The first collapse changed face 0 last, the third and so the fourth follow from it.
  EXPECT_EQ(log.undo(std::array{0u}, 1, faces), (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(cornersOf(faces), (std::vector<std::uint32_t>{0, 0, 0, 0, 2, 2}));
  EXPECT_FALSE(log.isChanged(3));
  EXPECT_TRUE(log.isChanged(4));
  EXPECT_TRUE(log.undo(std::array{0u}, 1, faces).empty());
}

TEST(CollapseLog, UndoesAsManyCollapsesOfAFaceAsAskedFor) {
  for (const std::size_t depth : {1u, 2u, 3u, 9u}) {
    std::vector<ComplexFace> faces(2);
    CollapseLog log(faces.size());
    for (const std::uint32_t number : {1u, 2u, 3u}) change(log, faces, number, {1});
    EXPECT_EQ(log.undo(std::array{1u}, depth, faces), (std::vector<std::uint32_t>{1}));
    EXPECT_EQ(faces[1].corner.x, depth < 3 ? 3 - depth : 0);
  }
}

}  // namespace
}  // namespace sherd
