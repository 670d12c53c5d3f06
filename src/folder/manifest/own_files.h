// Selects the files in a manifest's list that have names of fracture files.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sherd {

/// The files that a manifest lists, without duplicates.
struct OwnFiles {
  std::vector<std::string> own;     ///< with names that fileNames can return
  std::vector<std::string> others;  ///< all others, which are not replaced
};

/// Returns nothing if listedFiles does.  The manifest is untrusted.
[[nodiscard]] std::optional<OwnFiles> ownFiles(const nlohmann::json& manifest);

}  // namespace sherd
