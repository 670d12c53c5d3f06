// The journal of an object: a record of finished work.
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

#include "dataset/store/store.h"

namespace sherd {

using Json = nlohmann::ordered_json;

/// Why an object failed.
struct FailedObject {
  std::string reason;
  std::string sha256;      ///< of its file; empty where that could not be read
  bool isPassing = false;  ///< for want of memory, time or a device, or by a fault of the program:
                           ///< another run may break it
};

/// The content of a journal.
struct JournalText {
  std::string object;           ///< its key; empty before the first line
  std::string sha256;           ///< of the object's file at the beginning; empty before
  std::vector<Json> fractures;  ///< lines of fractures, in order
  bool done = false;
  std::vector<FileRecord> files{};  ///< of the last line: the finished archive
  std::optional<FailedObject> failed;
  std::uint64_t bytes = 0;  ///< of complete lines
  std::string sum;          ///< of the last line
};

/// Returns a line with its checksum as last field, "sum", and a line break.  The sum is of the line
/// and of the line before, so that lines can't be changed, exchanged or left out.
///   line    an object's JSON text
///   before  the sum of the line before, empty for the first; set to the line's
[[nodiscard]] std::string sealedLine(std::string line, std::string& before);

/// Parses a journal and checks every field: the result has all fields that the index, statistics
/// and verification read, of the right kind and in range.
///   name    of the file, for messages
///   throws  Error(input) "name:line: what": a line has another checksum, is not JSON, out of
///           order, or damaged
[[nodiscard]] JournalText parsedJournal(std::string_view bytes, const std::string& name);

/// Reads an object's journal without locking it; empty if there is none.
///   throws  Error(input) as parsedJournal; it is another object's; a symbolic link on its path
[[nodiscard]] JournalText readJournal(const std::filesystem::path& out,
                                      const LibraryObject& object);

/// A file of JSON lines, one per finished step:
///
///     {"object": key, "sha256": ..}                 first
///     {"fracture": "whole", "fragments": [..], ..}  the intact object, then each fracture
///     {"done": true, "files": [..]}                 last; or {"failed": reason, "of": key, ..}
///
/// Each ends with its checksum, see sealedLine.  An incomplete last line is ignored.  One process
/// locks it at a time.
class Journal {
 public:
  /// Opens or creates the journal, and reads it.
  ///   throws  Error(output) it cannot be written, another process holds it, a symbolic link on its
  ///           path; Error(input) it is damaged
  Journal(const std::filesystem::path& out, const LibraryObject& object);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  [[nodiscard]] const JournalText& text() const { return text_; }

  /// Returns all files that fractures list.
  [[nodiscard]] std::vector<FileRecord> files() const;

  /// Bytes of the archive after the last fracture.
  [[nodiscard]] std::uint64_t archiveBytes() const;

  void begin(const std::string& sha256);
  void add(const Json& fracture);
  void finish(const std::vector<FileRecord>& files);
  void fail(const FailedObject& failed);

  /// Empties the journal.
  void clear();

 private:
  void write(const Json& line);

  std::filesystem::path file_;
  std::string key_;
  int descriptor_ = -1;
  JournalText text_;
};

/// Returns the path of an object's journal below the dataset's folder.
[[nodiscard]] std::string journalName(const LibraryObject& object);

[[nodiscard]] Json jsonOf(const std::vector<FileRecord>& files);
[[nodiscard]] std::vector<FileRecord> filesOf(const Json& line);

}  // namespace sherd
