// Disjoint sets.
#include "base/union_find.h"

#include <gtest/gtest.h>

namespace sherd {
namespace {

TEST(UnionFind, StartsWithASetForEachNumber) {
  EXPECT_EQ(UnionFind(3).all(), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_TRUE(UnionFind(0).all().empty());
}

TEST(UnionFind, NamesASetByItsLeastNumberWhateverTheOrder) {
  UnionFind a(7), b(7);
  a.unite(6, 4), a.unite(4, 2), a.unite(5, 1);
  b.unite(1, 5), b.unite(2, 6), b.unite(6, 4), b.unite(4, 4);
  EXPECT_EQ(a.find(6), 2u);
  const std::vector<std::uint32_t> expected{0, 1, 2, 3, 2, 1, 2};
  EXPECT_EQ(std::move(a).all(), expected);
  EXPECT_EQ(std::move(b).all(), expected);
}

}  // namespace
}  // namespace sherd
