// The text of a seed file.
#pragma once

#include <sherd/seeds.h>

#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace sherd {

/// The seeds that a file's JSON lists; see readSeeds.
///   throws  Error(input) without the file's name
[[nodiscard]] std::vector<SeedPoint> seedPoints(const nlohmann::json& json);

}  // namespace sherd
