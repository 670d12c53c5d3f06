// The options of a fracture, by group.
#pragma once

#include <sherd/fracture.h>
#include <sherd/io.h>

#include "cli/command.h"

namespace sherd::cli {

/// Accepts finite numbers above 0.
[[nodiscard]] CLI::Validator aboveZero();

void addSeedOptions(CLI::App& command, FractureOptions& options);
void addGrowthOptions(CLI::App& command, FractureOptions& options);
void addErosionOptions(CLI::App& command, FractureOptions& options);
void addSurfaceOptions(CLI::App& command, FractureOptions& options);
void addPointOptions(CLI::App& command, WriteOptions& write);

/// Refuses what cannot go together, before the work.
///   throws  CLI::ValidationError
void checkPointOptions(const WriteOptions& write);

}  // namespace sherd::cli
