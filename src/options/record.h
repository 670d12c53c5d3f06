// The options in a manifest.
#pragma once

#include <sherd/options.h>

#include <nlohmann/json.hpp>

namespace sherd {

/// Returns a manifest's `options`: the rows with a key, each where it applies.
///   isRefracture  leaves out how the inside of a mesh was found
[[nodiscard]] nlohmann::ordered_json recordedOptions(const RunOptions& options, bool isRefracture);

/// Returns the options that a manifest's `options` record; others have their defaults.  Of seeds
/// from a file, only the name is recorded.
///   throws  Error(input) a value that no option has; members without a row are ignored
[[nodiscard]] RunOptions optionsRecorded(const nlohmann::json& recorded);

}  // namespace sherd
