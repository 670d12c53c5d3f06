// Reads manifest.json; the file is untrusted.
#pragma once

#include <sherd/folder.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "folder/manifest/listed_files.h"

namespace sherd {

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

}  // namespace sherd
