// Where a piece touches itself.
#include "clean/part_sheets.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "clean/star_fans.h"

namespace sherd {
namespace {

// A face of a piece at a vertex.
struct OwnSpoke {
  std::uint32_t face = 0;
  std::uint32_t from = 0, to = 0;
};

std::vector<OwnSpoke> spokesOf(const Stars& stars, std::uint16_t piece, std::uint32_t vertex) {
  std::vector<OwnSpoke> spokes;
  for (const std::uint32_t f : stars.around(vertex)) {
    if (stars.face(f).piece != piece) continue;
    const Spoke spoke = spokeOf(stars.face(f).corner, piece, vertex);
    spokes.push_back({f, spoke.from, spoke.to});
  }
  return spokes;
}

// Returns the spoke that follows one around the inside.  An edge of four faces has the inside
// between two that have different pieces beyond them.
std::optional<std::size_t> nextOf(const Stars& stars, const std::vector<OwnSpoke>& spokes,
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

}  // namespace

std::vector<SheetParting> partings(const Stars& stars, std::uint16_t piece, std::uint32_t vertex) {
  const std::vector<OwnSpoke> spokes = spokesOf(stars, piece, vertex);
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
    const std::uint32_t end = spokeOf(own.corner, own.piece, vertex).to;
    change.patches.push_back({{{vertex, end, fresh}, before, after}, nextFace});
    change.patches.push_back({{{vertex, fresh, end}, after, before}, nextFace});
  }
  return change;
}

bool partsSheets(const Stars& stars, const Change& change, std::uint32_t vertex,
                 std::uint16_t piece) {
  Spokes before, after, fresh;  // those that stay, and those of the new vertex
  std::vector<std::uint32_t> moved;
  for (const Change::Face& f : change.moved) {
    moved.push_back(f.number);
    fresh.push_back(spokeOf(f.corner, stars.face(f.number).piece, change.at));
  }
  for (const std::uint32_t f : stars.around(vertex)) {
    before.push_back(spokeOf(stars.face(f).corner, stars.face(f).piece, vertex));
    const bool stays = std::find(moved.begin(), moved.end(), f) == moved.end();
    if (stays) after.push_back(before.back());
  }
  for (const Change::Patch& patch : change.patches) {
    after.push_back(spokeOf(patch.face.corner, patch.face.piece, vertex));
    fresh.push_back(spokeOf(patch.face.corner, patch.face.piece, change.at));
  }
  before = sorted(std::move(before));
  after = sorted(std::move(after));
  fresh = sorted(std::move(fresh));
  // The piece may touch itself at more of the vertex's edges.
  return std::all_of(before.begin(), before.end(), [&](const Spoke& spoke) {
    const std::uint16_t own = spoke.piece;
    const int was = fansOf(before, own), stays = fansOf(after, own), added = fansOf(fresh, own);
    if (added == kNoFans || added > 1) return false;
    if (stays == kNoFans) return own == piece && was == kNoFans;
    return was == kNoFans || stays <= was;
  });
}

}  // namespace sherd
