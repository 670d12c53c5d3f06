// Which fragments are withheld.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "grow/sized/crack_areas.h"

namespace sherd {

/// Returns which of fragments 1..fragments to withhold so that every one that is kept touches
/// another one that is.  They go from the last id down: first those that touch none, then each
/// whose neighbors all touch another one that is kept, then pairs that touch each other only; if
/// one would be too many, one that was withheld and touches a pair replaces another pair.  Where
/// that cannot be, as of one that is kept, some touch none.
///   contacts  of which both are 1..fragments count
///   count     below `fragments`
///   return    [fragments + 1] whether each is withheld, `count` of them
[[nodiscard]] std::vector<bool> withheldByContacts(std::size_t fragments, std::size_t count,
                                                   std::span<const CrackArea> contacts);

/// Returns how many kept fragments touch others, of which none is kept.
///   withheld  [fragments + 1]
[[nodiscard]] std::size_t aloneByContacts(const std::vector<bool>& withheld,
                                          std::span<const CrackArea> contacts);

}  // namespace sherd
