// Vertices of the intact solid's surface at the creases of its input.
#include "interface/cells/creases.h"

#include <algorithm>

namespace sherd {

std::size_t Creases::indexOf(const openvdb::Coord& origin) const {
  const auto at = std::lower_bound(origins_.begin(), origins_.end(), origin);
  if (at == origins_.end() || *at != origin) return origins_.size();
  return static_cast<std::size_t>(at - origins_.begin());
}

std::span<const CreaseVertex> Creases::of(const openvdb::Coord& origin) const {
  const std::size_t index = indexOf(origin);
  return index < vertices_.size() ? vertices_[index] : std::span<const CreaseVertex>();
}

std::span<const KnownCrossing> Creases::crossings(const openvdb::Coord& origin) const {
  const std::size_t index = indexOf(origin);
  return index < crossings_.size() ? crossings_[index] : std::span<const KnownCrossing>();
}

const CreaseVertex* CreasesOfLeaf::find(std::uint32_t offset, const CellSheets& sheets,
                                        unsigned position) {
  while (!left_.empty() && left_.front().offset < offset) left_ = left_.subspan(1);
  if (left_.empty() || left_.front().offset != offset) return nullptr;
  const std::uint16_t edges = edgesOf(sheets, position);
  for (const CreaseVertex& vertex : left_) {
    if (vertex.offset != offset) break;
    if (vertex.edges == edges) return &vertex;
  }
  return nullptr;
}

}  // namespace sherd
