// Whether the surfaces of pieces stay manifold.
#include "clean/star_fans.h"

#include <algorithm>
#include <cstddef>
#include <span>

namespace sherd {
namespace {

Spokes spokesAt(const Stars& stars, std::uint32_t vertex) {
  Spokes spokes;
  for (const std::uint32_t f : stars.around(vertex)) {
    spokes.push_back(spokeOf(stars.face(f).corner, stars.face(f).piece, vertex));
  }
  return sorted(std::move(spokes));
}

Spokes spokesAfter(const Stars& stars, const Change& change) {
  Spokes spokes;
  const auto add = [&](const Change::Face& f) {
    spokes.push_back(spokeOf(f.corner, stars.face(f.number).piece, change.at));
  };
  std::vector<std::uint32_t> changed = change.removed;
  for (const Change::Face& f : change.moved) changed.push_back(f.number);
  std::sort(changed.begin(), changed.end());
  for (const std::uint32_t f : stars.around(change.at)) {
    if (std::binary_search(changed.begin(), changed.end(), f)) continue;
    spokes.push_back(spokeOf(stars.face(f).corner, stars.face(f).piece, change.at));
  }
  std::for_each(change.moved.begin(), change.moved.end(), add);
  std::for_each(change.added.begin(), change.added.end(), add);
  return sorted(std::move(spokes));
}

// Returns the spokes of one piece.
std::span<const Spoke> ofPiece(const Spokes& spokes, std::uint16_t piece) {
  const auto [begin, end] =
      std::equal_range(spokes.begin(), spokes.end(), Spoke{piece},
                       [](const Spoke& a, const Spoke& b) { return a.piece < b.piece; });
  return {begin, end};
}

}  // namespace

Spoke spokeOf(const glm::uvec3& corner, std::uint16_t piece, std::uint32_t at) {
  if (corner.x == at) return {piece, corner.y, corner.z};
  if (corner.y == at) return {piece, corner.z, corner.x};
  return {piece, corner.x, corner.y};
}

Spokes sorted(Spokes spokes) {
  std::sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) {
    return a.piece != b.piece ? a.piece < b.piece : a.from < b.from;
  });
  return spokes;
}

int fansOf(const Spokes& all, std::uint16_t piece) {
  const std::span<const Spoke> spokes = ofPiece(all, piece);
  const auto isOf = [](const Spoke& s, std::uint32_t from) { return s.from < from; };
  std::vector<bool> isSeen(spokes.size(), false);
  int fans = 0;
  for (std::size_t i = 0; i < spokes.size(); ++i) {
    if (i > 0 && spokes[i].from == spokes[i - 1].from) return kNoFans;
    if (isSeen[i]) continue;
    std::size_t at = i, length = 0;
    while (!isSeen[at]) {
      isSeen[at] = true;
      ++length;
      const auto next = std::lower_bound(spokes.begin(), spokes.end(), spokes[at].to, isOf);
      if (next == spokes.end() || next->from != spokes[at].to) return kNoFans;
      at = static_cast<std::size_t>(next - spokes.begin());
    }
    if (at != i || length < 3) return kNoFans;
    ++fans;
  }
  return fans;
}

bool keepsFans(const Stars& stars, const Change& change) {
  const Spokes ofAt = spokesAt(stars, change.at), after = spokesAfter(stars, change);
  const Spokes ofGone = change.gone == Change::kNone ? Spokes{} : spokesAt(stars, change.gone);
  // Pieces at the vertex that goes, and at an edge that is split, change; so do all that are at
  // the vertex where it moves, but not their fans.
  std::vector<std::uint16_t> pieces;
  for (const std::uint32_t f : change.removed) pieces.push_back(stars.face(f).piece);
  for (const Change::Face& f : change.moved) pieces.push_back(stars.face(f.number).piece);
  std::sort(pieces.begin(), pieces.end());
  pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
  for (const std::uint16_t piece : pieces) {
    const int atBefore = fansOf(ofAt, piece), goneBefore = fansOf(ofGone, piece);
    const int fans = fansOf(after, piece);
    if (atBefore == kNoFans || goneBefore == kNoFans || fans == kNoFans) return false;
    const int both = atBefore > 0 && goneBefore > 0 ? 1 : 0;
    if (fans != std::max(1, atBefore + goneBefore - both)) return false;
  }
  return true;
}

}  // namespace sherd
