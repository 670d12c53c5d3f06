// The labels of inside voxels, by slices of voxels of one label.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <cstdint>
#include <cstring>

namespace sherd {

/// Calls visit(label, x, bits) for the inside voxels of a leaf: those of the slice x with bit y*8+z
/// have this label.  Most slices have one label, and one call.
template <class Visit>
void forEachLabelSlice(const Labels& labels, std::size_t leaf, const Visit& visit) {
  constexpr std::uint64_t kRow = 0xff;
  const auto areEqual = [](const std::uint16_t* first, std::size_t count) {
    return std::memcmp(first, first + 1, (count - 1) * sizeof *first) == 0;
  };
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t inside = labels.blocks->inside[leaf * 8 + x];
    if (inside == 0) continue;
    const std::uint16_t* const own = &labels.fragment[leaf * 512 + x * 64];
    if (areEqual(own, 64)) {
      visit(own[0], x, inside);
      continue;
    }
    for (std::size_t y = 0; y < 8; ++y) {
      const std::uint64_t row = inside & (kRow << (8 * y));
      if (row == 0) continue;
      if (areEqual(own + 8 * y, 8)) {
        visit(own[8 * y], x, row);
        continue;
      }
      for (std::size_t i = 8 * y; i < 8 * y + 8; ++i) {
        if ((row >> i) & 1) visit(own[i], x, std::uint64_t{1} << i);
      }
    }
  }
}

}  // namespace sherd
