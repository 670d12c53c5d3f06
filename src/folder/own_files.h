// Which of the files that a manifest lists are a fracture's by their names.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sherd {

/// The files that a manifest lists, each once.
struct OwnFiles {
  std::vector<std::string> own;     ///< named as fileNames names them, with some options
  std::vector<std::string> others;  ///< somebody else's, whatever the manifest says
};

/// Nothing where listedFiles returns nothing.  Anybody may have written the manifest.
[[nodiscard]] std::optional<OwnFiles> ownFiles(const nlohmann::json& manifest);

}  // namespace sherd
