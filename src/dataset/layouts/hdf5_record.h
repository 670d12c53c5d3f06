// The records of joined files: fractures.hdf5.json says what fractures.hdf5 has.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dataset/layouts/joined_file.h"

namespace sherd {

[[nodiscard]] std::string recordName(const std::string& joined);

/// Records what is, or is about to be, a joined file: of several states the file's size and sum say
/// which it has.  So a file is replaced without a moment at which no record fits.
///   throws  Error(output)
void writeRecord(const std::filesystem::path& out, const std::vector<JoinedFile>& states);

/// Removes the files of shards and their records, also those that a killed run left of either.
void removeShardFiles(const std::filesystem::path& out);

/// Returns the sentence about a joined file whose checksum is not its record's.
[[nodiscard]] inline std::string differs(const std::string& file) {
  return file +
         ": differs from what was written; remove it, and a resumed run makes its fractures again";
}

}  // namespace sherd
