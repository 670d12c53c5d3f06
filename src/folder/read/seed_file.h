// The content of a seed file.
#pragma once

#include <sherd/seeds.h>

#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace sherd {

/// Returns the seeds in a seed file's JSON; see readSeeds.
///   throws  Error(input) without the file's name
[[nodiscard]] std::vector<SeedPoint> seedPoints(const nlohmann::json& json);

}  // namespace sherd
