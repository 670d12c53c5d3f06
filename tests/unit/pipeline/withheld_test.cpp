// Which fragments are withheld: every one that is kept touches another.
#include "pipeline/withheld.h"

#include <gtest/gtest.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <vector>

#include "base/random.h"
#include "kernels/device_fixture.h"
#include "shapes.h"

namespace sherd {
namespace {

std::vector<CrackArea> contactsOfTest(std::initializer_list<std::pair<int, int>> pairs) {
  std::vector<CrackArea> contacts;
  for (const auto& [a, b] : pairs)
    contacts.push_back({static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(b), 1});
  return contacts;
}

std::size_t lonely(const std::vector<bool>& withheld, const std::vector<CrackArea>& contacts) {
  std::size_t count = 0;
  for (std::size_t id = 1; id < withheld.size(); ++id) {
    if (withheld[id]) continue;
    count += std::none_of(contacts.begin(), contacts.end(), [&](const CrackArea& c) {
      return (c.a == id && !withheld[c.b]) || (c.b == id && !withheld[c.a]);
    });
  }
  return count;
}

// The least number of kept fragments that touch none, of all choices.
std::size_t leastLonely(std::size_t fragments, std::size_t count,
                        const std::vector<CrackArea>& contacts) {
  std::size_t least = fragments;
  for (unsigned bits = 0; bits < (1u << fragments); ++bits) {
    if (static_cast<std::size_t>(std::popcount(bits)) != count) continue;
    std::vector<bool> withheld(fragments + 1, false);
    for (std::size_t id = 1; id <= fragments; ++id) withheld[id] = ((bits >> (id - 1)) & 1) != 0;
    least = std::min(least, lonely(withheld, contacts));
  }
  return least;
}

TEST(Withheld, TheRuleHoldsWhereverItCan) {
  // Random graphs of 7 fragments, beside all choices.
  std::uint64_t item = 0;
  for (int round = 0; round < 400; ++round) {
    const double density = 0.05 + 0.5 * randomUnit(1, Stage::seedVoxel, item++);
    std::vector<CrackArea> contacts;
    for (std::uint16_t a = 1; a <= 7; ++a) {
      for (std::uint16_t b = a + 1; b <= 7; ++b) {
        if (randomUnit(1, Stage::seedVoxel, item++) < density) contacts.push_back({a, b, 1});
      }
    }
    for (std::size_t count = 0; count < 7; ++count) {
      const std::vector<bool> withheld = withheldByContacts(7, count, contacts);
      EXPECT_EQ(std::count(withheld.begin(), withheld.end(), true), static_cast<long>(count));
      if (leastLonely(7, count, contacts) == 0) {
        EXPECT_EQ(lonely(withheld, contacts), 0u) << "round " << round << ", " << count;
      }
    }
  }
}

TEST(Withheld, TheLastGoWhereTheyMay) {
  const auto chain = contactsOfTest({{1, 2}, {2, 3}, {3, 4}});
  EXPECT_EQ(withheldByContacts(4, 2, chain), (std::vector<bool>{false, false, false, true, true}));
  // 3 is the only neighbor of 1: the last two would leave it alone.
  const auto other = contactsOfTest({{1, 3}, {2, 4}, {3, 4}});
  const std::vector<bool> withheld = withheldByContacts(4, 2, other);
  EXPECT_EQ(lonely(withheld, other), 0u);
}

// Of the first fragments of a fracture, those without a contact among them.
std::size_t aloneOf(const FractureResult& result, std::size_t kept) {
  std::size_t alone = 0;
  for (std::size_t i = 0; i < kept; ++i) {
    const std::vector<Contact>& contacts = result.fragments[i].contacts;
    alone += std::none_of(contacts.begin(), contacts.end(), [&](const Contact& c) {
      return static_cast<std::size_t>(c.fragment) <= kept;
    });
  }
  return alone;
}

using WithheldFragments = DeviceTest;

TEST_F(WithheldFragments, EveryKeptOneHasAKeptContact) {
  std::size_t wouldBeAlone = 0;  // if the last were withheld, whatever they touch
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    FractureOptions options{.pieces = 10, .seed = seed, .solid = {.resolution = 32}, .missing = 6};
    const FractureResult result = fracture(shapes::torus(1.0, 0.2), options, device());
    ASSERT_EQ(result.kept(), 4u);
    EXPECT_EQ(aloneOf(result, 4), 0u) << seed;
    options.missing = 0.0;
    wouldBeAlone += aloneOf(fracture(shapes::torus(1.0, 0.2), options, device()), 4);
  }
  EXPECT_GT(wouldBeAlone, 10u);
}

TEST_F(WithheldFragments, AnyMayGoIfAsked) {
  std::size_t alone = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const FractureOptions options{.pieces = 10,
                                  .seed = seed,
                                  .solid = {.resolution = 32},
                                  .missing = 6,
                                  .missingRule = MissingRule::any};
    const FractureResult result = fracture(shapes::torus(1.0, 0.2), options, device());
    ASSERT_EQ(result.kept(), 4u);
    EXPECT_EQ(result.alone, aloneOf(result, 4)) << seed;
    alone += result.alone;
  }
  EXPECT_GT(alone, 10u);
}

TEST(Withheld, ThoseWithoutAKeptNeighborAreCounted) {
  const auto contacts = contactsOfTest({{1, 3}, {2, 4}, {3, 4}});
  EXPECT_EQ(aloneByContacts({false, false, false, true, true}, contacts), 2u);
  EXPECT_EQ(aloneByContacts({false, false, false, false, true}, contacts), 1u);
  // 5 touches nothing at all.
  EXPECT_EQ(aloneByContacts({false, false, false, false, false, false}, contacts), 0u);
}

TEST_F(WithheldFragments, IdsOfKeptOnesSayNothing) {
  // A torus in a ring of pieces: the mean share of each id is that of all, within three standard
  // errors, and the fragments are those of the whole fracture.
  std::vector<double> sums(6, 0.0), squares(6, 0.0);
  constexpr int kSeeds = 60;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    FractureOptions options{.pieces = 6, .seed = seed, .solid = {.resolution = 24}, .missing = 3};
    const FractureResult result = fracture(shapes::torus(1.0, 0.3), options, device());
    std::set<std::uint64_t> own, other;
    double kept = 0.0;
    for (std::size_t i = 0; i < 3; ++i) kept += static_cast<double>(result.fragments[i].voxels);
    for (std::size_t i = 0; i < 3; ++i) {
      const double share = static_cast<double>(result.fragments[i].voxels) / kept;
      sums[i] += share;
      squares[i] += share * share;
    }
    options.missing = 0.0;
    for (const Fragment& f : result.fragments) own.insert(f.voxels);
    for (const Fragment& f : fracture(shapes::torus(1.0, 0.3), options, device()).fragments)
      other.insert(f.voxels);
    EXPECT_EQ(own, other);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const double mean = sums[i] / kSeeds, variance = squares[i] / kSeeds - mean * mean;
    EXPECT_LT(std::abs(mean - 1.0 / 3.0), 3.0 * std::sqrt(variance / kSeeds)) << i;
  }
}

}  // namespace
}  // namespace sherd
