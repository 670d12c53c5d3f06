// The options that shape a fracture, by group.
#pragma once

#include <sherd/fracture.h>

#include "cli/command.h"

namespace sherd::cli {

/// Accepts finite numbers above 0.
[[nodiscard]] CLI::Validator aboveZero();

void addSeedOptions(CLI::App& command, FractureOptions& options);
void addGrowthOptions(CLI::App& command, FractureOptions& options);
void addErosionOptions(CLI::App& command, FractureOptions& options);
void addSurfaceOptions(CLI::App& command, FractureOptions& options);

}  // namespace sherd::cli
