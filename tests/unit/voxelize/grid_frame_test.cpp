// Points of the world and of voxels.
#include <gtest/gtest.h>
#include <sherd/solid.h>

#include <type_traits>

namespace sherd {
namespace {

template <class P>
concept IsIndex = requires(const GridFrame& frame, const P& p) {
  frame.worldFromIndex(p);
};
template <class P>
concept IsWorld = requires(const GridFrame& frame, const P& p) {
  frame.indexFromWorld(p);
};

// A conversion that is done twice does not compile.
static_assert(IsIndex<IndexPoint> && !IsIndex<WorldPoint>);
static_assert(IsWorld<WorldPoint> && !IsWorld<IndexPoint>);
static_assert(IsIndex<glm::dvec3> && IsWorld<glm::dvec3>);
static_assert(!std::is_convertible_v<WorldPoint, IndexPoint>);
static_assert(!std::is_assignable_v<IndexPoint&, WorldPoint>);

TEST(GridFrame, VoxelsLieAtTheOriginAndTheirSizeApart) {
  const GridFrame frame{{1.0, -2.0, 8.0}, 0.25};
  EXPECT_EQ(frame.worldFromIndex(openvdb::Coord(0, 0, 0)), glm::dvec3(1.0, -2.0, 8.0));
  EXPECT_EQ(frame.worldFromIndex(openvdb::Coord(4, 2, -1)), glm::dvec3(2.0, -1.5, 7.75));
  EXPECT_EQ(frame.indexFromWorld({2.0, -1.5, 7.75}), glm::dvec3(4.0, 2.0, -1.0));
}

}  // namespace
}  // namespace sherd
