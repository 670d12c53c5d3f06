// Where a piece touches itself.
#include "clean/part_sheets.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <utility>

namespace sherd {
namespace {

// A face at a vertex: the two others of its corners, in order.
struct Spoke {
  std::uint32_t face = 0;
  std::uint32_t from = 0, to = 0;
};

Spoke spokeOf(std::uint32_t face, const glm::uvec3& corner, std::uint32_t at) {
  if (corner.x == at) return {face, corner.y, corner.z};
  if (corner.y == at) return {face, corner.z, corner.x};
  return {face, corner.x, corner.y};
}

std::vector<Spoke> spokesOf(const Stars& stars, std::uint16_t piece, std::uint32_t vertex) {
  std::vector<Spoke> spokes;
  for (const std::uint32_t f : stars.around(vertex)) {
    const CleanFace& face = stars.face(f);
    if (face.piece == piece) spokes.push_back(spokeOf(f, face.corner, vertex));
  }
  return spokes;
}

// Returns the spoke that follows one around the inside.  An edge of four faces has the inside
// between two that have different pieces beyond them.
std::optional<std::size_t> nextOf(const Stars& stars, const std::vector<Spoke>& spokes,
                                  std::size_t at) {
  std::vector<std::size_t> next;
  for (std::size_t i = 0; i < spokes.size(); ++i) {
    if (spokes[i].from == spokes[at].to) next.push_back(i);
  }
  if (next.size() == 1) return next.front();
  if (next.size() != 2) return {};
  const auto beyond = [&](std::size_t i) { return stars.face(spokes[i].face).other; };
  if (beyond(next[0]) == beyond(next[1])) return {};
  return beyond(next[0]) == beyond(at) ? next[1] : next[0];
}

// Returns the face that is the same, seen from beyond it.
std::optional<std::uint32_t> behindOf(const Stars& stars, std::uint32_t f) {
  const CleanFace& face = stars.face(f);
  if (face.isOutside()) return {};
  for (const std::uint32_t other : stars.around(face.corner.x)) {
    const CleanFace& own = stars.face(other);
    if (own.piece == face.other && own.other == face.piece && own.has(face.corner.y) &&
        own.has(face.corner.z)) {
      return other;
    }
  }
  return {};
}

glm::uvec3 replaced(glm::uvec3 corner, std::uint32_t from, std::uint32_t to) {
  for (int k = 0; k < 3; ++k) {
    if (corner[k] == from) corner[k] = to;
  }
  return corner;
}

// The corners around a vertex of a piece's faces: from each the next.  Counts the rings of them.
class Rings {
 public:
  void add(const glm::uvec3& corner, std::uint32_t at) {
    const Spoke spoke = spokeOf(0, corner, at);
    isSimple_ = next_.emplace(spoke.from, spoke.to).second && isSimple_;
  }

  // Returns their number, or none if an edge is used twice in one direction, or is open.
  [[nodiscard]] std::optional<std::size_t> count() const {
    if (!isSimple_) return {};
    std::map<std::uint32_t, std::uint32_t> left = next_;
    std::size_t rings = 0;
    while (!left.empty()) {
      const std::uint32_t first = left.begin()->first;
      std::uint32_t at = first;
      std::size_t length = 0;
      do {
        const auto found = left.find(at);
        if (found == left.end()) return {};
        at = found->second;
        left.erase(found);
        ++length;
      } while (at != first);
      if (length < 3) return {};
      ++rings;
    }
    return rings;
  }

 private:
  std::map<std::uint32_t, std::uint32_t> next_;
  bool isSimple_ = true;
};

}  // namespace

std::vector<SheetParting> partings(const Stars& stars, std::uint16_t piece, std::uint32_t vertex) {
  const std::vector<Spoke> spokes = spokesOf(stars, piece, vertex);
  std::vector<bool> isSeen(spokes.size(), false);
  std::vector<SheetParting> found;
  for (std::size_t i = 0; i < spokes.size(); ++i) {
    if (isSeen[i]) continue;
    SheetParting parting;
    std::size_t at = i;
    while (!isSeen[at]) {
      isSeen[at] = true;
      const std::optional<std::uint32_t> behind = behindOf(stars, spokes[at].face);
      const std::optional<std::size_t> next = nextOf(stars, spokes, at);
      if (!behind || !next) return {};
      parting.fan.push_back(spokes[at].face);
      parting.behind.push_back(*behind);
      at = *next;
    }
    if (at != i) return {};
    found.push_back(std::move(parting));
  }
  if (found.size() < 2) return {};
  std::stable_sort(found.begin(), found.end(), [](const SheetParting& a, const SheetParting& b) {
    return a.fan.size() < b.fan.size();
  });
  return found;
}

Change part(const Stars& stars, const SheetParting& parting, std::uint32_t vertex,
            std::uint32_t fresh, const glm::dvec3& position, double distance) {
  Change change{.at = fresh, .position = position, .distance = distance};
  for (const auto* faces : {&parting.fan, &parting.behind}) {
    for (const std::uint32_t f : *faces) {
      change.moved.push_back({f, replaced(stars.face(f).corner, vertex, fresh)});
    }
  }
  for (std::size_t i = 0; i < parting.fan.size(); ++i) {
    const CleanFace& own = stars.face(parting.fan[i]);
    const std::uint32_t nextFace = parting.fan[(i + 1) % parting.fan.size()];
    const std::uint16_t before = own.other, after = stars.face(nextFace).other;
    if (before == after) continue;
    // What is beyond the faces before the edge meets what is beyond those behind it.
    const std::uint32_t end = spokeOf(0, own.corner, vertex).to;
    change.patches.push_back({{{vertex, end, fresh}, before, after}, nextFace});
    change.patches.push_back({{{vertex, fresh, end}, after, before}, nextFace});
  }
  return change;
}

bool partsSheets(const Stars& stars, const Change& change, std::uint32_t vertex,
                 std::uint16_t piece) {
  std::map<std::uint16_t, std::array<Rings, 3>> rings;  // at the vertex before and after; the new
  std::vector<std::uint32_t> moved;
  for (const Change::Face& f : change.moved) {
    moved.push_back(f.number);
    rings[stars.face(f.number).piece][2].add(f.corner, change.at);
  }
  for (const std::uint32_t f : stars.around(vertex)) {
    const CleanFace& face = stars.face(f);
    rings[face.piece][0].add(face.corner, vertex);
    const bool stays = std::find(moved.begin(), moved.end(), f) == moved.end();
    if (stays) rings[face.piece][1].add(face.corner, vertex);
  }
  for (const Change::Patch& patch : change.patches) {
    rings[patch.face.piece][1].add(patch.face.corner, vertex);
    rings[patch.face.piece][2].add(patch.face.corner, change.at);
  }
  for (const auto& [own, at] : rings) {
    const auto before = at[0].count(), after = at[1].count(), fresh = at[2].count();
    if (!fresh || *fresh > 1) return false;
    if (!after && (own != piece || before)) return false;
    if (before && after && *after > *before) return false;
  }
  return true;
}

}  // namespace sherd
