// Reads manifest.json; the file is untrusted.
#pragma once

#include <sherd/folder.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sherd {

inline constexpr const char* kManifestSchema = "sherd/2";
inline constexpr const char* kFormerManifestSchema = "sherd/1";  ///< read too, never written
inline constexpr const char* kAutomatic = "auto";              ///< options.resolution if automatic
inline constexpr const char* kPartialName = ".sherd-partial";  ///< folder of an unfinished fracture

/// Converts a manifest's JSON.
///   throws  Error(input) without the file's name: another schema, a field that is missing, of
///           another type or out of range, ids that are not 1, 2, 3, ..., a file outside the folder
[[nodiscard]] Manifest manifestOf(const nlohmann::json& json);

/// As readManifest.
///   json  receives the whole, with the fields that are not read
[[nodiscard]] Manifest readManifest(const std::filesystem::path& file, nlohmann::json& json);

/// Returns the path of a file listed in a manifest.
///   throws  Error(input) a symbolic link on the way leads out of the manifest's folder
[[nodiscard]] std::filesystem::path listedFile(const std::filesystem::path& manifest,
                                               const std::string& name);

/// Returns the files that a manifest lists; nothing unless each satisfies isBelowFolder and is
/// neither the manifest nor in kPartialName.
[[nodiscard]] std::optional<std::vector<std::string>> listedFiles(const nlohmann::json& manifest);

/// Returns a file's JSON if it has a manifest's schema; other fields are not checked.
[[nodiscard]] std::optional<nlohmann::json> manifestJson(const std::filesystem::path& file);

}  // namespace sherd
