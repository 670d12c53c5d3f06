// Triangles that a mesh has several times.
#include "mesh/repair/duplicates.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <unordered_map>
#include <utility>

#include "base/union_find.h"

namespace sherd {
namespace {

// Returns a triangle's corners in ascending order, and whether that is an even permutation.
std::pair<std::array<std::uint32_t, 3>, bool> sortedCorners(const glm::uvec3& t) {
  std::array<std::uint32_t, 3> corners{t.x, t.y, t.z};
  bool even = true;
  const auto order = [&](std::size_t a, std::size_t b) {
    if (corners[a] <= corners[b]) return;
    std::swap(corners[a], corners[b]);
    even = !even;
  };
  order(0, 1), order(1, 2), order(0, 1);
  return {corners, even};
}

// One of each triangle, and the copies that are left out though they have its orientation.
struct Once {
  std::vector<bool> isKept;
  std::vector<std::uint32_t> copies;
  std::vector<std::uint32_t> canceled;  // the first of those of which none is kept
  std::vector<std::uint32_t> behind;    // [canceled] the first of the other orientation
};

Once once(std::span<const glm::uvec3> triangles) {
  struct Entry {
    std::array<std::uint32_t, 3> corners;
    bool even;
    std::uint32_t index;
  };
  std::vector<Entry> entries;
  entries.reserve(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto [corners, even] = sortedCorners(triangles[i]);
    entries.push_back({corners, even, i});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.corners != b.corners ? a.corners < b.corners : a.index < b.index;
  });
  Once out{std::vector<bool>(triangles.size(), false), {}, {}, {}};
  for (std::size_t i = 0; i < entries.size();) {
    std::size_t end = i;
    int net = 0;
    for (; end < entries.size() && entries[end].corners == entries[i].corners; ++end) {
      net += entries[end].even ? 1 : -1;
    }
    int left = std::abs(net);
    if (left == 0) {
      out.canceled.push_back(entries[i].index);
      std::size_t other = i;
      while (entries[other].even == entries[i].even) ++other;
      out.behind.push_back(entries[other].index);
    }
    for (std::size_t k = i; k < end && left > 0; ++k) {
      if (entries[k].even != (net > 0)) continue;
      if (left-- == std::abs(net)) {
        out.isKept[entries[k].index] = true;
      } else {
        out.copies.push_back(entries[k].index);
      }
    }
    i = end;
  }
  return out;
}

// Calls visit(edge, 1 or -1) for the edges of a triangle: -1 if it has it from high to low.
template <class Visit>
void forEachSide(const glm::uvec3& t, Visit visit) {
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t from = t[k], to = t[(k + 1) % 3];
    if (from == to) continue;
    visit(std::uint64_t{std::min(from, to)} << 32 | std::max(from, to), from < to ? 1 : -1);
  }
}

// Keeps the copies with which edges balance better, patch by patch.
void keepNeeded(std::span<const glm::uvec3> triangles, Once& all) {
  std::unordered_map<std::uint64_t, int> balance;  // of the edges of copies, without these
  UnionFind patches(all.copies.size());
  std::unordered_map<std::uint64_t, std::uint32_t> firstAt;
  for (std::uint32_t i = 0; i < all.copies.size(); ++i) {
    forEachSide(triangles[all.copies[i]], [&](std::uint64_t edge, int) {
      balance[edge] = 0;
      patches.unite(i, firstAt.try_emplace(edge, i).first->second);
    });
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!all.isKept[t]) continue;
    forEachSide(triangles[t], [&](std::uint64_t edge, int sign) {
      if (const auto found = balance.find(edge); found != balance.end()) found->second += sign;
    });
  }
  const std::vector<std::uint32_t> patchOf = std::move(patches).all();
  std::map<std::uint32_t, std::map<std::uint64_t, int>> added;  // what patches add to balances
  for (std::size_t i = 0; i < patchOf.size(); ++i) {
    forEachSide(triangles[all.copies[i]],
                [&](std::uint64_t edge, int sign) { added[patchOf[i]][edge] += sign; });
  }
  std::map<std::uint32_t, bool> isNeeded;
  for (const auto& [patch, sums] : added) {
    int before = 0, after = 0;
    for (const auto& [edge, sum] : sums) {
      before += std::abs(balance[edge]);
      after += std::abs(balance[edge] + sum);
    }
    isNeeded[patch] = after < before;
  }
  for (std::size_t i = 0; i < patchOf.size(); ++i) {
    if (isNeeded[patchOf[i]]) all.isKept[all.copies[i]] = true;
  }
}

// Keeps one side of the closed surfaces among triangles that cancel each other.  Returns the
// others: sheets, and walls between bodies, which end at these.
std::vector<SheetFace> keepSurfaces(std::span<const glm::uvec3> triangles, Once& all) {
  struct Edge {
    std::uint32_t first = 0;  // of the canceled ones
    int count = 0;
    bool isOfOthers = false;  // of triangles that are kept
  };
  std::unordered_map<std::uint64_t, Edge> edges;
  UnionFind groups(all.canceled.size());
  for (std::uint32_t i = 0; i < all.canceled.size(); ++i) {
    forEachSide(triangles[all.canceled[i]], [&](std::uint64_t edge, int) {
      Edge& own = edges.try_emplace(edge, Edge{.first = i}).first->second;
      ++own.count;
      groups.unite(i, own.first);
    });
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!all.isKept[t]) continue;
    forEachSide(triangles[t], [&](std::uint64_t edge, int) {
      if (const auto found = edges.find(edge); found != edges.end())
        found->second.isOfOthers = true;
    });
  }
  const std::vector<std::uint32_t> groupOf = std::move(groups).all();
  std::vector<std::uint8_t> isOpen(groupOf.size(), 0), isWall(groupOf.size(), 0);
  for (const auto& [key, edge] : edges) {
    const std::uint32_t group = groupOf[edge.first];
    if (edge.isOfOthers) isWall[group] = 1;
    if (edge.count == 1 && !edge.isOfOthers) isOpen[group] = 1;
    if (edge.count > 2) isOpen[group] = 1;
  }
  std::vector<SheetFace> sheets;
  for (std::size_t i = 0; i < groupOf.size(); ++i) {
    const std::uint32_t front = all.canceled[i];
    if (isOpen[groupOf[i]] == 0 && isWall[groupOf[i]] == 0) {
      all.isKept[front] = true;
      continue;
    }
    sheets.push_back({.corners = triangles[front],
                      .front = front,
                      .back = all.behind[i],
                      .isBetweenOthers = isOpen[groupOf[i]] == 0});
  }
  return sheets;
}

}  // namespace

OnceTriangles withoutDuplicates(std::span<const glm::uvec3> triangles) {
  Once all = once(triangles);
  if (!all.copies.empty()) keepNeeded(triangles, all);
  OnceTriangles out;
  if (!all.canceled.empty()) out.sheets = keepSurfaces(triangles, all);
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    if (all.isKept[i]) out.kept.push_back(i);
  }
  return out;
}

}  // namespace sherd
