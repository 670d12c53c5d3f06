// Contacts between fragments that are not withheld.
#pragma once

#include <sherd/fragments.h>

#include <cstddef>
#include <span>

namespace sherd {

/// Calls visit(one, other, contact of `one`) with two indices for each pair of touching pieces,
/// ascending by both.  Contacts with others, which are withheld, are left out.
///   pieces  with ids 1, 2, ... and their contacts ascending by id
template <class Piece, class Visit>
void forEachContact(std::span<const Piece> pieces, const Visit& visit) {
  for (std::size_t one = 0; one < pieces.size(); ++one) {
    for (const Contact& contact : pieces[one].contacts) {
      const auto other = static_cast<std::size_t>(contact.fragment - 1);
      if (other > one && other < pieces.size()) visit(one, other, contact);
    }
  }
}

}  // namespace sherd
