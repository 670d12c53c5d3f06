// Verifies the fractures of the layout hdf5.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "dataset/layouts/hdf5_join.h"
#include "formats/arrays/hdf5_file.h"

namespace sherd {

/// The joined files of a dataset.
class JoinedFractures {
 public:
  /// Compares each file with its record's checksum.  One that differs is not opened.
  explicit JoinedFractures(std::filesystem::path out);

  /// Returns a sentence for each file that differs.
  [[nodiscard]] const std::vector<std::string>& problems() const { return problems_; }

  /// Compares the faces of a fracture's fragments with its journal's line, in its part or else in a
  /// joined file, unless that differs.
  ///   throws  Error(input) they are absent, or differ
  ///   meshSum  the journal's
  void check(const LibraryObject& object, const std::string& meshSum, const Json& line) const;

 private:
  std::filesystem::path out_;
  std::vector<JoinedFile> files_;
  std::vector<std::string> problems_;
  std::map<std::string, std::unique_ptr<Hdf5Reader>> readers_;  // by name
};

}  // namespace sherd
