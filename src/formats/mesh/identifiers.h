// Names of prims, attributes and groups.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "formats/mesh/materials.h"

namespace sherd {

/// Returns text as an identifier: letters, digits and '_', the first no digit, not empty.
[[nodiscard]] std::string identifierOf(std::string_view text);

/// Returns [materials] a unique identifier of each.
[[nodiscard]] std::vector<std::string> identifiersOf(const MaterialTable& table);

}  // namespace sherd
