// The files that a manifest lists, whatever else it has; it is untrusted.
#pragma once

#include <sherd/folder.h>

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sherd {

inline constexpr const char* kManifestSchema = "sherd/2";
inline constexpr const char* kAutomatic = "auto";              ///< options.resolution if automatic
inline constexpr const char* kPartialName = ".sherd-partial";  ///< folder of an unfinished fracture

/// Returns the files that a manifest lists; nothing unless each satisfies isBelowFolder and is
/// neither the manifest nor in kPartialName.
[[nodiscard]] std::optional<std::vector<std::string>> listedFiles(const nlohmann::json& manifest);

/// Returns a file's JSON if it has a manifest's schema; other fields are not checked.
[[nodiscard]] std::optional<nlohmann::json> manifestJson(const std::filesystem::path& file);

/// Reads a manifest's JSON; fields are not checked.
///   throws  Error(input)
[[nodiscard]] nlohmann::json readManifestJson(const std::filesystem::path& file);

/// Whether it has a manifest's schema.
[[nodiscard]] bool hasManifestSchema(const nlohmann::json& json);

}  // namespace sherd
