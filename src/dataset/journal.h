// What is done of an object, noted as it is done.
#pragma once

#include <sherd/dataset.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
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

/// What the bytes of a journal tell, each field of it checked: what comes of it has all that the
/// index, figures and verification read, in the right kind and range.
///   name    of the file, for messages
///   throws  Error(input) "name:line: what": a line that is no JSON, out of place, or damaged
[[nodiscard]] JournalText parsedJournal(std::string_view bytes, const std::string& name);

/// The journal of an object that nobody writes to; empty where there is none.
///   throws  Error(input) as above; a symbolic link on the way to it
[[nodiscard]] JournalText readJournal(const std::filesystem::path& out,
                                      const LibraryObject& object);

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
  ///   throws  Error(output) it cannot be written, another process holds it, a symbolic link on the
  ///           way to it; Error(input) it is damaged
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

/// Where the journal of an object is, below the dataset's folder.
[[nodiscard]] std::string journalName(const LibraryObject& object);

[[nodiscard]] Json jsonOf(const std::vector<FileRecord>& files);
[[nodiscard]] std::vector<FileRecord> filesOf(const Json& line);

}  // namespace sherd
