// Adds the options of a fracture, by group.
#pragma once

#include <sherd/fracture.h>
#include <sherd/io.h>
#include <sherd/volume.h>

#include "cli/command.h"

namespace sherd::cli {

/// Accepts finite numbers above 0.
[[nodiscard]] CLI::Validator aboveZero();

/// Adds --resolution, and returns it for options that exclude it.
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

///   compress  name of the option that compresses .vdb files
void addHostOptions(CLI::App& command, WriteOptions& write, const std::string& compress);

/// The output options as given.
struct WriteArguments {
  std::vector<std::string> names{"labels", "vdb", "mesh", "preview"};
  WriteOptions files{};  ///< everything except what `names` and `up` set
  std::string up = "y";
};

/// Adds --write and --up.
void addWriteOptions(CLI::App& command, WriteArguments& arguments);

[[nodiscard]] WriteOptions writeOptions(const WriteArguments& arguments);

/// Adds --preset.  Must be called before all functions that add to `options`: CLI11 sets values in
/// the order in which options were added, so the others override the preset.
void addPreset(CLI::App& command, FractureOptions& options);

}  // namespace sherd::cli
