// What is known of a joined HDF5 file.
#pragma once

#include <sherd/dataset.h>

#include <cstdint>
#include <map>
#include <string>

namespace sherd {

inline constexpr const char* kHdf5Stem = "fractures";

/// A joined file, from the record beside it.
struct JoinedFile {
  std::string name;  ///< "fractures.hdf5", or "fractures_2_of_4.hdf5" of a shard
  std::uint64_t bytes = 0;
  std::string sha256;
  std::map<std::string, std::string> objects;  ///< by key the SHA-256 of the object's mesh

  /// Whether it has the fractures of an object as it is now.
  [[nodiscard]] bool holds(const LibraryObject& object, const std::string& meshSum) const {
    const auto found = objects.find(object.key);
    return found != objects.end() && found->second == meshSum;
  }
};

}  // namespace sherd
