// Contacts between fragments that are not withheld.
#pragma once

#include <sherd/fragments.h>

#include <cstddef>
#include <span>

namespace sherd {

/// Calls visit(one, other, contact of `one`) for each pair of touching fragments in `fragments`.
template <class Visit>
void forEachContact(std::span<const Fragment> fragments, const Visit& visit) {
  for (const Fragment& fragment : fragments) {
    for (const Contact& contact : fragment.contacts) {
      const auto other = static_cast<std::size_t>(contact.fragment - 1);
      if (contact.fragment <= fragment.id || other >= fragments.size()) continue;
      visit(fragment, fragments[other], contact);
    }
  }
}

}  // namespace sherd
