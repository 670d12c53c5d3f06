// The checksums of a dataset's own files.
#pragma once

#include <sherd/dataset.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace sherd {

/// The file with the checksums, in the format of sha256sum.  It lists all files but those of
/// fractures, whose checksums the journals have, HDF5 files, whose records have them, and itself.
/// It exists only while they fit: a run removes it first and writes it last.
inline constexpr const char* kSumsName = "journal/SHA256SUMS";

/// By name below the dataset's folder, in '/'.
using OwnSums = std::map<std::string, std::string>;

/// Reads the checksums; none where there is no file, and none of damaged lines.
[[nodiscard]] OwnSums readOwnSums(const std::filesystem::path& out);

/// Removes the file of checksums.
///   throws  Error(output) it cannot be removed
void removeOwnSums(const std::filesystem::path& out);

/// Writes the checksums of all files.  Those that this run did not write keep the ones they have,
/// so that damage is found again.
///   before   of the run before
///   written  objects that this run broke
///   throws   Error(output), Error(input) a file cannot be read
void writeOwnSums(const std::filesystem::path& out, const OwnSums& before,
                  const std::vector<const LibraryObject*>& written);

}  // namespace sherd
