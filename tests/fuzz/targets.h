// The readers that are fuzzed.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sherd::fuzz {

/// A reader, and files for it to begin with.
struct Target {
  const char* name;

  /// Read bytes, and abort where what comes of them is not what the reader promises.
  ///   throws  Error(input)
  void (*read)(std::string_view bytes);

  /// How the names end that a fracture gives such files, or empty: it writes none.
  const char* written;

  std::vector<std::string> handmade;
};

[[nodiscard]] std::span<const Target> targets();

/// The files that targets begin with: the ones made by hand, and all that a fracture of a small
/// mesh writes.
///   return  [targets()][files]
[[nodiscard]] std::vector<std::vector<std::string>> startingFiles();

/// Write these as DIR/NAME/0, DIR/NAME/1, ...
void writeCorpus(const std::filesystem::path& folder);

/// Let a target's reader read bytes: they are read or refused by an Error(input) with a sentence,
/// or this aborts.
void readOrRefuse(const Target& target, std::string_view bytes);

}  // namespace sherd::fuzz
