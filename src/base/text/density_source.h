// The text that names where densities come from: an attribute, or a grid of a file.
#pragma once

#include <filesystem>
#include <string>

#include "base/text/lower_case.h"

namespace sherd {

struct DensitySource {
  std::filesystem::path file;  ///< a `.vdb` file; empty for an attribute of a mesh
  std::string name;            ///< of the attribute or the grid; empty: the file's only grid

  /// Returns the text, with the file's name without folders.
  [[nodiscard]] std::string withoutFolders() const {
    if (file.empty()) return name;
    return file.filename().string() + (name.empty() ? "" : ":" + name);
  }
};

/// Splits "NAME", "FILE.vdb" or "FILE.vdb:GRID".
[[nodiscard]] inline DensitySource densitySourceOf(const std::string& text) {
  const std::string lower = lowerCase(text);
  if (lower.ends_with(".vdb")) return {text, ""};
  const std::size_t colon = lower.find(".vdb:");
  if (colon == std::string::npos) return {{}, text};
  const std::size_t end = colon + 4;
  return {text.substr(0, end), text.substr(end + 1)};
}

}  // namespace sherd
