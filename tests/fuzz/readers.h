// Readers as fuzzing calls them, with what their headers promise of the result.
#pragma once

#include <sherd/files.h>

#include <string_view>

namespace sherd::fuzz {

/// Abort unless it holds.
void check(bool holds);

void readMeshNamed(const char* name, std::string_view bytes);
void readGuideNamed(const char* name, std::string_view bytes);
void readDraco(std::string_view bytes);
void checkVoxels(const RunLengthVoxels& voxels);
void checkPoints(const SurfacePoints& points);
void readMtl(std::string_view bytes);
void readModelOf3mf(std::string_view xml);
void readManifestOf(std::string_view bytes);
void readSeedFile(std::string_view bytes);
void readJournalOf(std::string_view bytes);
void readPlanOf(std::string_view bytes);
void readHdf5PartOf(std::string_view bytes);
void readConfig(const char* name, std::string_view bytes);

}  // namespace sherd::fuzz
