// The options of a fracture, by group.
#pragma once

#include <sherd/fracture.h>
#include <sherd/io.h>
#include <sherd/volume.h>

#include "cli/command.h"

namespace sherd::cli {

/// Accepts finite numbers above 0.
[[nodiscard]] CLI::Validator aboveZero();

/// --resolution; returned for options that exclude it.
CLI::Option* addResolution(CLI::App& command, FractureOptions& options);

void addFillOptions(CLI::App& command, FractureOptions& options);
void addVolumeOptions(CLI::App& command, VolumeOptions& options);
void addSeedOptions(CLI::App& command, FractureOptions& options);
void addGrowthOptions(CLI::App& command, FractureOptions& options);
void addErosionOptions(CLI::App& command, FractureOptions& options);
void addSurfaceOptions(CLI::App& command, FractureOptions& options);
void addPointOptions(CLI::App& command, WriteOptions& write);
void addVoxelFormatOption(CLI::App& command, WriteOptions& write);
void addMeshFormatOption(CLI::App& command, WriteOptions& write);

///   compress  what the option that packs .vdb files is called
void addHostOptions(CLI::App& command, WriteOptions& write, const std::string& compress);

/// What is to be written, as it is told.
struct WriteArguments {
  std::vector<std::string> names{"labels", "vdb", "mesh", "preview"};
  WriteOptions files{};  ///< all of it but what `names` and `up` tell
  std::string up = "y";
};

/// --write and --up.
void addWriteOptions(CLI::App& command, WriteArguments& arguments);

[[nodiscard]] WriteOptions writeOptions(const WriteArguments& arguments);

/// --preset.  To be added before all others that set `options`: CLI11 sets values in the order in
/// which options were added, wherever they stand on the command line, so the others win.
void addPreset(CLI::App& command, FractureOptions& options);

}  // namespace sherd::cli
