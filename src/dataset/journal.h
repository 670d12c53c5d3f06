// What is done of an object, noted as it is done.
#pragma once

#include <sherd/dataset.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "dataset/store.h"

namespace sherd {

using Json = nlohmann::ordered_json;

/// What a journal tells.
struct JournalText {
  std::string sha256;           ///< of the object's file when it was begun; empty before
  std::vector<Json> fractures;  ///< lines of fractures, in order
  bool done = false;
  std::optional<std::string> failed;
  std::uint64_t bytes = 0;  ///< of whole lines
};

/// A journal that nobody writes to; empty where there is none.
[[nodiscard]] JournalText readJournal(const std::filesystem::path& file);

/// Lines of JSON, one for each thing done:
///
///     {"object": key, "sha256": ..}                 first
///     {"fracture": "whole", "fragments": [..], ..}  the unbroken object, then each fracture
///     {"done": true, "files": [..]}                 last; or {"failed": reason}
///
/// A line that is cut off does not count.  One process holds it at a time.
class Journal {
 public:
  /// Open, and read what is there.
  ///   throws  Error(output) it cannot be written, or another process holds it
  Journal(const std::filesystem::path& out, const LibraryObject& object);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  [[nodiscard]] const JournalText& text() const { return text_; }

  /// All files that fractures list.
  [[nodiscard]] std::vector<FileRecord> files() const;

  /// Bytes of the archive after the last of them.
  [[nodiscard]] std::uint64_t archiveBytes() const;

  void begin(const std::string& sha256);
  void add(Json fracture);
  void finish(const std::vector<FileRecord>& files);
  void fail(const std::string& reason);

  /// Forget everything.
  void clear();

 private:
  void write(const Json& line);

  std::filesystem::path file_;
  std::string key_;
  int descriptor_ = -1;
  JournalText text_;
};

/// Where the journal of an object is.
[[nodiscard]] std::filesystem::path journalOf(const std::filesystem::path& out,
                                              const LibraryObject& object);

[[nodiscard]] Json jsonOf(const std::vector<FileRecord>& files);
[[nodiscard]] std::vector<FileRecord> filesOf(const Json& line);

}  // namespace sherd
